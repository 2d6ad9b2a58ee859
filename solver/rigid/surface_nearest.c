/* The nearest point of a surface of patches, and distance, normal and curvature there. */
#include <math.h>
#include <string.h>

#include "solver/base/box_tree.h"
#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

#define INSIDE 1e-9   /* slack of barycentric coordinates */
#define SETTLED 1e-12 /* last step of an iteration, in barycentric coordinates */
#define CLOSEST 1e-9  /* of the surface's size: nearer than that the direction says nothing */

enum { NEWTON_STEPS = 12 };

/* Where the nearest point lies on its patch. */
enum part { PART_FACE, PART_EDGE, PART_CORNER };

/* The nearest point so far. number: of the edge or corner of its triangle. */
struct foot {
  double square; /* of the distance, m2 */
  int triangle, number;
  enum part part;
  double v, w;
};

/* ---- one patch -------------------------------------------------------------------------- */

static const double corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};

/* Parameters of the point s of edge e. */
static void on_edge(int e, double s, double *v, double *w) {
  const double *a = corners[e], *b = corners[(e + 1) % 3];
  *v = a[0] + s * (b[0] - a[0]);
  *w = a[1] + s * (b[1] - a[1]);
}

static void offer(struct foot *best, int triangle, enum part part, int number, double v, double w,
                  double square) {
  if (square < best->square) {
    *best = (struct foot){square, triangle, number, part, v, w};
  }
}

static double square_from(const struct patch *patch, double v, double w, const double x[3]) {
  double point[3], square = 0;
  patch_point(patch, v, w, point, NULL);
  for (int i = 0; i < 3; i++) {
    square += (point[i] - x[i]) * (point[i] - x[i]);
  }
  return square;
}

/* The nearest point of edge e: Newton's iteration for the foot on a parabola from s, kept within
 * the edge; its ends are candidates, too. */
static void try_edge(const struct patch *patch, int triangle, int e, const double x[3], double s,
                     struct foot *best) {
  const double *a = patch->x[e], *b = patch->x[(e + 1) % 3], *bend = patch->bend + 3 * e;
  double step = 1, v, w;
  for (int k = 0; k < NEWTON_STEPS && fabs(step) > SETTLED; k++) {
    double slope = 0, curvature = 0;
    for (int i = 0; i < 3; i++) {
      double off = (1 - s) * a[i] + s * b[i] - s * (1 - s) * bend[i] - x[i];
      double along = b[i] - a[i] - (1 - 2 * s) * bend[i];
      slope += off * along;
      curvature += along * along + 2 * off * bend[i];
    }
    double to = curvature > 0 ? fmin(fmax(s - slope / curvature, 0), 1) : slope > 0 ? 0 : 1;
    step = to - s;
    s = to;
  }
  on_edge(e, s, &v, &w);
  offer(best, triangle, PART_EDGE, e, v, w, square_from(patch, v, w, x));
  for (int k = 0; k < 2; k++) {
    int corner = (e + k) % 3;
    const double *c = corners[corner];
    double square = square_from(patch, c[0], c[1], x);
    /* An iteration that ended in a corner has found no other point there. */
    if (s == k && square <= best->square && best->triangle == triangle && best->part == PART_EDGE &&
        best->number == e) {
      *best = (struct foot){square, triangle, corner, PART_CORNER, c[0], c[1]};
    } else {
      offer(best, triangle, PART_CORNER, corner, c[0], c[1], square);
    }
  }
}

/* One step of Newton's iteration for the foot on a curved patch; false where the distance has no
 * minimum in the model of second order. */
static bool newton_step(const struct patch *patch, double second[3][3], const double x[3],
                        double *v, double *w, double *step) {
  double off[3], slope[2][3];
  patch_point(patch, *v, *w, off, slope);
  for (int i = 0; i < 3; i++) {
    off[i] -= x[i];
  }
  double g0 = vec3_dot(off, slope[0]), g1 = vec3_dot(off, slope[1]);
  double h00 = vec3_dot(slope[0], slope[0]) + vec3_dot(off, second[0]),
         h01 = vec3_dot(slope[0], slope[1]) + vec3_dot(off, second[1]),
         h11 = vec3_dot(slope[1], slope[1]) + vec3_dot(off, second[2]);
  double determinant = h00 * h11 - h01 * h01;
  if (!(h00 > 0 && determinant > 1e-12 * h00 * h11)) {
    return false;
  }
  double dv = (h01 * g1 - h11 * g0) / determinant, dw = (h01 * g0 - h00 * g1) / determinant;
  *step = fmax(fabs(dv), fabs(dw));
  double scale = *step > 0.5 ? 0.5 / *step : 1;
  *v += scale * dv;
  *w += scale * dw;
  return true;
}

/* The foot within the patch, from the flat triangle's (v, w) on. Edges towards which the iteration
 * leaves the patch are looked at instead. */
static void try_face(const struct patch *patch, int triangle, const double x[3], double v, double w,
                     struct foot *best) {
  double second[3][3], step = 1;
  bool found = true;
  patch_curvature(patch, second);
  for (int k = 0; k < NEWTON_STEPS && step > SETTLED && found; k++) {
    found =
        newton_step(patch, second, x, &v, &w, &step) && fabs(v - 0.5) < 1.5 && fabs(w - 0.5) < 1.5;
  }
  found = found && step < 1e-6;
  double u = 1 - v - w;
  if (found && v >= -INSIDE && w >= -INSIDE && u >= -INSIDE) {
    offer(best, triangle, PART_FACE, 0, v, w, square_from(patch, v, w, x));
    return;
  }
  double beyond[3] = {w, u, v}; /* of the edges: negative where the iteration has passed them */
  for (int e = 0; e < 3; e++) {
    if (!found || beyond[e] < INSIDE) {
      try_edge(patch, triangle, e, x, 0.5, best);
    }
  }
}

/* ---- one flat triangle ------------------------------------------------------------------ */

/* The nearest point of the flat triangle: parameters, and the square of the distance. */
static double flat_foot(const struct surface_flat *flat, const double x[3], double *v, double *w) {
  double off[3] = {x[0] - flat->x[0], x[1] - flat->x[1], x[2] - flat->x[2]}, square = 0;
  double aa = flat->aa, ab = flat->ab, bb = flat->bb, xa = vec3_dot(off, flat->a),
         xb = vec3_dot(off, flat->b);
  *v = (bb * xa - ab * xb) * flat->inverse;
  *w = (aa * xb - ab * xa) * flat->inverse;
  if (*v < 0 || *w < 0 || *v + *w > 1) {
    /* The nearest of the three edges. */
    double s[3] = {xa / aa, (xb - xa + aa - ab) / (aa - 2 * ab + bb), 1 - xb / bb};
    double least = INFINITY, best_v = 0, best_w = 0;
    for (int e = 0; e < 3; e++) {
      double p, q;
      on_edge(e, fmin(fmax(s[e], 0), 1), &p, &q);
      double more = p * (p * aa - 2 * xa) + q * (q * bb - 2 * xb) + 2 * p * q * ab;
      if (more < least) {
        least = more;
        best_v = p;
        best_w = q;
      }
    }
    *v = best_v;
    *w = best_w;
  }
  for (int i = 0; i < 3; i++) {
    double gap = off[i] - *v * flat->a[i] - *w * flat->b[i];
    square += gap * gap;
  }
  return square;
}

/* On a flat patch the parameters tell the part. */
static void offer_flat(struct foot *best, int triangle, double v, double w, double square) {
  double coordinate[3] = {1 - v - w, v, w};
  int zeros = 0, last = 0;
  for (int k = 0; k < 3; k++) {
    zeros += coordinate[k] < INSIDE;
    last = coordinate[k] < INSIDE ? last : k;
  }
  int zero = coordinate[0] < INSIDE ? 0 : coordinate[1] < INSIDE ? 1 : 2;
  enum part part = zeros == 0 ? PART_FACE : zeros == 1 ? PART_EDGE : PART_CORNER;
  /* The edge across from corner k begins at the next one. */
  offer(best, triangle, part, zeros == 1 ? (zero + 1) % 3 : last, v, w, square);
}

static void try_patch(const struct surface *surface, const struct surface_flat *flat,
                      const double x[3], struct foot *best) {
  double v, w, square = flat_foot(flat, x, &v, &w);
  if (flat->bulge == 0) {
    offer_flat(best, flat->triangle, v, w, square);
    return;
  }
  double least = fmax(sqrt(square) - flat->bulge, 0);
  if (least * least < best->square) {
    struct patch patch = surface_patch(surface, flat->triangle);
    try_face(&patch, flat->triangle, x, v, w, best);
  }
}

/* ---- the tree --------------------------------------------------------------------------- */

static bool find_foot(const struct surface *surface, const double x[3], double limit,
                      struct foot *best) {
  struct {
    const struct box_branch *branch;
    double square;
  } stack[BOX_TREE_DEPTH];
  const struct box_branch *all = box_tree_branches(surface->tree);
  int waiting = 0;
  *best = (struct foot){.square = limit, .triangle = -1};
  stack[waiting].branch = all;
  stack[waiting++].square = box_distance_square(&all->box, x);
  while (waiting > 0) {
    waiting--;
    const struct box_branch *branch = stack[waiting].branch;
    if (stack[waiting].square > best->square) {
      continue;
    }
    if (branch->child > 0) {
      const struct box_branch *near = &all[branch->child], *far = near + 1;
      double a = box_distance_square(&near->box, x), b = box_distance_square(&far->box, x);
      stack[waiting].branch = a <= b ? far : near;
      stack[waiting++].square = fmax(a, b);
      stack[waiting].branch = a <= b ? near : far;
      stack[waiting++].square = fmin(a, b);
      continue;
    }
    for (int n = 0; n < branch->count; n++) {
      try_patch(surface, &surface->flat[branch->first + n], x, best);
    }
  }
  return best->triangle >= 0;
}

/* ---- what is there ---------------------------------------------------------------------- */

/* Adds the curvature of the distance in a patch at signed distance d over (v, w):
 * - J I^-1 b (I - d b)^-1 J^T with the first and second fundamental forms I and b. */
static void add_curvature(const struct patch *patch, double v, double w, const double normal[3],
                          double d, double share, double sum[3][3]) {
  double point[3], slope[2][3], second[3][3], lifted[2][3];
  patch_point(patch, v, w, point, slope);
  patch_curvature(patch, second);
  double i00 = vec3_dot(slope[0], slope[0]), i01 = vec3_dot(slope[0], slope[1]),
         i11 = vec3_dot(slope[1], slope[1]);
  double b00 = vec3_dot(second[0], normal), b01 = vec3_dot(second[1], normal),
         b11 = vec3_dot(second[2], normal);
  double m00 = i00 - d * b00, m01 = i01 - d * b01, m11 = i11 - d * b11;
  double first = i00 * i11 - i01 * i01, determinant = m00 * m11 - m01 * m01;
  if (!(determinant > 1e-6 * first && m00 > 0)) {
    return; /* deeper inside than the radius of curvature */
  }
  /* Rows of I^-1 J^T, and S = b M^-1 I, so that the sum is -lifted^T S lifted. */
  for (int i = 0; i < 3; i++) {
    lifted[0][i] = (i11 * slope[0][i] - i01 * slope[1][i]) / first;
    lifted[1][i] = (i00 * slope[1][i] - i01 * slope[0][i]) / first;
  }
  double n00 = (m11 * i00 - m01 * i01) / determinant, n01 = (m11 * i01 - m01 * i11) / determinant,
         n10 = (m00 * i01 - m01 * i00) / determinant, n11 = (m00 * i11 - m01 * i01) / determinant;
  double s00 = b00 * n00 + b01 * n10, s01 = b00 * n01 + b01 * n11, s10 = b01 * n00 + b11 * n10,
         s11 = b01 * n01 + b11 * n11;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      sum[i][j] -= share * (lifted[0][i] * (s00 * lifted[0][j] + 0.5 * (s01 + s10) * lifted[1][j]) +
                            lifted[1][i] * (0.5 * (s01 + s10) * lifted[0][j] + s11 * lifted[1][j]));
    }
  }
}

/* The same edge, or corner, in the triangle on the other side. */
static void across(const struct surface *surface, const struct foot *foot, struct foot *other) {
  int twin = surface->beside[3 * foot->triangle + foot->number], e = foot->number;
  const double *a = corners[e], *b = corners[(e + 1) % 3];
  double s = (foot->v - a[0]) * (b[0] - a[0]) + (foot->w - a[1]) * (b[1] - a[1]);
  s /= (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
  *other = *foot;
  other->triangle = twin / 3;
  other->number = twin % 3;
  on_edge(other->number, 1 - s, &other->v, &other->w);
}

/* A direction out of the body at the foot: the normal of its patch, the mean of both at an edge,
 * the angle-weighted mean at a corner. */
static void outward_at(const struct surface *surface, const struct foot *foot, double out[3]) {
  struct patch patch = surface_patch(surface, foot->triangle);
  if (foot->part == PART_CORNER) {
    memcpy(out, surface->pseudo + 3 * surface->triangle[3 * foot->triangle + foot->number],
           sizeof(double[3]));
    return;
  }
  patch_normal(&patch, foot->v, foot->w, out);
  if (foot->part == PART_EDGE) {
    struct foot other;
    double normal[3], length;
    across(surface, foot, &other);
    patch = surface_patch(surface, other.triangle);
    patch_normal(&patch, other.v, other.w, normal);
    for (int i = 0; i < 3; i++) {
      out[i] += normal[i];
    }
    length = fmax(vec3_norm(out), 1e-300);
    for (int i = 0; i < 3; i++) {
      out[i] /= length;
    }
  }
}

/* Whether the surface goes on smoothly at an edge or corner. */
static bool is_smooth(const struct surface *surface, const struct foot *foot) {
  int half = 3 * foot->triangle + foot->number, at = half;
  if (foot->part == PART_EDGE) {
    return !surface->sharp[half];
  }
  do {
    if (surface->sharp[at]) {
      return false;
    }
    at = surface_next_corner(surface, at);
  } while (at != half);
  return true;
}

/* Curvature off a crease: the distance is that from a curve, or a point. */
static void crease_curvature(const struct surface *surface, const struct foot *foot,
                             struct rigid_nearest *nearest) {
  struct patch patch = surface_patch(surface, foot->triangle);
  const double *n = nearest->normal, *bend = patch.bend + 3 * foot->number;
  double along[3] = {0}, stiff = 1, size = 0;
  for (int i = 0; i < 3; i++) {
    size += surface->high[i] - surface->low[i];
  }
  double d = copysign(fmax(fabs(nearest->distance), 1e-6 * size), nearest->distance);
  if (foot->part == PART_EDGE) {
    int e = foot->number;
    double s = e == 0 ? foot->v : e == 1 ? foot->w : 1 - foot->v - foot->w;
    for (int i = 0; i < 3; i++) {
      along[i] = patch.x[(e + 1) % 3][i] - patch.x[e][i] - (1 - 2 * s) * bend[i];
    }
    stiff = vec3_dot(along, along) - 2 * d * vec3_dot(n, bend);
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      double kept = stiff > 0 ? along[i] * along[j] / stiff : 0;
      nearest->curvature[i][j] = ((i == j) - n[i] * n[j] - kept) / d;
    }
  }
}

/* Takes out of a tensor what it does along the normal, which at edges is not quite that of the
 * patches. */
static void project(const double n[3], double tensor[3][3]) {
  double image[3], along = 0;
  for (int i = 0; i < 3; i++) {
    image[i] = vec3_dot(tensor[i], n);
    along += image[i] * n[i];
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      tensor[i][j] += along * n[i] * n[j] - image[i] * n[j] - n[i] * image[j];
    }
  }
}

static void fill_curvature(const struct surface *surface, const struct foot *foot,
                           struct rigid_nearest *nearest) {
  struct patch patch = surface_patch(surface, foot->triangle);
  bool edge = foot->part == PART_EDGE;
  memset(nearest->curvature, 0, sizeof nearest->curvature);
  if (foot->part != PART_FACE && !is_smooth(surface, foot)) {
    crease_curvature(surface, foot, nearest);
    return;
  }
  add_curvature(&patch, foot->v, foot->w, nearest->normal, nearest->distance, edge ? 0.5 : 1,
                nearest->curvature);
  if (edge) {
    struct foot other;
    across(surface, foot, &other);
    patch = surface_patch(surface, other.triangle);
    add_curvature(&patch, other.v, other.w, nearest->normal, nearest->distance, 0.5,
                  nearest->curvature);
  }
  project(nearest->normal, nearest->curvature);
}

bool surface_nearest(const struct surface *surface, const double x[3], double reach,
                     struct rigid_nearest *nearest) {
  struct foot foot;
  struct patch patch;
  double out[3], point[3], off[3];
  double from_box = box_distance_square(&box_tree_branches(surface->tree)->box, x);
  /* Outside of the box the body is not nearer; within it the sign is not known yet. */
  if (from_box > 0 && !(reach >= 0 && from_box <= reach * reach)) {
    return false;
  }
  double limit = from_box > 0 ? reach * reach * (1 + 1e-12) : INFINITY;
  if (!find_foot(surface, x, limit, &foot)) {
    return false;
  }
  patch = surface_patch(surface, foot.triangle);
  patch_point(&patch, foot.v, foot.w, point, NULL);
  outward_at(surface, &foot, out);
  double size = 0;
  for (int i = 0; i < 3; i++) {
    off[i] = x[i] - point[i];
    size += surface->high[i] - surface->low[i];
  }
  double side = vec3_dot(off, out) < 0 ? -1 : 1, distance = vec3_norm(off);
  if (!(side * distance <= reach)) {
    return false;
  }
  nearest->distance = side * distance;
  /* The foot's own normal is that of the gradient, and does not lose digits near the surface. */
  bool direct = foot.part != PART_FACE && distance > CLOSEST * size;
  for (int i = 0; i < 3; i++) {
    nearest->normal[i] = direct ? side * off[i] / distance : out[i];
  }
  fill_curvature(surface, &foot, nearest);
  return true;
}
