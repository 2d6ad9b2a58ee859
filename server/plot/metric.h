/* Which metric of a study the plot "metric" shows. */
#ifndef PNEULAB_PLOT_METRIC_H
#define PNEULAB_PLOT_METRIC_H

#include <jansson.h>

/* The metric `asked` for, or else the first of these that a member has: the one with published
 * values, the force of a grasp, the sensitivity (unless pressures are what varies), the bending
 * angle, the twist angle, the contraction. NULL when no member has it. The text belongs to `asked`,
 * to the document or to nobody. */
const char *metric_choose(const json_t *result, const char *asked);

#endif
