#include <math.h>
#include <stdlib.h>

#include "server/plot/axes.h"
#include "server/plot/draw.h"
#include "server/plot/members.h"
#include "server/plot/quantity.h"
#include "server/plot/views.h"

/* The tips of all samples of all members. */
struct workspace {
  struct members members;
  struct views_point *points;
  struct views_path *paths;
  size_t point_count, path_count;
  bool rows; /* coloured by the pressures of both rows */
  double top_kPa;
};

/* Highest pressure of a row (0: left, 1: right) as the study gives it: by itself, as part of the
 * pressure, or as that of both rows; NaN when it does not. */
static double given_pressure(const json_t *values, int row) {
  static const char *const own[2] = {"/load/pressure/left", "/load/pressure/right"};
  static const char *const part[2] = {"left", "right"};
  const json_t *whole = json_object_get(values, "/load/pressure");
  const json_t *choices[4] = {json_object_get(values, own[row]), json_object_get(whole, part[row]),
                              json_object_get(values, "/load/pressure/to"),
                              json_object_get(whole, "to")};
  double pressure = NAN;
  for (int i = 0; i < 4 && !isfinite(pressure); i++) {
    pressure = quantity_pressure_kPa(choices[i]);
  }
  return pressure;
}

/* Pressures of both rows at a sample, in kPa, in the proportion that the study gives the rows of
 * this member; NaN when it does not give both. */
static void row_pressures(const struct member *member, const json_t *sample, double rows[2]) {
  const json_t *values = json_object_get(member->object, "values");
  double pressure = data_number(sample, "pressure_kPa");
  const double full[2] = {given_pressure(values, 0), given_pressure(values, 1)};
  double larger = fmax(full[0], full[1]);
  bool known = full[0] >= 0 && full[1] >= 0;
  for (int c = 0; c < 2; c++) {
    rows[c] = !known ? NAN : larger > 0 ? pressure * full[c] / larger : 0;
  }
}

/* Whether all positions have known row pressures; finds the highest pressure too. */
static void choose_colours(struct workspace *space) {
  space->rows = true;
  for (size_t i = 0; i < space->members.count; i++) {
    const struct member *member = &space->members.list[i];
    const json_t *samples = json_object_get(member->object, "samples");
    for (size_t k = 0; k < json_array_size(samples); k++) {
      const json_t *sample = json_array_get(samples, k);
      double rows[2];
      row_pressures(member, sample, rows);
      space->rows = space->rows && isfinite(rows[0]) && isfinite(rows[1]);
      space->top_kPa = fmax(space->top_kPa, data_number(sample, "pressure_kPa"));
      space->top_kPa = fmax(space->top_kPa, fmax(rows[0], rows[1]));
    }
  }
  if (!(space->top_kPa > 0)) {
    space->rows = false;
    space->top_kPa = 1;
  }
}

/* Adds the way of one member's tip. */
static void add_path(struct workspace *space, const struct member *member) {
  const json_t *samples = json_object_get(member->object, "samples");
  struct views_point *start = space->points + space->point_count;
  size_t count = 0;
  for (size_t i = 0; i < json_array_size(samples); i++) {
    const json_t *sample = json_array_get(samples, i);
    struct views_point p = {{data_number(sample, "tip_x_mm"), data_number(sample, "tip_y_mm"),
                             data_number(sample, "tip_z_mm")},
                            colour_muted};
    double rows[2], pressure = data_number(sample, "pressure_kPa");
    if (!isfinite(p.at[0]) || !isfinite(p.at[1]) || !isfinite(p.at[2])) {
      continue;
    }
    row_pressures(member, sample, rows);
    if (space->rows) {
      p.colour = colour_map_plane(rows[1] / space->top_kPa, rows[0] / space->top_kPa);
    } else if (isfinite(pressure)) {
      p.colour = colour_map_line(pressure / space->top_kPa);
    }
    start[count++] = p;
  }
  if (count > 0) {
    space->paths[space->path_count++] = (struct views_path){
        .points = start, .count = count, .width = 0.8, .light = true, .dots = true};
    space->point_count += count;
  }
}

static enum status workspace_read(const json_t *result, struct workspace *space,
                                  struct error *error) {
  enum status status = members_read(result, &space->members, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t total = 1;
  for (size_t i = 0; i < space->members.count; i++) {
    total += json_array_size(json_object_get(space->members.list[i].object, "samples"));
  }
  space->points = calloc(total, sizeof *space->points);
  space->paths = calloc(space->members.count + 1, sizeof *space->paths);
  if (!space->points || !space->paths) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu positions", total);
  }
  choose_colours(space);
  for (size_t i = 0; i < space->members.count; i++) {
    add_path(space, &space->members.list[i]);
  }
  return STATUS_OK;
}

/* A square of all pairs of row pressures. */
static void draw_key(struct canvas *canvas, struct box area, const void *context) {
  enum { CELLS = 32 };
  const struct workspace *space = context;
  double u = canvas->unit, left = 78 * u, below = 56 * u;
  double side = fmin(fmin(area.width - left, area.height - below - 8 * u), 0.36 * canvas->height);
  const struct axes axes = {.x_label = "Right row (kPa)", .y_label = "Left row (kPa)"};
  if (side < 30 * u) {
    return;
  }
  /* in the middle of its quarter */
  double x = area.x + (area.width - side - left) / 2 + left;
  struct frame frame = {
      {round(x), round(area.y + 8 * u), side, side}, 0, space->top_kPa, 0, space->top_kPa};
  axes_draw(canvas, &axes, &frame, false);
  for (int i = 0; i < CELLS * CELLS; i++) {
    int column = i % CELLS, row = i / CELLS;
    double x0 = round(frame.area.x + side * column / CELLS);
    double x1 = round(frame.area.x + side * (column + 1) / CELLS);
    double y0 = round(frame.area.y + side * row / CELLS);
    double y1 = round(frame.area.y + side * (row + 1) / CELLS);
    canvas_set_colour(canvas, colour_map_plane((column + 0.5) / CELLS, 1 - (row + 0.5) / CELLS));
    cairo_rectangle(canvas->cr, x0, y0, x1 - x0, y1 - y0);
    cairo_fill(canvas->cr);
  }
}

enum status draw_workspace(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error) {
  (void)count;
  struct workspace space = {.point_count = 0};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = workspace_read(inputs[0].result, &space, error);
  if (status == STATUS_OK) {
    members_subtitle(&inputs[0], space.members.count, subtitle);
    members_notice(&space.members, notice);
    struct views views = {.title = "Positions of the tip",
                          .subtitle = subtitle,
                          .notice = notice,
                          .paths = space.paths,
                          .path_count = space.path_count,
                          .empty = "No positions of the tip were recorded"};
    if (space.rows) {
      views.key = draw_key;
      views.key_context = &space;
    } else {
      views.bar = (struct colour_bar){
          .label = "Pressure (kPa)", .map = colour_map_line, .min = 0, .max = space.top_kPa};
    }
    views_draw(&views, canvas);
  }
  free(space.points);
  free(space.paths);
  members_release(&space.members);
  return status;
}
