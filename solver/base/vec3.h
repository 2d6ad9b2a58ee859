/* Small vectors and rotations. */
#ifndef PNEULAB_BASE_VEC3_H
#define PNEULAB_BASE_VEC3_H

#include <math.h>

static inline double vec3_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec3_norm(const double a[3]) {
  return sqrt(vec3_dot(a, a));
}

static inline void vec3_cross(const double a[3], const double b[3], double out[3]) {
  double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
         z = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
  out[2] = z;
}

/* Rotation matrix (row-major) of the rotation vector w: Rodrigues' formula. */
static inline void rotation_matrix(const double w[3], double r[9]) {
  double t2 = vec3_dot(w, w), t = sqrt(t2);
  double s = t2 < 1e-12 ? 1 - t2 / 6 : sin(t) / t;
  double c = t2 < 1e-12 ? 0.5 - t2 / 24 : (1 - cos(t)) / t2;
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      r[3 * i + j] = c * w[i] * w[j] + (i == j ? 1 - c * t2 : 0);
    }
  }
  r[1] -= s * w[2];
  r[2] += s * w[1];
  r[3] += s * w[2];
  r[5] -= s * w[0];
  r[6] -= s * w[1];
  r[7] += s * w[0];
}

/* Rotation vector (angle below pi) of the rotation a^T b between two frames, seen from the first. */
static inline void rotation_between(const double a[9], const double b[9], double w[3]) {
  double r[9], trace = 0;
  for (int i = 0; i < 9; i++) {
    r[i] = 0;
    for (int k = 0; k < 3; k++) {
      r[i] += a[3 * k + i / 3] * b[3 * k + i % 3];
    }
    trace += i % 4 == 0 ? r[i] : 0;
  }
  double angle = acos(fmax(-1, fmin(1, 0.5 * (trace - 1))));
  double factor = angle > 1e-6 ? 0.5 * angle / sin(angle) : 0.5;
  w[0] = factor * (r[7] - r[5]);
  w[1] = factor * (r[2] - r[6]);
  w[2] = factor * (r[3] - r[1]);
}

static inline void mat3_apply(const double m[9], const double x[3], double out[3]) {
  double a = vec3_dot(m, x), b = vec3_dot(m + 3, x), c = vec3_dot(m + 6, x);
  out[0] = a;
  out[1] = b;
  out[2] = c;
}

#endif
