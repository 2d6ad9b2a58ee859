/* Analyses of studies, from the answers in which the daemon gives them to everybody
 * (server/study/analysis.h), as plots take them. */
#ifndef PNEULAB_PLOT_STUDY_ANSWER_H
#define PNEULAB_PLOT_STUDY_ANSWER_H

#include <jansson.h>
#include "server/plot/study_plot.h"

/* What the members of a study_plot_input point to; destroyed after drawing. */
struct study_answer;

/* For "history" the answer is an object with "objective" of the study's document and "history" of
 * its result.
 *
 * Reads the answer for `plot` (one that needs an analysis) into the field of *input that the plot
 * draws; other plots need none. What the answer lacks is left out. The caller destroys *read in
 * either case; it keeps its own reference to `answer`. STATUS_NO_MEMORY. */
enum status study_answer_read(const char *plot, json_t *answer, const struct study_table *table,
                              struct study_plot_input *input, struct study_answer **read,
                              struct error *error);
void study_answer_destroy(struct study_answer *read); /* NULL is fine */

#endif
