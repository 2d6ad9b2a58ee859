/* One design against a much finer solution: true errors of the metrics and their estimates. */
#ifndef PNEULAB_TESTS_ERROR_CASE_H
#define PNEULAB_TESTS_ERROR_CASE_H

#include "solver/job/spec.h"

enum { ERROR_METRICS = 6 };

struct error_metric {
  const char *name; /* as in the result */
  double value, reference, estimate;
};

struct error_case {
  struct error_metric metric[ERROR_METRICS];
  int unknowns, reference_unknowns;
  double solve_s, estimate_s; /* CPU time of load path and estimate */
};

/* Solves the job as pneulab-solve does: all of *result but the references and their unknowns. An
 * estimate that is missing is NAN. STATUS_OK or why there is no solution, with *error. */
enum status error_case_metrics(const struct job_spec *spec, struct error_case *result,
                               struct error *error);

/* The same, and once more on a mesh whose cells subdivide those of the
 * job in every direction, to which the last state of the load path is carried. Its own error is
 * about a tenth of that of the job's mesh, the corners being singular.
 * STATUS_OK or why a solution is missing, with *error. */
enum status error_case_run(const struct job_spec *spec, struct error_case *result,
                           struct error *error);

/* |value - reference|, but at least `resolution` (1e-3) of the reference: the reference is not
 * known better. */
double error_case_truth(const struct error_metric *metric);

/* Whether the estimate reaches the true error, and whether they are within a factor 3. */
bool error_case_covers(const struct error_metric *metric);
bool error_case_is_near(const struct error_metric *metric);

#endif
