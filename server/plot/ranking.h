/* The ranking of a study's result document. */
#ifndef PNEULAB_PLOT_RANKING_H
#define PNEULAB_PLOT_RANKING_H

#include <jansson.h>

/* The list of ranked designs, best first, NULL when there is none. */
const json_t *ranking_list(const json_t *result);

#endif
