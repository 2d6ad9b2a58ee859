/* What a picture is drawn on, as asked for. */
#ifndef PNEULAB_PLOT_SHEET_H
#define PNEULAB_PLOT_SHEET_H

#include "server/plot/colour.h"
#include "solver/base/error.h"

enum { SHEET_SIDE_MIN = 200, SHEET_SIDE_MAX = 4000 };

struct plot_sheet {
  int width, height; /* pixels, SHEET_SIDE_MIN to SHEET_SIDE_MAX each */
  enum colour_theme theme;
};

struct canvas;

/* Makes an empty canvas. The caller owns *canvas. STATUS_INVALID (size), STATUS_NO_MEMORY. */
enum status plot_sheet_open(const struct plot_sheet *sheet, struct canvas **canvas,
                            struct error *error);

#endif
