#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/shape_internal.h"

enum status rigid_shape_allocate(enum rigid_kind kind, struct rigid_shape **shape,
                                 struct error *error) {
  *shape = calloc(1, sizeof **shape);
  if (!*shape) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a rigid object");
  }
  (*shape)->kind = kind;
  return STATUS_OK;
}

void rigid_shape_destroy(struct rigid_shape *shape) {
  if (shape) {
    meridian_release(&shape->meridian);
    surface_release(&shape->surface);
    free(shape);
  }
}

enum rigid_kind rigid_shape_kind(const struct rigid_shape *shape) {
  return shape->kind;
}

static bool nearest_plane(const double x[3], double reach, struct rigid_nearest *nearest) {
  if (!(x[2] <= reach)) {
    return false;
  }
  *nearest = (struct rigid_nearest){.distance = x[2], .normal = {0, 0, 1}};
  return true;
}

static bool nearest_sphere(double radius, const double x[3], double reach,
                           struct rigid_nearest *nearest) {
  double rho = vec3_norm(x);
  if (!(rho - radius <= reach)) {
    return false;
  }
  *nearest = (struct rigid_nearest){.distance = rho - radius, .normal = {0, 0, 1}};
  if (rho < 1e-300) {
    return true;
  }
  for (int i = 0; i < 3; i++) {
    nearest->normal[i] = x[i] / rho;
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      nearest->curvature[i][j] = ((i == j) - nearest->normal[i] * nearest->normal[j]) / rho;
    }
  }
  return true;
}

bool rigid_shape_nearest(const struct rigid_shape *shape, const double x[3], double reach,
                         struct rigid_nearest *nearest) {
  switch (shape->kind) {
  case RIGID_PLANE:
    return nearest_plane(x, reach, nearest);
  case RIGID_SPHERE:
    return nearest_sphere(shape->radius, x, reach, nearest);
  case RIGID_BOX:
    return box_nearest(&shape->box, x, reach, nearest);
  case RIGID_SURFACE:
    return surface_nearest(&shape->surface, x, reach, nearest);
  default:
    return meridian_nearest(&shape->meridian, x, reach, nearest);
  }
}

bool rigid_shape_nearest_posed(const struct rigid_shape *shape, const struct rigid_pose *pose,
                               const double x[3], double reach, struct rigid_nearest *nearest) {
  double inner[3];
  rigid_pose_inward(pose, x, inner);
  if (!rigid_shape_nearest(shape, inner, reach, nearest)) {
    return false;
  }
  rigid_pose_turn_outward(pose, nearest->normal, nearest->normal);
  rigid_pose_tensor_outward(pose, nearest->curvature);
  return true;
}

void rigid_shape_bounds(const struct rigid_shape *shape, double low[3], double high[3]) {
  const struct meridian *meridian = &shape->meridian;
  const struct rounded_box *box = &shape->box;
  switch (shape->kind) {
  case RIGID_PLANE:
    for (int i = 0; i < 3; i++) {
      low[i] = -INFINITY;
      high[i] = i == 2 ? 0 : INFINITY;
    }
    return;
  case RIGID_BOX:
    for (int i = 0; i < 3; i++) {
      high[i] = box->core[i] + box->edge;
      low[i] = -high[i];
    }
    return;
  case RIGID_SURFACE:
    memcpy(low, shape->surface.low, sizeof shape->surface.low);
    memcpy(high, shape->surface.high, sizeof shape->surface.high);
    return;
  default:
    for (int i = 0; i < 2; i++) {
      high[i] = meridian->high[1];
      low[i] = -high[i];
    }
    low[2] = meridian->low[0];
    high[2] = meridian->high[0];
  }
}

bool rigid_shape_mass(const struct rigid_shape *shape, struct rigid_mass *mass) {
  switch (shape->kind) {
  case RIGID_PLANE:
    return false;
  case RIGID_BOX:
    box_mass(&shape->box, mass);
    return true;
  case RIGID_SURFACE:
    surface_mass(&shape->surface, mass);
    return true;
  default:
    meridian_mass(&shape->meridian, mass);
    return true;
  }
}
