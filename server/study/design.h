/* From the values of a design to the job that solves it. */
#ifndef PNEULAB_STUDY_DESIGN_H
#define PNEULAB_STUDY_DESIGN_H

#include "server/study/table.h"

/* The job document of a design of a study: its base and "set", with `values` (pointer of a
 * parameter -> number in the shown unit, word, or text as in a job), `name`, and the label
 * "study". Parameters without a value are as in the base. study: the study's own document. The
 * caller owns *document. STATUS_INVALID, with the pointer to the value, for a parameter that the
 * study does not have or a value that is none; STATUS_NO_MEMORY. */
enum status design_document(const json_t *study, const struct study_table *table,
                            const json_t *values, const char *name, json_t **document,
                            struct error *error);

#endif
