/* The state that a motion begins with. */
#ifndef PNEULAB_BISTABLE_REST_H
#define PNEULAB_BISTABLE_REST_H

#include "solver/bistable/system.h"

/* Fills the state x. Cells have their given elongations, where one has; otherwise all are in
 * equilibrium on their sides, at the given pressure or at the set-points (which are those of the
 * system). STATUS_INVALID where there is no such equilibrium, or where elongations of actuators do
 * not fit to one plate. */
enum status rest_state(struct bistable_system *system, double x[], struct error *error);

#endif
