/* Carries a body over a jump: from a state that has no equilibrium at the wanted load nearby, in
 * motion, to where it rests again. */
#ifndef PNEULAB_FE_DYNAMICS_CARRY_H
#define PNEULAB_FE_DYNAMICS_CARRY_H

#include "solver/fe/dynamics.h"

struct carry_options {
  double duration; /* carry for so long, s; 0: until the body rests */
  double driven;   /* the drive moves things until so long after the start: no rest before, s */
  double longest;  /* give up after so much time, s */
  int steps;       /* or so many steps */
  double wall_s;   /* or so much time on the wall; 0: no limit besides that of the solver */
  double quiet;    /* rest is tried when the kinetic energy has fallen to this share of its peak */
  double leftover; /* and found when no more energy is lost by it, as a part of what has moved or
                    * been dissipated: at a turning point much more would be */
  double near;     /* and when it is so near to the moving state, rms, m */
  struct dynamics_drive drive; /* all NULL: load and obstacles stay as they are */
};

/* How it went. Energies in J of the modelled body, since the start of the carrying. */
struct carry_report {
  bool rested;                     /* the state is a stable equilibrium at rest */
  double time;                     /* in motion, s */
  int steps, rejected, iterations; /* steps; attempts that did not do; factorisations of all */
  double peak_kinetic;
  double damping, friction, remainder; /* dissipated; see struct energy */
  enum status reason;                  /* why it ended without rest, else OK */
};

/* Limits for the dynamics: until at rest, at most 4000 times dynamics_scale, 400 steps and 60 s on
 * the wall; quiet 1e-3; leftover 1e-2; near 2e-3 of the body's length. */
struct carry_options carry_defaults(const struct dynamics *dynamics);

/* From a state that rests, or moves as `motion` says (motion_clear for one at rest), under *load as
 * it is at `motion`'s time and then by the drive, until the body rests: the kinetic energy is
 * nearly gone and the equilibrium next to the state, which then becomes the state, is stable; or
 * for the given duration. A load that is another one than that of the state comes on within the
 * first step. A motion->step of 0 stands for a twentieth of dynamics_scale. *energy, unless NULL,
 * records every step; without it the report tells of no dissipation. Returns STATUS_OK; else the
 * state is the last one accepted: STATUS_DIVERGED when it still moves at the end of the limits,
 * STEP_MINIMUM, TIMEOUT, CANCELLED, NO_MEMORY, or what the drive returned, with *error. The report
 * is always filled. */
enum status dynamics_carry(struct dynamics *dynamics, const struct carry_options *options,
                           struct fe_load *load, struct fe_state *state, struct motion *motion,
                           struct energy *energy, struct carry_report *report, struct error *error);

#endif
