/* Two oblique rows of the tests: a short body with few chambers. */
#ifndef PNEULAB_TESTS_PHYSICS_OBLIQUE_CASE_H
#define PNEULAB_TESTS_PHYSICS_OBLIQUE_CASE_H

#include "solver/job/spec.h"
#include "solver/solve.h"

/* Fills the spec of a body 25 mm wide and 20 mm high with `chambers` in each row, its bottom layer
 * 6 mm, cavities 4 mm and gaps 1.5 mm wide; whole model, coarse mesh, neo-Hooke of 0.4 MPa, both
 * rows at 20 kPa in two steps, no contact, dimensions of a channel but none. */
void oblique_prototype(struct job_spec *spec, double angle_deg, int chambers);

/* Sets angle and length; the solid ends, 3 mm, are kept. */
void oblique_turn(struct oblique_spec *p, double angle_deg);

/* Builds the mesh and follows the load of the spec to its end; a path that stops early fails the
 * test. The caller releases *solve. */
void oblique_follow(const struct job_spec *spec, struct solve *solve);

#endif
