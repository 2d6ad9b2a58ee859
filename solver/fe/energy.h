/* The energy of a body and what has changed it, over steps at rest and in motion. */
#ifndef PNEULAB_FE_ENERGY_H
#define PNEULAB_FE_ENERGY_H

#include "solver/fe/inertia.h"

/* All in J, of the modelled body (half of it for a half model). */
struct energy {
  double strain, kinetic;            /* now */
  double pressure_work, weight_work; /* done on the body since the start, by the pressure in its
                                      * cavities and by the dead load */
  double obstacle_work;              /* by obstacles that were moved */
  double damping, friction;          /* dissipated since the start */
  double remainder; /* lost besides: work - change of strain and kinetic energy - dissipated. The
                     * time integration dissipates it, and the works, taken by the trapezoidal
                     * rule, err by it */
  /* At the start, and at the last record. */
  double start;
  double pressure, volume, dead, lift;
};

/* Strain energy int W + p (J - 1) - p^2 / (2 kappa) dV, J. */
double energy_strain(const struct fe_model *model, const struct fe_state *state);

/* The power that the viscosity (Pa s) dissipates at the state, int |S|^2 / (2 viscosity) dV with
 * the stress S that `inertia` gives it there, W. */
double energy_viscous_power(const struct fe_model *model, const struct inertia *inertia,
                            const struct fe_state *state, double viscosity);

/* Begins the ledger at a state in equilibrium with a load, or moving with a kinetic energy. */
void energy_start(struct energy *energy, const struct fe_model *model, const struct fe_state *state,
                  const struct fe_load *load, double kinetic);

/* What one accepted step has done besides changing state and load. */
struct energy_step {
  double kinetic;       /* at its end */
  double damping;       /* dissipated */
  double friction;      /* dissipated */
  double obstacle_work; /* done by obstacles on the body */
};

/* Records an accepted step that ended in the state under the load. */
void energy_record(struct energy *energy, const struct fe_model *model,
                   const struct fe_state *state, const struct fe_load *load,
                   const struct energy_step *step);

#endif
