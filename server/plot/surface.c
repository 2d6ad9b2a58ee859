#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/raster.h"
#include "server/plot/skin.h"

/* The view is an oblique parallel projection from the front (-y), right and above:
 *   u = x + SHEAR_X y,  v = z + SHEAR_Z y,  depth = y.
 * It shows the tops of the chambers, yet lengths and angles in the bending plane are true. */
static const double SHEAR_X = 0.30, SHEAR_Z = 0.24;

/* Edges between faces that meet at more than about 35 degrees are drawn. */
static const double CREASE_COSINE = 0.82;

struct view {
  double scale;        /* samples per mm */
  double left, bottom; /* samples: where u = 0 and v = 0 are */
};

struct edge {
  size_t low, high; /* its points, low < high */
  size_t quad;
  int forward; /* the quad runs from low to high */
};

static struct raster_vertex project(const struct view *view, struct skin_point p, double value) {
  return (struct raster_vertex){view->left + view->scale * (p.x + SHEAR_X * p.y),
                                view->bottom - view->scale * (p.z + SHEAR_Z * p.y), p.y, value};
}

/* Unit normal of a quad from its diagonals; zero for a degenerate one. */
static struct skin_point quad_normal(const struct skin *skin, const struct skin_point *points,
                                     size_t quad) {
  const size_t *q = skin->quads[quad];
  struct skin_point a = points[q[0]], b = points[q[1]], c = points[q[2]], d = points[q[3]];
  struct skin_point e = {c.x - a.x, c.y - a.y, c.z - a.z}, f = {d.x - b.x, d.y - b.y, d.z - b.z};
  struct skin_point n = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
  double length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  if (length > 0) {
    n.x /= length;
    n.y /= length;
    n.z /= length;
  }
  return n;
}

/* Positive when the normal points to the viewer. */
static double towards_viewer(struct skin_point n) {
  return SHEAR_X * n.x - n.y + SHEAR_Z * n.z;
}

static void fill(const struct skin *skin, const struct skin_point *points, const double *values,
                 const struct rgb *shades, double ambient, const struct view *view,
                 struct raster *raster) {
  for (size_t i = 0; i < skin->quad_count; i++) {
    const size_t *q = skin->quads[i];
    struct skin_point n = quad_normal(skin, points, i);
    double side = towards_viewer(n) < 0 ? -1 : 1;
    /* light from the upper left behind the viewer */
    double lit = side * (-0.32 * n.x - 0.66 * n.y + 0.68 * n.z);
    double light = ambient + (1 - ambient) * fmax(lit, 0.0);
    struct raster_vertex corner[4];
    for (size_t k = 0; k < 4; k++) {
      corner[k] = project(view, points[q[k]], values ? values[q[k]] : 0.0);
    }
    raster_triangle(raster, corner, shades, light);
    struct raster_vertex second[3] = {corner[0], corner[2], corner[3]};
    raster_triangle(raster, second, shades, light);
  }
}

static int compare_edges(const void *left, const void *right) {
  const struct edge *a = left, *b = right;
  if (a->low != b->low) {
    return a->low < b->low ? -1 : 1;
  }
  return a->high < b->high ? -1 : a->high > b->high;
}

/* All edges of all quads, those of one place next to each other. NULL when memory ran out. */
static struct edge *sort_edges(const struct skin *skin) {
  struct edge *edges = malloc(4 * skin->quad_count * sizeof *edges);
  if (!edges) {
    return NULL;
  }
  for (size_t i = 0; i < 4 * skin->quad_count; i++) {
    size_t from = skin->quads[i / 4][i % 4], to = skin->quads[i / 4][(i + 1) % 4];
    edges[i] = (struct edge){from < to ? from : to, from < to ? to : from, i / 4, from < to};
  }
  qsort(edges, 4 * skin->quad_count, sizeof *edges, compare_edges);
  return edges;
}

/* Whether the edge between two quads is a crease, or the outline as seen from here. */
static bool is_drawn(const struct skin *skin, const struct skin_point *points, const struct edge *a,
                     const struct edge *b) {
  struct skin_point n = quad_normal(skin, points, a->quad), m = quad_normal(skin, points, b->quad);
  /* neighbours of one orientation run along their edge in opposite directions */
  double turn = a->forward == b->forward ? -1 : 1;
  double cosine = turn * (n.x * m.x + n.y * m.y + n.z * m.z);
  return cosine < CREASE_COSINE || towards_viewer(n) * turn * towards_viewer(m) < 0;
}

static void outline(const struct skin *skin, const struct skin_point *points,
                    const struct edge *edges, struct rgb colour, double width,
                    const struct view *view, struct raster *raster) {
  size_t count = 4 * skin->quad_count;
  double bias = 1.5 * width / view->scale;
  for (size_t i = 0; i < count;) {
    size_t next = i + 1;
    while (next < count && compare_edges(&edges[i], &edges[next]) == 0) {
      next++;
    }
    if (next - i != 2 || is_drawn(skin, points, &edges[i], &edges[i + 1])) {
      struct raster_vertex ends[2] = {project(view, points[edges[i].low], 0),
                                      project(view, points[edges[i].high], 0)};
      raster_line(raster, ends, colour, width, bias);
    }
    i = next;
  }
}

static void widen(double box[4], const struct skin *skin, const struct skin_point *points) {
  for (size_t i = 0; i < skin->point_count; i++) {
    double u = points[i].x + SHEAR_X * points[i].y, v = points[i].z + SHEAR_Z * points[i].y;
    box[0] = fmin(box[0], u);
    box[1] = fmax(box[1], u);
    box[2] = fmin(box[2], v);
    box[3] = fmax(box[3], v);
  }
}

/* Fits both states into the raster. */
static struct view fit_view(const struct skin *skin, const struct raster *raster) {
  double box[4] = {INFINITY, -INFINITY, INFINITY, -INFINITY};
  widen(box, skin, skin->rest);
  widen(box, skin, skin->bent);
  double du = fmax(box[1] - box[0], 1e-6), dv = fmax(box[3] - box[2], 1e-6);
  double scale = 0.96 * fmin(raster->width / du, raster->height / dv);
  return (struct view){scale, raster->width / 2.0 - scale * (box[0] + box[1]) / 2,
                       raster->height / 2.0 + scale * (box[2] + box[3]) / 2};
}

/* Values between 0 and 1 for the shades; *bar gets the range. NULL: no memory, or no stretches. */
static double *scale_stretch(const struct skin *skin, struct colour_bar *bar) {
  double *values = skin->stretch ? malloc(skin->point_count * sizeof *values) : NULL;
  if (!values) {
    return NULL;
  }
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < skin->point_count; i++) {
    low = fmin(low, skin->stretch[i]);
    high = fmax(high, skin->stretch[i]);
  }
  high = fmax(high, low + 1e-3);
  for (size_t i = 0; i < skin->point_count; i++) {
    values[i] = (skin->stretch[i] - low) / (high - low);
  }
  *bar = (struct colour_bar){
      .label = "Largest principal stretch", .map = colour_map_area, .min = low, .max = high};
  return values;
}

/* Draws both states into the raster; `values` colours the deformed one. */
static void draw_states(const struct canvas *canvas, const struct skin *skin, const double *values,
                        const struct edge *edges, const struct view *view, struct raster *raster) {
  struct rgb shades[RASTER_SHADES];
  double line = fmax(canvas->unit * raster->factor, 1.0);
  for (int i = 0; i < RASTER_SHADES; i++) {
    shades[i] = colour_rgb(colour_shade, canvas->theme);
  }
  fill(skin, skin->rest, NULL, shades, 0.94, view, raster);
  outline(skin, skin->rest, edges, colour_rgb(colour_edge, canvas->theme), line, view, raster);
  raster_bring_forward(raster);
  for (int i = 0; i < RASTER_SHADES; i++) {
    struct colour shade =
        values ? colour_map_area((i + 0.5) / RASTER_SHADES) : (struct colour){.role = COLOUR_BODY};
    shades[i] = colour_rgb(shade, canvas->theme);
  }
  fill(skin, skin->bent, values, shades, 0.74, view, raster);
  struct rgb edge = colour_rgb((struct colour){.role = COLOUR_OUTLINE}, canvas->theme);
  outline(skin, skin->bent, edges, edge, line, view, raster);
}

/* The strip below the body: a bar of round length, and what the grey body is. */
static void draw_scale(struct canvas *canvas, double mm, double left, double y,
                       const struct skin *skin) {
  double u = canvas->unit;
  struct ticks ticks = ticks_make(0, 0.3 * canvas->width / mm, 2);
  double right = left + ticks.step * mm;
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  char number[TICKS_TEXT], text[TICKS_TEXT + 40];
  ticks_plain(ticks.step, 3, number);
  snprintf(text, sizeof text, "%s mm", number);
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, left, y, right, y, 2);
  canvas_line(canvas, left, y - 4 * u, left, y + 5 * u, 2);
  canvas_line(canvas, right, y - 4 * u, right, y + 5 * u, 2);
  canvas_text(canvas, right + 8 * u, y, 0, 0.5, text, &style);
  double width, height;
  canvas_measure(canvas, text, &style, &width, &height);
  double key = right + 8 * u + width + 28 * u;
  cairo_rectangle(canvas->cr, key, y - 5 * u, 18 * u, 10 * u);
  canvas_set_colour(canvas, colour_shade);
  cairo_fill_preserve(canvas->cr);
  canvas_set_colour(canvas, colour_edge);
  cairo_set_line_width(canvas->cr, u);
  cairo_stroke(canvas->cr);
  ticks_plain(skin->rest_kPa, 3, number);
  snprintf(text, sizeof text, isfinite(skin->rest_kPa) ? "at %s kPa" : "first state", number);
  canvas_text(canvas, key + 26 * u, y, 0, 0.5, text, &style);
}

static enum status draw_body(struct canvas *canvas, const struct skin *skin, struct box area,
                             struct colour_bar *bar, struct error *error) {
  enum status status = STATUS_OK;
  double *values = scale_stretch(skin, bar);
  struct edge *edges = sort_edges(skin);
  double bar_room = chart_bar_room(canvas, bar), strip = 34 * canvas->unit;
  struct raster *raster = raster_create((int)(area.width - bar_room), (int)(area.height - strip));
  if (!edges || !raster || (skin->stretch && !values)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while drawing a surface");
    goto done;
  }
  struct view view = fit_view(skin, raster);
  draw_states(canvas, skin, values, edges, &view, raster);
  if (!raster_paint(raster, canvas->cr, round(area.x), round(area.y))) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while drawing a surface");
    goto done;
  }
  draw_scale(canvas, view.scale / raster->factor, area.x, area.y + area.height - strip / 2, skin);
  if (bar->label) {
    chart_bar(canvas, bar, area);
  }
done:
  raster_destroy(raster);
  free(edges);
  free(values);
  return status;
}

enum status draw_surface(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  (void)count;
  struct skin skin = {0};
  struct colour_bar bar = {0};
  enum status status = skin_read(inputs[0].artifacts_dir, &skin, error);
  if (status != STATUS_OK) {
    goto done;
  }
  char title[TICKS_TEXT + 40], number[TICKS_TEXT];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  ticks_plain(skin.bent_kPa, 3, number);
  snprintf(title, sizeof title,
           isfinite(skin.bent_kPa) ? "Deformed body at %s kPa" : "Deformed body", number);
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  double u = canvas->unit, left = 24 * u;
  double top = chart_heading_height(canvas, subtitle, notice);
  chart_heading(canvas, left, title, subtitle, notice);
  status = draw_body(
      canvas, &skin,
      (struct box){left, top, canvas->width - left - 8 * u, canvas->height - top - 12 * u}, &bar,
      error);
done:
  skin_release(&skin);
  return status;
}
