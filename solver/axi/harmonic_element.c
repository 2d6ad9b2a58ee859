#include <math.h>
#include <string.h>
#include "solver/axi/harmonic_internal.h"
#include "solver/fe/hyperelastic.h"

enum { LINEAR = 3 };

/* Components of F, row-major in the order r, t, z. */
enum { RR, RT, RZ, TR, TT, TZ, ZR, ZT, ZZ };

/* Rows of the gradient of the perturbation that a node's (u_r, u_z, u_t) enter:
 *   dF_rR = u_r,R  dF_rZ = u_r,Z  dF_zR = u_z,R  dF_zZ = u_z,Z  dF_tT = (u_r + n u_t)/R  (cos)
 *   dF_rT = -(n u_r + u_t)/R  dF_zT = -n u_z/R  dF_tR = u_t,R  dF_tZ = u_t,Z             (sin) */
static void gradient(const struct axi_point *p, int n, double g[9][HARMONIC_ELEMENT]) {
  memset(g, 0, sizeof(double[9][HARMONIC_ELEMENT]));
  for (int a = 0; a < AXI_NODES; a++) {
    double hoop = p->n[a] / p->radius;
    int r = HARMONIC_PARTS * a, z = r + 1, t = r + 2;
    g[RR][r] = g[ZR][z] = g[TR][t] = p->dr[a];
    g[RZ][r] = g[ZZ][z] = g[TZ][t] = p->dz[a];
    g[TT][r] = hoop;
    g[TT][t] = n * hoop;
    g[RT][r] = g[ZT][z] = -n * hoop;
    g[RT][t] = -hoop;
  }
}

/* Adds w g^T A g to the upper triangle. Few rows of g belong to a component. */
static void add_tangent(const double tangent[81], double g[9][HARMONIC_ELEMENT], double weight,
                        double *form) {
  for (int i = 0; i < HARMONIC_ELEMENT; i++) {
    double row[9] = {0};
    for (int p = 0; p < 9; p++) {
      double factor = weight * g[p][i];
      for (int q = 0; q < 9 && factor != 0; q++) {
        row[q] += factor * tangent[9 * p + q];
      }
    }
    for (int q = 0; q < 9; q++) {
      for (int j = i; j < HARMONIC_ELEMENT && row[q] != 0; j++) {
        form[HARMONIC_ELEMENT * i + j] += row[q] * g[q][j];
      }
    }
  }
}

/* Adds pressure times the second derivative of J, J (G_iJ G_kL - G_iL G_kJ), G = F^-T, and the
 * local bulk modulus times the square of the first one. */
static void add_volumetric(const struct kinematics *k, double pressure, double local,
                           double tangent[81]) {
  const double *g = k->cofactor;
  for (int p = 0; p < 9; p++) {
    for (int q = 0; q < 9; q++) {
      int i = p / 3, j = p % 3, m = q / 3, l = q % 3;
      tangent[9 * p + q] += pressure * k->j * (g[p] * g[q] - g[3 * i + l] * g[3 * m + j]) +
                            local * k->j * k->j * g[p] * g[q];
    }
  }
}

/* Adds the volumetric part to the upper triangle: kappa times the square of the projection of the
 * change of J. */
static void add_projection(const struct axi_geometry *geometry, double weight,
                           double dilatation[LINEAR][HARMONIC_ELEMENT], double *form) {
  for (int i = 0; i < HARMONIC_ELEMENT; i++) {
    double parameter[LINEAR] = {0};
    for (int a = 0; a < LINEAR; a++) {
      for (int b = 0; b < LINEAR; b++) {
        parameter[a] += weight * geometry->inverse[LINEAR * a + b] * dilatation[b][i];
      }
    }
    for (int j = i; j < HARMONIC_ELEMENT; j++) {
      for (int a = 0; a < LINEAR; a++) {
        form[HARMONIC_ELEMENT * i + j] += parameter[a] * dilatation[a][j];
      }
    }
  }
}

bool harmonic_element(const struct axi_mesh *mesh, const struct axi_geometry *geometry, int element,
                      const double *u, int n, double form[HARMONIC_ELEMENT * HARMONIC_ELEMENT]) {
  const struct axi_element *e = &mesh->element[element];
  const struct material_spec *material = &mesh->region[e->region];
  struct axi_bulk bulk = axi_bulk_parts(material);
  double around = n == 0 ? 1 : 0.5; /* mean of cos^2 */
  double local[AXI_DOFS], parameter[LINEAR], dilatation[LINEAR][HARMONIC_ELEMENT] = {{0}};
  memset(form, 0, sizeof *form * HARMONIC_ELEMENT * HARMONIC_ELEMENT);
  for (int i = 0; i < AXI_DOFS; i++) {
    local[i] = u[2 * e->node[i / 2] + i % 2];
  }
  axi_element_pressure(geometry, material, local, parameter);
  for (int q = 0; q < AXI_POINTS; q++) {
    const struct axi_point *p = &geometry->point[q];
    struct kinematics k;
    double g[9][HARMONIC_ELEMENT], stress[9], tangent[81], pressure = 0;
    axi_deformation(p, local, k.f);
    if (!(kinematics_complete(&k) > 0)) {
      return false;
    }
    for (int a = 0; a < LINEAR; a++) {
      pressure += parameter[a] * p->psi[a];
    }
    gradient(p, n, g);
    hyperelastic_isochoric(material, &k, stress, tangent);
    add_volumetric(&k, pressure + bulk.local * (k.j - 1), bulk.local, tangent);
    add_tangent(tangent, g, around * p->weight, form);
    for (int i = 0; i < HARMONIC_ELEMENT; i++) {
      double change = 0; /* of J */
      for (int c = 0; c < 9; c++) {
        change += k.j * k.cofactor[c] * g[c][i];
      }
      for (int a = 0; a < LINEAR; a++) {
        dilatation[a][i] += p->weight * p->psi[a] * change;
      }
    }
  }
  add_projection(geometry, around * bulk.projected, dilatation, form);
  for (int i = 0; i < HARMONIC_ELEMENT; i++) {
    for (int j = 0; j < i; j++) {
      form[HARMONIC_ELEMENT * i + j] = form[HARMONIC_ELEMENT * j + i];
    }
  }
  return true;
}

static const double gauss_at[AXI_EDGE_POINTS] = {-0.774596669241483377, 0, 0.774596669241483377};
static const double gauss_weight[AXI_EDGE_POINTS] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/* With x = (r + a) e_r + b e_t and z + c on the deformed surface, the volume is the integral of
 * half of (x dy - y dx) dz, and its part of second order in a cos, b sin, c cos is, around the
 * axis (pi, for n = 0 twice that),
 *   pi/2 int [ z' (a^2 + 2 n a b + b^2) + c' r (2 a + n b) + n c (r b' - r' b) ] ds.
 * The cavity is on the right of the way along s, so that V counts negative along it. */
void harmonic_edge(const struct axi_mesh *mesh, int edge, const double *u, double pressure, int n,
                   double form[HARMONIC_EDGE * HARMONIC_EDGE]) {
  const int *node = mesh->inner[edge].node;
  memset(form, 0, sizeof *form * HARMONIC_EDGE * HARMONIC_EDGE);
  for (int q = 0; q < AXI_EDGE_POINTS; q++) {
    double value[3], slope[3], r = 0, dr = 0, dz = 0;
    axi_edge_shape(gauss_at[q], value, slope);
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      const double *x = mesh->position + 2 * node[a], *d = u + 2 * node[a];
      r += value[a] * (x[0] + d[0]);
      dr += slope[a] * (x[0] + d[0]);
      dz += slope[a] * (x[1] + d[1]);
    }
    double weight = pressure * (n == 0 ? M_PI : M_PI / 2) * gauss_weight[q];
    for (int i = 0; i < AXI_EDGE_NODES; i++) {
      for (int j = 0; j < AXI_EDGE_NODES; j++) {
        double block[3][3] = {{0}}; /* of i and j: twice the symmetric part of the integrand */
        block[0][0] = 2 * dz * value[i] * value[j];
        block[2][2] = block[0][0];
        block[0][2] = block[2][0] = n * block[0][0];
        block[0][1] = 2 * r * value[i] * slope[j];
        block[1][0] = 2 * r * slope[i] * value[j];
        block[1][2] = n * (r * slope[i] * value[j] + value[i] * (r * slope[j] - dr * value[j]));
        block[2][1] = n * (r * slope[j] * value[i] + value[j] * (r * slope[i] - dr * value[i]));
        for (int p = 0; p < 9; p++) {
          form[HARMONIC_EDGE * (3 * i + p / 3) + 3 * j + p % 3] += weight * block[p / 3][p % 3];
        }
      }
    }
  }
}

void harmonic_touch(const struct harmonic_touch *touch, int n, double *form) {
  int width = HARMONIC_PARTS * touch->count;
  double gap[HARMONIC_TOUCH] = {0}, stiffness = (n == 0 ? 1 : 0.5) * touch->stiffness;
  for (int i = 0; i < touch->count; i++) {
    gap[HARMONIC_PARTS * i] = touch->weight[i][0];
    gap[HARMONIC_PARTS * i + 1] = touch->weight[i][1];
  }
  for (int i = 0; i < width; i++) {
    for (int j = 0; j < width; j++) {
      form[width * i + j] = stiffness * gap[i] * gap[j];
    }
  }
}

/* A tangent over (r, z) of the nodes, upper triangle by rows over `room` nodes of which `count` are
 * used, becomes a form over all components. */
static void unpack(const double *packed, int room, int count, double factor, double *form) {
  int width = HARMONIC_PARTS * count;
  memset(form, 0, sizeof *form * (size_t)width * (size_t)width);
  for (int i = 0; i < 2 * room; i++) {
    for (int j = i; j < 2 * room; j++, packed++) {
      int row = HARMONIC_PARTS * (i / 2) + i % 2, column = HARMONIC_PARTS * (j / 2) + j % 2;
      if (j < 2 * count) {
        form[width * row + column] = form[width * column + row] = factor * *packed;
      }
    }
  }
}

void harmonic_contact(const struct axi_touch *touch, int n, double *form) {
  int count = touch->master < 0 ? AXI_EDGE_NODES : TOUCH_NODES;
  unpack(touch->packed, TOUCH_NODES, count, n == 0 ? 1 : 0.5, form);
}

bool harmonic_skin(const struct axi_mesh *mesh, const struct axi_turning *turning, const double *u,
                   int n, double *form) {
  double x[SKIN_NODES][2], energy, force[SKIN_DOFS], packed[SKIN_PACKED];
  for (int i = 0; i < 2 * turning->count; i++) {
    int at = 2 * turning->node[i / 2] + i % 2;
    x[i / 2][i % 2] = mesh->position[at] + u[at];
  }
  if (!axi_skin_evaluate(turning, x, &energy, force, packed)) {
    return false;
  }
  unpack(packed, turning->count, turning->count, n == 0 ? 1 : 0.5, form);
  return true;
}
