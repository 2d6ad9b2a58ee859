/* Switches without end in a finite time. */
#ifndef PNEULAB_HLPV_ACCUMULATION_H
#define PNEULAB_HLPV_ACCUMULATION_H

#include "solver/hlpv/trajectory.h"

/* Looks at the switches so far, after each.
 * STATUS_CHATTERING: CHATTER_EVENTS switches within CHATTER_TIME, as with guards that send the
 * state to and fro. STATUS_ZENO: the intervals between the last ZENO_EVENTS switches by the same
 * guard shrink by one factor, so that infinitely many come before a time that the message names.
 * STATUS_EVENTS: HLPV_EVENTS_MAX switches. Otherwise STATUS_OK. */
enum status accumulation_check(const struct hlpv_trajectory *trajectory, struct error *error);

#endif
