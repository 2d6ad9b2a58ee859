/* The result document of a `verify` job: one case with a known solution, on a sequence of
 * meshes. */
#ifndef PNEULAB_VERIFY_VERIFY_H
#define PNEULAB_VERIFY_VERIFY_H

#include <jansson.h>
#include <stdio.h>
#include "solver/job/spec.h"
#include "solver/verify/report.h"

/* One case. All strings are static. */
struct verify_case {
  const char *name, *title;
  const char *quantity, *unit; /* what is compared; unit "1" for a ratio */
  const char *author, *source; /* of the reference */
  int year;
  const char *size;          /* meaning of the rows' size */
  const char *point;         /* key of the points' x, NULL without points */
  const char *x_label;       /* the points' x in words, with its unit */
  const char *y_label;       /* and what is computed and referred to there */
  double order;              /* expected slope of the error over the size, 0: none */
  const char *norm, *other;  /* names of the rows' two errors, NULL with one error only */
  double other_order;        /* expected slope of the second one */
  double bound;              /* of the error with one mesh, as a fraction */
  double worst_bound;        /* of the metric worst_error_percent, 0: as bound */
  const char *bound_because; /* where the bound comes from */
  /* Runs on run->refinement meshes and fills run->report. Returns STATUS_OK, or the reason for
   * which it stopped, with *error: the rows until then are kept. */
  enum status (*run)(struct verify_run *run, struct error *error);
};

/* The table of cases; *count receives their number. Static storage. */
const struct verify_case *verify_cases(int *count);
/* The case of that name, or NULL. */
const struct verify_case *verify_find(const char *name);

struct verify_options {
  FILE *events; /* progress as JSON lines, or NULL */
  bool (*cancelled)(void *context);
};

/* Runs the job. On success *document is a new reference and *ending tells how the solve ended:
 * one that stopped early gives a document too. STATUS_INVALID for an unknown case, NO_MEMORY. */
enum status verify_job(const struct job_spec *spec, const struct verify_options *options,
                       json_t **document, enum status *ending, struct error *error);

#endif
