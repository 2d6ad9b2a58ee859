#include "solver/verify/inflation.h"

#include <math.h>

const double inflation_inner = 1, inflation_outer = 2;
const struct inflation_shape inflation_cylinder = {2, 1, 1.5};
const struct inflation_shape inflation_sphere = {3, 3, 1};

static void cylinder_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  double r = inflation_inner * pow(inflation_outer / inflation_inner, s[0]),
         angle = 0.5 * M_PI * s[1];
  x[0] = s[1] < 1 ? r * cos(angle) : 0;
  x[1] = r * sin(angle);
  x[2] = s[2];
}

/* The faces x = 1, y = 1, z = 1 of the unit cube, blown up to the sphere. */
static void sphere_map(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  double r = inflation_inner * pow(inflation_outer / inflation_inner, s[0]);
  double y = tan(0.25 * M_PI * s[1]), z = tan(0.25 * M_PI * s[2]);
  double scale = r / sqrt(1 + y * y + z * z);
  x[block] = scale;
  x[(block + 1) % 3] = scale * y;
  x[(block + 2) % 3] = scale * z;
}

enum status inflation_open(struct inflation *c, const struct inflation_shape *shape,
                           const struct material_spec *material, int radial, int around,
                           struct error *error) {
  struct body body = {.blocks = shape->blocks,
                      .cells = {radial, around, shape->power == 3 ? around : 1},
                      .cavity = true,
                      .map = shape->power == 3 ? sphere_map : cylinder_map};
  *c = (struct inflation){.shape = shape, .at = 1};
  if (body_build(&body, &c->body.mesh) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a mesh");
  }
  body_hold(&c->body.mesh, 0, 0, HOLD_X);
  body_hold(&c->body.mesh, 1, 0, HOLD_Y);
  body_hold(&c->body.mesh, shape->power == 3 ? 2 : -1, 0, HOLD_Z);
  enum status status = verify_body_open(&c->body, material, false, error);
  if (status == STATUS_OK) {
    c->volume = shape->volume_scale * model_volume(c->body.model, &c->body.state, NULL);
  }
  return status;
}

enum status inflate(struct verify_run *run, struct inflation *c, double stretch,
                    struct error *error) {
  double from = c->at;
  int steps = (int)ceil(fabs(stretch - from) / 0.1 - 1e-9);
  for (int k = 1; k <= steps; k++) {
    c->at = from + (stretch - from) * k / steps;
    double target = c->volume * pow(c->at, c->shape->power);
    enum status status = newton_inflate(c->body.model, target, c->shape->volume_scale,
                                        &c->body.state, &c->pressure, &run->control);
    if (status != STATUS_OK) {
      return verify_failed(status, "the inflation", error);
    }
  }
  return STATUS_OK;
}
