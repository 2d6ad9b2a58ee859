/* A hybrid model derived from the law of a cell.
 *
 * Of a row of n equal cells with the law F(e, p) of one:
 *   states of rest      h_c(u), h_s(u) = n times the elongation with F = 0 at p = u on either side
 *   gamma               -(F(e, p1) - F(e, 0)) / p1 at the natural length e = h_s(0) / n: the force
 *                       held there per pressure, p1 the largest pressure
 *   rests               0 and h_s(0)
 *   stiffness           k(u) = gamma u / (h(u) - rest), as a polynomial by least squares of the
 *                       relative differences, of the least degree that leaves less than HYBRID_FIT
 * of the travel in the states of rest, or of the best one; without 3 % of the set-points at either
 * end, where limit points are mass                of the plate and, with speeds that rise evenly
 * from the ground, of the cells damping             of one cell, divided by n alpha, beta -1/tau
 * and 1/tau: the lag, or of a chamber the mean over the set-points of tau = (V / n + P dV/du) / (P0
 * conductance), with V that of the states of rest; 1 ms of a direct supply guards              h_c
 * at the trigger, rising; h_s at the release, falling resets              where the plate comes to
 * rest or turns after the last snap of the simulated motion, with the pressure then; after the
 * return the compressed state of rest, with the pressure as it was range               set-points
 * from the release to the trigger, and to the largest pressure. */
#ifndef PNEULAB_BISTABLE_HYBRID_H
#define PNEULAB_BISTABLE_HYBRID_H

#include <jansson.h>
#include "solver/bistable/trajectory.h"

/* Largest difference of a state of rest that is accepted of a polynomial of low degree, of the
 * travel. */
#define HYBRID_FIT 0.005

struct hybrid {
  double trigger, release;              /* set-points, Pa */
  double trigger_h, release_h, natural; /* elongations, m */
  double gamma, mass, damping;
  double rate[2]; /* 1/tau, compressed and stretched */
  int count[2];   /* coefficients of k, multiplying (u / kPa)^i */
  double k[2][HLPV_TERMS_MAX];
  double error[2]; /* largest difference of states of rest, m */
  double guard[2]; /* h, of the trigger and of the release */
  double reset_h, reset_velocity, reset_pressure;
  double return_h;
};

/* Derives the model of the row of cells that the system has (the law of the first; their factors
 * do not count) up to the pressure `to`. trajectory: of its motion, or NULL for a reset to the
 * stretched state of rest at the trigger. STATUS_INVALID for a law without a trigger or a release
 * within its pressures, or without states of rest; STATUS_NO_MEMORY. */
enum status hybrid_derive(const struct bistable_system *system, double to,
                          const struct bistable_trajectory *trajectory, struct hybrid *hybrid,
                          struct error *error);

/* The model as a job of kind hlpv, set-points by eight steps up to `to` and down again, a new
 * reference; NULL without memory. */
json_t *hybrid_job(const struct hybrid *hybrid, const char *name, double rest_length, double to);

#endif
