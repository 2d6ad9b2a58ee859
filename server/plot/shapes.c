#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

/* Most shapes in one picture, and points of one outline: what is read is not trusted. */
enum { SHAPES_MOST = 8, OUTLINE_MOST = 20000 };

/* Design units: words under a shape, space between shapes, edge of the sheet. */
enum { WORDS = 40, GAP = 34, MARGIN = 26, SCALE_BAR = 44 };

/* Meridians in some states, and how far they reach. */
struct gallery {
  const json_t *shapes[SHAPES_MOST];
  size_t count;
  double radius, low, high; /* mm */
};

/* A layout: every shape in a place of its own, all in one scale. */
struct wall {
  size_t columns, rows;
  double scale; /* pixels per mm */
  struct box area;
};

static const struct colour silicone = {.role = COLOUR_SOFT}, pet = {.role = COLOUR_SERIES + 1};

static void measure(const json_t *shape, struct gallery *gallery) {
  size_t r, i;
  const json_t *region, *point;
  json_array_foreach(json_object_get(shape, "regions"), r, region) {
    json_array_foreach(json_object_get(region, "outline_mm"), i, point) {
      double radius = data_element(point, 0), z = data_element(point, 1);
      if (isfinite(radius) && isfinite(z)) {
        gallery->radius = fmax(gallery->radius, fabs(radius));
        gallery->low = fmin(gallery->low, z);
        gallery->high = fmax(gallery->high, z);
      }
    }
  }
}

static struct gallery gallery_read(const json_t *result) {
  struct gallery gallery = {.low = INFINITY, .high = -INFINITY};
  size_t index;
  const json_t *shape;
  json_array_foreach(json_object_get(result, "shapes"), index, shape) {
    if (gallery.count < SHAPES_MOST && json_array_size(json_object_get(shape, "regions")) > 0) {
      gallery.shapes[gallery.count++] = shape;
      measure(shape, &gallery);
    }
  }
  if (!(gallery.radius > 1e-6) || !(gallery.high - gallery.low > 1e-6)) {
    gallery.count = 0;
  }
  return gallery;
}

/* The number of columns that allows the largest scale. */
static struct wall lay_out(const struct gallery *gallery, const struct canvas *canvas, double top) {
  double u = canvas->unit;
  struct wall wall = {.scale = 0};
  struct box area = {MARGIN * u, top, canvas->width - 2 * MARGIN * u,
                     canvas->height - top - SCALE_BAR * u};
  for (size_t columns = 1; columns <= gallery->count; columns++) {
    size_t rows = (gallery->count + columns - 1) / columns;
    double wide = area.width / (double)columns - GAP * u;
    double high = area.height / (double)rows - (WORDS + GAP) * u;
    double scale = fmin(wide / (2 * gallery->radius), high / (gallery->high - gallery->low));
    if (scale > wall.scale) {
      wall = (struct wall){columns, rows, scale, area};
    }
  }
  return wall;
}

/* Adds one outline, mirrored when side is -1, to the path; (x, y) is where the axis meets z = 0. */
static void add_outline(cairo_t *cr, const json_t *outline, double side, double x, double y,
                        double scale) {
  size_t i;
  const json_t *point;
  json_array_foreach(outline, i, point) {
    double radius = data_element(point, 0), z = data_element(point, 1);
    if (isfinite(radius) && isfinite(z) && i < OUTLINE_MOST) {
      cairo_line_to(cr, x + side * scale * radius, y - scale * z);
    }
  }
  cairo_close_path(cr);
}

/* Fills what lies between both sides, so that the eye takes them for one body. */
static void fill_between(struct canvas *canvas, const json_t *shape, double x, double y,
                         double scale) {
  cairo_t *cr = canvas->cr;
  size_t r, i;
  const json_t *region, *point;
  json_array_foreach(json_object_get(shape, "regions"), r, region) {
    struct point before = {NAN, NAN};
    json_array_foreach(json_object_get(region, "outline_mm"), i, point) {
      struct point now = {scale * data_element(point, 0), y - scale * data_element(point, 1)};
      if (isfinite(now.x + now.y + before.x + before.y) && i < OUTLINE_MOST) {
        cairo_move_to(cr, x + before.x, before.y);
        cairo_line_to(cr, x + now.x, now.y);
        cairo_line_to(cr, x - now.x, now.y);
        cairo_line_to(cr, x - before.x, before.y);
        cairo_close_path(cr);
        cairo_fill_preserve(cr);
        cairo_stroke(cr);
      }
      before = now;
    }
  }
}

/* Fills the regions of one kind on both sides of the axis. */
static void fill_regions(struct canvas *canvas, const json_t *shape, bool of_pet, double x,
                         double y, double scale) {
  size_t index;
  const json_t *region;
  json_array_foreach(json_object_get(shape, "regions"), index, region) {
    const char *name = json_string_value(json_object_get(region, "region"));
    bool is_pet = name && strcmp(name, "pet") == 0;
    for (int k = 0; k < 2 && is_pet == of_pet; k++) {
      cairo_new_path(canvas->cr);
      add_outline(canvas->cr, json_object_get(region, "outline_mm"), k ? -1 : 1, x, y, scale);
      canvas_set_colour(canvas, of_pet ? pet : silicone);
      cairo_set_line_width(canvas->cr, (of_pet ? 0.8 : 0.6) * canvas->unit);
      cairo_fill_preserve(canvas->cr);
      /* PET is thinner than a pixel in a small picture: its edge keeps it visible */
      canvas_set_colour(canvas, of_pet ? pet : colour_muted);
      cairo_stroke(canvas->cr);
    }
  }
}

/* The axis as a chain line and the words under the shape. */
static void draw_words(struct canvas *canvas, const json_t *shape, double x, double bottom,
                       double room) {
  double u = canvas->unit;
  char load[120] = "", number[TICKS_TEXT];
  const char *name = json_string_value(json_object_get(shape, "name"));
  double pressure = data_number(shape, "pressure_kPa"), force = data_number(shape, "force_N");
  struct text_style ink = chart_style_tick(), small = chart_style_tick();
  ink.colour = colour_ink;
  ink.max_width = small.max_width = room;
  canvas_text(canvas, x, bottom + 6 * u, 0.5, 0, name ? name : "", &ink);
  if (isfinite(pressure)) {
    ticks_plain(fabs(pressure) < 5e-4 ? 0 : pressure, 3, number);
    snprintf(load, sizeof load, "%s kPa", number);
  }
  if (isfinite(force) && fabs(force) > 5e-4) {
    size_t used = strlen(load);
    ticks_plain(force, 3, number);
    snprintf(load + used, sizeof load - used, "%s%s N", used ? ", " : "", number);
  }
  canvas_text(canvas, x, bottom + 22 * u, 0.5, 0, load, &small);
}

static void draw_shape(struct canvas *canvas, const struct gallery *gallery,
                       const struct wall *wall, size_t place) {
  double u = canvas->unit, across = wall->area.width / (double)wall->columns;
  double down = wall->area.height / (double)wall->rows;
  double x = wall->area.x + ((double)(place % wall->columns) + 0.5) * across;
  double middle = wall->area.y + (double)(place / wall->columns) * down + (down - WORDS * u) / 2;
  double height = wall->scale * (gallery->high - gallery->low);
  double bottom = middle + height / 2, y = bottom + wall->scale * gallery->low;
  const double chain[4] = {8 * u, 3 * u, 1.5 * u, 3 * u};
  canvas_set_colour(canvas, colour_shade);
  cairo_set_line_width(canvas->cr, 1);
  fill_between(canvas, gallery->shapes[place], x, y, wall->scale);
  fill_regions(canvas, gallery->shapes[place], false, x, y, wall->scale);
  fill_regions(canvas, gallery->shapes[place], true, x, y, wall->scale);
  cairo_set_dash(canvas->cr, chain, 4, 0);
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, x, bottom - height - 6 * u, x, bottom + 4 * u, 0.8);
  cairo_set_dash(canvas->cr, NULL, 0, 0);
  draw_words(canvas, gallery->shapes[place], x, bottom, across - 8 * u);
}

/* A length of 1, 2 or 5 times a power of ten, and the colours. */
static void draw_key(struct canvas *canvas, const struct wall *wall) {
  static const char *const names[2] = {"silicone", "PET"};
  double u = canvas->unit, y = canvas->height - 20 * u, x = wall->area.x;
  double most = 0.18 * wall->area.width / wall->scale, length = pow(10, floor(log10(most)));
  length *= most / length >= 5 ? 5 : most / length >= 2 ? 2 : 1;
  struct text_style style = chart_style_tick();
  char text[TICKS_TEXT + 4], number[TICKS_TEXT];
  ticks_plain(length, 3, number);
  snprintf(text, sizeof text, "%s mm", number);
  double end = x + wall->scale * length;
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, x, y, end, y, 2);
  canvas_line(canvas, x, y - 4 * u, x, y + 4 * u, 1);
  canvas_line(canvas, end, y - 4 * u, end, y + 4 * u, 1);
  canvas_text(canvas, end + 8 * u, y, 0, 0.5, text, &style);
  x = wall->area.x + wall->area.width;
  for (int k = 1; k >= 0; k--) {
    double width, height;
    canvas_measure(canvas, names[k], &style, &width, &height);
    canvas_text(canvas, x, y, 1, 0.5, names[k], &style);
    x -= width + 24 * u;
    canvas_set_colour(canvas, k ? pet : silicone);
    cairo_rectangle(canvas->cr, x, y - 5 * u, 16 * u, 10 * u);
    cairo_fill(canvas->cr);
    x -= 20 * u;
  }
}

enum status draw_shapes(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  struct gallery gallery = gallery_read(inputs[0].result);
  (void)count;
  (void)error;
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  chart_heading(canvas, MARGIN * canvas->unit, "Meridian in its states, true to scale", subtitle,
                notice);
  if (gallery.count == 0) {
    struct text_style style = chart_style_label();
    style.colour = colour_muted;
    canvas_text(canvas, canvas->width / 2.0, canvas->height / 2.0, 0.5, 0.5,
                "No shapes were recorded", &style);
    return STATUS_OK;
  }
  struct wall wall = lay_out(&gallery, canvas, chart_heading_height(canvas, subtitle, notice));
  if (wall.scale > 0) {
    for (size_t i = 0; i < gallery.count; i++) {
      draw_shape(canvas, &gallery, &wall, i);
    }
    draw_key(canvas, &wall);
  }
  return STATUS_OK;
}
