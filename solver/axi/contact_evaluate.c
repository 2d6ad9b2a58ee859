/* Who touches whom, and the potential of it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/contact_internal.h"

/* ---- closest point ----------------------------------------------------------------------- */

static void edge_at(double y[AXI_EDGE_NODES][2], double xi, double at[2], double slope[2]) {
  double n[AXI_EDGE_NODES], d[AXI_EDGE_NODES];
  axi_edge_shape(xi, n, d);
  for (int i = 0; i < 2; i++) {
    at[i] = n[0] * y[0][i] + n[1] * y[1][i] + n[2] * y[2][i];
    slope[i] = d[0] * y[0][i] + d[1] * y[1][i] + d[2] * y[2][i];
  }
}

/* The best of five points of the edge. */
static double sample(double y[AXI_EDGE_NODES][2], const double point[2]) {
  double best = 0, least = INFINITY;
  for (int k = -2; k <= 2; k++) {
    double at[2], slope[2];
    edge_at(y, 0.5 * k, at, slope);
    double d = (point[0] - at[0]) * (point[0] - at[0]) + (point[1] - at[1]) * (point[1] - at[1]);
    if (d < least) {
      least = d;
      best = 0.5 * k;
    }
  }
  return best;
}

struct axi_closest axi_closest_point(double y[AXI_EDGE_NODES][2], const double point[2]) {
  struct axi_closest c = {.xi = sample(y, point)};
  double at[2], way[2];
  for (int i = 0; i < 2; i++) {
    c.bend[i] = y[0][i] + y[1][i] - 2 * y[2][i];
  }
  for (int k = 0;; k++) {
    edge_at(y, c.xi, at, c.tangent);
    way[0] = point[0] - at[0];
    way[1] = point[1] - at[1];
    if (k == 12) {
      break;
    }
    double square = c.tangent[0] * c.tangent[0] + c.tangent[1] * c.tangent[1];
    double curved = square - way[0] * c.bend[0] - way[1] * c.bend[1];
    double step =
        (way[0] * c.tangent[0] + way[1] * c.tangent[1]) / (curved > 0.2 * square ? curved : square);
    double next = fmax(-1, fmin(1, c.xi + step));
    if (fabs(next - c.xi) < 1e-14) {
      break;
    }
    c.xi = next;
  }
  double length = hypot(c.tangent[0], c.tangent[1]);
  double n[2] = {c.tangent[1] / length, -c.tangent[0] / length};
  c.distance = hypot(way[0], way[1]);
  c.gap = way[0] * n[0] + way[1] * n[1];
  /* Beyond an end the point of the end is closest, unless the way is that of the normal. */
  c.vertex = fabs(c.xi) == 1 && c.distance - fabs(c.gap) > 1e-9 * c.distance;
  c.aside = c.vertex && fabs(c.gap) < 0.5 * c.distance;
  if (c.vertex) {
    double sign = c.gap < 0 ? -1 : 1;
    c.gap = sign * c.distance;
    n[0] = sign * way[0] / c.distance;
    n[1] = sign * way[1] / c.distance;
  }
  memcpy(c.normal, n, sizeof n);
  return c;
}

/* ---- search ------------------------------------------------------------------------------ */

static int by_height(const void *a, const void *b) {
  double x = ((const struct axi_contact_box *)a)->low, y = ((const struct axi_contact_box *)b)->low;
  return (x > y) - (x < y);
}

static void place_edges(struct axi_contact *c, const double *u, double elongation) {
  for (int i = 0; i < 2 * c->mesh->node_count; i++) {
    c->position[i] = c->mesh->position[i] + u[i];
  }
  c->box_count = 0;
  int most = c->periodic ? 1 : 0;
  for (int k = 0; k < c->edge_count; k++) {
    for (int shift = -most; shift <= most; shift++) {
      struct axi_contact_box *b = &c->box[c->box_count++];
      for (int a = 0; a < AXI_EDGE_NODES; a++) {
        const double *x = &c->position[2 * c->edge[k].node[a]];
        b->y[a][0] = x[0];
        b->y[a][1] = x[1] + shift * (c->period + elongation);
      }
      double p = hypot(b->y[0][0] - b->y[2][0], b->y[0][1] - b->y[2][1]);
      double q = hypot(b->y[1][0] - b->y[2][0], b->y[1][1] - b->y[2][1]);
      b->radius = 1.1 * fmax(p, q);
      b->low = b->y[2][1] - b->radius;
      b->normal[0] = b->y[1][1] - b->y[0][1];
      b->normal[1] = b->y[0][0] - b->y[1][0];
      b->edge = k;
      b->shift = shift;
    }
  }
  qsort(c->box, (size_t)c->box_count, sizeof *c->box, by_height);
}

struct slave_point {
  int edge;
  double arc; /* place on the chain */
  double n[AXI_EDGE_NODES], x[2], normal[2];
};

static struct slave_point slave_at(const struct axi_contact *c, int edge, double xi) {
  struct slave_point p = {.edge = edge,
                          .arc = c->edge[edge].arc + 0.5 * (1 + xi) * c->edge[edge].length};
  double d[AXI_EDGE_NODES], t[2] = {0};
  axi_edge_shape(xi, p.n, d);
  for (int a = 0; a < AXI_EDGE_NODES; a++) {
    const double *x = &c->position[2 * c->edge[edge].node[a]];
    for (int i = 0; i < 2; i++) {
      p.x[i] += p.n[a] * x[i];
      t[i] += d[a] * x[i];
    }
  }
  p.normal[0] = t[1];
  p.normal[1] = -t[0];
  return p;
}

static bool opposed(const double a[2], const double b[2]) {
  return a[0] * b[0] + a[1] * b[1] < 0;
}

/* First box that may reach up to z: boxes before it end below. */
static int first_box(const struct axi_contact *c, double z, double widest) {
  int low = 0, high = c->box_count;
  while (low < high) {
    int middle = (low + high) / 2;
    if (c->box[middle].low + 2 * widest < z) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/* The closest opposite edge within reach of a slave point. */
static const struct axi_contact_box *opponent(const struct axi_contact *c,
                                              const struct slave_point *p, double widest,
                                              struct axi_closest *closest) {
  const struct axi_contact_box *found = NULL;
  double reach = c->reach;
  bool inner = c->chain[c->edge[p->edge].chain].inner;
  for (int k = first_box(c, p->x[1] - reach, widest);
       k < c->box_count && c->box[k].low < p->x[1] + reach; k++) {
    struct axi_contact_box *b = &c->box[k];
    double dr = p->x[0] - b->y[2][0], dz = p->x[1] - b->y[2][1], limit = reach + b->radius;
    if (dr * dr + dz * dz > limit * limit || !opposed(p->normal, b->normal) ||
        c->chain[c->edge[b->edge].chain].inner != inner) {
      continue;
    }
    struct axi_closest at = axi_closest_point(b->y, p->x);
    double n[2] = {at.tangent[1], -at.tangent[0]};
    if (at.distance < reach && opposed(p->normal, n) && !at.aside) {
      reach = at.distance;
      *closest = at;
      found = b;
    }
  }
  return found;
}

/* ---- potential --------------------------------------------------------------------------- */

/* phi, -phi' and phi''. */
static double potential(double eps, double delta, double g, double *traction, double *slope) {
  double x = delta - g;
  if (g <= -delta) {
    *traction = -eps * g;
    *slope = eps;
    return eps * (0.5 * g * g + delta * delta / 6);
  }
  *traction = eps * x * x / (4 * delta);
  *slope = eps * x / (2 * delta);
  return eps * x * x * x / (12 * delta);
}

/* Points near each other along the surface are neighbours rather than opponents: their potential
 * fades, by a factor between 0 at one edge's length and 1 at two and a half. */
struct fading {
  double value, slope, bend; /* of the factor over xi of the master */
};

static struct fading fade(const struct axi_contact *c, const struct slave_point *p,
                          const struct axi_contact_box *box, double xi) {
  const struct axi_contact_edge *s = &c->edge[p->edge], *m = &c->edge[box->edge];
  const struct axi_contact_chain *chain = &c->chain[s->chain];
  struct fading f = {.value = 1};
  if (s->chain != m->chain || (box->shift != 0 && chain->turn == 0)) {
    return f;
  }
  double half = 0.5 * m->length;
  double at = m->arc + (1 + xi) * half + box->shift * chain->turn * chain->length;
  double rate = (at < p->arc ? -half : half) / (1.5 * s->length);
  double x = (fabs(at - p->arc) - s->length) / (1.5 * s->length);
  if (x < 1) {
    x = fmax(0, x);
    f.value = x * x * x * (10 - 15 * x + 6 * x * x);
    f.slope = 30 * x * x * (1 - x) * (1 - x) * rate;
    f.bend = 60 * x * (1 - x) * (1 - 2 * x) * rate * rate;
  }
  return f;
}

/* Adds scale a b^T, made symmetric with b a^T unless a is b. */
static void add_outer(double scale, const double *a, const double *b, double *packed) {
  for (int i = 0; i < TOUCH_DOFS; i++) {
    for (int j = i; j < TOUCH_DOFS; j++) {
      *packed++ += a == b ? scale * a[i] * a[j] : scale * (a[i] * b[j] + b[i] * a[j]);
    }
  }
}

/* Variations at a slave point over the nodes' coordinates, of the way w = x - y(xi) and of y' and
 * y'' at fixed xi, contracted with vectors. */
struct variations {
  double n[AXI_EDGE_NODES], d[AXI_EDGE_NODES]; /* shape of the master, slope */
  const double *slave;                         /* shape of the slave */
};

static void vary_way(const struct variations *v, const double e[2], double out[TOUCH_DOFS]) {
  for (int k = 0; k < TOUCH_DOFS; k++) {
    int a = k / 2;
    out[k] = (a < AXI_EDGE_NODES ? v->slave[a] : -v->n[a - AXI_EDGE_NODES]) * e[k % 2];
  }
}

static void vary_slope(const struct variations *v, const double e[2], double out[TOUCH_DOFS]) {
  for (int k = 0; k < TOUCH_DOFS; k++) {
    int a = k / 2 - AXI_EDGE_NODES;
    out[k] = a < 0 ? 0 : v->d[a] * e[k % 2];
  }
}

static double dot(const double a[2], const double b[2]) {
  return a[0] * b[0] + a[1] * b[1];
}

/* d xi = (y' . dw + w . dy') / A from the stationarity (x - y) . y' = 0, A = |y'|^2 - w . y''. */
static double vary_xi(const struct variations *v, const struct axi_closest *at,
                      double out[TOUCH_DOFS]) {
  double way[2] = {at->gap * at->normal[0], at->gap * at->normal[1]}, turn[TOUCH_DOFS];
  double a = dot(at->tangent, at->tangent) - dot(way, at->bend);
  vary_way(v, at->tangent, out);
  vary_slope(v, way, turn);
  for (int k = 0; k < TOUCH_DOFS; k++) {
    out[k] = (out[k] + turn[k]) / a;
  }
  return a;
}

/* Second derivatives of w f phi(g) with the factor f held: with a = y' . dw, b = n . dy',
 *   d2g = -(a b + b a + (n . y'' / |y'|^2) a a + g b b) / A,
 * from dn = -(n . dy') y'/|y'|^2 and d xi; at an end of the edge, with e across the way, d2g =
 * (e . dw) (e . dw) / g. */
static void add_gap(const struct variations *v, const struct axi_closest *at, double force,
                    double slope, double *packed) {
  double grad[TOUCH_DOFS], along[TOUCH_DOFS], turn[TOUCH_DOFS];
  const double e[2] = {-at->normal[1], at->normal[0]};
  vary_way(v, at->normal, grad);
  vary_way(v, at->vertex ? e : at->tangent, along);
  add_outer(slope, grad, grad, packed);
  if (at->vertex) {
    add_outer(force / at->gap, along, along, packed);
    return;
  }
  vary_slope(v, at->normal, turn);
  double square = dot(at->tangent, at->tangent), bend = dot(at->normal, at->bend);
  double factor = -force / (square - at->gap * bend);
  add_outer(factor, along, turn, packed);
  add_outer(factor * bend / square, along, along, packed);
  add_outer(factor * at->gap, turn, turn, packed);
}

/* What a changing factor f(xi) adds: f' phi' (dg dxi + dxi dg) + phi f'' dxi dxi + phi f' d2xi,
 *   A d2xi = dw . dy' + dy' . dw + c dxi + dxi c - 3 y' . y'' dxi dxi,
 *   c = y'' . dw - 2 y' . dy' + w . dy''. */
static void add_fading(const struct variations *v, const struct axi_closest *at, double energy,
                       double force, const struct fading *f, double *packed) {
  static const double bend[AXI_EDGE_NODES] = {1, 1, -2}; /* second derivatives of the shape */
  double xi[TOUCH_DOFS], grad[TOUCH_DOFS], c[TOUCH_DOFS], turn[TOUCH_DOFS];
  double a = vary_xi(v, at, xi), scale = energy * f->slope / a;
  vary_way(v, at->normal, grad);
  vary_way(v, at->bend, c);
  vary_slope(v, at->tangent, turn);
  for (int k = 0; k < TOUCH_DOFS; k++) {
    int node = k / 2 - AXI_EDGE_NODES;
    c[k] += (node < 0 ? 0 : bend[node] * at->gap * at->normal[k % 2]) - 2 * turn[k];
  }
  add_outer(f->slope * force, grad, xi, packed);
  add_outer(energy * f->bend - 3 * scale * dot(at->tangent, at->bend), xi, xi, packed);
  add_outer(scale, c, xi, packed);
  for (int i = 0; i < 2; i++) {
    const double e[2] = {i == 0, i == 1};
    vary_way(v, e, c);
    vary_slope(v, e, turn);
    add_outer(scale, c, turn, packed);
  }
}

static struct axi_touch *new_touch(struct axi_contact *c) {
  if (c->touch_count == c->touch_capacity) {
    int capacity = 2 * c->touch_capacity + 64;
    struct axi_touch *more = realloc(c->touch, sizeof *more * (size_t)capacity);
    if (!more) {
      return NULL;
    }
    c->touch = more;
    c->touch_capacity = capacity;
  }
  return &c->touch[c->touch_count++];
}

/* Records the contact of a slave point with a master edge at `at`. */
static bool touch_edge(struct axi_contact *c, const struct slave_point *p, double weight,
                       const struct axi_contact_box *box, const struct axi_closest *at,
                       bool tangent) {
  struct fading f = fade(c, p, box, at->xi);
  if (f.value == 0) {
    return true;
  }
  struct axi_touch *t = new_touch(c);
  if (!t) {
    return false;
  }
  struct variations v = {.slave = p->n};
  double slope = 0, xi[TOUCH_DOFS], traction = 0;
  double energy =
      weight * potential(c->edge[p->edge].stiffness, c->offset, at->gap, &traction, &slope);
  double force = -weight * traction;
  *t = (struct axi_touch){.slave = p->edge,
                          .master = box->edge,
                          .shift = box->shift,
                          .gap = at->gap,
                          .traction = f.value * traction,
                          .weight = weight};
  c->energy += f.value * energy;
  t->stiffness = f.value * weight * slope;
  axi_edge_shape(at->xi, v.n, v.d);
  vary_way(&v, at->normal, t->force);
  for (int k = 0; k < TOUCH_DOFS; k++) {
    t->force[k] *= f.value * force;
  }
  bool fading = f.value < 1 && !at->vertex;
  if (fading) {
    vary_xi(&v, at, xi);
    for (int k = 0; k < TOUCH_DOFS; k++) {
      t->force[k] += energy * f.slope * xi[k];
    }
  }
  if (tangent) {
    add_gap(&v, at, f.value * force, t->stiffness, t->packed);
  }
  if (tangent && fading) {
    add_fading(&v, at, energy, force, &f, t->packed);
  }
  return true;
}

/* The same with the axis: g = r. */
static bool touch_axis(struct axi_contact *c, const struct slave_point *p, double weight,
                       bool tangent) {
  double slope = 0, grad[TOUCH_DOFS] = {p->n[0], 0, p->n[1], 0, p->n[2]};
  struct axi_touch *t = new_touch(c);
  if (!t) {
    return false;
  }
  *t = (struct axi_touch){.slave = p->edge, .master = -1, .gap = p->x[0], .weight = weight};
  c->energy +=
      weight * potential(c->edge[p->edge].stiffness, c->offset, t->gap, &t->traction, &slope);
  t->stiffness = weight * slope;
  for (int k = 0; k < TOUCH_DOFS; k++) {
    t->force[k] = -weight * t->traction * grad[k];
  }
  if (tangent) {
    add_outer(t->stiffness, grad, grad, t->packed);
  }
  return true;
}

enum status axi_contact_evaluate(struct axi_contact *c, const double *u, double elongation,
                                 bool tangent, struct error *error) {
  double widest = 0;
  bool room = true;
  place_edges(c, u, elongation);
  for (int k = 0; k < c->box_count; k++) {
    widest = fmax(widest, c->box[k].radius);
  }
  c->touch_count = c->near_count = 0;
  c->energy = 0;
  c->min_gap = INFINITY;
  for (int k = 0; room && k < AXI_EDGE_POINTS * c->edge_count; k++) {
    int edge = k / AXI_EDGE_POINTS, g = k % AXI_EDGE_POINTS;
    double weight = c->edge[edge].weight[g];
    struct slave_point p = slave_at(c, edge, contact_point[g]);
    struct axi_closest at;
    if (p.x[0] < c->offset) {
      c->min_gap = fmin(c->min_gap, p.x[0]);
      room = touch_axis(c, &p, weight, tangent);
    }
    const struct axi_contact_box *box = opponent(c, &p, widest, &at);
    if (room && box) {
      c->near[c->near_count++] = (struct axi_near){edge, box->edge, box->shift};
      c->min_gap = fmin(c->min_gap, at.gap);
      room = at.gap >= c->offset || touch_edge(c, &p, weight, box, &at, tangent);
    }
  }
  return room ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d points in contact",
                          c->touch_count);
}
