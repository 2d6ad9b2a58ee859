/* What the parts of the result document share. */
#ifndef PNEULAB_POST_RESULT_INTERNAL_H
#define PNEULAB_POST_RESULT_INTERNAL_H

#include "solver/post/export.h"
#include "solver/post/result.h"
#include "solver/post/shape.h"

/* One recorded state in numbers. */
struct sample {
  double pressure; /* Pa */
  struct shape shape;
  double cavity_volume; /* m3, whole body */
  double min_gap;       /* m, INFINITY without facing faces */
  double max_stretch;
  int iterations;
};

/* One end of the body's contact history: a converged state still open. */
struct open_state {
  double pressure, gap;
};

struct result {
  const struct job_spec *spec;
  struct fe_model *model;
  const struct retraction *retraction;
  struct sample *sample;
  size_t sample_count;
  json_t *midlines;
  json_t *artifacts;
  struct open_state open[2]; /* the last two states without contact, newest first */
  int open_count;
  double onset;                /* Pa, negative until contact */
  double penetration;          /* largest over recorded states, m */
  struct fe_state first, last; /* recorded states */
  struct export *export;       /* NULL: no files are wanted */
  struct error failure;        /* of writing files on the way */
};

/* The samples of the document, a new reference. */
json_t *result_samples(const struct result *result);

/* Warnings of the run as a JSON array, a new reference: unstable material, stretch beyond the
 * fit, overlapping chambers. */
json_t *result_warnings(const struct result *result);

#endif
