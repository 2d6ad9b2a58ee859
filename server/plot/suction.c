#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/members.h"

/* A metric of a member; one that has no suckers has neither their number nor their force. */
static double metric_or_zero(const struct member *member, const char *key) {
  double value = member_metric(member, key);
  return isfinite(value) || strncmp(key, "suc", 3) != 0 ? value : 0;
}

static int compare_points(const void *left, const void *right) {
  const struct point *a = left, *b = right;
  return a->x < b->x ? -1 : a->x > b->x;
}

/* The metric over the number of suckers; *line: at most one member for each number. */
static size_t read_points(const struct members *members, const char *key, struct point *points,
                          bool *line) {
  size_t count = 0;
  *line = true;
  for (size_t i = 0; i < members->count; i++) {
    const struct member *member = &members->list[i];
    struct point p = {metric_or_zero(member, "sucker_count"), metric_or_zero(member, key)};
    if (isfinite(p.x) && isfinite(p.y) && !member->stopped) {
      points[count++] = p;
    }
  }
  qsort(points, count, sizeof *points, compare_points);
  for (size_t i = 1; i < count; i++) {
    *line = *line && points[i].x > points[i - 1].x;
  }
  return count;
}

enum status draw_suction(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  static const char *const keys[2] = {"suction_force_N", "bending_angle_deg"};
  static const double shares[2] = {0.5, 0.5};
  (void)count;
  struct members members;
  struct point *points[2] = {NULL, NULL};
  enum status status = members_read(inputs[0].result, &members, error);
  if (status != STATUS_OK) {
    goto done;
  }
  struct chart_series series[2];
  struct chart charts[2];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  members_subtitle(&inputs[0], members.count, subtitle);
  members_notice(&members, notice);
  for (size_t k = 0; k < 2; k++) {
    bool line;
    points[k] = calloc(members.count + 1, sizeof *points[k]);
    if (!points[k]) {
      status =
          error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu members", members.count);
      goto done;
    }
    size_t used = read_points(&members, keys[k], points[k], &line);
    series[k] = (struct chart_series){.points = points[k],
                                      .count = used,
                                      .colour = colour_series(k),
                                      .width = line ? 2.0 : 0,
                                      .marker = k ? MARKER_SQUARE : MARKER_CIRCLE};
    charts[k] = (struct chart){.title = "Suction and bending against the number of suckers",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Number of suckers",
                               .y_label = k ? "Bending angle (°)" : "Suction force (N)",
                               .whole_x = true,
                               .series = &series[k],
                               .series_count = 1,
                               .empty = "None of the members has it"};
  }
  chart_draw_stack(charts, shares, 2, canvas);
done:
  free(points[0]);
  free(points[1]);
  members_release(&members);
  return status;
}
