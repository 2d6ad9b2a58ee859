/* Thick cylinder and sphere under inner pressure, A = 1, B = 2: pressure against inner stretch.
 *
 * The incompressible solution is p = integral over the stretch l, from the outer to the inner one,
 * of W'(l) / (l^n - 1), n = 2 for the cylinder and 3 for the sphere, W'(l) of the homogeneous
 * deformation with hoop stretch l. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/inflation.h"

/* ---- the incompressible solution ---- */

static double outer_stretch(const struct inflation_shape *shape, double stretch) {
  double ratio = pow(inflation_inner / inflation_outer, shape->power);
  return pow((pow(stretch, shape->power) - 1) * ratio + 1, 1.0 / shape->power);
}

/* dW/dl over l^n - 1; the neo-Hookean solid is a Yeoh solid with c[0] = mu/2. */
static double integrand(const struct inflation_shape *shape, const struct material_spec *m,
                        double l) {
  double i1 = shape->power == 2 ? l * l + 1 / (l * l) + 1 : 2 * l * l + pow(l, -4);
  double slope = shape->power == 2 ? 2 * l - 2 * pow(l, -3) : 4 * l - 4 * pow(l, -5);
  double x = i1 - 3;
  double w1 =
      m->model == MATERIAL_NEO_HOOKE ? m->c[0] / 2 : m->c[0] + x * (2 * m->c[1] + 3 * m->c[2] * x);
  return w1 * slope / (pow(l, shape->power) - 1);
}

static double gauss3(const struct inflation_shape *shape, const struct material_spec *m, double a,
                     double b) {
  double middle = 0.5 * (a + b), half = 0.5 * (b - a), d = sqrt(0.6) * half;
  return half / 9 *
         (5 * integrand(shape, m, middle - d) + 8 * integrand(shape, m, middle) +
          5 * integrand(shape, m, middle + d));
}

/* Adaptive quadrature: halves until three Gauss points agree with six. */
static double integrate(const struct inflation_shape *shape, const struct material_spec *m,
                        double a, double b, double tolerance, int depth) {
  double middle = 0.5 * (a + b), whole = gauss3(shape, m, a, b);
  double parts = gauss3(shape, m, a, middle) + gauss3(shape, m, middle, b);
  if (fabs(whole - parts) < tolerance || depth == 0) {
    return parts;
  }
  return integrate(shape, m, a, middle, tolerance, depth - 1) +
         integrate(shape, m, middle, b, tolerance, depth - 1);
}

static double quadrature(const struct inflation_shape *shape, const struct material_spec *m,
                         double a) {
  return integrate(shape, m, outer_stretch(shape, a), a, 1e-13 * m->c[0], 30);
}

static double neo_hooke(const struct inflation_shape *shape, double a) {
  double b = outer_stretch(shape, a);
  return shape->power == 2 ? log(a / b) + (1 / (b * b) - 1 / (a * a)) / 2
                           : 2 / b + 1 / (2 * pow(b, 4)) - 2 / a - 1 / (2 * pow(a, 4));
}

/* Stretch between a and b at which the pressure is largest (sign 1) or smallest (sign -1). */
static double extremum(const struct inflation_shape *shape, const struct material_spec *m, double a,
                       double b, double sign) {
  const double golden = 0.5 * (sqrt(5) - 1);
  for (int k = 0; k < 60; k++) {
    double c = b - golden * (b - a), d = a + golden * (b - a);
    if (sign * quadrature(shape, m, c) > sign * quadrature(shape, m, d)) {
      b = d;
    } else {
      a = c;
    }
  }
  return 0.5 * (a + b);
}

/* Inflates to every stretch; the points become those of this mesh. */
static enum status inflate_curve(struct verify_run *run, const struct inflation_shape *shape,
                                 const struct material_spec *material, int n,
                                 const double *stretches, int count, struct error *error) {
  struct inflation c;
  enum status status = inflation_open(&c, shape, material, n, n, error);
  verify_points_clear(run);
  for (int k = 0; status == STATUS_OK && k < count; k++) {
    status = inflate(run, &c, stretches[k], error);
    if (status == STATUS_OK) {
      verify_point(run, stretches[k], c.pressure, quadrature(shape, material, stretches[k]));
    }
  }
  if (status == STATUS_OK) {
    const struct verify_point *last = &run->report.point[run->report.point_count - 1];
    verify_result(run, last->computed, last->reference, 0);
    verify_row(run, 1.0 / n, last->computed, run->report.error, c.body.model,
               "%d through the wall, %d around%s", n, n, shape->power == 3 ? ", 3 blocks" : "");
  }
  verify_body_close(run, &c.body);
  return status;
}

/* Elements through the wall; a sphere has the square of that many around. */
static int elements(const struct inflation_shape *shape, int level) {
  static const int around[2][4] = {{2, 4, 8, 16}, {2, 3, 4, 6}};
  return around[shape->power == 3][level];
}

static enum status curve_case(struct verify_run *run, const struct inflation_shape *shape,
                              const struct material_spec *material, const double *stretches,
                              int count, struct error *error) {
  run->control.tolerance = 1e-10;
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement && level < 4; level++) {
    status = inflate_curve(run, shape, material, elements(shape, level), stretches, count, error);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

/* ---- cases ---- */

static const double nearly_rigid_volume = 1e6; /* kappa/mu: the reference is incompressible */

static enum status neo_hooke_case(struct verify_run *run, const struct inflation_shape *shape,
                                  struct error *error) {
  static const double stretches[4] = {1.1, 1.25, 1.5, 2.0};
  struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = nearly_rigid_volume};
  double difference = 0;
  for (int k = 0; k < 4; k++) {
    double closed = neo_hooke(shape, stretches[k]);
    difference = fmax(difference, fabs(quadrature(shape, &material, stretches[k]) / closed - 1));
  }
  verify_metric(run, "closed_form_against_quadrature_percent", 100 * difference);
  return curve_case(run, shape, &material, stretches, 4, error);
}

enum status case_cylinder_neo_hooke(struct verify_run *run, struct error *error) {
  return neo_hooke_case(run, &inflation_cylinder, error);
}

enum status case_sphere_neo_hooke(struct verify_run *run, struct error *error) {
  return neo_hooke_case(run, &inflation_sphere, error);
}

/* Elastosil M4601, in units of its first coefficient's MPa. */
static const struct material_spec elastosil = {
    .model = MATERIAL_YEOH, .terms = 2, .c = {0.11, 0.02}, .bulk_ratio = nearly_rigid_volume};

static enum status yeoh_case(struct verify_run *run, const struct inflation_shape *shape,
                             struct error *error) {
  double stretches[10];
  for (int k = 0; k < 10; k++) {
    stretches[k] = 1.1 + 0.1 * k;
  }
  return curve_case(run, shape, &elastosil, stretches, 10, error);
}

enum status case_cylinder_yeoh(struct verify_run *run, struct error *error) {
  return yeoh_case(run, &inflation_cylinder, error);
}

enum status case_sphere_yeoh(struct verify_run *run, struct error *error) {
  return yeoh_case(run, &inflation_sphere, error);
}

/* Elastic 50A softens and stiffens again: the pressure has a largest and then a smallest value. */
static const struct material_spec softening = {.model = MATERIAL_YEOH,
                                               .terms = 3,
                                               .c = {0.25, -0.05, 0.005},
                                               .bulk_ratio = nearly_rigid_volume};

/* Stretches at equal distances up to `farthest`, the last two replaced by the limit points. */
enum { CURVE = 48 };
static void curve_stretches(double farthest, const double limit[2], double stretches[CURVE]) {
  for (int k = 0; k < CURVE; k++) {
    stretches[k] = 1 + (farthest - 1) * (k + 1) / (CURVE - 2);
  }
  for (int i = 0; i < 2; i++) {
    int k = CURVE - 2 + i;
    for (stretches[k] = limit[i]; k > 0 && stretches[k - 1] > stretches[k]; k--) {
      double swap = stretches[k];
      stretches[k] = stretches[k - 1];
      stretches[k - 1] = swap;
    }
  }
}

/* The largest pressure of the points and the smallest one behind it. */
static void limit_points(const struct verify_report *r, double limit[2]) {
  int top = 0;
  while (top + 1 < r->point_count && r->point[top + 1].computed > r->point[top].computed) {
    top++;
  }
  limit[0] = r->point[top].computed;
  limit[1] = limit[0];
  for (int k = top; k < r->point_count; k++) {
    limit[1] = fmin(limit[1], r->point[k].computed);
  }
}

static enum status limit_case(struct verify_run *run, const struct inflation_shape *shape,
                              double farthest, struct error *error) {
  double stretches[CURVE], found[2] = {NAN, NAN};
  double at[2] = {extremum(shape, &softening, 1.05, 1.9, 1), 0};
  at[1] = extremum(shape, &softening, at[0], farthest, -1);
  double exact[2] = {quadrature(shape, &softening, at[0]), quadrature(shape, &softening, at[1])};
  curve_stretches(farthest, at, stretches);
  run->control.tolerance = 1e-8;
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement && level < 4; level++) {
    int n = elements(shape, level);
    status = inflate_curve(run, shape, &softening, n, stretches, CURVE, error);
    if (status == STATUS_OK) {
      struct verify_row *row = &run->report.row[run->report.row_count - 1];
      limit_points(&run->report, found);
      verify_result(run, found[0], exact[0], 0);
      row->computed = found[0];
      row->error = run->report.error;
      verify_row_other(run, fabs(found[1] / exact[1] - 1));
    }
  }
  if (status == STATUS_OK) {
    verify_metric(run, "lower_limit_pressure_MPa", found[1]);
    verify_metric(run, "lower_limit_error_percent", 100 * fabs(found[1] / exact[1] - 1));
    verify_metric(run, "upper_limit_stretch", at[0]);
    verify_metric(run, "lower_limit_stretch", at[1]);
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

enum status case_cylinder_limit_point(struct verify_run *run, struct error *error) {
  return limit_case(run, &inflation_cylinder, 3.1, error);
}

enum status case_sphere_limit_point(struct verify_run *run, struct error *error) {
  return limit_case(run, &inflation_sphere, 2.5, error);
}
