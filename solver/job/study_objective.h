/* Inside of the search of a study: what it makes small, and within which limits, out of the results
 * of members. */
#ifndef PNEULAB_JOB_STUDY_OBJECTIVE_H
#define PNEULAB_JOB_STUDY_OBJECTIVE_H

#include "solver/job/reader.h"

enum { OBJECTIVE_TERMS_MAX = 64, OBJECTIVE_LIMITS_MAX = 32, OBJECTIVE_STATIONS = 40 };

enum objective_kind {
  OBJECTIVE_MINIMISE,
  OBJECTIVE_MAXIMISE,
  OBJECTIVE_TARGETS,
  OBJECTIVE_PROFILE
};

/* sign (metric - value) / scale. */
struct objective_term {
  const char *metric; /* in the document */
  double pressure;    /* kPa; NAN: the last one */
  double value, scale, sign;
};

struct study_objective {
  enum objective_kind kind;
  size_t term_count; /* 1 of a metric, 0 of a profile */
  struct objective_term term[OBJECTIVE_TERMS_MAX];
  size_t limit_count; /* terms that have to be 0 or less */
  struct objective_term limit[OBJECTIVE_LIMITS_MAX];
  double pressure;                        /* of the profile, as above */
  double profile[3 * OBJECTIVE_STATIONS]; /* mm, at equal parts of its length without the base */
  double length;                          /* of the profile, mm */
};

/* How a member does, in numbers for people. */
struct objective_figures {
  double objective; /* the metric; the relative deviation of targets, rms; the distance, rms, mm */
  double max_distance; /* of a profile, mm; otherwise NAN */
  double violation;    /* largest of the limits, relative; 0 for none */
};

/* Reads "objective" and the limits on metrics among the "constraints". It refers to the document.
 * pressure_to: of the base, kPa, NAN for a base without pressures. STATUS_OK or STATUS_INVALID. */
enum status study_objective_read(const struct reader *reader, const json_t *document,
                                 double pressure_to, struct study_objective *objective);

/* Residuals (0 for a single metric), and all functions: these or the metric, then the limits. */
size_t study_objective_residuals(const struct study_objective *objective);
size_t study_objective_functions(const struct study_objective *objective);

/* Whether the solver has derivatives of all that the objective takes. */
bool study_objective_differentiable(const struct study_objective *objective);

/* The functions of a result into value[], and unless gradient is NULL their derivatives to the
 * `count` parameters of its block "sensitivity" into gradient[functions x count], each times
 * factor[k]. Returns what the result lacks, or NULL when all is there. */
const char *study_objective_evaluate(const struct study_objective *objective, const json_t *result,
                                     size_t count, const double *factor, double *value,
                                     double *gradient);

/* What the functions of a member come to. */
struct objective_figures study_objective_figures(const struct study_objective *objective,
                                                 const double *value);

/* Name of the figure that is made small or large: a metric, "relative_deviation" or
 * "rms_distance_mm". */
const char *study_objective_name(const struct study_objective *objective);

#endif
