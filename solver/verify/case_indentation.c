/* Hertz: a rigid sphere in a block that is so large that it is a half space. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/slider.h"

static const double contact_radius = 0.01; /* of the last step; the block has the edge 1 */
static const double sphere_radius = 0.2;

/* Half of the elements share twice the radius of the contact, the others grow away from it. */
static double graded(double s) {
  const double near = 4 * contact_radius;
  return near * s + (1 - near) * pow(fmax(0, 2 * s - 1), 3);
}

/* A quarter of the block, its top z = 0 under the sphere. */
static void quarter_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = graded(s[0]);
  x[1] = graded(s[1]);
  x[2] = -graded(1 - s[2]);
}

/* Radius of the contact from the second moment of the pressure, 2/5 F a^2 for Hertz's
 * half ellipsoid: it takes in all of the profile. */
static double radius_of(const struct fe_model *m, const struct obstacle *o) {
  double force = 0, moment = 0;
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    const struct obstacle_point *point = &o->point[i];
    double share = point->area * point->pressure;
    force += share;
    moment += share * (point->x[0] * point->x[0] + point->x[1] * point->x[1]);
  }
  return sqrt(2.5 * moment / force);
}

static enum status indent(struct verify_run *run, struct verify_body *b, double modulus, int n,
                          struct error *error) {
  const struct rigid_pose pose = {{0, 0, sphere_radius}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  const double depth = contact_radius * contact_radius / sphere_radius, none[3] = {0};
  struct slider slider = {.body = NULL};
  struct rigid_shape *sphere = NULL;
  enum status status = rigid_shape_create_sphere(2 * sphere_radius, &sphere, error);
  if (status == STATUS_OK) {
    /* Small against the depth of the contact, or the pressure reaches beyond its edge. */
    b->model->contact.smoothing = 0.005 * depth;
    status = slider_open(&slider, b, sphere, &pose, 0, run, error);
  }
  if (status == STATUS_OK) {
    status = slider_move(&slider, (double[3]){0, 0, -depth}, none, 2, error);
  }
  if (status == STATUS_OK) {
    double force = 4 * slider.now.normal_force;
    double wanted = 4.0 / 3 * modulus * sqrt(sphere_radius) * pow(depth, 1.5);
    double radius = radius_of(b->model, b->model->obstacle[slider.object]);
    verify_result(run, force / modulus, wanted / modulus, 0);
    verify_row(run, 1.0 / n, force / modulus, run->report.error, b->model,
               "quarter, %d x %d x %d, graded", n, n, n);
    verify_row_other(run, fabs(radius / contact_radius - 1));
  }
  slider_close(&slider);
  rigid_shape_destroy(sphere);
  return status;
}

enum status case_hertz_sphere(struct verify_run *run, struct error *error) {
  static const int cells[] = {8, 10, 12, 14};
  const struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1000};
  double mu = material.c[0], kappa = mu * material.bulk_ratio;
  double modulus = 4 * mu * (3 * kappa + mu) / (3 * kappa + 4 * mu); /* E / (1 - nu^2) */
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < run->refinement && k < 4; k++) {
    int n = cells[k];
    struct body body = {.blocks = 1, .cells = {n, n, n}, .map = quarter_map};
    struct verify_body b = {.model = NULL};
    status = body_build(&body, &b.mesh);
    if (status == STATUS_OK) {
      b.mesh.wall_thickness = contact_radius;
      body_hold(&b.mesh, 0, 0, HOLD_X);
      body_hold(&b.mesh, 1, 0, HOLD_Y);
      body_hold(&b.mesh, 2, -1, HOLD_Z);
      status = verify_body_open(&b, &material, false, error);
    }
    if (status == STATUS_OK) {
      status = indent(run, &b, modulus, n, error);
    }
    verify_body_close(run, &b);
  }
  return status;
}
