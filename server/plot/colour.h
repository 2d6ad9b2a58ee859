/* Colours that stay apart for colour-blind readers. */
#ifndef PNEULAB_PLOT_COLOUR_H
#define PNEULAB_PLOT_COLOUR_H

#include <stddef.h>

/* sRGB components, 0 to 1. */
struct colour {
  double r, g, b;
};

extern const struct colour colour_ink;    /* titles and labels */
extern const struct colour colour_muted;  /* subtitles, tick labels, axes */
extern const struct colour colour_grid;   /* grid lines */
extern const struct colour colour_notice; /* warnings in words, dark enough for small text */
extern const struct colour colour_paper;  /* the background */

/* Number of different colours of colour_series. */
#define COLOUR_SERIES_COUNT 7

/* Colour of the index-th curve: the palette of Okabe and Ito without its yellow, which cannot be
 * seen on white. Starts again after COLOUR_SERIES_COUNT. */
struct colour colour_series(size_t index);

/* Colour map for areas, t in [0, 1] (clamped; NaN gives grey): dark violet over teal to yellow with
 * steadily rising lightness. */
struct colour colour_map_area(double t);

/* Colour map for thin lines on white: like colour_map_area, but every colour keeps a contrast of
 * 3:1 against white. */
struct colour colour_map_line(double t);

#endif
