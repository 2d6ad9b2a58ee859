/* Manufactured solutions on the unit cube: a displacement field is chosen, the body force that
 * keeps it in equilibrium follows from a stress written out here and not taken from the solver,
 * and the whole boundary is held at the field. The mesh is distorted smoothly. */
#include <math.h>
#include <string.h>
#include "solver/verify/cases.h"

/* Displacement u and deformation gradient f (row-major) at x. */
typedef void field_fn(const double x[3], double u[3], double f[9]);

/* Changes volume: det F from 0.7 to 1.3. */
static void wavy_field(const double x[3], double u[3], double f[9]) {
  static const double amplitude[3] = {0.04, 0.03, 0.025};
  memset(f, 0, 9 * sizeof *f);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    u[i] = amplitude[i] * sin(M_PI * x[i]) * cos(M_PI * x[j]);
    f[3 * i + i] = 1 + amplitude[i] * M_PI * cos(M_PI * x[i]) * cos(M_PI * x[j]);
    f[3 * i + j] = -amplitude[i] * M_PI * sin(M_PI * x[i]) * sin(M_PI * x[j]);
  }
}

/* Keeps volume: three simple shears, one after the other, each moving component i by a wave along
 * component i + 1. */
static void sheared_field(const double x[3], double u[3], double f[9]) {
  static const double amplitude[3] = {0.12, 0.1, 0.08};
  static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double y[3] = {x[0], x[1], x[2]};
  memcpy(f, unit, sizeof unit);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    double slope = amplitude[i] * M_PI * cos(M_PI * y[j]);
    y[i] += amplitude[i] * sin(M_PI * y[j]);
    for (int k = 0; k < 3; k++) {
      f[3 * i + k] += slope * f[3 * j + k];
    }
  }
  for (int i = 0; i < 3; i++) {
    u[i] = y[i] - x[i];
  }
}

struct manufactured {
  field_fn *field;
  double shear, bulk;
};

/* Neo-Hooke: P = mu J^(-2/3) (F - I1/3 F^-T) + kappa (J - 1) J F^-T. */
static void stress_at(const struct manufactured *c, const double x[3], double p[9]) {
  double u[3], f[9], cofactor[9], i1 = 0;
  c->field(x, u, f);
  for (int i = 0; i < 3; i++) {
    const double *a = f + 3 * ((i + 1) % 3), *b = f + 3 * ((i + 2) % 3);
    for (int k = 0; k < 3; k++) {
      int l = (k + 1) % 3, m = (k + 2) % 3;
      cofactor[3 * i + k] = a[l] * b[m] - a[m] * b[l];
      i1 += f[3 * i + k] * f[3 * i + k];
    }
  }
  double j = f[0] * cofactor[0] + f[1] * cofactor[1] + f[2] * cofactor[2];
  double scale = c->shear * pow(j, -2.0 / 3);
  for (int k = 0; k < 9; k++) {
    p[k] = scale * (f[k] - i1 / (3 * j) * cofactor[k]) + c->bulk * (j - 1) * cofactor[k];
  }
}

/* -Div P by central differences of fourth order. */
static void body_force(const struct manufactured *c, const double x[3], double b[3]) {
  static const double weight[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};
  static const double at[4] = {-2, -1, 1, 2};
  const double h = 2e-3;
  memset(b, 0, 3 * sizeof *b);
  for (int d = 0; d < 3; d++) {
    for (int k = 0; k < 4; k++) {
      double y[3] = {x[0], x[1], x[2]}, p[9];
      y[d] += at[k] * h;
      stress_at(c, y, p);
      for (int i = 0; i < 3; i++) {
        b[i] -= weight[k] / h * p[3 * i + d];
      }
    }
  }
}

/* The inside of the cube is pushed along, its surface stays. */
static void bulged(const void *context, int block, const double s[3], double x[3]) {
  static const double push[3] = {0.02, -0.016, 0.024};
  double hill = sin(M_PI * s[0]) * sin(M_PI * s[1]) * sin(M_PI * s[2]);
  (void)context;
  (void)block;
  for (int i = 0; i < 3; i++) {
    x[i] = s[i] + push[i] * hill;
  }
}

/* Place of the point with shape functions n in element e. */
static void element_point(const struct mesh *mesh, int e, const double *n, double x[3]) {
  memset(x, 0, 3 * sizeof *x);
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      x[i] += n[a] * mesh->x[3 * mesh->element_nodes[HEX27_NODES * e + a] + i];
    }
  }
}

static void add_body_force(const struct manufactured *c, struct fe_model *m) {
  for (int e = 0; e < m->mesh->element_count; e++) {
    for (int q = 0; q < HEX27_POINTS; q++) {
      double n[HEX27_NODES], x[3], b[3];
      hex27_shape(m->hex27.point[q], n, NULL);
      element_point(m->mesh, e, n, x);
      body_force(c, x, b);
      for (int a = 0; a < HEX27_NODES; a++) {
        for (int i = 0; i < 3; i++) {
          m->dead_load[3 * m->mesh->element_nodes[HEX27_NODES * e + a] + i] +=
              m->geometry[e].weight[q] * n[a] * b[i];
        }
      }
    }
  }
}

/* Squares of the error and of the exact field at one point: [0], [1] values, [2], [3] gradients. */
static void add_squares(const struct manufactured *c, const struct verify_body *b, int e,
                        const double xi[3], double weight, double sum[4]) {
  const int *nodes = b->mesh.element_nodes + HEX27_NODES * e;
  double n[HEX27_NODES], dn[3][HEX27_NODES], x[3], u[3], f[9];
  double value[3] = {0}, slope[9] = {0};
  struct kinematics map = {.j = 0}; /* d x / d xi */
  hex27_shape(xi, n, dn);
  element_point(&b->mesh, e, n, x);
  c->field(x, u, f);
  for (int a = 0; a < HEX27_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      value[i] += n[a] * b->state.u[3 * nodes[a] + i];
      for (int d = 0; d < 3; d++) {
        map.f[3 * i + d] += dn[d][a] * b->mesh.x[3 * nodes[a] + i];
        slope[3 * i + d] += dn[d][a] * b->state.u[3 * nodes[a] + i];
      }
    }
  }
  weight *= kinematics_complete(&map);
  for (int i = 0; i < 3; i++) {
    sum[0] += weight * (value[i] - u[i]) * (value[i] - u[i]);
    sum[1] += weight * u[i] * u[i];
    for (int k = 0; k < 3; k++) {
      double exact = f[3 * i + k] - (i == k), computed = 0;
      for (int d = 0; d < 3; d++) {
        computed += slope[3 * i + d] * map.cofactor[3 * k + d];
      }
      sum[2] += weight * (computed - exact) * (computed - exact);
      sum[3] += weight * exact * exact;
    }
  }
}

/* Relative errors in L2 and in the H1 seminorm, with four Gauss points a direction: none of them
 * is one at which the element is better than elsewhere. */
static void field_errors(const struct manufactured *c, const struct verify_body *b, double *l2,
                         double *h1) {
  static const double at[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                               0.861136311594052575};
  static const double weight[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                   0.347854845137453857};
  double sum[4] = {0};
  for (int e = 0; e < b->mesh.element_count; e++) {
    for (int q = 0; q < 64; q++) {
      double xi[3] = {at[q / 16], at[q / 4 % 4], at[q % 4]};
      add_squares(c, b, e, xi, weight[q / 16] * weight[q / 4 % 4] * weight[q % 4], sum);
    }
  }
  *l2 = sqrt(sum[0] / sum[1]);
  *h1 = sqrt(sum[2] / sum[3]);
}

static enum status solve_cube(struct verify_run *run, const struct manufactured *c, int n,
                              struct error *error) {
  struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {c->shear}, .bulk_ratio = c->bulk / c->shear};
  struct body body = {.blocks = 1, .cells = {n, n, n}, .map = bulged};
  struct verify_body b = {.model = NULL};
  enum status status = body_build(&body, &b.mesh);
  for (int axis = 0; status == STATUS_OK && axis < 3; axis++) {
    body_hold(&b.mesh, axis, 0, HOLD_ALL);
    body_hold(&b.mesh, axis, 1, HOLD_ALL);
  }
  if (status == STATUS_OK) {
    status = verify_body_open(&b, &material, false, error);
  }
  if (status == STATUS_OK) {
    for (int k = 0; k < b.mesh.node_count; k++) {
      double f[9];
      c->field(b.mesh.x + 3 * k, b.state.u + 3 * k, f);
    }
    add_body_force(c, b.model);
    struct fe_load load = {0, 0, 1};
    status = newton_solve(b.model, &load, &b.state, &run->control);
    if (status == STATUS_OK) {
      double l2, h1;
      field_errors(c, &b, &l2, &h1);
      verify_row(run, 1.0 / n, l2, l2, b.model, "%d x %d x %d", n, n, n);
      verify_row_other(run, h1);
    } else {
      verify_failed(status, "the manufactured solution", error);
    }
  }
  verify_body_close(run, &b);
  return status;
}

/* A rate needs two meshes: one more than the refinement says. */
static enum status rate_case(struct verify_run *run, const struct manufactured *c,
                             struct error *error) {
  static const int cells[] = {2, 4, 6, 8, 12};
  enum status status = STATUS_OK;
  run->control.tolerance = 1e-11;
  for (int k = 0; status == STATUS_OK && k <= run->refinement && k < 5; k++) {
    status = solve_cube(run, c, cells[k], error);
  }
  if (status == STATUS_OK) {
    int last = run->report.row_count;
    struct verify_row *fine = &run->report.row[last - 1], *coarse = fine - 1;
    verify_result(run, verify_order(run, last - 2, last), 3, 0);
    verify_metric(run, "h1_order",
                  log(coarse->other / fine->other) / log(coarse->size / fine->size));
  }
  return status;
}

enum status case_manufactured(struct verify_run *run, struct error *error) {
  return rate_case(run, &(struct manufactured){wavy_field, 1, 1}, error);
}

enum status case_manufactured_incompressible(struct verify_run *run, struct error *error) {
  return rate_case(run, &(struct manufactured){sheared_field, 1, 1000}, error);
}
