/* Inside of the search of a study, shared by its files. */
#ifndef PNEULAB_JOB_STUDY_SEARCH_H
#define PNEULAB_JOB_STUDY_SEARCH_H

#include "solver/explore/optimise.h"
#include "solver/job/study_constraint.h"
#include "solver/job/study_objective.h"
#include "solver/job/study_optimise.h"
#include "solver/job/study_range.h"

enum { SEARCH_STARTS_MAX = 32, SEARCH_BUDGET = 40 };

/* What became of a design that was asked for. */
enum search_state {
  SEARCH_OPEN,
  SEARCH_SOLVED,
  SEARCH_FAILED, /* no result, or one without what the objective takes */
  SEARCH_REFUSED /* no body: it never became a member */
};

struct search_design {
  enum search_state state;
  size_t member; /* unless refused */
  double x[OPTIMISE_PARAMETERS_MAX];
  double *value, *gradient; /* of a solved one, in one piece of memory at value */
  char reason[120];         /* of a failed one */
};

/* One start and the designs it has asked for, in order. */
struct search_line {
  double x[OPTIMISE_PARAMETERS_MAX];
  size_t budget;
  size_t count;
  struct search_design *design; /* budget */
  bool ended;
  struct optimise_outcome outcome; /* as far as is known */
};

/* One side of a constraint on a sum: sign (sum - bound) / scale has to be 0 or less. */
struct search_side {
  const struct study_constraint *constraint;
  double sign, bound, scale;
};

struct study_search {
  const struct job_reader *reader;
  json_t *document;
  size_t parameters;
  const char *pointer[OPTIMISE_PARAMETERS_MAX]; /* in the document */
  struct study_range range[OPTIMISE_PARAMETERS_MAX];
  double si[OPTIMISE_PARAMETERS_MAX];     /* one of the range's unit in SI, 1 for numbers */
  double factor[OPTIMISE_PARAMETERS_MAX]; /* one of the range's unit in that of derivatives */
  bool derivatives;
  struct study_objective objective;
  struct study_constraints constraints;
  size_t sides;
  struct search_side side[2 * CONSTRAINTS_MAX];
  enum optimise_method method;
  double tolerance;
  size_t starts;
  struct search_line line[SEARCH_STARTS_MAX];
  size_t members; /* asked for */
  size_t told;
};

/* The parameter at x of [0, 1], in the unit of its range, and its derivative. */
double search_value(const struct study_range *range, double x);
double search_slope(const struct study_range *range, double x);

/* A side condition, in the form that struct optimise_problem asks for; context: the search. */
double search_side_value(void *context, size_t which, const double *x, double *gradient);

/* Fills all but the lines from the document. The failures of study_search_create. */
enum status search_read(struct study_search *search, struct error *error);

/* Appends the design at x to the values in the document, if it is a job that can be; *refused
 * otherwise, with *error saying why. STATUS_OK or STATUS_NO_MEMORY. */
enum status search_append(struct study_search *search, const double *x, bool *refused,
                          struct error *error);

/* The line and the design of a member; NULL for none. */
const struct search_design *search_member(const struct study_search *search, size_t member,
                                          size_t *line);

#endif
