#include "solver/job/grasp_shape.h"

#include <stdio.h>
#include <string.h>

#include "solver/rigid/stl.h"

static enum status create_surface(const struct grasp_shape *s, struct rigid_shape **shape,
                                  struct error *error) {
  struct stl stl;
  enum status status = stl_read(s->stl, s->stl_size, &stl, error);
  if (status == STATUS_OK) {
    status = rigid_shape_create_surface(&stl, s->stl_unit, s->crease, shape, error);
    stl_release(&stl);
  } else if (error && error->pointer[0] == '\0') {
    snprintf(error->pointer, sizeof error->pointer, "/stl/base64");
  }
  return status;
}

static enum status create(const struct grasp_shape *s, struct rigid_shape **shape,
                          struct error *error) {
  switch (s->form) {
  case GRASP_SPHERE:
    return rigid_shape_create_sphere(s->diameter, shape, error);
  case GRASP_CYLINDER:
    return rigid_shape_create_cylinder(s->diameter, s->length, s->rounding, shape, error);
  case GRASP_FRUSTUM:
    return rigid_shape_create_frustum(s->base_diameter, s->tip_diameter, s->length, s->rounding,
                                      shape, error);
  case GRASP_BOX:
    return rigid_shape_create_box(s->size, s->rounding, shape, error);
  case GRASP_REVOLUTION:
    return rigid_shape_create_revolution(s->profile, s->profile_count,
                                         s->smooth ? RIGID_PROFILE_SMOOTH : RIGID_PROFILE_STRAIGHT,
                                         s->rounding, shape, error);
  case GRASP_SURFACE:
    return create_surface(s, shape, error);
  case GRASP_PLANE:
    break;
  }
  return rigid_shape_create_plane(shape, error);
}

enum status grasp_shape_create(const struct grasp_shape *spec, struct rigid_shape **shape,
                               struct error *error) {
  enum status status = create(spec, shape, error);
  if (status != STATUS_OK && status != STATUS_NO_MEMORY && error) {
    char inside[sizeof error->pointer];
    snprintf(inside, sizeof inside, "/object/shape%.180s", error->pointer);
    memcpy(error->pointer, inside, sizeof inside);
  }
  return status;
}

struct rigid_pose grasp_pose(const struct grasp_object *object, const double shift[3]) {
  struct rigid_pose pose;
  for (int i = 0; i < 3; i++) {
    pose.place[i] = object->place[i] + shift[i];
    memcpy(&pose.rotation[3 * i], object->rotation[i], sizeof object->rotation[i]);
  }
  return pose;
}
