#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/cloud.h"
#include "server/plot/isoline.h"
#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

enum { CLOUD = 1500, BANDS = 9, SHADES = 2 * BANDS + 2 };

/* A slice on its way to the sheet. */
struct map {
  const struct study_slice *slice;
  struct study_axis metric, x, y;
  double *across, *up; /* positions of the columns and rows of its grid */
  struct ticks levels;
  double unsure; /* what has a larger standard deviation is hatched; INFINITY: nothing */
  struct study_panel panel;
};

/* Where a pixel lies in the grid: cell and part of it. */
struct spot {
  size_t cell;
  double part;
};

static struct spot locate(const double *values, size_t count, double position) {
  size_t low = 0, high = count - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(position < values[middle] ? &high : &low) = middle;
  }
  double part = (position - values[low]) / (values[high] - values[low]);
  return (struct spot){low, fmin(fmax(part, 0), 1)};
}

/* A value between the points of the grid. */
static double between(const struct map *map, const double *values, struct spot x, struct spot y) {
  size_t columns = map->slice->columns, at = y.cell * columns + x.cell;
  double low = values[at] + x.part * (values[at + 1] - values[at]);
  double high = values[at + columns] + x.part * (values[at + columns + 1] - values[at + columns]);
  return low + y.part * (high - low);
}

static uint32_t pack(struct rgb c) {
  return (uint32_t)(255 * c.r + 0.5) << 16 | (uint32_t)(255 * c.g + 0.5) << 8 |
         (uint32_t)(255 * c.b + 0.5);
}

/* A pixel of the hatching, upwards to the right. */
static bool is_hatched(const struct canvas *canvas, int column, int row) {
  int period = (int)fmax(round(7 * canvas->unit), 4), width = (int)fmax(round(canvas->unit), 1);
  return (column + row) % period < width;
}

static uint32_t darker(uint32_t pixel) {
  uint32_t r = pixel >> 16 & 255, g = pixel >> 8 & 255, b = pixel & 255;
  bool bright = 3 * r + 6 * g + b > 1100;
  uint32_t to = bright ? 0 : 255;
  return (r * 6 + to * 4) / 10 << 16 | (g * 6 + to * 4) / 10 << 8 | (b * 6 + to * 4) / 10;
}

/* Fills the area with the bands of colour, and hatches where the surrogate is not sure. */
static enum status fill(struct map *map, struct canvas *canvas, struct error *error) {
  const struct box *area = &map->panel.frame.area;
  const struct frame *frame = &map->panel.frame;
  int left = (int)round(area->x), top = (int)round(area->y), bands = map->panel.bar.bands;
  int width = (int)round(area->width), height = (int)round(area->height);
  uint32_t shades[SHADES];
  struct spot *spots = malloc((size_t)width * sizeof *spots);
  if (!spots) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (int k = 0; k < bands; k++) {
    double value =
        map->panel.bar.min + (k + 0.5) / bands * (map->panel.bar.max - map->panel.bar.min);
    shades[k] = pack(colour_rgb(chart_bar_colour(&map->panel.bar, value), canvas->theme));
  }
  for (int i = 0; i < width; i++) {
    double share = (i + 0.5) / width;
    spots[i] = locate(map->across, map->slice->columns,
                      frame->x_min + share * (frame->x_max - frame->x_min));
  }
  cairo_surface_flush(canvas->surface);
  unsigned char *data = cairo_image_surface_get_data(canvas->surface);
  ptrdiff_t stride = cairo_image_surface_get_stride(canvas->surface);
  double scale = bands / (map->panel.bar.max - map->panel.bar.min);
  for (int j = 0; j < height; j++) {
    double share = (j + 0.5) / height;
    struct spot y =
        locate(map->up, map->slice->rows, frame->y_max + share * (frame->y_min - frame->y_max));
    unsigned char *row = data + stride * (top + j) + 4 * (ptrdiff_t)left;
    for (int i = 0; i < width; i++) {
      double value = between(map, map->slice->mean, spots[i], y);
      double band = fmin(fmax((value - map->panel.bar.min) * scale, 0), bands - 1);
      uint32_t pixel =
          isnan(value) ? pack(colour_rgb(colour_shade, canvas->theme)) : shades[(int)band];
      if (isfinite(map->unsure) && is_hatched(canvas, i, j) &&
          between(map, map->slice->deviation, spots[i], y) > map->unsure) {
        pixel = darker(pixel);
      }
      memcpy(row + 4 * (ptrdiff_t)i, &pixel, sizeof pixel);
    }
  }
  cairo_surface_mark_dirty(canvas->surface);
  free(spots);
  return STATUS_OK;
}

static double along(const double *values, size_t count, double at) {
  size_t i = at >= (double)(count - 1) ? count - 2 : (size_t)at;
  return values[i] + (at - (double)i) * (values[i + 1] - values[i]);
}

/* Writes the level beside the middle of a line, along it, where other words are not. */
static void label_line(struct canvas *canvas, const struct point *points, size_t count,
                       const char *text, const struct text_style *style, struct place *place) {
  double width, height;
  canvas_measure(canvas, text, style, &width, &height);
  for (size_t k = 1; k < 8; k++) {
    /* from the middle outwards */
    size_t middle = count * (k % 2 ? 8 - k : 8 + k) / 16, first = middle, last = middle;
    while (first > 0 && hypot(points[first].x - points[middle].x,
                              points[first].y - points[middle].y) < width / 2 + 3) {
      first--;
    }
    while (last + 1 < count && hypot(points[last].x - points[middle].x,
                                     points[last].y - points[middle].y) < width / 2 + 3) {
      last++;
    }
    struct point a = points[first], b = points[last];
    double chord = hypot(b.x - a.x, b.y - a.y);
    struct point m = {(a.x + b.x) / 2, (a.y + b.y) / 2};
    double angle = atan2(b.y - a.y, b.x - a.x);
    angle = angle > G_PI / 2 ? angle - G_PI : angle < -G_PI / 2 ? angle + G_PI : angle;
    double w = fabs(cos(angle)) * width + fabs(sin(angle)) * height;
    double h = fabs(sin(angle)) * width + fabs(cos(angle)) * height;
    struct box box = {m.x - w / 2, m.y - h / 2, w, h};
    if (chord > width && place_is_free(place, box, 3 * canvas->unit)) {
      canvas_text_turned(canvas, m.x, m.y, angle, 0.5, 1, text, style);
      place_add_box(place, box);
      return;
    }
  }
}

/* Draws and names the lines of one level. */
static enum status draw_level(struct map *map, struct canvas *canvas, double level,
                              const char *text, struct place *place, struct error *error) {
  struct isolines lines;
  enum status status =
      isolines_find(map->slice->mean, map->slice->columns, map->slice->rows, level, &lines, error);
  struct rgb below = colour_rgb(chart_bar_colour(&map->panel.bar, level), THEME_LIGHT);
  bool bright = 0.3 * below.r + 0.59 * below.g + 0.11 * below.b > 0.42;
  bool ink = bright == (canvas->theme == THEME_LIGHT);
  struct text_style style = {.size = 11, .colour = ink ? colour_ink : colour_paper};
  for (size_t l = 0; l < lines.count; l++) {
    struct isoline *line = &lines.line[l];
    for (size_t i = 0; i < line->count; i++) {
      struct point p = {along(map->across, map->slice->columns, line->points[i].x),
                        along(map->up, map->slice->rows, line->points[i].y)};
      line->points[i] = frame_pixel(&map->panel.frame, p);
      cairo_line_to(canvas->cr, line->points[i].x, line->points[i].y);
    }
    canvas_set_glaze(canvas, style.colour, 0.65);
    cairo_set_line_width(canvas->cr, 1.0 * canvas->unit);
    cairo_stroke(canvas->cr);
    label_line(canvas, line->points, line->count, text, &style, place);
  }
  isolines_release(&lines);
  return status;
}

/* Thousands of members as a cloud of dots; those that failed are light. */
static void draw_many(struct map *map, struct canvas *canvas) {
  struct cloud *cloud = cloud_create(canvas, map->panel.frame.area, false);
  struct rgb rim = colour_rgb((struct colour){.role = COLOUR_OUTLINE}, canvas->theme);
  struct rgb light = {1, 1, 1};
  for (size_t row = 0; cloud && row < map->x.table->members; row++) {
    struct point p = {study_axis_at(&map->x, row), study_axis_at(&map->y, row)};
    p = frame_pixel(&map->panel.frame, p);
    cloud_dot(cloud, p.x, p.y, 0.8 * canvas->unit,
              study_row_counts(map->x.table, row) ? rim : light);
  }
  if (cloud) {
    cloud_paint(cloud, canvas, 0.5);
  }
  cloud_destroy(cloud);
}

/* Members as dots, wherever they lie across the slice; failed ones as crosses. */
static void draw_members(struct map *map, struct canvas *canvas) {
  if (map->x.table->members > CLOUD) {
    draw_many(map, canvas);
    return;
  }
  double r = 2.2 * canvas->unit;
  for (size_t row = 0; row < map->x.table->members; row++) {
    bool solved = study_row_counts(map->x.table, row);
    struct point p = {study_axis_at(&map->x, row), study_axis_at(&map->y, row)};
    if (isnan(p.x) || isnan(p.y) || !(solved || study_row_failed(map->x.table, row))) {
      continue;
    }
    p = frame_pixel(&map->panel.frame, p);
    if (solved) {
      cairo_rectangle(canvas->cr, p.x - r, p.y - r, 2 * r, 2 * r);
      canvas_set_colour(canvas, (struct colour){.role = COLOUR_OUTLINE});
      cairo_fill(canvas->cr);
      cairo_rectangle(canvas->cr, p.x - r / 2, p.y - r / 2, r, r);
      canvas_set_colour(canvas, canvas->theme == THEME_LIGHT ? colour_paper : colour_ink);
      cairo_fill(canvas->cr);
    } else {
      double d = 1.6 * r;
      cairo_move_to(canvas->cr, p.x - d, p.y - d);
      cairo_line_to(canvas->cr, p.x + d, p.y + d);
      cairo_move_to(canvas->cr, p.x - d, p.y + d);
      cairo_line_to(canvas->cr, p.x + d, p.y - d);
      canvas_set_colour(canvas, (struct colour){.role = COLOUR_OUTLINE});
      cairo_set_line_width(canvas->cr, 3.4 * canvas->unit);
      cairo_stroke_preserve(canvas->cr);
      canvas_set_colour(canvas, canvas->theme == THEME_LIGHT ? colour_paper : colour_ink);
      cairo_set_line_width(canvas->cr, 1.4 * canvas->unit);
      cairo_stroke(canvas->cr);
    }
  }
}

/* Range of the bands from the means; where the surrogate is sure of less than a tenth of that. */
static void set_levels(struct map *map) {
  const struct study_slice *slice = map->slice;
  double low = INFINITY, high = -INFINITY, widest = 0;
  for (size_t k = 0; k < slice->columns * slice->rows; k++) {
    low = fmin(low, slice->mean[k]);
    high = fmax(high, slice->mean[k]);
    widest = fmax(widest, slice->deviation ? slice->deviation[k] : 0);
  }
  ticks_widen(&low, &high, BANDS);
  map->levels = ticks_make(low, high, BANDS);
  map->panel.bar = (struct colour_bar){.map = colour_map_area,
                                       .min = low,
                                       .max = high,
                                       .bands = map->levels.count > 1 ? map->levels.count - 1 : 1};
  map->unsure = INFINITY;
  struct ticks tenth = ticks_make(0, 0.3 * (high - low), 2);
  char text[STUDY_LABEL];
  if (slice->deviation) {
    study_axis_text(&map->metric, tenth.step, true, text);
    map->unsure = widest > tenth.step ? tenth.step : INFINITY;
    study_panel_add(&map->panel,
                    isfinite(map->unsure) ? "hatched: standard deviation above %s"
                                          : "standard deviation below %s",
                    text);
  }
}

static void set_frame(struct map *map, char labels[3][STUDY_LABEL]) {
  const struct study_slice *slice = map->slice;
  study_axis_label(&map->x, labels[0]);
  study_axis_label(&map->y, labels[1]);
  study_axis_label(&map->metric, labels[2]);
  map->panel.bar.label = labels[2];
  map->panel.tight = true;
  map->panel.axes = (struct axes){.x_label = labels[0],
                                  .y_label = labels[1],
                                  .log_x = map->x.logarithmic,
                                  .log_y = map->y.logarithmic};
  map->panel.frame = (struct frame){.x_min = map->across[0],
                                    .x_max = map->across[slice->columns - 1],
                                    .y_min = map->up[0],
                                    .y_max = map->up[slice->rows - 1]};
}

static void set_words(struct map *map) {
  const struct study_slice *slice = map->slice;
  snprintf(map->panel.title, sizeof map->panel.title, "%.120s over %.100s and %.100s, predicted",
           map->metric.column->title, map->x.column->title, map->y.column->title);
  if (slice->fixed && *slice->fixed) {
    snprintf(map->panel.subtitle, sizeof map->panel.subtitle, "at %.300s", slice->fixed);
  } else {
    study_panel_words(&map->panel, map->x.table);
  }
  if (slice->method && *slice->method) {
    study_panel_add(&map->panel, "%.120s", slice->method);
  }
}

static enum status draw_map(struct map *map, struct canvas *canvas, struct error *error) {
  char labels[3][STUDY_LABEL], text[TICKS_TEXT];
  struct place place = {0};
  set_words(map);
  set_levels(map);
  set_frame(map, labels);
  study_panel_begin(&map->panel, canvas);
  enum status status = fill(map, canvas, error);
  place.bounds = map->panel.frame.area;
  const struct box *area = &map->panel.frame.area;
  cairo_save(canvas->cr);
  cairo_rectangle(canvas->cr, area->x, area->y, area->width, area->height);
  cairo_clip(canvas->cr);
  for (int i = 1; i + 1 < map->levels.count && status == STATUS_OK; i++) {
    ticks_label(&map->levels, i, text);
    status = draw_level(map, canvas, ticks_value(&map->levels, i), text, &place, error);
  }
  draw_members(map, canvas);
  cairo_restore(canvas->cr);
  study_panel_rim(&map->panel, canvas);
  place_release(&place);
  return status;
}

/* Positions of the values of a grid; NULL without memory. */
static double *positions(const struct study_axis *axis, const double *values, size_t count) {
  double *found = malloc(count * sizeof *found);
  for (size_t i = 0; found && i < count; i++) {
    found[i] = axis->logarithmic ? log10(values[i]) : values[i];
  }
  return found;
}

enum status study_draw_contour(struct canvas *canvas, const struct study_plot_input *input,
                               const struct study_plot_options *options, struct error *error) {
  const struct study_slice *slice = input->slice;
  (void)options;
  struct map map = {.slice = slice,
                    .metric = study_axis_metric(input->table, slice->metric),
                    .x = study_axis_parameter(input->table, slice->x),
                    .y = study_axis_parameter(input->table, slice->y)};
  map.across = positions(&map.x, slice->x_value, slice->columns);
  map.up = positions(&map.y, slice->y_value, slice->rows);
  enum status status = map.across && map.up
                           ? draw_map(&map, canvas, error)
                           : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out");
  free(map.across);
  free(map.up);
  return status;
}
