#include "solver/material/law.h"

#include <math.h>

static const double exponents[DEFORMATION_COUNT] = {-0.5, 1.0, 0.0};

const char *deformation_word(enum deformation deformation) {
  static const char *const words[DEFORMATION_COUNT] = {"uniaxial", "equibiaxial", "planar"};
  return words[deformation];
}

void deformation_stretches(enum deformation deformation, double stretch, double lambda[3]) {
  lambda[0] = stretch;
  lambda[1] = pow(stretch, exponents[deformation]);
  lambda[2] = 1.0 / (lambda[0] * lambda[1]);
}

int law_count(const struct material_spec *material) {
  return material->model == MATERIAL_OGDEN ? 2 * material->terms : material->terms;
}

void law_set(struct material_spec *material, const double *coefficient) {
  for (int i = 0; i < material->terms; i++) {
    material->c[i] = coefficient[i];
    if (material->model == MATERIAL_OGDEN) {
      material->alpha[i] = coefficient[material->terms + i];
    }
  }
}

void law_get(const struct material_spec *material, double *coefficient) {
  for (int i = 0; i < material->terms; i++) {
    coefficient[i] = material->c[i];
    if (material->model == MATERIAL_OGDEN) {
      coefficient[material->terms + i] = material->alpha[i];
    }
  }
}

/* Ogden: P = sum mu_i (lambda1^alpha_i - lambda3^alpha_i) / lambda1. */
static double ogden_stress(const struct material_spec *material, const double lambda[3],
                           double *gradient) {
  int n = material->terms;
  double stress = 0.0;
  for (int i = 0; i < n; i++) {
    double a = pow(lambda[0], material->alpha[i]), b = pow(lambda[2], material->alpha[i]);
    double shape = (a - b) / lambda[0];
    stress += material->c[i] * shape;
    if (gradient) {
      gradient[i] = shape;
      gradient[n + i] = material->c[i] * (a * log(lambda[0]) - b * log(lambda[2])) / lambda[0];
    }
  }
  return stress;
}

/* With W(I1, I2): t1 - t3 = 2 (W1 (lambda1^2 - lambda3^2) - W2 (lambda1^-2 - lambda3^-2)). */
double law_stress(const struct material_spec *material, enum deformation deformation,
                  double stretch, double *gradient) {
  double lambda[3], shape[MATERIAL_TERMS_MAX] = {0};
  deformation_stretches(deformation, stretch, lambda);
  if (material->model == MATERIAL_OGDEN) {
    return ogden_stress(material, lambda, gradient);
  }
  double a = lambda[0] * lambda[0], b = lambda[1] * lambda[1], c = lambda[2] * lambda[2];
  double first = 2.0 * (a - c) / lambda[0], second = 2.0 * (1.0 / c - 1.0 / a) / lambda[0];
  double x = a + b + c - 3.0;
  if (material->model == MATERIAL_NEO_HOOKE) {
    shape[0] = 0.5 * first;
  } else if (material->model == MATERIAL_MOONEY_RIVLIN) {
    shape[0] = first;
    shape[1] = second;
  } else {
    shape[0] = first;
    shape[1] = 2.0 * x * first;
    shape[2] = 3.0 * x * x * first;
  }
  double stress = 0.0;
  for (int i = 0; i < material->terms; i++) {
    stress += material->c[i] * shape[i];
    if (gradient) {
      gradient[i] = shape[i];
    }
  }
  return stress;
}

/* Adds c times the second derivatives of sum_k lambda_k^p to the logarithms of the stretches. */
static void add_powers(const double lambda[3], double p, double c, double h[3]) {
  double third = c * p * p * pow(lambda[2], p);
  h[0] += c * p * p * pow(lambda[0], p) + third;
  h[1] += third;
  h[2] += c * p * p * pow(lambda[1], p) + third;
}

void law_tangent(const struct material_spec *material, const double lambda[3], double h[3]) {
  const double *c = material->c;
  h[0] = h[1] = h[2] = 0.0;
  if (material->model == MATERIAL_OGDEN) {
    for (int i = 0; i < material->terms; i++) {
      add_powers(lambda, material->alpha[i], c[i] / material->alpha[i], h);
    }
    return;
  }
  double a = lambda[0] * lambda[0], b = lambda[1] * lambda[1], d = lambda[2] * lambda[2];
  double x = a + b + d - 3.0, slope = c[0], curvature = 0.0;
  if (material->model == MATERIAL_NEO_HOOKE) {
    slope = 0.5 * c[0];
  } else if (material->model == MATERIAL_MOONEY_RIVLIN) {
    add_powers(lambda, -2.0, c[1], h);
  } else {
    slope = c[0] + 2.0 * c[1] * x + 3.0 * c[2] * x * x;
    curvature = 2.0 * c[1] + 6.0 * c[2] * x;
  }
  double g1 = 2.0 * (a - d), g2 = 2.0 * (b - d); /* of I1 to the logarithms */
  add_powers(lambda, 2.0, slope, h);
  h[0] += curvature * g1 * g1;
  h[1] += curvature * g1 * g2;
  h[2] += curvature * g2 * g2;
}
