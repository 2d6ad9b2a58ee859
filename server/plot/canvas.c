#include "server/plot/canvas.h"

#include <math.h>
#include <stdlib.h>

/* A picture of half the size with text of half the size could not be read. */
static double design_unit(int width, int height) {
  double ratio = fmin(width / 800.0, height / 600.0);
  return ratio >= 1.0 ? ratio : fmax(pow(ratio, 0.36), 0.62);
}

struct canvas *canvas_create(int width, int height, enum colour_theme theme) {
  struct canvas *canvas = calloc(1, sizeof *canvas);
  if (!canvas) {
    return NULL;
  }
  canvas->width = width;
  canvas->height = height;
  canvas->theme = theme;
  canvas->unit = design_unit(width, height);
  canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
  canvas->cr = cairo_create(canvas->surface);
  if (cairo_status(canvas->cr) != CAIRO_STATUS_SUCCESS) {
    canvas_destroy(canvas);
    return NULL;
  }
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(canvas->cr, options);
  cairo_font_options_destroy(options);
  canvas->layout = pango_cairo_create_layout(canvas->cr);
  pango_layout_set_single_paragraph_mode(canvas->layout, TRUE);
  canvas_set_colour(canvas, colour_paper);
  cairo_paint(canvas->cr);
  return canvas;
}

void canvas_destroy(struct canvas *canvas) {
  if (!canvas) {
    return;
  }
  if (canvas->layout) {
    g_object_unref(canvas->layout);
  }
  cairo_destroy(canvas->cr);
  cairo_surface_destroy(canvas->surface);
  free(canvas);
}

static void set_text(struct canvas *canvas, const char *text, const struct text_style *style) {
  PangoFontDescription *font = pango_font_description_new();
  pango_font_description_set_family_static(font, "DejaVu Sans, sans-serif");
  pango_font_description_set_absolute_size(font, style->size * canvas->unit * PANGO_SCALE);
  pango_font_description_set_weight(font, style->bold ? PANGO_WEIGHT_BOLD : PANGO_WEIGHT_NORMAL);
  pango_layout_set_font_description(canvas->layout, font);
  pango_font_description_free(font);
  char *valid = g_utf8_make_valid(text, -1);
  pango_layout_set_text(canvas->layout, valid, -1);
  g_free(valid);
  if (style->max_width > 0) {
    pango_layout_set_width(canvas->layout, (int)(style->max_width * PANGO_SCALE));
    pango_layout_set_ellipsize(canvas->layout, PANGO_ELLIPSIZE_END);
  } else {
    pango_layout_set_width(canvas->layout, -1);
    pango_layout_set_ellipsize(canvas->layout, PANGO_ELLIPSIZE_NONE);
  }
}

static void layout_size(struct canvas *canvas, double *width, double *height) {
  int w, h;
  pango_layout_get_size(canvas->layout, &w, &h);
  *width = (double)w / PANGO_SCALE;
  *height = (double)h / PANGO_SCALE;
}

void canvas_measure(struct canvas *canvas, const char *text, const struct text_style *style,
                    double *width, double *height) {
  set_text(canvas, text, style);
  layout_size(canvas, width, height);
}

void canvas_text(struct canvas *canvas, double x, double y, double align_x, double align_y,
                 const char *text, const struct text_style *style) {
  double width, height;
  canvas_measure(canvas, text, style, &width, &height);
  canvas_set_colour(canvas, style->colour);
  cairo_move_to(canvas->cr, x - align_x * width, y - align_y * height);
  pango_cairo_show_layout(canvas->cr, canvas->layout);
  cairo_new_path(canvas->cr);
}

void canvas_text_turned(struct canvas *canvas, double x, double y, double angle, double align_x,
                        double align_y, const char *text, const struct text_style *style) {
  cairo_save(canvas->cr);
  cairo_translate(canvas->cr, x, y);
  cairo_rotate(canvas->cr, angle);
  pango_cairo_update_layout(canvas->cr, canvas->layout);
  canvas_text(canvas, 0, 0, align_x, align_y, text, style);
  cairo_restore(canvas->cr);
  pango_cairo_update_layout(canvas->cr, canvas->layout);
}

void canvas_text_upwards(struct canvas *canvas, double x, double y, const char *text,
                         const struct text_style *style) {
  canvas_text_turned(canvas, x, y, -G_PI / 2, 0.5, 0.5, text, style);
}

void canvas_set_colour(struct canvas *canvas, struct colour colour) {
  struct rgb rgb = colour_rgb(colour, canvas->theme);
  cairo_set_source_rgb(canvas->cr, rgb.r, rgb.g, rgb.b);
}

void canvas_set_glaze(struct canvas *canvas, struct colour colour, double alpha) {
  struct rgb rgb = colour_rgb(colour, canvas->theme);
  cairo_set_source_rgba(canvas->cr, rgb.r, rgb.g, rgb.b, alpha);
}

void canvas_line(struct canvas *canvas, double x0, double y0, double x1, double y1, double width) {
  double pixels = fmax(round(width * canvas->unit), 1.0);
  double shift = fmod(pixels, 2.0) == 1.0 ? 0.5 : 0.0;
  if (x0 == x1) {
    x0 = x1 = floor(x0) + shift;
  }
  if (y0 == y1) {
    y0 = y1 = floor(y0) + shift;
  }
  cairo_set_line_width(canvas->cr, pixels);
  cairo_move_to(canvas->cr, x0, y0);
  cairo_line_to(canvas->cr, x1, y1);
  cairo_stroke(canvas->cr);
}
