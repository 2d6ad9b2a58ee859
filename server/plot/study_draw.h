/* The plots of studies. Each draws a whole canvas; what it needs of the input is there. */
#ifndef PNEULAB_PLOT_STUDY_DRAW_H
#define PNEULAB_PLOT_STUDY_DRAW_H

#include "server/plot/canvas.h"
#include "server/plot/study_plot.h"

typedef enum status study_draw(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error);

/* A metric over one parameter: a line for each combination of the others when these are few, else
 * dots coloured by one of them. */
study_draw study_draw_curve;
/* A metric over two parameters, a cell for each pair of values. */
study_draw study_draw_heat_map;
/* The surrogate of a metric over two parameters. */
study_draw study_draw_contour;
/* All members over parallel axes. */
study_draw study_draw_parallel;
/* Each column over each other one. */
study_draw study_draw_scatter;
/* Designs that no other one beats. */
study_draw study_draw_pareto;
/* Shares of the variance. */
study_draw study_draw_importance;
/* What a metric is on average over each parameter. */
study_draw study_draw_effects;
/* The best designs and the parts of their scores. */
study_draw study_draw_ranking;
/* Bent centrelines over two parameters. */
study_draw study_draw_shapes;
/* The evaluations of an optimisation. */
study_draw study_draw_history;
/* The surrogate against what was solved. */
study_draw study_draw_surrogate;

#endif
