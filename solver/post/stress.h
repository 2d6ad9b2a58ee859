/* Cauchy stress at the nodes. */
#ifndef PNEULAB_POST_STRESS_H
#define PNEULAB_POST_STRESS_H

#include "solver/fe/model.h"

enum { STRESS_COMPONENTS = 6 }; /* xx, yy, zz, xy, yz, xz */

/* Cauchy stress (Pa) of every node into stress[node_count][6]. In each element the stress of the
 * Gauss points is fitted by trilinear functions (least squares, the Gauss weights as weights)
 * and evaluated at the nodes; a node gets the mean over its elements. STATUS_NO_MEMORY when
 * there is none. */
enum status stress_at_nodes(const struct fe_model *model, const struct fe_state *state,
                            double (*stress)[STRESS_COMPONENTS]);

/* Largest values over all Gauss points, Pa; the largest principal stress is negative where all of
 * the body is under compression. */
struct stress_peak {
  double von_mises, principal;
};
struct stress_peak stress_peak(const struct fe_model *model, const struct fe_state *state);

/* Von Mises stress, largest principal stress, and pressure (-trace/3) of a stress. */
double stress_von_mises(const double stress[STRESS_COMPONENTS]);
double stress_largest(const double stress[STRESS_COMPONENTS]);
double stress_pressure(const double stress[STRESS_COMPONENTS]);

#endif
