/* Whether a deformed body holds points of its own surface, found from the elements alone: nothing
 * of the solver's contact is used. */
#ifndef PNEULAB_TESTS_PHYSICS_INSIDE_H
#define PNEULAB_TESTS_PHYSICS_INSIDE_H

#include "solver/fe/model.h"

/* Largest depth (m) below the surface of the body displaced by u, among the nodes of the outer
 * surface and base that lie in sections from .. to; 0 when all are outside. */
double inside_nodes(const struct mesh *mesh, const double *u, int from, int to);

/* The same of the Gauss points of the faces whose middle lies in those sections. */
double inside_points(const struct fe_model *model, const double *u, int from, int to);

#endif
