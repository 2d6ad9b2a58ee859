/* Suckers that pull: where the rim of a cup touches the object all around, the air between them is
 * drawn out.
 *
 * The difference of pressure acts on the faces of the cup inside the rim, along their outward
 * normal, and with the opposite resultant on the object. It comes on after the inflation, in a
 * stage of its own, in the cups that are closed then; one whose rim opens has lost it for good.
 * Rims are looked at, and the forces follow the faces, from step to step: within a step they are
 * dead loads. */
#ifndef PNEULAB_GRASP_CUPS_H
#define PNEULAB_GRASP_CUPS_H

#include <stdbool.h>
#include "solver/base/error.h"
#include "solver/job/spec.h"

struct finger;

struct cups {
  double *weight; /* the dead load without them, node_count x 3, N; NULL: there are none */
  bool holds[SUCKERS_MAX];
  double force[6]; /* on the object: force and moment about the origin, N, N m */
  double pull;     /* sum of the sizes of the forces of all cups, N */
};

/* Prepares for a finger whose model has its weight. cups_release is due. STATUS_NO_MEMORY. */
enum status cups_prepare(struct finger *finger);
void cups_release(struct finger *finger);

/* Finds the cups that are closed at the finger's state, which was evaluated last; returns their
 * number. */
int cups_close(struct finger *finger);

/* After an accepted step: cups that have opened let go from now on. */
void cups_watch(struct finger *finger);

/* Before a step from the finger's state: cups that hold pull with the part `share` of their
 * suction. The ledger goes on with the new forces. */
void cups_pull(struct finger *finger, double share);

#endif
