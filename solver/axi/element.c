#include "solver/axi/element.h"

#include <math.h>
#include <string.h>
#include "solver/fe/hyperelastic.h"

static const double gauss_point[3] = {-0.774596669241483377, 0, 0.774596669241483377};
static const double gauss_weight[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/* ---- shape functions --------------------------------------------------------------------- */

/* Quadratic Lagrange functions of the places -1, 0, 1. */
static void line_shape(double s, double n[3], double d[3]) {
  n[0] = 0.5 * s * (s - 1);
  n[1] = 1 - s * s;
  n[2] = 0.5 * s * (s + 1);
  d[0] = s - 0.5;
  d[1] = -2 * s;
  d[2] = s + 0.5;
}

void axi_shape(double xi, double eta, double n[AXI_NODES], double d[2][AXI_NODES]) {
  static const int place[AXI_NODES][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0},
                                          {2, 1}, {1, 2}, {0, 1}, {1, 1}};
  double f[3], df[3], g[3], dg[3];
  line_shape(xi, f, df);
  line_shape(eta, g, dg);
  for (int a = 0; a < AXI_NODES; a++) {
    int i = place[a][0], j = place[a][1];
    n[a] = f[i] * g[j];
    d[0][a] = df[i] * g[j];
    d[1][a] = f[i] * dg[j];
  }
}

/* ---- the undeformed element -------------------------------------------------------------- */

static bool point_init(double x[AXI_NODES][2], double xi, double eta, double w,
                       struct axi_point *p) {
  double d[2][AXI_NODES], jacobian[4] = {0};
  axi_shape(xi, eta, p->n, d);
  p->radius = p->height = 0;
  for (int a = 0; a < AXI_NODES; a++) {
    p->radius += p->n[a] * x[a][0];
    p->height += p->n[a] * x[a][1];
    for (int k = 0; k < 4; k++) {
      jacobian[k] += x[a][k / 2] * d[k % 2][a];
    }
  }
  double det = jacobian[0] * jacobian[3] - jacobian[1] * jacobian[2];
  if (!(det > 0) || !(p->radius > 0)) {
    return false;
  }
  for (int a = 0; a < AXI_NODES; a++) {
    p->dr[a] = (jacobian[3] * d[0][a] - jacobian[2] * d[1][a]) / det;
    p->dz[a] = (jacobian[0] * d[1][a] - jacobian[1] * d[0][a]) / det;
  }
  p->weight = 2 * M_PI * p->radius * det * w;
  return true;
}

/* Inverse of a symmetric positive definite 3 x 3 matrix by its cofactors. */
static void invert(const double m[9], double inverse[9]) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
      inverse[3 * i + j] = m[3 * a + c] * m[3 * b + d] - m[3 * a + d] * m[3 * b + c];
    }
  }
  double det = m[0] * inverse[0] + m[1] * inverse[3] + m[2] * inverse[6];
  for (int i = 0; i < 9; i++) {
    inverse[i] /= det;
  }
}

bool axi_geometry_init(double x[AXI_NODES][2], struct axi_geometry *geometry) {
  double length = 0, m[9] = {0};
  for (int a = 0; a < AXI_NODES - 1; a++) {
    length = fmax(length, hypot(x[a][0] - x[8][0], x[a][1] - x[8][1]));
  }
  for (int g = 0; g < AXI_POINTS; g++) {
    struct axi_point *p = &geometry->point[g];
    if (!point_init(x, gauss_point[g / 3], gauss_point[g % 3],
                    gauss_weight[g / 3] * gauss_weight[g % 3], p)) {
      return false;
    }
    p->psi[0] = 1;
    p->psi[1] = (p->radius - x[8][0]) / length;
    p->psi[2] = (p->height - x[8][1]) / length;
    for (int k = 0; k < 9; k++) {
      m[k] += p->weight * p->psi[k / 3] * p->psi[k % 3];
    }
  }
  invert(m, geometry->inverse);
  return true;
}

double axi_bulk_modulus(const struct material_spec *material) {
  return material->bulk_ratio * material_shear_modulus(material);
}

struct axi_bulk axi_bulk_parts(const struct material_spec *material) {
  double kappa = axi_bulk_modulus(material);
  double local = fmin(kappa, AXI_LOCAL_BULK * material_shear_modulus(material));
  return (struct axi_bulk){.local = local, .projected = kappa - local};
}

/* ---- deformation ------------------------------------------------------------------------- */

/* The five components of F that are not always 0. */
enum { RR, RZ, ZR, ZZ, TT, PARTS };
static const int part[PARTS] = {0, 2, 6, 8, 4}; /* their places in the 3 x 3 matrix */

static void deform(const struct axi_point *p, const double *u, double f[PARTS]) {
  double hoop = 0;
  f[RR] = f[ZZ] = 1;
  f[RZ] = f[ZR] = 0;
  for (int a = 0; a < AXI_NODES; a++) {
    double ur = u[2 * a], uz = u[2 * a + 1];
    f[RR] += p->dr[a] * ur;
    f[RZ] += p->dz[a] * ur;
    f[ZR] += p->dr[a] * uz;
    f[ZZ] += p->dz[a] * uz;
    hoop += p->n[a] * ur;
  }
  f[TT] = 1 + hoop / p->radius;
}

/* c = dJ/dF; returns J = (F_rr F_zz - F_rz F_zr) F_tt. */
static double cofactor(const double f[PARTS], double c[PARTS]) {
  c[RR] = f[ZZ] * f[TT];
  c[RZ] = -f[ZR] * f[TT];
  c[ZR] = -f[RZ] * f[TT];
  c[ZZ] = f[RR] * f[TT];
  c[TT] = f[RR] * f[ZZ] - f[RZ] * f[ZR];
  return c[TT] * f[TT];
}

double axi_deformation(const struct axi_point *point, const double u[AXI_DOFS], double f[9]) {
  double parts[PARTS], c[PARTS];
  deform(point, u, parts);
  memset(f, 0, 9 * sizeof *f);
  for (int k = 0; k < PARTS; k++) {
    f[part[k]] = parts[k];
  }
  return cofactor(parts, c);
}

struct deformed {
  double f[PARTS], c[PARTS], j;
};

/* False when J <= 0 somewhere. F_tt alone may not be negative either: the body would have passed
 * the axis. */
static bool deform_all(const struct axi_geometry *geometry, const double *u,
                       struct deformed at[AXI_POINTS]) {
  for (int g = 0; g < AXI_POINTS; g++) {
    deform(&geometry->point[g], u, at[g].f);
    at[g].j = cofactor(at[g].f, at[g].c);
    if (!(at[g].c[TT] > 0) || !(at[g].f[TT] > 0)) {
      return false;
    }
  }
  return true;
}

/* kappa M^-1 b; returns kappa/2 b M^-1 b. */
static double project(const struct axi_geometry *geometry, double kappa,
                      const struct deformed at[AXI_POINTS], double pressure[3]) {
  double b[3] = {0}, energy = 0;
  for (int g = 0; g < AXI_POINTS; g++) {
    const struct axi_point *p = &geometry->point[g];
    for (int i = 0; i < 3; i++) {
      b[i] += p->weight * p->psi[i] * (at[g].j - 1);
    }
  }
  for (int i = 0; i < 3; i++) {
    const double *row = geometry->inverse + 3 * i;
    pressure[i] = kappa * (row[0] * b[0] + row[1] * b[1] + row[2] * b[2]);
    energy += 0.5 * pressure[i] * b[i];
  }
  return energy;
}

void axi_element_pressure(const struct axi_geometry *geometry, const struct material_spec *material,
                          const double u[AXI_DOFS], double pressure[3]) {
  struct deformed at[AXI_POINTS];
  for (int g = 0; g < AXI_POINTS; g++) {
    deform(&geometry->point[g], u, at[g].f);
    at[g].j = cofactor(at[g].f, at[g].c);
  }
  project(geometry, axi_bulk_parts(material).projected, at, pressure);
}

/* ---- residual and tangent ---------------------------------------------------------------- */

/* v = B^T s: s by the parts of F to the unknowns of the nodes. */
static void scatter(const struct axi_point *p, const double s[PARTS], double v[AXI_DOFS]) {
  double hoop = s[TT] / p->radius;
  for (int a = 0; a < AXI_NODES; a++) {
    v[2 * a] += p->dr[a] * s[RR] + p->dz[a] * s[RZ] + p->n[a] * hoop;
    v[2 * a + 1] += p->dr[a] * s[ZR] + p->dz[a] * s[ZZ];
  }
}

/* Adds w p d2J/dF2. */
static void add_volumetric(double wp, const double f[PARTS], double d[PARTS][PARTS]) {
  const struct {
    int i, j;
    double value;
  } second[] = {{RR, ZZ, f[TT]},  {RZ, ZR, -f[TT]}, {RR, TT, f[ZZ]},
                {RZ, TT, -f[ZR]}, {ZR, TT, -f[RZ]}, {ZZ, TT, f[RR]}};
  for (size_t k = 0; k < sizeof second / sizeof *second; k++) {
    d[second[k].i][second[k].j] += wp * second[k].value;
    d[second[k].j][second[k].i] += wp * second[k].value;
  }
}

/* Adds B^T D B to the packed upper triangle. */
static void add_tangent(const struct axi_point *p, double d[PARTS][PARTS], double *packed) {
  for (int a = 0; a < AXI_NODES; a++) {
    double hoop = p->n[a] / p->radius, row[2][PARTS];
    for (int k = 0; k < PARTS; k++) {
      row[0][k] = p->dr[a] * d[RR][k] + p->dz[a] * d[RZ][k] + hoop * d[TT][k];
      row[1][k] = p->dr[a] * d[ZR][k] + p->dz[a] * d[ZZ][k];
    }
    for (int i = 0; i < 2; i++) {
      const double *r = row[i];
      double t = r[TT] / p->radius;
      for (int b = a; b < AXI_NODES; b++) {
        if (b > a || i == 0) {
          *packed++ += p->dr[b] * r[RR] + p->dz[b] * r[RZ] + p->n[b] * t;
        }
        *packed++ += p->dr[b] * r[ZR] + p->dz[b] * r[ZZ];
      }
    }
  }
}

/* Adds kappa G^T M^-1 G, G = db/du. */
static void add_bulk(const double inverse[9], double kappa, double g[3][AXI_DOFS], double *packed) {
  for (int i = 0; i < AXI_DOFS; i++) {
    double h[3];
    for (int k = 0; k < 3; k++) {
      h[k] = kappa * (inverse[k] * g[0][i] + inverse[3 + k] * g[1][i] + inverse[6 + k] * g[2][i]);
    }
    for (int j = i; j < AXI_DOFS; j++) {
      *packed++ += h[0] * g[0][j] + h[1] * g[1][j] + h[2] * g[2][j];
    }
  }
}

/* Adds one Gauss point; grad = db/du only with a tangent. Returns its isochoric energy. */
static double add_point(const struct axi_point *p, const struct deformed *at,
                        const struct material_spec *material, double local,
                        const double pressure[3], double residual[AXI_DOFS], double *tangent,
                        double grad[3][AXI_DOFS]) {
  struct kinematics k = {.f = {0}};
  double stress[9], law[81], s[PARTS], d[PARTS][PARTS];
  for (int i = 0; i < PARTS; i++) {
    k.f[part[i]] = at->f[i];
    k.cofactor[part[i]] = at->c[i] / at->j;
  }
  k.j = at->j;
  double energy = hyperelastic_isochoric(material, &k, stress, tangent ? law : NULL);
  double change = at->j - 1, tension = local * change;
  energy += 0.5 * local * change * change;
  for (int i = 0; i < 3; i++) {
    tension += pressure[i] * p->psi[i];
  }
  for (int i = 0; i < PARTS; i++) {
    s[i] = p->weight * (stress[part[i]] + tension * at->c[i]);
  }
  scatter(p, s, residual);
  if (!tangent) {
    return p->weight * energy;
  }
  for (int i = 0; i < PARTS; i++) {
    for (int j = 0; j < PARTS; j++) {
      d[i][j] = p->weight * (law[9 * part[i] + part[j]] + local * at->c[i] * at->c[j]);
    }
    s[i] = p->weight * at->c[i];
  }
  add_volumetric(p->weight * tension, at->f, d);
  add_tangent(p, d, tangent);
  double v[AXI_DOFS] = {0};
  scatter(p, s, v);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < AXI_DOFS; j++) {
      grad[i][j] += p->psi[i] * v[j];
    }
  }
  return p->weight * energy;
}

bool axi_element_evaluate(const struct axi_geometry *geometry, const struct material_spec *material,
                          const double u[AXI_DOFS], double *energy, double residual[AXI_DOFS],
                          double *tangent) {
  struct deformed at[AXI_POINTS];
  double pressure[3], grad[3][AXI_DOFS] = {{0}};
  struct axi_bulk bulk = axi_bulk_parts(material);
  if (!deform_all(geometry, u, at)) {
    return false;
  }
  memset(residual, 0, AXI_DOFS * sizeof *residual);
  if (tangent) {
    memset(tangent, 0, AXI_PACKED * sizeof *tangent);
  }
  *energy = project(geometry, bulk.projected, at, pressure);
  for (int g = 0; g < AXI_POINTS; g++) {
    *energy += add_point(&geometry->point[g], &at[g], material, bulk.local, pressure, residual,
                         tangent, grad);
  }
  if (tangent) {
    add_bulk(geometry->inverse, bulk.projected, grad, tangent);
  }
  return true;
}

/* ---- volume ------------------------------------------------------------------------------ */

double axi_edge_volume(double x[AXI_EDGE_NODES][2], double gradient[AXI_EDGE_DOFS],
                       double second[AXI_EDGE_PACKED]) {
  static const int order[AXI_EDGE_NODES] = {0, 2, 1}; /* start, end, middle */
  double volume = 0, h[AXI_EDGE_DOFS][AXI_EDGE_DOFS] = {{0}};
  memset(gradient, 0, AXI_EDGE_DOFS * sizeof *gradient);
  for (int g = 0; g < 3; g++) {
    double shape[3], slope[3], n[3], d[3], r = 0, dz = 0, w = -M_PI * gauss_weight[g];
    line_shape(gauss_point[g], shape, slope);
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      n[a] = shape[order[a]];
      d[a] = slope[order[a]];
      r += n[a] * x[a][0];
      dz += d[a] * x[a][1];
    }
    volume += w * r * r * dz;
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      gradient[2 * a] += w * 2 * r * n[a] * dz;
      gradient[2 * a + 1] += w * r * r * d[a];
      for (int b = 0; b < AXI_EDGE_NODES; b++) {
        h[2 * a][2 * b] += w * 2 * n[a] * n[b] * dz;
        h[2 * a][2 * b + 1] += w * 2 * r * n[a] * d[b];
        h[2 * b + 1][2 * a] += w * 2 * r * n[a] * d[b];
      }
    }
  }
  for (int i = 0; second && i < AXI_EDGE_DOFS; i++) {
    for (int j = i; j < AXI_EDGE_DOFS; j++) {
      *second++ = h[i][j];
    }
  }
  return volume;
}
