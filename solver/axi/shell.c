#include "solver/axi/shell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/hyperelastic.h"

enum { ALONG = 2, THROUGH = 2, POINTS = ALONG * THROUGH, GRADIENTS = 5 };

/* Components of F, row-major in the order r, t, z, that are not 0. */
enum { RR = 0, RZ = 2, TT = 4, ZR = 6, ZZ = 8 };
static const int component[GRADIENTS] = {RR, RZ, TT, ZR, ZZ};

struct shell_point {
  struct axi_point at; /* without the functions of the pressure */
  double normal[2];    /* unit vector along the rows */
};

struct shell_element {
  int row; /* lowest */
  struct shell_point point[POINTS];
};

struct axi_shell {
  const struct axi_mesh *mesh;
  int row_nodes, row_count;
  double arm;       /* m */
  double *director; /* row_count x 2 */
  double *offset;   /* node_count: from the middle node along the director */
  struct shell_element *element;
  int *edge_row; /* inner_count: lowest row */
};

/* ---- geometry ---- */

static enum status rows_init(struct axi_shell *s, struct error *error) {
  for (int k = 0; k < s->row_count; k++) {
    const double *first = s->mesh->position + 2 * (size_t)k * (size_t)s->row_nodes;
    const double *last = first + 2 * (s->row_nodes - 1), *middle = first + s->row_nodes - 1;
    double *d = s->director + 2 * k, length = hypot(last[0] - first[0], last[1] - first[1]);
    d[0] = (last[0] - first[0]) / length;
    d[1] = (last[1] - first[1]) / length;
    for (int i = 0; i < s->row_nodes; i++) {
      double r = first[2 * i] - middle[0], z = first[2 * i + 1] - middle[1];
      s->offset[k * s->row_nodes + i] = r * d[0] + z * d[1];
      if (!(fabs(z * d[0] - r * d[1]) <= 1e-6 * length)) {
        return error_set(error, STATUS_GEOMETRY, NULL, "row %d of the wall is not straight", k);
      }
    }
    s->arm += 0.5 * length / s->row_count;
  }
  return STATUS_OK;
}

/* Lowest of three neighbouring rows; -1 when the nodes connect others. */
static int lowest_row(const struct axi_shell *s, const int *node, int count) {
  int low = s->row_count, high = 0;
  for (int a = 0; a < count; a++) {
    int row = node[a] / s->row_nodes;
    low = row < low ? row : low;
    high = row > high ? row : high;
  }
  return high == low + 2 ? low : -1;
}

/* Fills a point of the parent square; false when it is turned inside out. */
static bool point_init(double x[AXI_NODES][2], double xi, double eta, bool rows_along_xi,
                       struct shell_point *p) {
  double d[2][AXI_NODES], j[2][2] = {{0}};
  axi_shape(xi, eta, p->at.n, d);
  p->at.radius = p->at.height = 0;
  for (int a = 0; a < AXI_NODES; a++) {
    p->at.radius += p->at.n[a] * x[a][0];
    p->at.height += p->at.n[a] * x[a][1];
    for (int c = 0; c < 2; c++) {
      j[c][0] += x[a][c] * d[0][a];
      j[c][1] += x[a][c] * d[1][a];
    }
  }
  double area = j[0][0] * j[1][1] - j[0][1] * j[1][0];
  for (int a = 0; a < AXI_NODES; a++) {
    p->at.dr[a] = (d[0][a] * j[1][1] - d[1][a] * j[1][0]) / area;
    p->at.dz[a] = (d[1][a] * j[0][0] - d[0][a] * j[0][1]) / area;
  }
  int across = rows_along_xi ? 0 : 1;
  double length = hypot(j[0][across], j[1][across]);
  p->normal[0] = j[0][across] / length;
  p->normal[1] = j[1][across] / length;
  p->at.weight = 2 * M_PI * p->at.radius * area; /* of weight 1 at each of the 2 x 2 points */
  return area > 0 && p->at.radius > 0;
}

static enum status element_init(struct axi_shell *s, int element, struct error *error) {
  static const double at = 0.577350269189625765;
  const int *node = s->mesh->element[element].node;
  struct shell_element *e = &s->element[element];
  double x[AXI_NODES][2];
  for (int a = 0; a < AXI_NODES; a++) {
    memcpy(x[a], s->mesh->position + 2 * node[a], sizeof x[a]);
  }
  e->row = lowest_row(s, node, AXI_NODES);
  bool fits = e->row >= 0;
  for (int q = 0; q < POINTS && fits; q++) {
    fits = point_init(x, q % 2 ? at : -at, q / 2 ? at : -at,
                      node[0] / s->row_nodes == node[1] / s->row_nodes, &e->point[q]);
  }
  return fits ? STATUS_OK
              : error_set(error, STATUS_GEOMETRY, NULL,
                          "element %d does not connect three rows of the wall", element);
}

enum status axi_shell_create(const struct axi_mesh *mesh, int row_nodes, struct axi_shell **out,
                             struct error *error) {
  struct axi_shell *s = calloc(1, sizeof *s);
  if (s) {
    s->mesh = mesh;
    s->row_nodes = row_nodes;
    s->row_count = mesh->node_count / row_nodes;
    s->director = calloc(2 * (size_t)s->row_count + 1, sizeof *s->director);
    s->offset = calloc((size_t)mesh->node_count + 1, sizeof *s->offset);
    s->element = calloc((size_t)mesh->element_count + 1, sizeof *s->element);
    s->edge_row = calloc((size_t)mesh->inner_count + 1, sizeof *s->edge_row);
  }
  if (!s || !s->director || !s->offset || !s->element || !s->edge_row) {
    axi_shell_destroy(s);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a shell of %d nodes",
                     mesh->node_count);
  }
  enum status status =
      row_nodes % 2 && mesh->node_count % row_nodes == 0
          ? rows_init(s, error)
          : error_set(error, STATUS_GEOMETRY, NULL, "%d nodes are no rows of %d with a middle one",
                      mesh->node_count, row_nodes);
  for (int e = 0; e < mesh->element_count && status == STATUS_OK; e++) {
    status = element_init(s, e, error);
  }
  for (int k = 0; k < mesh->inner_count && status == STATUS_OK; k++) {
    s->edge_row[k] = lowest_row(s, mesh->inner[k].node, AXI_EDGE_NODES);
    if (s->edge_row[k] < 0) {
      status = error_set(error, STATUS_GEOMETRY, NULL,
                         "edge %d of the cavity does not connect three rows of the wall", k);
    }
  }
  if (status != STATUS_OK) {
    axi_shell_destroy(s);
    return status;
  }
  *out = s;
  return STATUS_OK;
}

void axi_shell_destroy(struct axi_shell *s) {
  if (!s) {
    return;
  }
  free(s->director);
  free(s->offset);
  free(s->element);
  free(s->edge_row);
  free(s);
}

/* ---- rows ---- */

/* R(turn) D */
static void turned(const double d[2], double turn, double to[2]) {
  double c = cos(turn), s = sin(turn);
  to[0] = c * d[0] - s * d[1];
  to[1] = s * d[0] + c * d[1];
}

void axi_shell_expand(const struct axi_shell *s, int row, const double q[SHELL_ROW], double *u) {
  const double *d = s->director + 2 * row;
  double now[2];
  turned(d, q[2] / s->arm, now);
  for (int i = 0; i < s->row_nodes; i++) {
    int node = row * s->row_nodes + i;
    u[2 * node] = q[0] + s->offset[node] * (now[0] - d[0]);
    u[2 * node + 1] = q[1] + s->offset[node] * (now[1] - d[1]);
  }
}

void axi_shell_gather(const struct axi_shell *s, int row, const double *u, double q[SHELL_ROW]) {
  const double *d = s->director + 2 * row;
  int first = row * s->row_nodes, last = first + s->row_nodes - 1;
  int middle = first + s->row_nodes / 2;
  double span = s->offset[last] - s->offset[first];
  double r = span * d[0] + u[2 * last] - u[2 * first];
  double z = span * d[1] + u[2 * last + 1] - u[2 * first + 1];
  q[0] = u[2 * middle];
  q[1] = u[2 * middle + 1];
  q[2] = s->arm * atan2(d[0] * z - d[1] * r, d[0] * r + d[1] * z);
}

double axi_shell_lever(const struct axi_shell *s, int node, int direction) {
  const double *d = s->director + 2 * (node / s->row_nodes);
  return s->offset[node] / s->arm * (direction == 0 ? -d[1] : d[0]);
}

int axi_shell_element_row(const struct axi_shell *s, int element) {
  return s->element[element].row;
}

int axi_shell_edge_row(const struct axi_shell *s, int edge) {
  return s->edge_row[edge];
}

/* ---- the law of a point: no stress along the row ---- */

/* Adds kappa/2 (J - 1)^2, its stress and its tangent. */
static double add_volumetric(double kappa, const struct kinematics *k, double stress[9],
                             double tangent[81]) {
  const double *g = k->cofactor;
  double p = kappa * (k->j - 1) * k->j, pp = kappa * (2 * k->j - 1) * k->j;
  for (int a = 0; a < 9; a++) {
    stress[a] += p * g[a];
    for (int b = 0; b < 9; b++) {
      tangent[9 * a + b] += pp * g[a] * g[b] - p * g[3 * (a / 3) + b % 3] * g[3 * (b / 3) + a % 3];
    }
  }
  return 0.5 * kappa * (k->j - 1) * (k->j - 1);
}

/* m = t (I + (stretch - 1) n x n) for the matrix t, n in the meridian plane. */
static void stretched(const double t[9], double stretch, const double n[3], double m[9]) {
  for (int i = 0; i < 3; i++) {
    double along = t[3 * i] * n[0] + t[3 * i + 1] * n[1] + t[3 * i + 2] * n[2];
    for (int j = 0; j < 3; j++) {
      m[3 * i + j] = t[3 * i + j] + (stretch - 1) * along * n[j];
    }
  }
}

/* What the law gives at F (I + (stretch - 1) n x n). */
struct law {
  double stretch, energy, stress[9], tangent[81];
  double rate[9];   /* dF/dstretch = F n x n */
  double curvature; /* of the energy by the stretch */
};

/* Derivative of the energy by the stretch. */
static double law_slope(const struct material_spec *material, double kappa, const double f[9],
                        const double n[3], const double rate[9], double stretch,
                        struct kinematics *k, double stress[9]) {
  double slope = 0;
  stretched(f, stretch, n, k->f);
  kinematics_complete(k);
  hyperelastic_isochoric(material, k, stress, NULL);
  double p = kappa * (k->j - 1) * k->j;
  for (int a = 0; a < 9; a++) {
    slope += (stress[a] + p * k->cofactor[a]) * rate[a];
  }
  return slope;
}

/* The stretch of least energy by the secant method from that of an incompressible body, then all of
 * the law there. False when there is none. */
static bool find_stretch(const struct material_spec *material, const double f[9], const double n[3],
                         struct law *law) {
  enum { ROUNDS = 40 };
  struct kinematics k;
  memcpy(k.f, f, sizeof k.f);
  double kappa = axi_bulk_modulus(material), j = kinematics_complete(&k), slope, last = 0, at = 0;
  if (!(j > 0)) {
    return false;
  }
  for (int i = 0; i < 9; i++) {
    double along = f[i / 3 * 3] * n[0] + f[i / 3 * 3 + 1] * n[1] + f[i / 3 * 3 + 2] * n[2];
    law->rate[i] = along * n[i % 3];
  }
  law->stretch = 1 / j;
  law->curvature = kappa * j * j * (1 + 4 / (3 * material->bulk_ratio));
  for (int round = 0;; round++) {
    slope = law_slope(material, kappa, f, n, law->rate, law->stretch, &k, law->stress);
    if (round > 0 && slope != last) {
      law->curvature = (slope - last) / (law->stretch - at);
    }
    double step = -slope / law->curvature;
    if (!(law->curvature > 0) || round == ROUNDS) {
      return false;
    }
    if (fabs(step) <= 1e-13 * law->stretch) {
      break;
    }
    last = slope;
    at = law->stretch;
    law->stretch = fmax(law->stretch + step, 0.5 * law->stretch);
  }
  law->energy = hyperelastic_isochoric(material, &k, law->stress, law->tangent);
  law->energy += add_volumetric(kappa, &k, law->stress, law->tangent);
  law->curvature = 0;
  for (int a = 0; a < 9; a++) {
    for (int b = 0; b < 9; b++) {
      law->curvature += law->rate[a] * law->tangent[9 * a + b] * law->rate[b];
    }
  }
  return law->curvature > 0;
}

/* Energy, stress and tangent of the least energy by F; false where there is none. */
static bool plane_stress(const struct material_spec *material, const double f[9], const double n[3],
                         double *energy, double stress[9], double tangent[81]) {
  struct law law;
  double half[81], row[9], mixed[9] = {0}, normal[9];
  if (!find_stretch(material, f, n, &law)) {
    return false;
  }
  *energy = law.energy;
  stretched(law.stress, law.stretch, n, stress);
  /* The tangent by F from that by the stretched F: both of its index pairs, one after the other. */
  for (int a = 0; a < 9; a++) {
    stretched(law.tangent + 9 * a, law.stretch, n, half + 9 * a);
  }
  for (int b = 0; b < 9; b++) {
    for (int a = 0; a < 9; a++) {
      row[a] = half[9 * a + b];
      mixed[b] += half[9 * a + b] * law.rate[a];
    }
    stretched(row, law.stretch, n, normal);
    for (int a = 0; a < 9; a++) {
      tangent[9 * a + b] = normal[a];
    }
  }
  stretched(law.stress, 2, n, normal); /* P + P n x n */
  for (int a = 0; a < 9; a++) {
    mixed[a] += normal[a] - law.stress[a];
  }
  for (int a = 0; a < 81; a++) {
    tangent[a] -= mixed[a / 9] * mixed[a % 9] / law.curvature;
  }
  return true;
}

/* ---- element ---- */

/* Energy, forces and, unless NULL, full tangent over the displacements of the nodes. */
static bool evaluate_nodes(const struct axi_shell *s, int element, const double u[AXI_DOFS],
                           double *energy, double force[AXI_DOFS], double *tangent) {
  const struct material_spec *material = &s->mesh->region[s->mesh->element[element].region];
  *energy = 0;
  memset(force, 0, AXI_DOFS * sizeof *force);
  if (tangent) {
    memset(tangent, 0, AXI_DOFS * AXI_DOFS * sizeof *tangent);
  }
  for (int q = 0; q < POINTS; q++) {
    const struct shell_point *p = &s->element[element].point[q];
    double f[9], stress[9], a[81], w, b[GRADIENTS][AXI_DOFS] = {{0}};
    double n[3] = {p->normal[0], 0, p->normal[1]};
    axi_deformation(&p->at, u, f);
    if (!plane_stress(material, f, n, &w, stress, a)) {
      return false;
    }
    *energy += p->at.weight * w;
    for (int i = 0; i < AXI_NODES; i++) {
      b[0][2 * i] = b[3][2 * i + 1] = p->at.dr[i];
      b[1][2 * i] = b[4][2 * i + 1] = p->at.dz[i];
      b[2][2 * i] = p->at.n[i] / p->at.radius;
    }
    for (int i = 0; i < AXI_DOFS; i++) {
      double row[GRADIENTS] = {0};
      for (int c = 0; c < GRADIENTS; c++) {
        force[i] += p->at.weight * stress[component[c]] * b[c][i];
        for (int d = 0; tangent && d < GRADIENTS; d++) {
          row[d] += p->at.weight * b[c][i] * a[9 * component[c] + component[d]];
        }
      }
      for (int d = 0; tangent && d < GRADIENTS; d++) {
        for (int j = i; j < AXI_DOFS; j++) {
          tangent[AXI_DOFS * i + j] += row[d] * b[d][j];
        }
      }
    }
  }
  for (int i = 0; tangent && i < AXI_DOFS; i++) {
    for (int j = 0; j < i; j++) {
      tangent[AXI_DOFS * i + j] = tangent[AXI_DOFS * j + i];
    }
  }
  return true;
}

/* The nodes of an element or edge by the unknowns of their rows. */
struct motion {
  int count;
  int row[AXI_NODES];          /* 0 to 2 */
  double u[2 * AXI_NODES];     /* displacements */
  double slope[AXI_NODES][2];  /* du/dq_2 */
  double second[AXI_NODES][2]; /* d2u/dq_2^2 */
};

static void motion_fill(const struct axi_shell *s, int first, const int *node, int count,
                        const double q[SHELL_DOFS], struct motion *m) {
  m->count = count;
  for (int a = 0; a < count; a++) {
    int row = node[a] / s->row_nodes - first;
    const double *d = s->director + 2 * (first + row), *x = q + SHELL_ROW * row;
    double now[2], offset = s->offset[node[a]], lever = offset / s->arm;
    turned(d, x[2] / s->arm, now);
    m->row[a] = row;
    for (int c = 0; c < 2; c++) {
      m->u[2 * a + c] = x[c] + offset * (now[c] - d[c]);
      m->second[a][c] = -lever / s->arm * now[c];
    }
    m->slope[a][0] = -lever * now[1];
    m->slope[a][1] = lever * now[0];
  }
}

/* Forces and tangent (full; may be NULL) over the nodes' displacements become those over the rows'
 * unknowns. */
static void reduce(const struct motion *m, const double *force, const double *full,
                   double residual[SHELL_DOFS], double *packed) {
  double t[SHELL_DOFS][SHELL_DOFS] = {{0}};
  int size = 2 * m->count;
  memset(residual, 0, SHELL_DOFS * sizeof *residual);
  for (int i = 0; i < size; i++) {
    int a = i / 2, base = SHELL_ROW * m->row[a], own[2] = {base + i % 2, base + 2};
    double factor[2] = {1, m->slope[a][i % 2]};
    for (int k = 0; k < 2; k++) {
      residual[own[k]] += factor[k] * force[i];
    }
    t[base + 2][base + 2] += force[i] * m->second[a][i % 2];
    for (int j = 0; full && j < size; j++) {
      int other = SHELL_ROW * m->row[j / 2];
      double value = full[size * i + j], slope = m->slope[j / 2][j % 2];
      for (int k = 0; k < 2; k++) {
        t[own[k]][other + j % 2] += factor[k] * value;
        t[own[k]][other + 2] += factor[k] * value * slope;
      }
    }
  }
  for (int i = 0; full && i < SHELL_DOFS; i++) {
    for (int j = i; j < SHELL_DOFS; j++) {
      *packed++ = t[i][j];
    }
  }
}

bool axi_shell_element(const struct axi_shell *s, int element, const double q[SHELL_DOFS],
                       double *energy, double residual[SHELL_DOFS], double *tangent) {
  struct motion m;
  double force[AXI_DOFS], full[AXI_DOFS * AXI_DOFS];
  motion_fill(s, s->element[element].row, s->mesh->element[element].node, AXI_NODES, q, &m);
  if (!evaluate_nodes(s, element, m.u, energy, force, tangent ? full : NULL)) {
    return false;
  }
  reduce(&m, force, tangent ? full : NULL, residual, tangent);
  return true;
}

double axi_shell_volume(const struct axi_shell *s, int edge, const double q[SHELL_DOFS],
                        double gradient[SHELL_DOFS], double second[SHELL_PACKED]) {
  struct motion m;
  const int *node = s->mesh->inner[edge].node;
  double x[AXI_EDGE_NODES][2], force[AXI_EDGE_DOFS], packed[AXI_EDGE_PACKED], *at = packed;
  double full[AXI_EDGE_DOFS * AXI_EDGE_DOFS];
  motion_fill(s, s->edge_row[edge], node, AXI_EDGE_NODES, q, &m);
  for (int i = 0; i < AXI_EDGE_DOFS; i++) {
    x[i / 2][i % 2] = s->mesh->position[2 * node[i / 2] + i % 2] + m.u[i];
  }
  double volume = axi_edge_volume(x, force, second ? packed : NULL);
  for (int i = 0; second && i < AXI_EDGE_DOFS; i++) {
    for (int j = i; j < AXI_EDGE_DOFS; j++) {
      full[AXI_EDGE_DOFS * i + j] = full[AXI_EDGE_DOFS * j + i] = *at++;
    }
  }
  reduce(&m, force, second ? full : NULL, gradient, second);
  return volume;
}
