/* The measured steps of an identify job: from the text of its tables to trials. */
#ifndef PNEULAB_JOB_TRIALS_H
#define PNEULAB_JOB_TRIALS_H

#include "solver/job/identify.h"

enum { TRIAL_ROWS_MIN = 8, TRIALS_MAX = 10000 };

/* Rows of one trial, in SI units. Arrays belong to the struct trials. */
struct trial {
  char name[IDENTIFY_NAME];
  size_t count;
  const double *time, *set_point, *h, *pressure;
  const int *line;  /* of each row in its table */
  char pointer[40]; /* to the text of its table in the job */
  bool held_out;
};

struct trials {
  size_t count;
  struct trial *trial;
  size_t block_count;
  double **block; /* columns that the trials point into */
  int **lines;
};

/* Reads the trials from the document of the job; the caller releases them.
 * STATUS_INVALID with the pointer and, where one is to blame, the line of the table: what
 * table_read refuses; names of columns that say the opposite of what they are used for; rows of a
 * trial that stand apart; times that do not rise; fewer than TRIAL_ROWS_MIN rows; elongations,
 * pressures and times of another unit (ranges of h beyond 1 um to 10 m, of pressures that do not go
 * with the set-points, intervals over 60 s); a pressure that never changes; names in held_out that
 * no trial has; no trial left.
 * STATUS_TOO_LARGE for more than TRIALS_MAX trials or what table_read calls so; NO_MEMORY. */
enum status trials_read(const json_t *document, const struct identify_spec *spec,
                        struct trials *trials, struct error *error);
void trials_release(struct trials *trials);

#endif
