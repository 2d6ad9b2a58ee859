#include "server/plot/sheet.h"

#include "server/plot/canvas.h"

enum status plot_sheet_open(const struct plot_sheet *sheet, struct canvas **canvas,
                            struct error *error) {
  int width = sheet->width, height = sheet->height;
  if (width < SHEET_SIDE_MIN || width > SHEET_SIDE_MAX || height < SHEET_SIDE_MIN ||
      height > SHEET_SIDE_MAX) {
    return error_set(error, STATUS_INVALID, NULL,
                     "a picture of %d x %d pixels cannot be drawn; each side may have %d to %d, "
                     "as in 800 x 600",
                     width, height, SHEET_SIDE_MIN, SHEET_SIDE_MAX);
  }
  *canvas = canvas_create(width, height, sheet->theme);
  return *canvas ? STATUS_OK
                 : error_set(error, STATUS_NO_MEMORY, NULL,
                             "memory ran out for a picture of %d x %d", width, height);
}
