/* The frame of a plot of a study: heading, axes, key and colour bar around an empty inside. */
#ifndef PNEULAB_PLOT_STUDY_PANEL_H
#define PNEULAB_PLOT_STUDY_PANEL_H

#include "server/plot/axes.h"
#include "server/plot/study_axis.h"

enum { STUDY_HEADING = 600 };

struct study_panel {
  char title[STUDY_HEADING], subtitle[STUDY_HEADING], notice[STUDY_HEADING];
  struct axes axes;
  struct frame frame; /* ranges of the data; study_panel_begin adds the area */
  bool tight;         /* the ranges stay as they are */
  struct colour_bar bar;
  const struct chart_series *key; /* named above the chart; a point each is enough */
  size_t key_count;
};

/* "study 7 · taper · sobol, 256 members", and as notice what a reader must know of those that did
 * not succeed: how many, and the most frequent reason; "" when all did. */
void study_panel_words(struct study_panel *panel, const struct study_table *table);

/* Adds to the subtitle, after " · ". */
__attribute__((format(printf, 2, 3))) void study_panel_add(struct study_panel *panel,
                                                           const char *format, ...);

/* Lays out and draws all around the inside of the frame, and the grid. */
void study_panel_begin(struct study_panel *panel, struct canvas *canvas);

/* Draws the axes of a frame once more over what covers them. */
void study_panel_rim(const struct study_panel *panel, struct canvas *canvas);

/* Draws the heading and, in the middle of the sheet, why there is nothing else. */
void study_panel_empty(const struct study_panel *panel, struct canvas *canvas, const char *why);

/* Marks on the lower axis where members lie that failed, whose metric is therefore unknown. */
void study_panel_failed(const struct study_panel *panel, struct canvas *canvas,
                        const struct study_axis *x);

/* The line of a key for those marks; NULL as name when no member failed. */
struct chart_series study_panel_failed_key(const struct study_table *table);

/* A colour bar for an axis with round ends; categorical and empty ones have none (label NULL).
 * `label` receives its words. */
struct colour_bar study_panel_bar(const struct study_axis *axis, struct colour (*map)(double),
                                  char label[STUDY_LABEL]);

/* Writes a whole number with narrow spaces between thousands. */
void study_panel_count(size_t count, char text[TICKS_TEXT]);

#endif
