#include "solver/material/curve_job.h"

#include <math.h>
#include <stdio.h>

#include "solver/base/clock.h"
#include "solver/job/json.h"
#include "solver/material/document.h"
#include "solver/material/law.h"
#include "solver/material/stability.h"

static json_t *sample_object(const struct material_spec *material, double stretch) {
  json_t *o = json_object();
  json_set_finite(o, "stretch", stretch);
  json_set_finite(o, "strain", stretch - 1.0);
  for (enum deformation d = 0; d < DEFORMATION_COUNT; d++) {
    char key[40];
    snprintf(key, sizeof key, "%s_stress_MPa", deformation_word(d));
    json_set_finite(o, key, 1e-6 * law_stress(material, d, stretch, NULL));
  }
  return o;
}

/* The smallest stretch in tension at which one of the engineering stresses has its peak. */
static double peak_of(const struct material_spec *material, double high) {
  double first = NAN;
  for (enum deformation d = 0; d < DEFORMATION_COUNT; d++) {
    first = fmin(first, stability_peak(material, d, fmax(STABILITY_STRETCH_MAX, high)));
  }
  return first;
}

static json_t *metrics_object(const struct job_spec *spec) {
  const struct material_spec *material = &spec->material;
  double modulus = material_shear_modulus(material);
  json_t *metrics = json_object();
  json_set_finite(metrics, "initial_shear_modulus_MPa", 1e-6 * modulus);
  json_set_finite(metrics, "initial_youngs_modulus_MPa", 3e-6 * modulus);
  json_set_finite(metrics, "bulk_modulus_MPa", 1e-6 * material->bulk_ratio * modulus);
  json_set_finite(metrics, "stress_at_100_percent_MPa",
                  1e-6 * law_stress(material, DEFORMATION_UNIAXIAL, 2.0, NULL));
  json_set_finite(metrics, "stable_to_stretch", peak_of(material, spec->curve.to));
  return metrics;
}

enum status curve_job(const struct job_spec *spec, json_t **document, struct error *error) {
  const struct material_curve_spec *curve = &spec->curve;
  struct document_parts parts = {.metrics = metrics_object(spec),
                                 .samples = json_array(),
                                 .warnings = json_array(),
                                 .wall_s = clock_wall_s(),
                                 .cpu_s = clock_cpu_s()};
  json_t *stability = NULL;
  for (int i = 0; i < curve->points; i++) {
    double part = (double)i / (curve->points - 1);
    json_array_append_new(
        parts.samples,
        sample_object(&spec->material, curve->from + part * (curve->to - curve->from)));
  }
  if (spec->material.fit_stretch_max > 0.0 && curve->to > spec->material.fit_stretch_max) {
    json_array_append_new(parts.warnings,
                          json_sprintf("the curves go to a stretch of %.4g; the data behind the "
                                       "material end at %.4g",
                                       curve->to, spec->material.fit_stretch_max));
  }
  enum status status = stability_report(&spec->material, fmin(curve->from, 1.0),
                                        fmax(curve->to, 1.0), &stability, parts.warnings);
  *document = document_make(spec, "material-curve", STATUS_OK, NULL, &parts);
  if (status != STATUS_OK || !*document ||
      json_object_set(*document, "stability", stability) != 0) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
    json_decref(*document);
    *document = NULL;
  }
  json_decref(stability);
  return status;
}
