#include "server/plot/views.h"

#include <math.h>

#include "server/plot/axes.h"

/* Coordinates that a view shows. */
struct view {
  int across, up;
  const char *name;
  struct axes axes;
};

static const struct view all[3] = {
    {0, 2, "side", {.x_label = "x (mm)", .y_label = "z (mm)", .no_x_text = true}},
    {1, 2, "front, from the tip", {.x_label = "y (mm)", .y_label = "z (mm)", .no_y_text = true}},
    {0, 1, "from below", {.x_label = "x (mm)", .y_label = "y (mm)"}},
};

struct range {
  double min, max;
};

static size_t find_ranges(const struct views *views, struct range ranges[3]) {
  size_t count = 0;
  for (int k = 0; k < 3; k++) {
    ranges[k] = (struct range){INFINITY, -INFINITY};
  }
  for (size_t p = 0; p < views->path_count; p++) {
    for (size_t i = 0; i < views->paths[p].count; i++, count++) {
      for (int k = 0; k < 3; k++) {
        double value = views->paths[p].points[i].at[k];
        ranges[k] = (struct range){fmin(ranges[k].min, value), fmax(ranges[k].max, value)};
      }
    }
  }
  for (int k = 0; k < 3 && count == 0; k++) {
    ranges[k] = (struct range){0, 1};
  }
  return count;
}

static double share(double part, double other) {
  double sum = part + other;
  return sum > 0 ? fmin(fmax(part / sum, 0.28), 0.72) : 0.5;
}

/* Divides the sheet and widens the ranges so that all views have one scale. */
static void lay_out(const struct views *views, struct canvas *canvas, struct box sheet,
                    struct range ranges[3], struct frame frames[3]) {
  double u = canvas->unit, pad = 1.1;
  struct range grown[3];
  double left = 84 * u, gap_x = 34 * u, gap_y = 30 * u, right = 22 * u, bottom = 60 * u;
  if (views->bar.label) {
    right = chart_bar_room(canvas, &views->bar) + 8 * u;
  }
  double width = sheet.width - left - gap_x - right, height = sheet.height - gap_y - bottom;
  double d[3];
  for (int k = 0; k < 3; k++) {
    d[k] = fmax((ranges[k].max - ranges[k].min) * pad, 1e-6);
  }
  double wide = width * share(d[0], d[1]), high = height * share(d[2], d[1]);
  /* mm a pixel, set by the tightest direction; a single point gets some space around it */
  double scale =
      fmax(fmax(d[0] / wide, d[1] / (width - wide)), fmax(d[2] / high, d[1] / (height - high)));
  scale = fmax(scale, 1.0 / wide);
  const double lengths[4] = {wide, width - wide, high, height - high};
  const struct box areas[3] = {
      {sheet.x + left, sheet.y, lengths[0], lengths[2]},
      {sheet.x + left + wide + gap_x, sheet.y, lengths[1], lengths[2]},
      {sheet.x + left, sheet.y + high + gap_y, lengths[0], lengths[3]},
  };
  for (int v = 0; v < 3; v++) {
    const int axis[2] = {all[v].across, all[v].up};
    const double length[2] = {areas[v].width, areas[v].height};
    for (int k = 0; k < 2; k++) {
      double middle = (ranges[axis[k]].min + ranges[axis[k]].max) / 2;
      grown[k] = (struct range){middle - scale * length[k] / 2, middle + scale * length[k] / 2};
    }
    frames[v] = (struct frame){areas[v], grown[0].min, grown[0].max, grown[1].min, grown[1].max};
  }
  /* from below, y points down when x points to the right */
  frames[2].y_min = grown[1].max;
  frames[2].y_max = grown[1].min;
}

static struct point project(const struct frame *frame, const struct view *view,
                            const struct views_point *p) {
  return frame_pixel(frame, (struct point){p->at[view->across], p->at[view->up]});
}

static void draw_lines(struct canvas *canvas, const struct frame *frame, const struct view *view,
                       const struct views_path *path) {
  for (size_t i = 1; i < path->count; i++) {
    struct point a = project(frame, view, &path->points[i - 1]);
    struct point b = project(frame, view, &path->points[i]);
    cairo_move_to(canvas->cr, a.x, a.y);
    cairo_line_to(canvas->cr, b.x, b.y);
    canvas_set_colour(canvas, path->light ? colour_faint : path->points[i].colour);
    cairo_set_line_width(canvas->cr, path->width * canvas->unit);
    cairo_set_line_cap(canvas->cr, CAIRO_LINE_CAP_ROUND);
    cairo_stroke(canvas->cr);
  }
}

static void draw_dots(struct canvas *canvas, const struct frame *frame, const struct view *view,
                      const struct views_path *path) {
  double r = 2.6 * canvas->unit;
  for (size_t i = 0; path->dots && i < path->count; i++) {
    struct point p = project(frame, view, &path->points[i]);
    cairo_new_path(canvas->cr);
    cairo_arc(canvas->cr, p.x, p.y, r, 0, 2 * G_PI);
    canvas_set_colour(canvas, colour_paper);
    cairo_set_line_width(canvas->cr, 0.8 * canvas->unit);
    cairo_stroke_preserve(canvas->cr);
    canvas_set_colour(canvas, path->points[i].colour);
    cairo_fill(canvas->cr);
  }
}

static void draw_view(const struct views *views, struct canvas *canvas, const struct frame *frame,
                      const struct view *view, bool empty) {
  struct text_style style = chart_style_tick();
  axes_draw(canvas, &view->axes, frame, empty);
  for (size_t p = 0; p < views->path_count; p++) {
    draw_lines(canvas, frame, view, &views->paths[p]);
  }
  for (size_t p = 0; p < views->path_count; p++) {
    draw_dots(canvas, frame, view, &views->paths[p]);
  }
  canvas_text(canvas, frame->area.x + frame->area.width, frame->area.y - 3 * canvas->unit, 1, 1,
              view->name, &style);
}

void views_draw(const struct views *views, struct canvas *canvas) {
  struct range ranges[3];
  struct frame frames[3];
  double u = canvas->unit, top = chart_heading_height(canvas, views->subtitle, views->notice);
  struct box sheet = {0, top + 10 * u, canvas->width, canvas->height - top - 10 * u};
  size_t count = find_ranges(views, ranges);
  lay_out(views, canvas, sheet, ranges, frames);
  chart_heading(canvas, frames[0].area.x, views->title, views->subtitle, views->notice);
  for (int v = 0; v < 3; v++) {
    draw_view(views, canvas, &frames[v], &all[v], count == 0);
  }
  if (views->bar.label && count > 0) {
    chart_bar(canvas, &views->bar,
              (struct box){sheet.x, sheet.y, sheet.width - 8 * u, sheet.height - 60 * u});
  }
  if (views->key && count > 0) {
    double under = axes_bottom_room(canvas, &all[1].axes, frames[1].area.width);
    struct box quarter = {frames[1].area.x, frames[1].area.y + frames[1].area.height + under,
                          frames[1].area.width, 0};
    quarter.height = canvas->height - 8 * u - quarter.y;
    views->key(canvas, quarter, views->key_context);
  }
  if (count == 0) {
    struct text_style style = chart_style_label();
    style.colour = colour_muted;
    canvas_text(canvas, canvas->width / 2.0, canvas->height * 0.93, 0.5, 0.5, views->empty, &style);
  }
}
