/* Motions of bistable actuators for their plots. */
#ifndef PNEULAB_PLOT_MOTION_H
#define PNEULAB_PLOT_MOTION_H

#include <jansson.h>

/* What has the samples and events of a motion: the result, or that part of a snap's. */
const json_t *motion_of(const json_t *result);

/* The snap with the largest speed of the plate, with its times; NULL when there is none. */
const json_t *motion_fastest_snap(const json_t *result);

#endif
