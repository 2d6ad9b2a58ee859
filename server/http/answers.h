/* Answers that are asked for again and again. The view of a job at rest is kept as it was sent,
 * until the database changes: the version of the store decides, so no writer has to think of this.
 * What a result can be drawn as never changes; it is kept by job. */
#ifndef PNEULAB_HTTP_ANSWERS_H
#define PNEULAB_HTTP_ANSWERS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/plot/plot.h"
#include "solver/base/error.h"

struct answers;
struct store;

/* A text that lives as long as anybody uses it. */
struct answer {
  atomic_uint uses;
  size_t size;
  char text[];
};

/* The caller owns *answers; the store outlives it. */
enum status answers_create(struct store *store, struct answers **answers, struct error *error);
void answers_destroy(struct answers *answers);

/* The kept view of the job if it still holds, else NULL. Its use ends with answer_release. */
struct answer *answers_find(struct answers *answers, int64_t job_id);

/* Ends a use; text is that of the answer. */
void answer_release(void *text);

/* Keeps a copy of the view of a job. version: that of the store before the job was read. */
void answers_keep(struct answers *answers, int64_t job_id, uint64_t version, const char *text,
                  size_t size);

/* The plots of a finished job, as plot_names_for gave them. */
bool answers_plots(struct answers *answers, int64_t job_id, const char *names[PLOT_NAMES]);
void answers_keep_plots(struct answers *answers, int64_t job_id, const char *names[PLOT_NAMES]);

#endif
