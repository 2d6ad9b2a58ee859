#include "solver/fe/contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/vec3.h"

/* How far beyond its edge (parent coordinate 1) a master face is continued. */
static const double xi_limit = 1.6;

enum status contact_init(struct contact *contact, const struct mesh *mesh,
                         const struct quad9_tables *tables, struct error *error) {
  *contact = (struct contact){.mesh = mesh, .tables = tables, .pair_count = mesh->facing_count};
  size_t points = (size_t)mesh->facing_count * QUAD9_POINTS;
  contact->point = calloc(points + 1, sizeof *contact->point);
  if (!contact->point) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %zu contact points", points);
  }
  for (int p = 0; p < contact->pair_count; p++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->facing[p].slave, nodes);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double a[3] = {0}, b[3] = {0}, normal[3];
      for (int m = 0; m < QUAD9_NODES; m++) {
        for (int i = 0; i < 3; i++) {
          a[i] += tables->dn[q][0][m] * mesh->x[3 * nodes[m] + i];
          b[i] += tables->dn[q][1][m] * mesh->x[3 * nodes[m] + i];
        }
      }
      vec3_cross(a, b, normal);
      struct contact_point *point = &contact->point[QUAD9_POINTS * p + q];
      point->area = tables->weight[q] * vec3_norm(normal);
      point->xi[0] = tables->point[q][0];
      point->xi[1] = tables->point[q][1];
    }
  }
  return STATUS_OK;
}

void contact_release(struct contact *contact) {
  free(contact->point);
  *contact = (struct contact){0};
}

void contact_nodes(const struct contact *contact, int pair, int nodes[CONTACT_NODES]) {
  const struct mesh_facing *facing = &contact->mesh->facing[pair];
  mesh_face_nodes(contact->mesh, &facing->slave, nodes);
  mesh_face_nodes(contact->mesh, &facing->master, nodes + QUAD9_NODES);
}

/* Closest-point projection onto a master face. */
struct projection {
  double n[QUAD9_NODES], dn[2][QUAD9_NODES];
  double tangent[2][3];
  double distance[3];     /* slave point - master point */
  double curvature[3][3]; /* second derivatives of the master point: ss, tt, st */
  double c11, c12, c22;   /* Hessian of |distance|^2 / 2 in the parent coordinates */
};

static void evaluate_projection(double master[][3], const double slave[3], const double xi[2],
                                struct projection *p) {
  double d2n[3][QUAD9_NODES];
  quad9_shape(xi[0], xi[1], p->n, p->dn, d2n);
  memset(p->tangent, 0, sizeof p->tangent);
  memset(p->curvature, 0, sizeof p->curvature);
  memcpy(p->distance, slave, sizeof p->distance);
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      double x = master[m][i];
      p->distance[i] -= p->n[m] * x;
      p->tangent[0][i] += p->dn[0][m] * x;
      p->tangent[1][i] += p->dn[1][m] * x;
      p->curvature[0][i] += d2n[0][m] * x;
      p->curvature[1][i] += d2n[1][m] * x;
      p->curvature[2][i] += d2n[2][m] * x;
    }
  }
  const double *a = p->tangent[0], *b = p->tangent[1], *d = p->distance;
  p->c11 = vec3_dot(a, a) - vec3_dot(d, p->curvature[0]);
  p->c22 = vec3_dot(b, b) - vec3_dot(d, p->curvature[1]);
  p->c12 = vec3_dot(a, b) - vec3_dot(d, p->curvature[2]);
}

/* Newton iteration for the closest point, started at xi. False when it leaves the face. */
static bool project(double master[][3], const double slave[3], double xi[2], struct projection *p) {
  for (int iteration = 0; iteration < 12; iteration++) {
    evaluate_projection(master, slave, xi, p);
    double determinant = p->c11 * p->c22 - p->c12 * p->c12;
    if (!(determinant > 0)) {
      return false;
    }
    double r1 = vec3_dot(p->distance, p->tangent[0]), r2 = vec3_dot(p->distance, p->tangent[1]);
    double d1 = (p->c22 * r1 - p->c12 * r2) / determinant;
    double d2 = (p->c11 * r2 - p->c12 * r1) / determinant;
    if (fabs(d1) + fabs(d2) < 1e-10) {
      return fabs(xi[0]) < xi_limit && fabs(xi[1]) < xi_limit;
    }
    xi[0] = fmax(-2, fmin(2, xi[0] + d1));
    xi[1] = fmax(-2, fmin(2, xi[1] + d2));
  }
  return false;
}

/* The smoothed law of x = g - lambda/eps: traction and its negative derivative. */
static double contact_law(double eps, double delta, double x, double *slope) {
  if (x >= delta) {
    *slope = 0;
    return 0;
  }
  if (x <= -delta) {
    *slope = eps;
    return -eps * x;
  }
  *slope = eps * (delta - x) / (2 * delta);
  return eps * (delta - x) * (delta - x) / (4 * delta);
}

/* Traction of a point at its gap, with its gain, and the negative derivative to the gap. */
static double point_traction(const struct contact *contact, const struct contact_point *point,
                             double *slope) {
  double x = point->gap - point->lambda / contact->stiffness;
  double traction = contact_law(contact->stiffness, contact->smoothing, x, slope);
  if (point->gain > 0) {
    *slope *= point->gain;
    traction = point->lambda + point->gain * (traction - point->lambda);
  }
  return traction;
}

void contact_follow(struct contact *contact, double cap) {
  double eps = contact->stiffness, slope;
  for (int i = 0; i < contact->pair_count * QUAD9_POINTS; i++) {
    struct contact_point *point = &contact->point[i];
    point->gain = 0;
    if (cap > 0 && point->valid) {
      point_traction(contact, point, &slope);
      point->gain = slope < eps * (1 - 1 / cap) ? 1 / (1 - slope / eps) : cap;
    }
  }
}

/* Adds the Hessian e'' n n^T + e' Hess g of the potential e(g), e' = first, e'' = second. With
 * t_a = c x,a (c the nodes' coefficients in the distance), m_a = n N,a on the master nodes, the
 * metric A, the curvature K = n . x,ab and C = A - g K:
 *   Hess g = - t M t^T - t C^-1 m^T - m C^-1 t^T - g m C^-1 m^T,  M = A^-1 K C^-1.
 * Nothing is divided by g, which the multipliers drive to zero. */
static void add_tangent(const struct projection *p, const double c[CONTACT_NODES],
                        const double normal[3], double gap, double first, double second,
                        double *packed) {
  const double *x1 = p->tangent[0], *x2 = p->tangent[1];
  double a11 = vec3_dot(x1, x1), a12 = vec3_dot(x1, x2), a22 = vec3_dot(x2, x2);
  double k11 = vec3_dot(normal, p->curvature[0]), k22 = vec3_dot(normal, p->curvature[1]),
         k12 = vec3_dot(normal, p->curvature[2]);
  double metric = a11 * a22 - a12 * a12, determinant = p->c11 * p->c22 - p->c12 * p->c12;
  double i11 = p->c22 / determinant, i12 = -p->c12 / determinant, i22 = p->c11 / determinant;
  double ak[2][2] = {{(a22 * k11 - a12 * k12) / metric, (a22 * k12 - a12 * k22) / metric},
                     {(a11 * k12 - a12 * k11) / metric, (a11 * k22 - a12 * k12) / metric}};
  double m11 = ak[0][0] * i11 + ak[0][1] * i12, m12 = ak[0][0] * i12 + ak[0][1] * i22,
         m22 = ak[1][0] * i12 + ak[1][1] * i22;
  /* The sum of left[v] right[v]^T over v. */
  double left[5][CONTACT_DOFS], right[5][CONTACT_DOFS];
  for (int r = 0; r < CONTACT_DOFS; r++) {
    int a = r / 3, i = r % 3;
    double t1 = c[a] * x1[i], t2 = c[a] * x2[i], n = c[a] * normal[i];
    double n1 = a < QUAD9_NODES ? 0 : normal[i] * p->dn[0][a - QUAD9_NODES];
    double n2 = a < QUAD9_NODES ? 0 : normal[i] * p->dn[1][a - QUAD9_NODES];
    double s1 = t1 + gap * n1, s2 = t2 + gap * n2;
    double l[5] = {t1, t2, n1, n2, n};
    double q[5] = {-first * (m11 * t1 + m12 * t2 + i11 * n1 + i12 * n2),
                   -first * (m12 * t1 + m22 * t2 + i12 * n1 + i22 * n2),
                   -first * (i11 * s1 + i12 * s2), -first * (i12 * s1 + i22 * s2), second * n};
    for (int v = 0; v < 5; v++) {
      left[v][r] = l[v];
      right[v][r] = q[v];
    }
  }
  for (int r = 0; r < CONTACT_DOFS; r++) {
    double *restrict row = packed - r;
    double l0 = left[0][r], l1 = left[1][r], l2 = left[2][r], l3 = left[3][r], l4 = left[4][r];
#pragma omp simd
    for (int s = r; s < CONTACT_DOFS; s++) {
      row[s] += l0 * right[0][s] + l1 * right[1][s] + l2 * right[2][s] + l3 * right[3][s] +
                l4 * right[4][s];
    }
    packed += CONTACT_DOFS - r;
  }
}

/* Slave point and projection of Gauss point q; fills gap, outward master normal, validity. */
static void find_gap(const struct contact *contact, int pair, int q, double x[CONTACT_NODES][3],
                     struct projection *p, struct contact_point *point, double normal[3]) {
  const double *n = contact->tables->n[q];
  double slave[3] = {0};
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      slave[i] += n[m] * x[m][i];
    }
  }
  double xi[2] = {point->xi[0], point->xi[1]};
  point->valid = project(x + QUAD9_NODES, slave, xi, p);
  point->traction = 0;
  if (!point->valid) {
    return;
  }
  memcpy(point->xi, xi, sizeof xi);
  vec3_cross(p->tangent[0], p->tangent[1], normal);
  double length = vec3_norm(normal) * contact->mesh->facing[pair].master.side;
  for (int i = 0; i < 3; i++) {
    normal[i] /= length;
  }
  point->gap = vec3_dot(p->distance, normal);
}

bool contact_evaluate(struct contact *contact, int pair, double x[CONTACT_NODES][3],
                      double r[CONTACT_DOFS], double *packed) {
  bool touched = false;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    struct contact_point *point = &contact->point[QUAD9_POINTS * pair + q];
    struct projection p;
    double normal[3], slope;
    find_gap(contact, pair, q, x, &p, point, normal);
    if (!point->valid) {
      continue;
    }
    point->traction = point_traction(contact, point, &slope);
    if (slope <= 0) {
      continue;
    }
    if (!touched) {
      memset(r, 0, CONTACT_DOFS * sizeof *r);
      if (packed) {
        memset(packed, 0, CONTACT_PACKED * sizeof *packed);
      }
      touched = true;
    }
    double c[CONTACT_NODES];
    for (int m = 0; m < QUAD9_NODES; m++) {
      c[m] = contact->tables->n[q][m];
      c[QUAD9_NODES + m] = -p.n[m];
    }
    for (int a = 0; a < CONTACT_DOFS; a++) {
      r[a] -= point->area * point->traction * c[a / 3] * normal[a % 3];
    }
    if (packed) {
      add_tangent(&p, c, normal, point->gap, -point->area * point->traction, point->area * slope,
                  packed);
    }
  }
  return touched;
}

struct contact_summary contact_summarise(const struct contact *contact) {
  struct contact_summary summary = {.min_gap = INFINITY};
  for (int i = 0; i < contact->pair_count * QUAD9_POINTS; i++) {
    const struct contact_point *point = &contact->point[i];
    if (point->valid) {
      summary.min_gap = fmin(summary.min_gap, point->gap);
      summary.active += point->traction > 0;
    }
  }
  return summary;
}

/* Aitken's factor for the next update, from this and the last t - lambda of all points. */
static double aitken_factor(const struct contact *contact, double last_factor) {
  double product = 0, square = 0;
  for (int i = 0; i < contact->pair_count * QUAD9_POINTS; i++) {
    const struct contact_point *point = &contact->point[i];
    double difference = point->traction - point->lambda - point->change;
    product += point->change * difference;
    square += difference * difference;
  }
  double factor = square > 0 ? -last_factor * product / square : 1;
  return fmax(1, fmin(10, factor));
}

double contact_update_multipliers(struct contact *contact, double *relaxation) {
  double largest = 0;
  *relaxation = *relaxation > 0 ? aitken_factor(contact, *relaxation) : 1;
  for (int i = 0; i < contact->pair_count * QUAD9_POINTS; i++) {
    struct contact_point *point = &contact->point[i];
    point->change = point->traction - point->lambda;
    largest = fmax(largest, fabs(point->change));
    point->lambda = fmax(0, point->lambda + *relaxation * point->change);
  }
  return largest;
}
