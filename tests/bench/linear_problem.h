/* Linear systems of the size and kind that a solve meets, for the comparison of solvers. */
#ifndef PNEULAB_TESTS_LINEAR_PROBLEM_H
#define PNEULAB_TESTS_LINEAR_PROBLEM_H

#include "solver/fe/model.h"
#include "tests/bench/bench.h"

/* The tangent of a body in equilibrium under pressure, as a sum of cliques, with the right-hand
 * side of a pressure step. The pattern holds every pair of faces that may touch, as a solve
 * needs it to keep one analysis; pairs that do not touch carry zeros. */
struct linear_problem {
  struct mesh mesh;
  struct fe_model *model;
  struct fe_state state;
  double pressure;    /* of the last equilibrium, Pa */
  bool reached;       /* the path got to the pressure that was asked for */
  int factorizations; /* of that path */
  int touching;       /* contact cliques with values */
  int clique_count;
  int *start; /* clique_count + 1, into dofs; dofs is -1 where held */
  int *dofs;
  double *b; /* dof_count */
};

/* The assembled matrix: lower triangle by columns, rows ascending. */
struct linear_matrix {
  int order;
  int *start;    /* order + 1 */
  int *row;      /* start[order] */
  double *value; /* start[order] */
  int *place;    /* for every value of every clique: its index in value, -1 where held */
};

/* Follows the path of `spec` to its pressure, with or without contact, and evaluates the tangent
 * there. stiffness_factor multiplies the pressure in the load's part of the tangent: 1 is the
 * true tangent, larger values make it indefinite. On success the caller releases *problem. */
enum status linear_problem_create(const struct job_spec *spec, bool contact,
                                  double stiffness_factor, struct linear_problem *problem,
                                  struct error *error);
void linear_problem_release(struct linear_problem *problem);

/* ||A x - b|| / ||b||. */
double linear_problem_residual(const struct linear_problem *problem, const double *x);

/* Pattern of the assembled matrix; on success the caller releases *matrix. */
enum status linear_matrix_create(const struct linear_problem *problem,
                                 struct linear_matrix *matrix);
void linear_matrix_release(struct linear_matrix *matrix);

/* Adds up the cliques in matrix->value. */
void linear_matrix_fill(const struct linear_problem *problem, struct linear_matrix *matrix);

#endif
