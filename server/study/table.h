/* A study as a table: what its members differ in, and what came out of them. */
#ifndef PNEULAB_STUDY_TABLE_H
#define PNEULAB_STUDY_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/store/store.h"

/* A parameter or a metric. */
struct study_column {
  char *key;         /* JSON pointer of a parameter, name of a metric */
  char *title;       /* for people, without the unit */
  char *unit;        /* as shown: "mm", "°", "" for plain numbers and words */
  bool categorical;  /* its values are words */
  bool logarithmic;  /* its range is spread evenly in the logarithm */
  double low, high;  /* of the range of a parameter, or of the values; NaN when there are none */
  char **words;      /* of a categorical one, in the order in which they come */
  size_t word_count; /* 0 of numbers */
};

/* Row i is a member that is a job: rows are in the order of the members, and those that are not
 * stored yet, or were deleted, have none. */
struct study_table {
  int64_t study_id;
  char *name;               /* of the study */
  char *sampling;           /* "grid", "sobol", ... */
  enum job_state own_state; /* of the study */
  size_t members;           /* rows */
  size_t wanted;            /* members that the study will have, as far as is known */
  size_t parameters, metrics;
  struct study_column *parameter, *metric; /* metrics in the order of their names */
  int *member;                             /* its index in the study */
  int64_t *job_id;
  int *state;         /* enum job_state */
  char **reason;      /* why it has not succeeded, "" otherwise */
  char **member_name; /* never NULL */
  double *value;  /* [row * parameters + k]: number in the shown unit, or index of a word; NaN */
  double *result; /* [row * metrics + k]; NaN: none */
};

/* Reads a study as it is now; the caller owns *table. STATUS_NOT_FOUND when there is no such job,
 * or it is no study; one whose members are not known yet has an empty table. STATUS_NO_MEMORY,
 * STATUS_IO. About 100 ms for 10,000 members: see tables.h. */
enum status study_table_read(struct store *store, int64_t study_id, struct study_table **table,
                             struct error *error);

/* NULL is fine. */
void study_table_destroy(struct study_table *table);

#endif
