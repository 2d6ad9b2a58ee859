/* What a shape consists of. */
#ifndef PNEULAB_RIGID_SHAPE_INTERNAL_H
#define PNEULAB_RIGID_SHAPE_INTERNAL_H

#include "solver/rigid/box.h"
#include "solver/rigid/meridian.h"
#include "solver/rigid/shape.h"
#include "solver/rigid/surface.h"

struct rigid_shape {
  enum rigid_kind kind;
  double radius;            /* of a sphere, m */
  struct meridian meridian; /* of all bodies of revolution, spheres among them */
  struct rounded_box box;
  struct surface surface;
};

/* An empty shape. STATUS_NO_MEMORY with its message. */
enum status rigid_shape_allocate(enum rigid_kind kind, struct rigid_shape **shape,
                                 struct error *error);

#endif
