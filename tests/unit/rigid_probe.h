/* Rigid shapes looked at from outside: what their distance says against itself. */
#ifndef PNEULAB_TESTS_UNIT_RIGID_PROBE_H
#define PNEULAB_TESTS_UNIT_RIGID_PROBE_H

#include "solver/rigid/shape.h"

/* A number of a repeatable sequence, uniform in [low, high). */
double probe_random(unsigned *state, double low, double high);

/* Asserts at `count` points around the shape, from `depth` (m) inside to `depth` outside, that the
 * normal is the gradient of the distance and the curvature that of the normal (central differences
 * of `step` m, to `tolerance` relative to 1/depth), that the normal has unit length, that the
 * curvature is symmetric and leaves the normal alone, and that the foot lies on the surface. Points
 * whose neighbours of the differences have another curvature are left out, of which there may be
 * one in twenty. */
void probe_derivatives(const struct rigid_shape *shape, double depth, int count, double step,
                       double tolerance);

/* Asserts that distance, normal and curvature of a turned and shifted shape are those of the shape
 * at rest, turned. */
void probe_turned(const struct rigid_shape *shape, double depth, int count);

#endif
