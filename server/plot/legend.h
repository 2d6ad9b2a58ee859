/* The box that names the curves of a chart. */
#ifndef PNEULAB_PLOT_LEGEND_H
#define PNEULAB_PLOT_LEGEND_H

#include "server/plot/chart.h"

/* A legend that has been laid out; everything 0 when no series has a name and a point. */
struct legend {
  struct box box; /* pixels */
  size_t columns, rows;
  size_t shown;  /* series named, column by column; when fewer than there are, the last place says
                  * how many are missing */
  bool complete; /* all are named, and no name is shortened */
};

/* Finds the size of the legend in so many columns. max_width and max_height limit it: names are
 * shortened and curves left out. */
struct legend legend_measure(struct canvas *canvas, const struct chart *chart, size_t columns,
                             double max_width, double max_height);

/* Draws the legend where its box is. */
void legend_draw(struct canvas *canvas, const struct chart *chart, const struct legend *legend);

#endif
