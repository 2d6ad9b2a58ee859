#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"

enum { DEFORMATIONS = 3 };

/* Cuts a curve where its compression gets larger than `top`, the largest tension of all:
 * equibiaxial compression grows so fast that nothing else could be seen. Returns the points left,
 * the last ones. */
static size_t cut(struct point *points, size_t count, double top) {
  size_t first = 0;
  while (first < count && points[first].y < -top) {
    first++;
  }
  if (first > 0 && first < count) {
    struct point a = points[first - 1], b = points[first];
    double t = (-top - a.y) / (b.y - a.y);
    points[--first] = (struct point){a.x + t * (b.x - a.x), -top};
  }
  memmove(points, points + first, (count - first) * sizeof *points);
  return count - first;
}

enum status draw_stress(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  static const char *const keys[DEFORMATIONS] = {"uniaxial_stress_MPa", "planar_stress_MPa",
                                                 "equibiaxial_stress_MPa"};
  static const char *const names[DEFORMATIONS] = {"uniaxial", "planar", "equibiaxial"};
  (void)count;
  const json_t *result = inputs[0].result;
  struct point *points[DEFORMATIONS] = {NULL};
  struct chart_series series[DEFORMATIONS];
  enum status status = STATUS_OK;
  double top = 0;
  for (size_t i = 0; i < DEFORMATIONS; i++) {
    size_t used;
    status = data_samples(result, "stretch", keys[i], &points[i], &used, error);
    if (status != STATUS_OK) {
      goto done;
    }
    series[i] = (struct chart_series){.points = points[i],
                                      .count = used,
                                      .colour = colour_series(i),
                                      .width = 2.2,
                                      .dash = (enum chart_dash)i,
                                      .name = names[i]};
    for (size_t k = 0; k < used; k++) {
      top = fmax(top, points[i][k].y);
    }
  }
  for (size_t i = 0; i < DEFORMATIONS && top > 0; i++) {
    series[i].count = cut(points[i], series[i].count, top);
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING], number[TICKS_TEXT], mark_text[80];
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  struct point peak = {data_number(json_object_get(result, "metrics"), "stable_to_stretch"), 0};
  ticks_plain(peak.x, 3, number);
  snprintf(mark_text, sizeof mark_text, "a peak at %s", number);
  bool inside = false;
  for (size_t i = 0; i < series[0].count; i++) {
    inside = inside || series[0].points[i].x >= peak.x;
  }
  struct chart chart = {.title = "Engineering stress against stretch",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Stretch",
                        .y_label = "Engineering stress (MPa)",
                        .series = series,
                        .series_count = DEFORMATIONS,
                        .mark = inside ? &peak : NULL,
                        .mark_text = mark_text,
                        .empty = "No stresses were recorded"};
  chart_draw(&chart, canvas);
done:
  for (size_t i = 0; i < DEFORMATIONS; i++) {
    free(points[i]);
  }
  return status;
}
