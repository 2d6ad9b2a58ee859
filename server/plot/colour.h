/* Colours that stay apart for colour-blind readers, on light and on dark sheets. A colour says what
 * it is for; what that looks like is the matter of the sheet's theme, from one table. */
#ifndef PNEULAB_PLOT_COLOUR_H
#define PNEULAB_PLOT_COLOUR_H

#include <stddef.h>

enum colour_theme { THEME_LIGHT, THEME_DARK, THEME_COUNT };

/* Number of different colours of colour_series. */
#define COLOUR_SERIES_COUNT 7

/* What a colour is for. */
enum colour_role {
  COLOUR_INK,       /* titles and labels */
  COLOUR_MUTED,     /* subtitles, tick labels, axes */
  COLOUR_GRID,      /* grid lines */
  COLOUR_NOTICE,    /* warnings in words, clear enough for small text */
  COLOUR_PAPER,     /* the background */
  COLOUR_FAINT,     /* curves and marks that are there for comparison */
  COLOUR_SHADE,     /* areas behind curves */
  COLOUR_EDGE,      /* outlines of such areas */
  COLOUR_COLUMN,    /* columns that need no telling apart */
  COLOUR_COLUMN_UP, /* the second part of a column */
  COLOUR_BODY,      /* a body without a quantity */
  COLOUR_OUTLINE,   /* edges of a body */
  COLOUR_SOFT,      /* silicone in a section */
  COLOUR_BARE,      /* a body where nothing touches it */
  COLOUR_OBJECT,    /* what a gripper holds */
  COLOUR_SERIES,    /* the first of COLOUR_SERIES_COUNT curves */
  COLOUR_ROLES = COLOUR_SERIES + COLOUR_SERIES_COUNT,
  COLOUR_MAP_AREA = COLOUR_ROLES, /* a place on a map */
  COLOUR_MAP_LINE,
  COLOUR_MAP_PLANE /* a place between four corners */
};

struct colour {
  enum colour_role role;
  double x, y; /* place on a map, 0 to 1; NaN gives grey */
  double fade; /* part of the paper that is mixed in, 0 to 1 */
};

/* sRGB components, 0 to 1. */
struct rgb {
  double r, g, b;
};

static const struct colour colour_ink = {.role = COLOUR_INK};
static const struct colour colour_muted = {.role = COLOUR_MUTED};
static const struct colour colour_grid = {.role = COLOUR_GRID};
static const struct colour colour_notice = {.role = COLOUR_NOTICE};
static const struct colour colour_paper = {.role = COLOUR_PAPER};
static const struct colour colour_faint = {.role = COLOUR_FAINT};
static const struct colour colour_shade = {.role = COLOUR_SHADE};
static const struct colour colour_edge = {.role = COLOUR_EDGE};
static const struct colour colour_column = {.role = COLOUR_COLUMN};

/* What a colour looks like on a sheet of this theme. */
struct rgb colour_rgb(struct colour colour, enum colour_theme theme);

/* Finds the theme that is called "light" or "dark"; 0 for another word. */
int colour_theme_of(const char *word, enum colour_theme *theme);

/* Colour of the index-th curve: the palette of Okabe and Ito without its yellow, which cannot be
 * seen on white; the same hues, lighter, on a dark sheet. Starts again after COLOUR_SERIES_COUNT.
 */
struct colour colour_series(size_t index);

/* The colour with `part` (0 to 1) of the paper mixed in. */
struct colour colour_fade(struct colour colour, double part);

/* Colour map for areas, t in [0, 1] (clamped; NaN gives grey): dark violet over teal to yellow with
 * steadily rising lightness. */
struct colour colour_map_area(double t);

/* Colour map for thin lines and dots: like colour_map_area, but every colour keeps a contrast of
 * 3:1 against the sheet. */
struct colour colour_map_line(double t);

/* Two quantities at once, each in [0, 1]: grey for none, orange for x, blue for y, and what stands
 * out most from the sheet for both. */
struct colour colour_map_plane(double x, double y);

#endif
