/* Level bars beside names. */
#ifndef PNEULAB_PLOT_STUDY_BARS_H
#define PNEULAB_PLOT_STUDY_BARS_H

#include "server/plot/study_panel.h"

enum { STUDY_BARS = 15 };

/* The rows from above. */
struct study_bars {
  size_t count;
  const char *name[STUDY_BARS];
};

/* Draws heading, key, names and the level axis of panel->frame, whose range of x is given and
 * widened; row i is at y = i. */
void study_bars_begin(struct study_bars *bars, struct study_panel *panel, struct canvas *canvas);

/* Fills a bar from one x to another; thick: of the height of a row. */
void study_bars_fill(struct canvas *canvas, const struct frame *frame, double row, double thick,
                     double from, double to, struct colour colour);

/* Draws the upright line at zero. */
void study_bars_zero(const struct study_panel *panel, struct canvas *canvas);

#endif
