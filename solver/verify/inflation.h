/* Thick cylinder and sphere under inner pressure, A = 1, B = 2, driven by the cavity's volume: the
 * flat part and the limit point of the curve are then no obstacle. */
#ifndef PNEULAB_VERIFY_INFLATION_H
#define PNEULAB_VERIFY_INFLATION_H

#include "solver/verify/report.h"

/* A quarter of a cylinder of height 1 (one block), or an octant of a sphere (three blocks). */
struct inflation_shape {
  int power; /* 2 cylinder, 3 sphere */
  int blocks;
  double volume_scale; /* model_volume leaves out the planes z = 0, 1 of the cylinder */
};
extern const struct inflation_shape inflation_cylinder, inflation_sphere;

extern const double inflation_inner, inflation_outer; /* radii */

struct inflation {
  const struct inflation_shape *shape;
  struct verify_body body;
  double volume;   /* of the cavity at rest */
  double pressure; /* of the last equilibrium */
  double at;       /* its inner stretch: that of the volume */
};

/* Builds the body with `radial` elements through the wall; close it with verify_body_close, also
 * after a failure. */
enum status inflation_open(struct inflation *inflation, const struct inflation_shape *shape,
                           const struct material_spec *material, int radial, int around,
                           struct error *error);

/* Brings the inner stretch to `stretch` in steps of at most 0.1. */
enum status inflate(struct verify_run *run, struct inflation *inflation, double stretch,
                    struct error *error);

#endif
