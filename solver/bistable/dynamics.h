/* The motion that a snap job asks for, after its paths. */
#ifndef PNEULAB_BISTABLE_DYNAMICS_H
#define PNEULAB_BISTABLE_DYNAMICS_H

#include <jansson.h>
#include "solver/bistable/result.h"

/* Simulates the bistable part of a snap job with the law in its result `document`, and adds to
 * that: metrics of the motion; "motion", with its samples, events, plateaus and laws; "hybrid", the
 * derived model with what it leaves; and "hlpv", the model as a job. What cannot be had for want of
 * paths, states of rest or time is named in its warnings. STATUS_NO_MEMORY, INTERNAL. */
enum status bistable_dynamics(const struct job_spec *spec,
                              const struct result_bistable_options *options, json_t *document,
                              struct error *error);

#endif
