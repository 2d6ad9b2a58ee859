#include "server/plot/contact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int by_size(const void *left, const void *right) {
  double a = *(const double *)left, b = *(const double *)right;
  return a < b ? -1 : a > b;
}

enum status contact_scale_make(const struct frames *frames, enum colour_theme theme,
                               struct contact_scale *scale, struct error *error) {
  size_t points = frames->point_count, count = 0;
  double *values = malloc((frames->shot_count * points + 1) * sizeof *values);
  if (!values) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the contact pressure");
  }
  for (size_t s = 0; s < frames->shot_count; s++) {
    for (size_t p = 0; p < points; p++) {
      if (frames->shots[s].contact[p] > 1e-3) {
        values[count++] = frames->shots[s].contact[p];
      }
    }
  }
  qsort(values, count, sizeof *values, by_size);
  double highest = count > 0 ? values[count - 1] : 1;
  double usual = count > 0 ? values[(size_t)(0.98 * (double)(count - 1))] : 1;
  bool cut = highest > 1.25 * usual;
  free(values);
  scale->top = cut ? usual : highest;
  scale->bar = (struct colour_bar){.label = cut ? "Contact pressure (kPa), 2 % of points above"
                                                : "Contact pressure (kPa)",
                                   .map = colour_map_area,
                                   .min = 0,
                                   .max = scale->top};
  for (int i = 0; i < RASTER_SHADES; i++) {
    struct colour colour = i > 0 ? colour_map_area((double)i / (RASTER_SHADES - 1))
                                 : (struct colour){.role = COLOUR_BARE};
    scale->shades[i] = colour_rgb(colour, theme);
  }
  return STATUS_OK;
}

double contact_scale_at(const struct contact_scale *scale, double pressure) {
  return fmin(fmax(pressure / scale->top, 0), 1);
}

double contact_key(struct canvas *canvas, double x, double y, struct colour colour,
                   const char *words) {
  struct text_style style = chart_style_tick();
  double u = canvas->unit, width, height;
  cairo_rectangle(canvas->cr, round(x), round(y - 5 * u), 18 * u, 10 * u);
  canvas_set_colour(canvas, colour);
  cairo_fill_preserve(canvas->cr);
  canvas_set_colour(canvas, colour_edge);
  cairo_set_line_width(canvas->cr, u);
  cairo_stroke(canvas->cr);
  style.colour = colour_ink;
  canvas_text(canvas, x + 26 * u, y, 0, 0.5, words, &style);
  canvas_measure(canvas, words, &style, &width, &height);
  return x + 26 * u + width;
}

double contact_ruler(struct canvas *canvas, double x, double y, double pixels_per_mm, double room) {
  double u = canvas->unit, width, height;
  struct ticks ticks = ticks_make(0, room / pixels_per_mm, 2);
  double right = x + ticks.step * pixels_per_mm;
  struct text_style style = chart_style_tick();
  char number[TICKS_TEXT], text[TICKS_TEXT + 8];
  ticks_plain(ticks.step, 3, number);
  snprintf(text, sizeof text, "%s mm", number);
  style.colour = colour_ink;
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, x, y, right, y, 2);
  canvas_line(canvas, x, y - 4 * u, x, y + 5 * u, 2);
  canvas_line(canvas, right, y - 4 * u, right, y + 5 * u, 2);
  canvas_text(canvas, right + 8 * u, y, 0, 0.5, text, &style);
  canvas_measure(canvas, text, &style, &width, &height);
  return right + 8 * u + width;
}
