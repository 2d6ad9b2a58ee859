#include "solver/job/material.h"

#include <math.h>
#include <string.h>

/* Yeoh coefficients in MPa. `stretch` is the end of the fitted range, 0 when it is not known. */
#define YEOH(label, count, c1, c2, c3, density, stretch, text)                                     \
  {                                                                                                \
    .model = MATERIAL_YEOH, .terms = (count), .c = {(c1)*1e6, (c2)*1e6, (c3)*1e6},                 \
    .density_kg_m3 = (density), .bulk_ratio = 1000.0, .name = label, .source = text,               \
    .fit_stretch_max = (stretch)                                                                   \
  }

static const struct material_spec builtin[] = {
    YEOH("dragon-skin-10", 3, 0.0243, 0.00225, -5.4e-5, 1070.0, 4.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 300 %; density assumed from 1070 to 1080 kg/m3"),
    YEOH("dragon-skin-20", 2, 0.0612, 0.00796, 0.0, 1080.0, 2.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 100 %; density of the twisting-bending actuator study"),
    YEOH("dragon-skin-20-300", 3, 0.0704, 0.00522, -1.13e-4, 1080.0, 4.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 300 %; density of the twisting-bending actuator study"),
    YEOH("dragon-skin-30", 2, 0.0904, 0.00908, 0.0, 1080.0, 2.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 100 %; density assumed from 1070 to 1080 kg/m3"),
    YEOH("dragon-skin-30-300", 3, 0.1006, 0.00639, -1.49e-4, 1080.0, 4.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 300 %; density assumed from 1070 to 1080 kg/m3"),
    YEOH("dragon-skin-30-sorotoki", 2, 0.1536, 0.0016, 0.0, 1080.0, 0.0,
         "Sorotoki toolbox, fit range unknown; density assumed from 1070 to 1080 kg/m3"),
    YEOH("ecoflex-00-30", 3, 0.00783, 1.03e-4, -8e-7, 1070.0, 4.0,
         "fit to ASTM D412 data of the Soft Robotics Materials Database (10.1089/soro.2019.0115), "
         "up to 300 %; density assumed"),
    YEOH("elastosil-m4601", 2, 0.11, 0.02, 0.0, 1130.0, 0.0,
         "Sorotoki toolbox, fit range unknown; density assumed"),
    YEOH("elastosil-m4601-tapered", 2, 0.1, 0.02, 0.0, 1130.0, 0.0,
         "as printed in the tapered-actuator study, fit range unknown; density assumed"),
    YEOH("elastic-50a", 3, 0.25, -0.05, 0.005, 1080.0, 0.0,
         "as printed in the multi-chamber, multi-curvature actuator study, fit range unknown; "
         "density assumed"),
    YEOH("elastic-50a-sorotoki", 3, 0.5056, 0.0, 0.002562, 1080.0, 0.0,
         "Sorotoki toolbox after 10.1016/j.sna.2021.113199, fit range unknown; density assumed"),
};

enum { BUILTIN_COUNT = sizeof builtin / sizeof *builtin };

const struct material_spec *material_builtin(size_t index) {
  return index < BUILTIN_COUNT ? &builtin[index] : NULL;
}

const struct material_spec *material_find(const char *name) {
  for (size_t i = 0; i < BUILTIN_COUNT; i++) {
    if (strcmp(builtin[i].name, name) == 0) {
      return &builtin[i];
    }
  }
  return NULL;
}

double material_shear_modulus(const struct material_spec *material) {
  double sum = 0.0;
  switch (material->model) {
  case MATERIAL_NEO_HOOKE:
    return material->c[0];
  case MATERIAL_YEOH:
    return 2.0 * material->c[0];
  case MATERIAL_MOONEY_RIVLIN:
    return 2.0 * (material->c[0] + material->c[1]);
  case MATERIAL_OGDEN:
    for (int i = 0; i < material->terms; i++) {
      sum += 0.5 * material->c[i] * material->alpha[i];
    }
    return sum;
  }
  return sum;
}

/* First and second derivative with respect to s of sum_k s^(factor e_k), and the sum itself. */
struct power_sum {
  double value, slope, curvature;
};

static struct power_sum sum_powers(const double e[3], double factor, double s) {
  struct power_sum sum = {0.0, 0.0, 0.0};
  for (int k = 0; k < 3; k++) {
    double a = factor * e[k];
    sum.value += pow(s, a);
    sum.slope += a * pow(s, a - 1.0);
    sum.curvature += a * (a - 1.0) * pow(s, a - 2.0);
  }
  return sum;
}

double material_tangent(const struct material_spec *material, const double exponents[3],
                        double stretch) {
  struct power_sum i1 = sum_powers(exponents, 2.0, stretch);
  struct power_sum i2 = sum_powers(exponents, -2.0, stretch);
  const double *c = material->c;
  double x = i1.value - 3.0;
  double tangent = 0.0;
  switch (material->model) {
  case MATERIAL_NEO_HOOKE:
    return 0.5 * c[0] * i1.curvature;
  case MATERIAL_YEOH: /* d2W = W' I1'' + W'' I1'^2 with W' = sum i c_i x^(i-1) */
    return (c[0] + 2.0 * c[1] * x + 3.0 * c[2] * x * x) * i1.curvature +
           (2.0 * c[1] + 6.0 * c[2] * x) * i1.slope * i1.slope;
  case MATERIAL_MOONEY_RIVLIN:
    return c[0] * i1.curvature + c[1] * i2.curvature;
  case MATERIAL_OGDEN:
    for (int i = 0; i < material->terms; i++) {
      tangent +=
          c[i] / material->alpha[i] * sum_powers(exponents, material->alpha[i], stretch).curvature;
    }
    return tangent;
  }
  return tangent;
}

/* Smallest stretch in [1, limit] at which the tangent along `exponents` is not positive, by a scan
 * and bisection; a value above `limit` when there is none. */
static double first_unstable_of(const struct material_spec *material, const double exponents[3],
                                double limit) {
  enum { STEPS = 2000 };
  double stable = 1.0;
  for (int i = 0; i <= STEPS; i++) {
    double stretch = pow(limit, (double)i / STEPS);
    if (material_tangent(material, exponents, stretch) > 0.0) {
      stable = stretch;
      continue;
    }
    double unstable = stretch;
    while (unstable - stable > 1e-10 * stable) {
      double middle = 0.5 * (stable + unstable);
      *(material_tangent(material, exponents, middle) > 0.0 ? &stable : &unstable) = middle;
    }
    return unstable;
  }
  return 2.0 * limit;
}

bool material_stable_to(const struct material_spec *material, double stretch_max,
                        double *first_unstable) {
  static const double modes[3][3] = {{1.0, -0.5, -0.5}, {1.0, 0.0, -1.0}, {1.0, 1.0, -2.0}};
  bool stable = true;
  for (int mode = 0; mode < 3; mode++) {
    double found = first_unstable_of(material, modes[mode], stretch_max);
    if (found <= stretch_max && (stable || (first_unstable && found < *first_unstable))) {
      stable = false;
      if (first_unstable) {
        *first_unstable = found;
      }
    }
  }
  return stable;
}
