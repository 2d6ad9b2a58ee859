/* The result document of a `response` job, gathered while the load path is followed. */
#ifndef PNEULAB_POST_RESULT_H
#define PNEULAB_POST_RESULT_H

#include <jansson.h>
#include "solver/fe/path.h"
#include "solver/job/spec.h"
#include "solver/post/sample.h"

struct result;

/* spec and model must outlive the result, which the caller owns. NULL when memory
 * runs out. */
struct result *result_create(const struct job_spec *spec, struct fe_model *model);
void result_destroy(struct result *result);

/* Notes whether the path started from that of a neighbouring design. */
void result_note_start(struct result *result, bool warm);

/* Takes in one converged state: recorded ones become samples and midlines, all of them serve to
 * find the onset of contact. STATUS_OK, STATUS_NO_MEMORY, or STATUS_IO when its files cannot be
 * written. */
enum status result_add(struct result *result, const struct path_point *point);

/* Has the fields of every recorded state to come written into `directory`, which is there and
 * outlives the result. STATUS_NO_MEMORY. */
enum status result_export(struct result *result, const char *directory, struct error *error);

/* After result_export, at the end of the path: writes surface.json, the tables and the deck into
 * the same directory and lists all files as artifacts. Also returns the failure that ended the
 * path when files could not be written on the way: STATUS_IO or STATUS_NO_MEMORY. */
enum status result_write_files(struct result *result, const char *directory, struct error *error);

/* Tells what a finer mesh gives for the last recorded state, as measure of the metrics' errors.
 * finer is NULL when that failed: `error` then says why, and becomes a warning. cpu_s is the CPU
 * time it took. */
void result_compare(struct result *result, const struct sample *finer, const struct error *error,
                    double cpu_s);

/* The cause of a path's end, looked at with its last converged states: a path that broke down
 * where the material law had lost its stability ends with UNSTABLE, other causes stay. Changes
 * `error` along. */
enum status result_cause(const struct result *result, enum status status, struct error *error);

/* The document, a new reference; `status` and `error` tell how the path ended. wall_s and cpu_s
 * are those of the whole run. NULL when memory runs out. */
json_t *result_document(struct result *result, enum status status, const struct error *error,
                        double wall_s, double cpu_s);

#endif
