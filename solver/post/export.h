/* The files of a run: fields at the recorded states, tables, and the input deck.
 *
 * Fields are written while the path is followed: surface-NNNN.vtu, the skin of the whole body,
 * and volume-NNNN.vtu, the elements as they were solved (half of the body where symmetry allowed
 * that), NNNN being the number of the recorded state; surface.pvd and volume.pvd list them by
 * pressure in kPa. Of a run with many recorded states every n-th and the last get files; the same
 * states are in surface.bin. */
#ifndef PNEULAB_POST_EXPORT_H
#define PNEULAB_POST_EXPORT_H

#include <jansson.h>
#include "solver/fe/model.h"
#include "solver/job/spec.h"

enum { EXPORT_STATES = 50 }; /* states with files, besides the first and the last */

struct export;

/* Files go into `directory`, which is there. All three have to outlive the export. On success
 * the caller owns *out. STATUS_NO_MEMORY. */
enum status export_create(const struct job_spec *spec, const struct fe_model *model,
                          const char *directory, struct export **out, struct error *error);
void export_destroy(struct export *export);

/* Takes in the next recorded state, at which the model's contact was last evaluated, and writes
 * its files and the collections. STATUS_IO or STATUS_NO_MEMORY. */
enum status export_add(struct export *export, const struct fe_state *state, double pressure,
                       struct error *error);

/* Writes the files of the last recorded state unless they are there, samples.csv, midlines.csv,
 * surface.bin and model.inp, and appends the names of all files to `artifacts`. `samples` and `midlines` are
 * those of the result document, `last` is the last recorded state. */
enum status export_finish(struct export *export, const struct fe_state *last, const json_t *samples,
                          const json_t *midlines, json_t *artifacts, struct error *error);

#endif
