/* Surrogates of the metrics of studies: fitted once and kept for as long as the data are the same.
 */
#ifndef PNEULAB_STUDY_MODEL_H
#define PNEULAB_STUDY_MODEL_H

#include <stdatomic.h>
#include "server/study/space.h"

/* Most members that a surrogate is made of: a fit takes seconds of processor time, a prediction
 * 30 us. Of more a random choice is used. */
enum { MODEL_POINTS_MAX = 600 };

/* A fitted surrogate. It is not changed any more and needs no table. */
struct model {
  atomic_uint uses;
  struct space space;
  struct surrogate *surrogate;
  size_t members;                       /* of the study so far */
  size_t succeeded;                     /* of those */
  size_t complete;                      /* of those with the metric and all parameters */
  size_t points;                        /* of those that it was made of */
  size_t *row;                          /* [points]: rows of the table */
  double *known, *left_out, *deviation; /* [points]: value, predicted without it, and how sure */
};

struct models;

/* The caller owns *models. GSL's error handler is switched off for the process. */
enum status models_create(struct models **models, struct error *error);
void models_destroy(struct models *models);

/* The surrogate of a metric (column of the table), kept or fitted now; one is fitted at a time. Its
 * use ends with model_release. STATUS_INVALID when fewer than 4 members have what it takes;
 * otherwise the failures of surrogate_create. */
enum status models_get(struct models *models, const struct study_table *table, size_t metric,
                       struct model **model, struct error *error);
void model_release(struct model *model); /* NULL is fine */

/* The metric expected of a design and, unless NULL, its standard deviation: that of the surrogate
 * and of the noise together. NAN for a design without a value. */
void model_predict(const struct model *model, const double *design, double *mean,
                   double *deviation);

/* What it was made of and how good it is, for answers: an object. NULL without memory. */
json_t *model_view(const struct model *model);

#endif
