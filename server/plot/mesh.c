#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/members.h"
#include "server/plot/metric.h"
#include "server/plot/quantity.h"

static int compare_points(const void *left, const void *right) {
  const struct point *a = left, *b = right;
  return a->x < b->x ? -1 : a->x > b->x;
}

/* Unknowns (decimal logarithm) and metric of the members that were solved, coarsest first. */
static size_t read_points(const struct members *members, const char *key, struct point *points,
                          struct chart_label *labels) {
  size_t count = 0;
  for (size_t i = 0; i < members->count; i++) {
    const struct member *member = &members->list[i];
    const json_t *statistics = json_object_get(member->object, "statistics");
    double unknowns = data_number(statistics, "unknowns");
    struct point p = {log10(unknowns), member_metric(member, key)};
    if (unknowns >= 1 && isfinite(p.y) && !member->stopped) {
      labels[count].at = p;
      snprintf(labels[count].text, sizeof labels[count].text, "%.36s", member->name);
      points[count++] = p;
    }
  }
  qsort(points, count, sizeof *points, compare_points);
  return count;
}

/* Draws the points, coarsest first, with the finest value and what lies within 1 % of it. */
static void draw_points(struct canvas *canvas, const struct plot_input *input,
                        const struct members *members, const char *key, const struct point *points,
                        size_t count, const struct chart_label *labels) {
  char subtitle[DATA_HEADING], notice[DATA_HEADING], y_label[160], name[100];
  char number[TICKS_TEXT], unit[32];
  struct point finest = count ? points[count - 1] : (struct point){0, 0};
  /* over the whole width; the range of y has to be opened for the band by points */
  const struct point line[2] = {{-99, finest.y}, {99, finest.y}};
  const struct point edges[2] = {{finest.x, 0.99 * finest.y}, {finest.x, 1.01 * finest.y}};
  const double band[2] = {fabs(finest.y) / 100, fabs(finest.y) / 100};
  ticks_number(finest.y, 4, number);
  quantity_unit(key, unit, sizeof unit);
  bool joined = *unit == '\0' || strncmp(unit, "°", strlen("°")) == 0;
  snprintf(name, sizeof name, "finest: %s%s%s, ± 1 %%", number, joined ? "" : " ", unit);
  const struct chart_series series[] = {{.points = edges, .count = count ? 2 : 0},
                                        {.points = line,
                                         .count = count > 1 ? 2 : 0,
                                         .colour = colour_series(1),
                                         .width = 1.6,
                                         .dash = DASH_LONG,
                                         .band = band,
                                         .guide = true,
                                         .name = name},
                                        {.points = points,
                                         .count = count,
                                         .colour = colour_series(0),
                                         .width = 2.0,
                                         .marker = MARKER_CIRCLE,
                                         .name = "computed"}};
  members_subtitle(input, members->count, subtitle);
  members_notice(members, notice);
  quantity_label(key, y_label, sizeof y_label);
  struct chart chart = {.title = "Convergence with the mesh",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Number of unknowns",
                        .y_label = y_label,
                        .loose_x = true,
                        .log_x = true,
                        .series = series,
                        .series_count = sizeof series / sizeof *series,
                        .labels = labels,
                        .label_count = count,
                        .empty = "None of the members was solved"};
  chart_draw(&chart, canvas);
}

enum status draw_mesh(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error) {
  (void)count;
  const struct plot_input *input = &inputs[0];
  struct members members;
  struct point *points = NULL;
  struct chart_label *labels = NULL;
  const char *key =
      metric_choose(input->result, input->metric ? input->metric : "bending_angle_deg");
  enum status status = members_read(input->result, &members, error);
  if (status != STATUS_OK) {
    goto done;
  }
  points = calloc(members.count + 1, sizeof *points);
  labels = calloc(members.count + 1, sizeof *labels);
  if (!points || !labels) {
    status =
        error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu meshes", members.count);
    goto done;
  }
  key = key ? key : "bending_angle_deg";
  size_t used = read_points(&members, key, points, labels);
  draw_points(canvas, input, &members, key, points, used, labels);
done:
  free(points);
  free(labels);
  members_release(&members);
  return status;
}
