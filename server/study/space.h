/* The design space of a study: its parameters as the coordinates of a surrogate. A design is
 * double[parameters] as in a study_table: numbers in the shown unit, words by their index. */
#ifndef PNEULAB_STUDY_SPACE_H
#define PNEULAB_STUDY_SPACE_H

#include "server/study/table.h"
#include "solver/explore/surrogate.h"

/* How a parameter is given to a surrogate. */
enum space_coding {
  SPACE_NUMBER,
  SPACE_LOGARITHM, /* log10 */
  SPACE_FLAGS,     /* a coordinate for each word, 0 or 1; of two words one coordinate */
  SPACE_ORDER      /* the index of the word: of many words */
};

struct space_axis {
  enum space_coding coding;
  int first, width; /* its coordinates */
  bool whole;       /* all values are whole numbers without a unit */
  double low, high; /* range of numbers */
  size_t words;     /* 0 of numbers */
  double middle;    /* the median of numbers, the most frequent word */
};

struct space {
  size_t parameters;
  int width; /* coordinates in all, up to SURROGATE_PARAMETERS_MAX */
  struct space_axis axis[SURROGATE_PARAMETERS_MAX];
};

/* A word for the coding: "number", "logarithm", "flags", "order". */
const char *space_coding_word(enum space_coding coding);

/* Finds ranges and codings from the table. STATUS_INVALID for a study without parameters or without
 * a value, STATUS_TOO_LARGE for more than SURROGATE_PARAMETERS_MAX parameters, STATUS_NO_MEMORY. */
enum status space_make(const struct study_table *table, struct space *space, struct error *error);

/* The coordinates x[width] of a design. False when a value is missing. */
bool space_encode(const struct space *space, const double *design, double *x);

/* The design at u[parameters], each in [0, 1): evenly spread over the ranges (of logarithmic
 * parameters in the logarithm) and words. */
void space_design(const struct space *space, const double *u, double *design);

/* Where a design stands: u[parameters], the inverse of space_design; of words the middle of their
 * share. */
void space_place(const struct space *space, const double *design, double *u);

/* Rounds numbers to a power of ten of 1/500 to 1/5000 of their range (of logarithmic ones of their
 * size), or to whole ones, so that they read well. */
void space_round(const struct space *space, double *design);

/* The design at the middle of every parameter. */
void space_middle(const struct space *space, double *design);

/* A design as people and job documents see it: pointer -> number in the shown unit, or word. A new
 * reference; NULL without memory. */
json_t *space_values(const struct study_table *table, const double *design);

#endif
