/* A job's body a little to either side of one parameter, for central differences. */
#ifndef PNEULAB_POST_VARIATION_H
#define PNEULAB_POST_VARIATION_H

#include "solver/fe/sensitivity.h"
#include "solver/job/parameter.h"

struct variation {
  const struct job_parameter *parameter;
  struct variant side[2];           /* below and above */
  struct material_spec material[2]; /* of the sides */
  double *x[2];                     /* nodes of the sides, NULL when they are those of the body */
  /* 1 / distance of the sides, per unit of the parameter; 0 when the body has no neighbour of the
   * same layout on either side. */
  double scale;
};

/* Varies `parameter` of `spec`, everything else that the job gives being held; `original` is the
 * body itself on `mesh`, which stands in for a side that cannot exist or whose mesh has another
 * layout. A half model stands for both halves: there one lateral taper stands for half of both.
 * Spec, parameter and original must outlive the variation. STATUS_OK or NO_MEMORY; the caller
 * releases it in either case. */
enum status variation_create(const struct job_spec *spec, const struct mesh *mesh,
                             const struct variant *original, const struct job_parameter *parameter,
                             struct variation *v);
void variation_release(struct variation *v);

/* Whether the parameter is a taper of one of two sides of which only one is modelled. */
bool variation_one_sided(const struct job_spec *spec, const struct job_parameter *parameter);

#endif
