/* Guards and resets from the switches in the trials. */
#ifndef PNEULAB_IDENTIFY_JUMPS_H
#define PNEULAB_IDENTIFY_JUMPS_H

#include "solver/identify/outcome.h"

/* Fills outcome->jump from the switches of the trials that are not held out; starts of steps and
 * modes are there. The level of a guard lies beyond the last elongation before a switch, and before
 * the one that the motion would have reached in the next row; of several switches the narrowest
 * bounds count. A reset is the state at the first row after it, taken back by half an interval. */
void jumps_fill(const struct identification *id, struct outcome *outcome);

#endif
