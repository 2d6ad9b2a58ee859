/* What the parts of the result document share. */
#ifndef PNEULAB_POST_RESULT_INTERNAL_H
#define PNEULAB_POST_RESULT_INTERNAL_H

#include "solver/post/export.h"
#include "solver/post/result.h"

/* One end of the body's contact history: a converged state still open. */
struct open_state {
  double pressure, gap;
};

struct result {
  const struct job_spec *spec;
  struct fe_model *model;
  struct sample *sample;
  size_t sample_count;
  json_t *midlines;
  json_t *artifacts;
  json_t *arc;               /* states that arc length found, in the order of the path */
  struct open_state open[2]; /* the last two states without contact, newest first */
  int open_count;
  double arc_stretch;          /* largest of the states that are not recorded */
  double onset;                /* Pa, negative until contact */
  double penetration;          /* largest over recorded states, m */
  struct fe_state first, last; /* recorded states */
  bool warm;                   /* the path started from a neighbouring design's */
  struct export *export;       /* NULL: no files are wanted */
  struct error failure;        /* of writing files on the way */
  bool compared;               /* `finer` holds the last recorded state on a finer mesh */
  struct sample finer;
  double estimate_s;     /* CPU time of that, s */
  struct error estimate; /* why it failed */
};

/* The samples of the document, a new reference. */
json_t *result_samples(const struct result *result);

/* Adds the error estimates to the metrics, as "<metric>_error", when there is a finer solution. */
void result_set_errors(const struct result *result, json_t *metrics);

/* Warnings of the run as a JSON array, a new reference: unstable material, stretch beyond the
 * fit, overlapping chambers. */
json_t *result_warnings(const struct result *result);

#endif
