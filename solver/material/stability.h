/* How far a hyperelastic law is stable. */
#ifndef PNEULAB_MATERIAL_STABILITY_H
#define PNEULAB_MATERIAL_STABILITY_H

#include <jansson.h>
#include "solver/material/law.h"

/* Stretches up to which is looked, and down to its inverse. */
#define STABILITY_STRETCH_MAX 8.0

/* First stretch from 1 towards `limit` (below 1: compression) at which the law breaks Drucker's
 * condition (law_tangent is no longer positive definite) in this deformation, to 1e-9; NAN when it
 * never does. */
double stability_lost(const struct material_spec *material, enum deformation deformation,
                      double limit);

/* First stretch at which the engineering stress in the deformation no longer grows with the
 * deformation (material_tangent), where a dead load would run away; NAN when it always grows. It
 * comes before the loss of Drucker's condition in tension, after it in compression. */
double stability_peak(const struct material_spec *material, enum deformation deformation,
                      double limit);

/* Looks at uniaxial, equibiaxial and planar tension and compression.
 * low, high: stretches that the material is meant for; a loss within them is a warning.
 * *stability: a new array of objects, "deformation", "side", "stable" (over that range),
 * "lost_at_stretch" and "peak_at_stretch" (up to STABILITY_STRETCH_MAX; null: none). Sentences are
 * appended to `warnings`. STATUS_OK or NO_MEMORY. */
enum status stability_report(const struct material_spec *material, double low, double high,
                             json_t **stability, json_t *warnings);

#endif
