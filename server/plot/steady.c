#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

enum { RUNS_MOST = 60 };

/* The states at the ends of the held set-points, and the runs in which these only rise or fall. */
struct ladder {
  struct point *points;
  size_t count;
  struct run {
    size_t first, last; /* neighbouring runs share a point */
    bool falling;
  } run[RUNS_MOST];
  size_t run_count;
};

static enum status read_ladder(const json_t *result, const char *key, struct ladder *ladder,
                               struct error *error) {
  const json_t *holds = json_object_get(result, "holds");
  size_t most = json_array_size(holds);
  ladder->points = malloc((most + 1) * sizeof *ladder->points);
  if (!ladder->points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu set-points", most);
  }
  for (size_t i = 0; i < most; i++) {
    const json_t *hold = json_array_get(holds, i);
    struct point p = {data_number(hold, "set_point_kPa"), data_number(hold, key)};
    if (isfinite(p.x) && isfinite(p.y)) {
      ladder->points[ladder->count++] = p;
    }
  }
  for (size_t i = 1; i < ladder->count; i++) {
    bool falling = ladder->points[i].x < ladder->points[i - 1].x;
    struct run *last = ladder->run_count ? &ladder->run[ladder->run_count - 1] : NULL;
    if (last && last->falling == falling) {
      last->last = i;
    } else if (ladder->run_count < RUNS_MOST) {
      ladder->run[ladder->run_count++] = (struct run){i - 1, i, falling};
    }
  }
  return STATUS_OK;
}

/* A run of one step says nothing about what lies between its ends: it gets a marker and no line. */
static size_t add_runs(const struct ladder *ladder, struct chart_series *series) {
  static const char *const names[2] = {"inflating", "deflating"};
  bool named[2] = {false, false};
  size_t count = 0;
  for (size_t i = 0; i < ladder->run_count; i++) {
    const struct run *run = &ladder->run[i];
    bool single = run->last == run->first + 1;
    for (size_t k = single && i == 0 ? 0 : 1; k < 2; k++) {
      /* The first set-point of all is come to from none. */
      bool falling = k == 0 ? ladder->points[0].x < 0 : run->falling;
      size_t first = k == 0 ? 0 : single ? run->last : run->first;
      series[count++] = (struct chart_series){
          .points = ladder->points + first,
          .count = (k == 0 ? 0 : run->last) - first + 1,
          .colour = colour_series(falling),
          .width = single ? 0 : 2.0,
          .marker = falling ? MARKER_SQUARE : MARKER_CIRCLE,
          .hollow = falling,
          .name = named[falling] ? NULL : names[falling],
      };
      named[falling] = true;
    }
  }
  return count;
}

enum status draw_steady(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result;
  bool ratio = isfinite(data_number(json_object_get(result, "metrics"), "extension_ratio"));
  struct chart_series series[RUNS_MOST + 1];
  struct ladder ladder = {.points = NULL};
  enum status status =
      read_ladder(result, ratio ? "end_extension_ratio" : "end_h_mm", &ladder, error);
  if (status == STATUS_OK) {
    char subtitle[DATA_HEADING], notice[DATA_HEADING];
    data_subtitle(&inputs[0], subtitle);
    data_notice(result, notice);
    struct chart chart = {.title = "Elongation at the end of each held set-point",
                          .subtitle = subtitle,
                          .notice = notice,
                          .x_label = "Set-point (kPa)",
                          .y_label = ratio ? "Extension ratio" : "h (mm)",
                          .series = series,
                          .series_count = add_runs(&ladder, series),
                          .empty = "Fewer than two set-points were held"};
    chart_draw(&chart, canvas);
  }
  free(ladder.points);
  return status;
}
