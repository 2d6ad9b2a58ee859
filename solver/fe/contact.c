#include "solver/fe/contact.h"

#include <math.h>
#include <string.h>
#include "solver/fe/contact_internal.h"
#include "solver/fe/contact_projection.h"
#include "solver/base/vec3.h"

/* How far beyond its edge (parent coordinate 1) a master face is continued: far for the two sides
 * of a gap, which are flat there, hardly for faces that have met by bending. */
static const double xi_limit_facing = 1.6;
static const double xi_limit = 1.05;

double contact_law(double eps, double delta, double x, double *slope) {
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
double contact_traction(const struct contact *contact, const struct contact_point *point,
                        double *slope) {
  double eps = contact->stiffness, x = point->gap - point->lambda / eps;
  double traction = contact_law(eps, contact->smoothing, x, slope);
  if (point->gain > 0) {
    *slope *= point->gain;
    traction = point->anchor + point->gain * (traction - point->anchor);
  }
  return traction;
}

void contact_follow(struct contact *contact, double cap) {
  for (int i = 0; i < contact->point_count; i++) {
    struct contact_point *point = &contact->point[i];
    double eps = contact->stiffness, slope;
    point->gain = 0;
    if (cap > 0 && point->valid) {
      point->anchor = contact_traction(contact, point, &slope);
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
  double slave[3] = {0}, xi[2] = {point->xi[0], point->xi[1]};
  double limit = pair < contact->mesh->facing_count ? xi_limit_facing : xi_limit;
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      slave[i] += n[m] * x[m][i];
    }
  }
  point->traction = 0;
  point->valid =
      projection_find(x + QUAD9_NODES, slave, xi, p) && fabs(xi[0]) < limit && fabs(xi[1]) < limit;
  if (point->valid) {
    memcpy(point->xi, xi, sizeof xi);
    point->gap = projection_gap(p, contact->face[contact->pair[pair].master].face.side, normal);
  }
}

bool contact_evaluate(struct contact *contact, int pair, double x[CONTACT_NODES][3],
                      double r[CONTACT_DOFS], double *packed) {
  bool touched = false;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    struct contact_point *point = &contact->point[QUAD9_POINTS * contact->pair[pair].slave + q];
    struct projection p;
    double normal[3], slope;
    if (point->pair != pair) {
      continue;
    }
    find_gap(contact, pair, q, x, &p, point, normal);
    if (!point->valid) {
      continue;
    }
    point->traction = contact_traction(contact, point, &slope);
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

bool contact_plane_evaluate(struct contact *contact, int plane, int face, double x[QUAD9_NODES][3],
                            double r[3 * QUAD9_NODES], double stiffness[QUAD9_NODES][QUAD9_NODES]) {
  const struct contact_plane *k = &contact->plane[plane];
  int first = QUAD9_POINTS * (contact->face_count * (1 + plane) + face);
  double height[QUAD9_NODES];
  bool touched = false;
  for (int m = 0; m < QUAD9_NODES; m++) {
    height[m] = vec3_dot(k->normal, x[m]) - vec3_dot(k->normal, k->point);
  }
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const double *n = contact->tables->n[q];
    struct contact_point *point = &contact->point[first + q];
    double slope;
    point->gap = 0;
    for (int m = 0; m < QUAD9_NODES; m++) {
      point->gap += n[m] * height[m];
    }
    point->valid = true;
    point->traction = contact_traction(contact, point, &slope);
    if (slope <= 0) {
      continue;
    }
    if (!touched) {
      memset(r, 0, 3 * QUAD9_NODES * sizeof *r);
      memset(stiffness, 0, QUAD9_NODES * sizeof *stiffness);
      touched = true;
    }
    for (int a = 0; a < QUAD9_NODES; a++) {
      for (int i = 0; i < 3; i++) {
        r[3 * a + i] -= point->area * point->traction * n[a] * k->normal[i];
      }
      for (int b = 0; b < QUAD9_NODES; b++) {
        stiffness[a][b] += point->area * slope * n[a] * n[b];
      }
    }
  }
  return touched;
}
