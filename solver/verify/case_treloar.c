/* Treloar's (1944) measurements on vulcanised rubber against the finite elements with the
 * constants that Ogden (1972) fitted to them. The loads are dead tractions on a cube. */
#include <math.h>
#include <string.h>
#include "solver/verify/cases.h"

static const double kgf_per_cm2 = 0.0980665; /* MPa */

struct measurement {
  double stretch, stress; /* nominal, kgf/cm2 */
};

static const struct measurement uniaxial[] = {
    {1.02, 0.26}, {1.125, 1.37}, {1.24, 2.30}, {1.39, 3.23}, {1.585, 4.16}, {1.90, 5.10},
    {2.18, 6.00}, {2.42, 6.90},  {3.02, 8.80}, {3.57, 10.7}, {4.03, 12.5},  {4.76, 16.2},
    {5.36, 19.9}, {5.75, 23.6},  {6.15, 27.4}, {6.40, 31.0}, {6.60, 34.8},  {6.85, 38.5},
    {7.05, 42.1}, {7.15, 45.8},  {7.25, 49.6}, {7.40, 53.3}, {7.50, 57.0},  {7.60, 64.4},
};

static const struct measurement equibiaxial[] = {
    {1.03, 0.95}, {1.07, 1.60}, {1.12, 2.42}, {1.14, 2.62}, {1.20, 3.32}, {1.31, 4.43},
    {1.42, 5.18}, {1.68, 6.60}, {1.94, 7.78}, {2.49, 9.79}, {3.03, 12.6}, {3.43, 14.7},
    {3.75, 17.4}, {4.07, 20.1}, {4.26, 22.5}, {4.45, 24.7},
};

struct tension {
  const struct measurement *data;
  int count;
  bool both; /* equibiaxial */
};

/* mu (kgf/cm2) and alpha; kappa/mu so large that the volume stays. */
static struct material_spec ogden(void) {
  struct material_spec m = {.model = MATERIAL_OGDEN,
                            .terms = 3,
                            .c = {6.3, 0.012, -0.1},
                            .alpha = {1.3, 5, -2},
                            .bulk_ratio = 1e6};
  for (int i = 0; i < m.terms; i++) {
    m.c[i] *= kgf_per_cm2;
  }
  return m;
}

/* Nominal stress of the incompressible material: sum mu_i (l^(a_i - 1) - l^(-k a_i - 1)), k = 1/2
 * in uniaxial and 2 in equibiaxial tension. */
static double closed_form(const struct material_spec *m, const struct tension *t, double l) {
  double stress = 0, k = t->both ? 2 : 0.5;
  for (int i = 0; i < m->terms; i++) {
    stress += m->c[i] * (pow(l, m->alpha[i] - 1) - pow(l, -k * m->alpha[i] - 1));
  }
  return stress;
}

static void cube_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  memcpy(x, s, 3 * sizeof *x);
}

/* Stretches the cube to every measured stretch, in steps of at most a fifth. */
static enum status stretch(struct verify_run *run, struct verify_body *b, const struct tension *t,
                           struct error *error) {
  int equation = b->model->equation[3 * body_node(&b->mesh, 1, 0, 0)];
  double at = 1, stress = 0;
  verify_points_clear(run);
  for (int k = 0; k < t->count; k++) {
    double goal = t->data[k].stretch;
    int steps = (int)ceil((goal - at) / 0.2);
    for (int i = 1; i <= steps; i++) {
      double target = at + (goal - at) * i / steps - 1;
      enum status status =
          newton_reach(b->model, equation, target, &b->state, &stress, &run->control);
      if (status != STATUS_OK) {
        return verify_failed(status, "the stretching", error);
      }
    }
    at = goal;
    verify_point(run, goal, stress, kgf_per_cm2 * t->data[k].stress);
  }
  return STATUS_OK;
}

/* Ogden's three terms leave the measurements when the chains are almost straight; he shows them up
 * to here. */
static const double fit_limit = 7;

/* Root mean square of the deviation over that of the measured stresses, up to a stretch. */
static double deviation(const struct verify_report *r, double limit) {
  double sum = 0, size = 0;
  for (int i = 0; i < r->point_count; i++) {
    const struct verify_point *p = &r->point[i];
    if (p->x <= limit) {
      sum += (p->computed - p->reference) * (p->computed - p->reference);
      size += p->reference * p->reference;
    }
  }
  return sqrt(sum / size);
}

/* Against the measurements, and against the closed form as a second reference. */
static void compare(struct verify_run *run, const struct material_spec *m, const struct tension *t,
                    double *closed) {
  struct verify_report *r = &run->report;
  *closed = 0;
  for (int i = 0; i < r->point_count; i++) {
    const struct verify_point *p = &r->point[i];
    *closed = fmax(*closed, fabs(p->computed / closed_form(m, t, p->x) - 1));
    if (p->x <= fit_limit) {
      verify_result(run, p->computed, p->reference, 0);
    }
  }
  r->error = deviation(r, fit_limit);
}

static enum status tension_case(struct verify_run *run, const struct tension *t,
                                struct error *error) {
  struct material_spec material = ogden();
  double closed = 0;
  enum status status = STATUS_OK;
  run->control.tolerance = 1e-10;
  for (int n = 1; status == STATUS_OK && n <= run->refinement; n++) {
    struct body body = {.blocks = 1, .cells = {n, n, n}, .map = cube_map};
    struct verify_body b = {.model = NULL};
    status = body_build(&body, &b.mesh);
    if (status == STATUS_OK) {
      body_hold(&b.mesh, 0, 0, HOLD_X);
      body_hold(&b.mesh, 1, 0, HOLD_Y);
      body_hold(&b.mesh, 2, 0, HOLD_Z);
      status = verify_body_open(&b, &material, false, error);
    }
    if (status == STATUS_OK) {
      body_add_traction(b.model, 0, 1, (double[3]){1, 0, 0});
      if (t->both) {
        body_add_traction(b.model, 1, 1, (double[3]){0, 1, 0});
      }
      status = stretch(run, &b, t, error);
    }
    if (status == STATUS_OK) {
      compare(run, &material, t, &closed);
      verify_row(run, 1.0 / n, run->report.computed, run->report.error, b.model, "%d x %d x %d", n,
                 n, n);
    }
    verify_body_close(run, &b);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "closed_form_error_percent", 100 * closed);
    verify_metric(run, "all_points_error_percent", 100 * deviation(&run->report, INFINITY));
  }
  return status;
}

enum status case_treloar_uniaxial(struct verify_run *run, struct error *error) {
  return tension_case(run, &(struct tension){uniaxial, sizeof uniaxial / sizeof *uniaxial, false},
                      error);
}

enum status case_treloar_equibiaxial(struct verify_run *run, struct error *error) {
  return tension_case(
      run, &(struct tension){equibiaxial, sizeof equibiaxial / sizeof *equibiaxial, true}, error);
}
