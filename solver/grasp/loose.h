/* The free object of a grasp. Up to full pressure it is held in its place; then what holds it is
 * taken away little by little, until the fingers alone bear it: a hand that lets go. Then a force
 * may draw on it.
 *
 * Fingers are solved one by one and meet through the object only. Where all see it alike, and the
 * same on their left and right, their resultant is along the axis of the gripper: each bears its
 * part of weight and force, and the object moves along the axis. (That an object may escape to the
 * side, where it would break the symmetry, is not seen.) */
#ifndef PNEULAB_GRASP_LOOSE_H
#define PNEULAB_GRASP_LOOSE_H

#include <stdbool.h>
#include "solver/base/error.h"

struct finger;
struct free_object;

struct loose {
  struct free_object *object; /* NULL: it is fixed, or still held; owned */
  double support[6];          /* what held it: force and moment about the centroid, N, N m */
  double start[3];            /* place of its centroid then, m */
  double clearance;           /* from the finger after the last step, m; 0 while it is touched */
  bool fell;                  /* it has left the finger */
};

/* Lets the object of the finger go, whose state is in equilibrium; nothing has changed yet.
 * STATUS_INVALID as free_object_create, NO_MEMORY. loose_end is due. */
enum status loose_begin(struct finger *finger, struct error *error);
void loose_end(struct finger *finger);

/* The part `support` of what held the object, and the part `pull` of the force, act on it from now
 * on. */
void loose_apply(struct finger *finger, double support, double pull);

/* Distance of the object from where it was let go, m. */
double loose_way(const struct finger *finger);

/* After an accepted step: whether the object has left the finger, which is noted: it is away from
 * it, and going further away. What falls onto the finger has not. */
bool loose_watch(struct finger *finger);

#endif
