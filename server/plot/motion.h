/* Motions of bistable actuators for their plots. */
#ifndef PNEULAB_PLOT_MOTION_H
#define PNEULAB_PLOT_MOTION_H

#include <jansson.h>

/* The snap with the largest speed of the plate, with its times; NULL when there is none. */
const json_t *motion_fastest_snap(const json_t *result);

#endif
