/* Built-in materials and what can be said about a hyperelastic law without solving anything. */
#ifndef PNEULAB_JOB_MATERIAL_H
#define PNEULAB_JOB_MATERIAL_H

#include "solver/job/spec.h"

/* Record number `index` of the built-in materials, NULL past the last one. Static storage. */
const struct material_spec *material_builtin(size_t index);

/* The built-in material of this name, or NULL. Static storage. */
const struct material_spec *material_find(const char *name);

/* Slope of the nominal stress with respect to the stretch, in Pa, of an incompressible body with
 * principal stretches stretch^(exponents[0..2]), stretch > 0, exponents of sum 0. It is the
 * second derivative of the energy along that path: uniaxial {1, -1/2, -1/2}, planar {1, 0, -1},
 * equibiaxial {1, 1, -2} (there it is twice the slope of the stress in one direction). */
double material_tangent(const struct material_spec *material, const double exponents[3],
                        double stretch);

/* Whether the tangent is positive in uniaxial, planar and equibiaxial tension for all stretches
 * from 1 to `stretch_max`. If not, *first_unstable (may be NULL) is the smallest stretch at which
 * one of the three vanishes, within 1e-9; otherwise it is left alone. */
bool material_stable_to(const struct material_spec *material, double stretch_max,
                        double *first_unstable);

#endif
