/* The energy of a body and what has changed it, over steps at rest and in motion. */
#ifndef PNEULAB_FE_ENERGY_H
#define PNEULAB_FE_ENERGY_H

#include "solver/fe/inertia.h"

/* All in J, of the modelled body (half of it for a half model). */
struct energy {
  double strain, kinetic;            /* now; that of a free object counts */
  double pressure_work, weight_work; /* done since the start by the pressure in the cavities, and
                                      * by the dead load and the weight of a free object */
  double obstacle_work;              /* by obstacles that were moved */
  double damping, friction;          /* dissipated since the start */
  double remainder; /* lost besides: work - change of strain and kinetic energy - dissipated. The
                     * time integration dissipates it; the works, taken by the trapezoidal rule,
                     * err by it; and a contact that settles at another overlap than before (see
                     * equilibrium_options) takes or gives its force times the difference */
  /* At the start, and at the last record. */
  double start;
  double pressure, volume, dead, lift;
};

/* Strain energy int W + p (J - 1) - p^2 / (2 kappa) dV, J. */
double energy_strain(const struct fe_model *model, const struct fe_state *state);

enum { ENERGY_STRESS = 6 * HEX27_POINTS }; /* of one element, 27 row + point: 00 01 02 11 12 22 */

/* Viscous stresses S of all elements (Pa, ENERGY_STRESS each) that `inertia` gives at displacements
 * u, over those given; returns the work int (S before + S now)/2 : (C(u) - C(from))/2 dV of the way
 * from displacements `from`, J. That trapezoidal rule closes with that of the other works, while
 * the power of a rate that swings from step to step would not; and it sees no rigid motion. */
double energy_viscous(const struct fe_model *model, const struct inertia *inertia,
                      const double *from, const double *u, double *stress);

/* Begins the ledger at a state in equilibrium with a load, or moving with a kinetic energy. */
void energy_start(struct energy *energy, const struct fe_model *model, const struct fe_state *state,
                  const struct fe_load *load, double kinetic);

/* What one accepted step has done besides changing state and load. */
struct energy_step {
  double kinetic;       /* at its end */
  double weight_work;   /* of a free object */
  double damping;       /* dissipated */
  double friction;      /* dissipated */
  double obstacle_work; /* done by obstacles on the body */
};

/* The dead load of the model has become another one at this state: its work goes on from here. */
void energy_reload(struct energy *energy, const struct fe_model *model,
                   const struct fe_state *state);

/* Records an accepted step that ended in the state under the load. */
void energy_record(struct energy *energy, const struct fe_model *model,
                   const struct fe_state *state, const struct fe_load *load,
                   const struct energy_step *step);

#endif
