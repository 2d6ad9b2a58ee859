#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/chart.h"
#include "tools/figure.h"
#include "tools/performance.h"

enum { FIGURE_WIDTH = 640, FIGURE_HEIGHT = 420, POINTS_MAX = 1000, SERIES_MAX = 8 };

static bool write_chart(const struct chart *chart, const char *directory, const char *name) {
  struct canvas *canvas = canvas_create(FIGURE_WIDTH, FIGURE_HEIGHT, THEME_LIGHT);
  struct canvas_note note = {"Title", chart->title};
  unsigned char *png = NULL;
  char path[4096];
  size_t size = 0;
  struct error error = {0};
  snprintf(path, sizeof path, "%s/%s.png", directory, name);
  if (!canvas) {
    fprintf(stderr, "performance: out of memory\n");
    return false;
  }
  chart_draw(chart, canvas);
  bool good = canvas_encode(canvas, &note, 1, &png, &size, &error) == STATUS_OK;
  canvas_destroy(canvas);
  if (!good) {
    fprintf(stderr, "performance: %s: %s\n", path, error.message);
    return false;
  }
  return figure_save(png, size, path);
}

/* ---- time against unknowns ---- */

/* Curves and fits, with the memory that they point into. */
struct curves {
  struct chart_series series[SERIES_MAX];
  size_t count;
  struct point points[SERIES_MAX][POINTS_MAX];
  char detail[SERIES_MAX][40];
};

/* The logarithms of a figure of all bodies of one series. */
static void add_points(struct curves *c, const json_t *series, const char *figure,
                       const char *name) {
  struct point *points = c->points[c->count];
  const json_t *p;
  size_t index, count = 0;
  json_array_foreach(json_object_get(series, "points"), index, p) {
    double unknowns = figure_number(p, "unknowns"), time = figure_number(p, figure);
    const char *status = figure_text(p, "status");
    bool whole = strcmp(figure, "whole_solve_s") != 0 || strcmp(status, "ok") == 0;
    if (unknowns > 0 && time > 0 && whole && count < POINTS_MAX) {
      points[count++] = (struct point){log10(unknowns), log10(time)};
    }
  }
  bool path = strcmp(figure, "whole_solve_s") == 0;
  static const enum chart_marker markers[] = {MARKER_CIRCLE, MARKER_SQUARE, MARKER_TRIANGLE};
  size_t body = c->count % 3;
  c->series[c->count++] = (struct chart_series){.points = points,
                                                .count = count,
                                                .colour = colour_series(path ? 4 : body),
                                                .width = 0,
                                                .marker = markers[body],
                                                .name = name};
}

static void add_fit(struct curves *c, const json_t *scaling, const char *figure, const char *name) {
  struct growth g = fit_growth(scaling, figure);
  struct point *points = c->points[c->count];
  if (isnan(g.exponent)) {
    return;
  }
  points[0] = (struct point){log10(g.smallest), log10(g.factor * pow(g.smallest, g.exponent))};
  points[1] = (struct point){log10(g.largest), log10(g.factor * pow(g.largest, g.exponent))};
  snprintf(c->detail[c->count], sizeof c->detail[0], "power %.2f", g.exponent);
  c->series[c->count] = (struct chart_series){.points = points,
                                              .count = 2,
                                              .colour = colour_muted,
                                              .width = 1.6,
                                              .dash = c->count % 2 ? DASH_LONG : DASH_SHORT,
                                              .guide = true,
                                              .name = name,
                                              .detail = c->detail[c->count]};
  c->count++;
}

static bool plot_unknowns(const json_t *scaling, const char *directory) {
  static const char *const bodies[] = {"step, finer meshes", "step, more chambers", "step, both"};
  struct curves *c = calloc(1, sizeof *c);
  if (!c) {
    fprintf(stderr, "performance: out of memory\n");
    return false;
  }
  for (size_t k = 0; k < 3; k++) {
    add_points(c, json_array_get(json_object_get(scaling, "series"), k), "step_s", bodies[k]);
  }
  for (size_t k = 0; k < 3; k++) {
    add_points(c, json_array_get(json_object_get(scaling, "series"), k), "whole_solve_s",
               k == 0 ? "load path, all bodies" : NULL);
  }
  add_fit(c, scaling, "step_s", "step,");
  add_fit(c, scaling, "whole_solve_s", "load path,");
  struct chart chart = {.title = "Time against unknowns",
                        .subtitle = "one step (assembly, factorisation, solution), and load paths "
                                    "of ten pressures",
                        .notice = "",
                        .x_label = "Unknowns",
                        .y_label = "CPU time (s)",
                        .log_x = true,
                        .log_y = true,
                        .series = c->series,
                        .series_count = c->count,
                        .empty = "Nothing was measured"};
  bool good = write_chart(&chart, directory, "performance-unknowns");
  free(c);
  return good;
}

/* ---- CPU time of the designs ---- */

static int compare(const void *a, const void *b) {
  double x = ((const struct point *)a)->x, y = ((const struct point *)b)->x;
  return (x > y) - (x < y);
}

/* CPU times in rising order, each with the share of the designs that took no longer, in per cent.
 */
static size_t cumulate(const json_t *designs, struct point *points) {
  size_t count = 0, index;
  const json_t *design;
  json_array_foreach(designs, index, design) {
    double time = figure_number(design, "cpu_s");
    if (time > 0) {
      points[count++] = (struct point){time, 0};
    }
  }
  qsort(points, count, sizeof *points, compare);
  for (size_t k = 0; k < count; k++) {
    points[k].y = 100.0 * (double)(k + 1) / (double)count;
  }
  return count;
}

static bool plot_designs(const json_t *document, const char *directory) {
  const json_t *designs = json_object_get(document, "designs");
  struct point *points = calloc(json_array_size(designs) + 1, sizeof *points);
  if (!points) {
    fprintf(stderr, "performance: out of memory\n");
    return false;
  }
  char subtitle[120];
  size_t count = cumulate(designs, points);
  snprintf(subtitle, sizeof subtitle, "%zu designs of a Latin hypercube, accuracy %s", count,
           figure_text(json_object_get(document, "options"), "accuracy"));
  struct chart_series series = {
      .points = points, .count = count, .colour = colour_series(0), .width = 2.2};
  struct chart chart = {.title = "Designs that took no longer",
                        .subtitle = subtitle,
                        .notice = "",
                        .x_label = "CPU time of the process (s)",
                        .y_label = "Share of the designs (%)",
                        .from_zero = true,
                        .series = &series,
                        .series_count = 1,
                        .empty = "No design was solved"};
  bool good = write_chart(&chart, directory, "performance-designs");
  free(points);
  return good;
}

bool write_plots(const struct figures *figures, const char *directory) {
  const json_t *scaling = figures->part[FIGURES_SCALING];
  const json_t *designs = figures->part[FIGURES_ROBUSTNESS];
  return (!scaling || plot_unknowns(scaling, directory)) &&
         (!designs || plot_designs(designs, directory));
}
