/* Inside of the reading of a study: how many members it has, and whether they are too many. */
#ifndef PNEULAB_JOB_STUDY_SIZE_H
#define PNEULAB_JOB_STUDY_SIZE_H

#include "solver/job/study.h"

/* The sampling of a study's document. */
bool study_is_list(const json_t *document);
bool study_is_grid(const json_t *document);

/* Whether it spreads its members over ranges: "latin-hypercube", "sobol", "halton" or
 * "optimise". */
bool study_is_spread(const json_t *document);

/* The kind of its members, borrowed from the document. */
const char *study_base_kind(const json_t *document);

/* Number of values of a parameter. */
size_t study_value_count(const json_t *parameter);

/* Number of members, at most one more than are allowed. */
size_t study_count(const json_t *document);

/* Whether the document has what its sampling needs, and neither too many members nor too much text.
 * STATUS_OK, STATUS_INVALID or STATUS_TOO_LARGE. */
enum status study_check_size(const json_t *document, struct error *error);

#endif
