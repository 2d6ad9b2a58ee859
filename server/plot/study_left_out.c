#include <math.h>
#include <stdio.h>

#include "server/plot/cloud.h"
#include "server/plot/series.h"
#include "server/plot/study_draw.h"
#include "server/plot/study_panel.h"

/* So many points have an error bar each. */
enum { BARS_MOST = 300 };

static const double two_sided_95 = 1.96;

static void find_range(const struct study_left_out *left_out, struct frame *frame) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < left_out->count; i++) {
    low = fmin(low, fmin(left_out->known[i], left_out->predicted[i]));
    high = fmax(high, fmax(left_out->known[i], left_out->predicted[i]));
  }
  double spare = high > low ? 0.02 * (high - low) : fmax(fabs(low) * 0.1, 0.5);
  /* quantities that are never negative start at zero */
  spare = fmin(spare, low >= 0 ? low : spare);
  *frame = (struct frame){
      .x_min = low - spare, .x_max = high + spare, .y_min = low - spare, .y_max = high + spare};
}

static void draw_bars(struct canvas *canvas, const struct study_panel *panel,
                      const struct study_left_out *left_out) {
  canvas_set_colour(canvas, colour_fade(colour_series(0), 0.5));
  for (size_t i = 0; i < left_out->count && left_out->count <= BARS_MOST; i++) {
    double half = two_sided_95 * left_out->deviation[i];
    if (!isfinite(left_out->known[i]) || !isfinite(left_out->predicted[i]) || !(half > 0)) {
      continue;
    }
    struct point a = {left_out->known[i], left_out->predicted[i] - half};
    struct point b = {left_out->known[i], left_out->predicted[i] + half};
    a = frame_pixel(&panel->frame, a);
    b = frame_pixel(&panel->frame, b);
    canvas_line(canvas, a.x, a.y, b.x, b.y, 1);
  }
}

static enum status draw_points(struct canvas *canvas, const struct study_panel *panel,
                               const struct study_left_out *left_out, struct error *error) {
  struct cloud *cloud = cloud_create(canvas, panel->frame.area, false);
  struct rgb colour = colour_rgb(colour_series(0), canvas->theme);
  double radius = (left_out->count > 1000 ? 1.5 : left_out->count > 200 ? 2.2 : 3.2) * canvas->unit;
  if (!cloud) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t i = 0; i < left_out->count; i++) {
    struct point p = {left_out->known[i], left_out->predicted[i]};
    p = frame_pixel(&panel->frame, p);
    cloud_dot(cloud, p.x, p.y, radius, colour);
  }
  cloud_paint(cloud, canvas, fmax(cloud_opacity(left_out->count), 0.3));
  cloud_destroy(cloud);
  return STATUS_OK;
}

static void add_words(struct study_panel *panel, const struct study_left_out *left_out) {
  study_panel_add(panel, "%zu designs", left_out->count);
  if (!isnan(left_out->r2)) {
    study_panel_add(panel, "R² %.3f", left_out->r2);
  }
  if (!isnan(left_out->within)) {
    study_panel_add(panel, "%.0f %% in their intervals", 100 * left_out->within);
  }
}

enum status study_draw_surrogate(struct canvas *canvas, const struct study_plot_input *input,
                                 const struct study_plot_options *options, struct error *error) {
  const struct study_left_out *left_out = input->left_out;
  struct study_axis metric = study_axis_metric(input->table, left_out->metric);
  struct study_panel panel = {0};
  char plain[STUDY_LABEL], labels[2][STUDY_LABEL + 40];
  (void)options;
  study_panel_words(&panel, input->table);
  snprintf(panel.title, sizeof panel.title, "%.150s: predicted without itself, and solved",
           metric.column->title);
  if (left_out->count == 0) {
    study_panel_empty(&panel, canvas, "No member has been solved yet");
    return STATUS_OK;
  }
  add_words(&panel, left_out);
  study_axis_label(&metric, plain);
  snprintf(labels[0], sizeof labels[0], "%s, solved", plain);
  snprintf(labels[1], sizeof labels[1], "%s, predicted", plain);
  panel.axes = (struct axes){.x_label = labels[0], .y_label = labels[1]};
  find_range(left_out, &panel.frame);
  const struct point dummy = {0, 0};
  struct point ends[2] = {{panel.frame.x_min, panel.frame.x_min},
                          {panel.frame.x_max, panel.frame.x_max}};
  const double bar = 0;
  const struct chart_series key[2] = {
      {.points = &dummy,
       .count = 1,
       .colour = colour_series(0),
       .marker = MARKER_CIRCLE,
       .errors = &bar,
       .name = left_out->count <= BARS_MOST ? "design, with its 95 % interval" : "design"},
      {.points = ends,
       .count = 2,
       .colour = colour_muted,
       .width = 1.4,
       .dash = DASH_SHORT,
       .name = "predicted = solved"}};
  panel.key = key;
  panel.key_count = 2;
  study_panel_begin(&panel, canvas);
  const struct box *a = &panel.frame.area;
  cairo_save(canvas->cr);
  cairo_rectangle(canvas->cr, a->x, a->y, a->width, a->height);
  cairo_clip(canvas->cr);
  draw_bars(canvas, &panel, left_out);
  series_draw(canvas, &panel.frame, &key[1]);
  cairo_restore(canvas->cr);
  return draw_points(canvas, &panel, left_out, error);
}
