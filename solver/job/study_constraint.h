/* Inside of the reading of a study: limits on sums of parameters. */
#ifndef PNEULAB_JOB_STUDY_CONSTRAINT_H
#define PNEULAB_JOB_STUDY_CONSTRAINT_H

#include "solver/explore/sequence.h"
#include "solver/job/reader.h"

enum { CONSTRAINTS_MAX = 16 };

/* low <= sum of factor[k] times parameter k <= high, in SI. */
struct study_constraint {
  double factor[SEQUENCE_DIMENSIONS_MAX];
  double low, high;
  char unit[32]; /* of the limits, without the number; "" for numbers */
};

struct study_constraints {
  size_t count, parameters;
  struct study_constraint constraint[CONSTRAINTS_MAX];
};

/* The "constraints" of a study. STATUS_OK, or STATUS_INVALID with the pointer. */
enum status study_constraints_read(const struct reader *reader, const json_t *document,
                                   struct study_constraints *constraints);

/* *met: whether the last value of each list meets all constraints. STATUS_OK, or STATUS_INVALID for
 * a value that is no quantity of the constraint's dimension. */
enum status study_constraints_check(const struct study_constraints *constraints,
                                    const struct reader *reader, json_t *const *lists, bool *met);

#endif
