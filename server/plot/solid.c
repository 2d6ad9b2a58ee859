#include "server/plot/solid.h"

#include <math.h>
#include <stdlib.h>

/* Edges between faces that meet at more than about 35 degrees are drawn. */
static const double CREASE_COSINE = 0.82;

static double dot(struct skin_point a, struct skin_point b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct skin_point cross(struct skin_point a, struct skin_point b) {
  return (struct skin_point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* ---- views ------------------------------------------------------------------------------- */

struct solid_view solid_view_oblique(void) {
  static const double SHEAR_X = 0.30, SHEAR_Z = 0.24;
  return (struct solid_view){.across = {1, SHEAR_X, 0},
                             .up = {0, SHEAR_Z, 1},
                             .away = {0, 1, 0},
                             .light = {-0.32, -0.66, 0.68}};
}

/* Zero stays zero. */
static struct skin_point unit(struct skin_point p) {
  double length = sqrt(dot(p, p)), factor = length > 0 ? 1 / length : 0;
  return (struct skin_point){factor * p.x, factor * p.y, factor * p.z};
}

struct solid_view solid_view_from(struct skin_point viewer) {
  /* the lamp as the viewer sees it: to the left, above or below like the viewer, behind */
  const double left = 0.35, high = viewer.z < 0 ? -0.62 : 0.62, behind = 0.70;
  struct skin_point out = unit(viewer);
  struct skin_point across = unit((struct skin_point){-out.y, out.x, 0}), up = cross(out, across);
  struct skin_point lamp = {behind * out.x - left * across.x + high * up.x,
                            behind * out.y - left * across.y + high * up.y,
                            behind * out.z - left * across.z + high * up.z};
  return (struct solid_view){
      .across = across, .up = up, .away = {-out.x, -out.y, -out.z}, .light = unit(lamp)};
}

struct solid_box solid_box_empty(void) {
  return (struct solid_box){INFINITY, -INFINITY, INFINITY, -INFINITY};
}

void solid_box_widen(struct solid_box *box, const struct solid_view *view,
                     const struct solid *solid) {
  for (size_t i = 0; i < solid->point_count; i++) {
    double u = dot(view->across, solid->points[i]), v = dot(view->up, solid->points[i]);
    box->left = fmin(box->left, u);
    box->right = fmax(box->right, u);
    box->bottom = fmin(box->bottom, v);
    box->top = fmax(box->top, v);
  }
}

double solid_box_scale(const struct solid_box *box, const struct raster *raster) {
  double du = fmax(box->right - box->left, 1e-6), dv = fmax(box->top - box->bottom, 1e-6);
  return 0.96 * fmin(raster->width / du, raster->height / dv);
}

void solid_view_centre(struct solid_view *view, const struct solid_box *box, double scale,
                       const struct raster *raster) {
  view->scale = scale;
  view->left = raster->width / 2.0 - scale * (box->left + box->right) / 2;
  view->bottom = raster->height / 2.0 + scale * (box->bottom + box->top) / 2;
}

static struct raster_vertex project(const struct solid_view *view, struct skin_point p,
                                    double value) {
  return (struct raster_vertex){view->left + view->scale * dot(view->across, p),
                                view->bottom - view->scale * dot(view->up, p), dot(view->away, p),
                                value};
}

/* Positive when the normal points to the viewer. */
static double towards_viewer(const struct solid_view *view, struct skin_point n) {
  return dot(cross(view->across, view->up), n);
}

/* ---- faces ------------------------------------------------------------------------------- */

/* Half the cross product of the diagonals: the normal, its length the area. */
static struct skin_point quad_area(const struct solid *solid, size_t quad) {
  const size_t *q = solid->quads[quad];
  struct skin_point a = solid->points[q[0]], b = solid->points[q[1]];
  struct skin_point c = solid->points[q[2]], d = solid->points[q[3]];
  struct skin_point e = {c.x - a.x, c.y - a.y, c.z - a.z}, f = {d.x - b.x, d.y - b.y, d.z - b.z};
  struct skin_point n = cross(e, f);
  return (struct skin_point){n.x / 2, n.y / 2, n.z / 2};
}

/* Unit normal of a quad; zero for a degenerate one. */
static struct skin_point quad_normal(const struct solid *solid, size_t quad) {
  return unit(quad_area(solid, quad));
}

double solid_seen(const struct solid *solid, const double *values, const struct solid_view *view) {
  double sum = 0;
  for (size_t i = 0; i < solid->quad_count; i++) {
    const size_t *q = solid->quads[i];
    double value = (values[q[0]] + values[q[1]] + values[q[2]] + values[q[3]]) / 4;
    sum += value * fmax(-dot(view->away, quad_area(solid, i)), 0);
  }
  return sum;
}

void solid_fill(const struct solid *solid, const double *values,
                const struct rgb shades[RASTER_SHADES], double ambient,
                const struct solid_view *view, struct raster *raster) {
  for (size_t i = 0; i < solid->quad_count; i++) {
    const size_t *q = solid->quads[i];
    struct skin_point n = quad_normal(solid, i);
    double side = towards_viewer(view, n) < 0 ? -1 : 1;
    if (solid->closed && side < 0) {
      continue;
    }
    double light = ambient + (1 - ambient) * fmax(side * dot(view->light, n), 0.0);
    struct raster_vertex corner[4];
    for (size_t k = 0; k < 4; k++) {
      corner[k] = project(view, solid->points[q[k]], values ? values[q[k]] : 0.0);
    }
    raster_triangle(raster, corner, shades, light);
    if (q[2] != q[3]) {
      struct raster_vertex second[3] = {corner[0], corner[2], corner[3]};
      raster_triangle(raster, second, shades, light);
    }
  }
}

/* ---- edges ------------------------------------------------------------------------------- */

static int compare_edges(const void *left, const void *right) {
  const struct solid_edge *a = left, *b = right;
  if (a->low != b->low) {
    return a->low < b->low ? -1 : 1;
  }
  return a->high < b->high ? -1 : a->high > b->high;
}

struct solid_edge *solid_edges(const struct solid *solid) {
  struct solid_edge *edges = malloc((4 * solid->quad_count + 1) * sizeof *edges);
  if (!edges) {
    return NULL;
  }
  for (size_t i = 0; i < 4 * solid->quad_count; i++) {
    size_t from = solid->quads[i / 4][i % 4], to = solid->quads[i / 4][(i + 1) % 4];
    edges[i] = (struct solid_edge){from < to ? from : to, from < to ? to : from, i / 4, from < to};
  }
  qsort(edges, 4 * solid->quad_count, sizeof *edges, compare_edges);
  return edges;
}

/* Whether the edge between two quads is a crease, or the outline as seen from here. */
static bool is_drawn(const struct solid *solid, const struct solid_view *view,
                     const struct solid_edge *a, const struct solid_edge *b) {
  struct skin_point n = quad_normal(solid, a->quad), m = quad_normal(solid, b->quad);
  /* neighbours of one orientation run along their edge in opposite directions */
  double turn = a->forward == b->forward ? -1 : 1;
  return turn * dot(n, m) < CREASE_COSINE ||
         towards_viewer(view, n) * turn * towards_viewer(view, m) < 0;
}

void solid_outline(const struct solid *solid, const struct solid_edge *edges, struct rgb colour,
                   double width, const struct solid_view *view, struct raster *raster) {
  size_t count = 4 * solid->quad_count;
  double bias = 1.5 * width / view->scale;
  for (size_t i = 0; i < count;) {
    size_t next = i + 1;
    while (next < count && compare_edges(&edges[i], &edges[next]) == 0) {
      next++;
    }
    bool proper = edges[i].low != edges[i].high; /* the last one of a triangle has no length */
    if (proper && (next - i != 2 || is_drawn(solid, view, &edges[i], &edges[i + 1]))) {
      struct raster_vertex ends[2] = {project(view, solid->points[edges[i].low], 0),
                                      project(view, solid->points[edges[i].high], 0)};
      raster_line(raster, ends, colour, width, bias);
    }
    i = next;
  }
}
