/* What a position control adds to the result of an `hlpv` job. */
#ifndef PNEULAB_POST_RESULT_CONTROL_H
#define PNEULAB_POST_RESULT_CONTROL_H

#include <jansson.h>
#include "solver/hlpv/trajectory.h"

/* Adds to the metrics how well the elongation was followed. */
void result_control_metrics(json_t *metrics, const struct hlpv_trajectory *trajectory);

/* Adds "steps", one for each of a held reference, and "control": gains, filter and eigenvalues. */
void result_control_store(json_t *document, const struct hlpv_spec *spec,
                          const struct hlpv_trajectory *trajectory);

#endif
