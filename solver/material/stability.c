#include "solver/material/stability.h"

#include <math.h>
#include <stdbool.h>

#include "solver/job/material.h"

/* A condition on the state of a body. */
typedef bool condition(const struct material_spec *material, enum deformation deformation,
                       double stretch);

static bool is_definite(const struct material_spec *material, enum deformation deformation,
                        double stretch) {
  double lambda[3], h[3];
  deformation_stretches(deformation, stretch, lambda);
  law_tangent(material, lambda, h);
  return h[0] > 0.0 && h[0] * h[2] - h[1] * h[1] > 0.0;
}

static bool is_rising(const struct material_spec *material, enum deformation deformation,
                      double stretch) {
  static const double exponents[DEFORMATION_COUNT][3] = {
      {1.0, -0.5, -0.5}, {1.0, 1.0, -2.0}, {1.0, 0.0, -1.0}};
  return material_tangent(material, exponents[deformation], stretch) > 0.0;
}

/* First stretch on the way from 1 to `limit` at which the condition does not hold, by a scan in
 * equal ratios and bisection; NAN when there is none. */
static double first_without(condition *holds, const struct material_spec *material,
                            enum deformation deformation, double limit) {
  enum { STEPS = 2000 };
  double good = 1.0;
  for (int i = 0; i <= STEPS; i++) {
    double bad = pow(limit, (double)i / STEPS);
    if (holds(material, deformation, bad)) {
      good = bad;
      continue;
    }
    while (fabs(bad - good) > 1e-10 * good) {
      double middle = 0.5 * (good + bad);
      *(holds(material, deformation, middle) ? &good : &bad) = middle;
    }
    return bad;
  }
  return NAN;
}

double stability_lost(const struct material_spec *material, enum deformation deformation,
                      double limit) {
  return first_without(is_definite, material, deformation, limit);
}

double stability_peak(const struct material_spec *material, enum deformation deformation,
                      double limit) {
  return first_without(is_rising, material, deformation, limit);
}

static json_t *stretch_value(double stretch) {
  return isnan(stretch) ? json_null() : json_real(stretch);
}

static bool is_within(double stretch, double low, double high) {
  return !isnan(stretch) && stretch >= low && stretch <= high;
}

enum status stability_report(const struct material_spec *material, double low, double high,
                             json_t **stability, json_t *warnings) {
  *stability = json_array();
  int failed = *stability ? 0 : -1;
  for (enum deformation d = 0; d < DEFORMATION_COUNT; d++) {
    for (int side = 0; side < 2; side++) {
      const char *word = side == 0 ? "tension" : "compression";
      double limit =
          side == 0 ? fmax(STABILITY_STRETCH_MAX, high) : fmin(1.0 / STABILITY_STRETCH_MAX, low);
      double lost = stability_lost(material, d, limit), peak = stability_peak(material, d, limit);
      bool stable = !is_within(lost, low, high);
      failed |= json_array_append_new(
          *stability, json_pack("{s:s, s:s, s:b, s:o, s:o}", "deformation", deformation_word(d),
                                "side", word, "stable", stable, "lost_at_stretch",
                                stretch_value(lost), "peak_at_stretch", stretch_value(peak)));
      if (!stable) {
        failed |= json_array_append_new(
            warnings, json_sprintf("the law is not stable (Drucker) in %s %s from a stretch of "
                                   "%.4g on, within the range of this job",
                                   deformation_word(d), word, lost));
      } else if (is_within(peak, low, high)) {
        failed |= json_array_append_new(
            warnings, json_sprintf("in %s %s the engineering stress of the law has its peak at a "
                                   "stretch of %.4g: a body under a dead load would run away there",
                                   deformation_word(d), word, peak));
      }
    }
  }
  return failed == 0 ? STATUS_OK : STATUS_NO_MEMORY;
}
