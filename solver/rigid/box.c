#include "solver/rigid/box.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Inside the smaller box: the nearest of the six faces. */
static void nearest_face(const struct rounded_box *box, const double x[3], const double beyond[3],
                         struct rigid_nearest *nearest) {
  int axis = 0;
  for (int i = 1; i < 3; i++) {
    axis = beyond[i] > beyond[axis] ? i : axis;
  }
  *nearest = (struct rigid_nearest){.distance = beyond[axis] - box->edge};
  nearest->normal[axis] = x[axis] < 0 ? -1 : 1;
}

bool box_nearest(const struct rounded_box *box, const double x[3], double reach,
                 struct rigid_nearest *nearest) {
  double beyond[3], square = 0;
  for (int i = 0; i < 3; i++) {
    beyond[i] = fabs(x[i]) - box->core[i];
    square += beyond[i] > 0 ? beyond[i] * beyond[i] : 0;
  }
  double rho = sqrt(square);
  if (!(rho - box->edge <= reach)) {
    return false;
  }
  if (square == 0) {
    nearest_face(box, x, beyond, nearest);
    return nearest->distance <= reach;
  }
  /* Axes along which x is beyond the smaller box: a face, an edge or a corner of it is nearest. */
  double *n = nearest->normal;
  nearest->distance = rho - box->edge;
  for (int i = 0; i < 3; i++) {
    n[i] = beyond[i] > 0 ? copysign(beyond[i], x[i]) / rho : 0;
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      bool both = beyond[i] > 0 && beyond[j] > 0;
      nearest->curvature[i][j] = both ? ((i == j) - n[i] * n[j]) / rho : 0;
    }
  }
  return true;
}

/* Of one eighth of the box: the volume, and the integral of the square of coordinate i. The parts
 * are the core, three slabs, three quarters of a cylinder, and an eighth of a sphere. */
static double eighth(const struct rounded_box *box, int i, double *square) {
  const double e = box->edge, a = box->core[i], b = box->core[(i + 1) % 3],
               c = box->core[(i + 2) % 3];
  const double quarter = 0.25 * PI * e * e, octant = PI * e * e * e / 6;
  /* Integrals of (a + u)^2 over the quarter disc and the octant of radius e. */
  const double over_quarter = quarter * a * a + 2 * a * e * e * e / 3 + PI * pow(e, 4) / 16;
  const double over_octant = octant * a * a + 2 * a * PI * pow(e, 4) / 16 + PI * pow(e, 5) / 30;
  const double shell = (pow(a + e, 3) - pow(a, 3)) / 3, inner = pow(a, 3) / 3;
  *square = inner * (b * c + e * c + b * e + quarter) + shell * b * c + over_quarter * (b + c) +
            over_octant;
  return a * b * c + e * (a * b + b * c + c * a) + quarter * (a + b + c) + octant;
}

void box_mass(const struct rounded_box *box, struct rigid_mass *mass) {
  double square[3], volume = 0;
  for (int i = 0; i < 3; i++) {
    volume = eighth(box, i, &square[i]);
  }
  *mass = (struct rigid_mass){.volume = 8 * volume};
  for (int i = 0; i < 3; i++) {
    mass->inertia[4 * i] = (square[(i + 1) % 3] + square[(i + 2) % 3]) / volume;
  }
}
