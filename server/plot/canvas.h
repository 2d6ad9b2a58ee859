/* A sheet to draw on, with text, that ends as a PNG. */
#ifndef PNEULAB_PLOT_CANVAS_H
#define PNEULAB_PLOT_CANVAS_H

#include <cairo.h>
#include <pango/pangocairo.h>
#include <stdbool.h>
#include <stddef.h>
#include "server/plot/colour.h"
#include "solver/base/error.h"

/* Everything here is in pixels, y downwards. */
struct canvas {
  cairo_surface_t *surface;
  cairo_t *cr;
  PangoLayout *layout; /* reused for every text */
  int width, height;
  double unit; /* pixels of one design unit: a line of width 1 on a sheet of 800 x 600 */
  enum colour_theme theme;
  bool busy; /* hardly two pixels are alike: to be compressed in haste */
};

struct text_style {
  double size; /* design units */
  int bold;
  struct colour colour;
  double max_width; /* pixels; longer text ends in an ellipsis; 0: no limit */
};

/* A text of the PNG file itself (tEXt chunk): both are printable ASCII, other bytes become '?'. */
struct canvas_note {
  const char *key;  /* 1 to 79 characters */
  const char *text; /* NULL: left out */
};

/* Creates an empty sheet of the theme's paper. Design units shrink slower than the sheet, so that
 * small pictures stay legible. Returns NULL when memory ran out. */
struct canvas *canvas_create(int width, int height, enum colour_theme theme);
void canvas_destroy(struct canvas *canvas);

/* Size of a text as canvas_text would draw it. Text may be any bytes: what is not UTF-8 shows as
 * replacement characters, line breaks as blanks. */
void canvas_measure(struct canvas *canvas, const char *text, const struct text_style *style,
                    double *width, double *height);

/* Draws one line of text; (x, y) is its left edge and top for alignment 0, the middle for 0.5, the
 * right edge and bottom for 1. */
void canvas_text(struct canvas *canvas, double x, double y, double align_x, double align_y,
                 const char *text, const struct text_style *style);

/* Like canvas_text for text turned about (x, y) by an angle in radians, clockwise. */
void canvas_text_turned(struct canvas *canvas, double x, double y, double angle, double align_x,
                        double align_y, const char *text, const struct text_style *style);

/* Like canvas_text for text that runs upwards, centred about (x, y). */
void canvas_text_upwards(struct canvas *canvas, double x, double y, const char *text,
                         const struct text_style *style);

/* Sets the colour of the following strokes and fills. */
void canvas_set_colour(struct canvas *canvas, struct colour colour);
/* The same for a colour through which a part (1 - alpha) of what is below shows. */
void canvas_set_glaze(struct canvas *canvas, struct colour colour, double alpha);

/* Strokes one straight line, sharp when it is upright or level: its centre is moved to the nearest
 * place where it covers whole pixels. width: design units. */
void canvas_line(struct canvas *canvas, double x0, double y0, double x1, double y1, double width);

/* Encodes the picture. *png is allocated with malloc and owned by the caller.
 * Errors: STATUS_NO_MEMORY, STATUS_INTERNAL. */
enum status canvas_encode(struct canvas *canvas, const struct canvas_note *notes, size_t note_count,
                          unsigned char **png, size_t *size, struct error *error);

#endif
