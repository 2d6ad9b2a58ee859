#include "solver/material/fit_job.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/base/text.h"
#include "solver/job/json.h"
#include "solver/job/tensile.h"
#include "solver/material/document.h"
#include "solver/material/regression.h"
#include "solver/material/stability.h"

/* Everything one fit owns. */
struct fit {
  const struct job_spec *spec;
  struct tensile_curve curve;
  struct regression regression;
  double low, high; /* strains of the points */
  json_t *warnings;
};

/* ---- coefficients ----------------------------------------------------------------------- */

/* Half width of the 95 % confidence interval of the initial shear modulus, which is linear in the
 * moduli. */
static double shear_half_width(const struct regression *r) {
  const struct material_spec *m = &r->material;
  double gradient[FIT_COEFFICIENTS_MAX] = {0}, variance = 0.0;
  for (int i = 0; i < m->terms; i++) {
    switch (m->model) {
    case MATERIAL_NEO_HOOKE:
      gradient[i] = 1.0;
      break;
    case MATERIAL_YEOH:
      gradient[i] = i == 0 ? 2.0 : 0.0;
      break;
    case MATERIAL_MOONEY_RIVLIN:
      gradient[i] = 2.0;
      break;
    case MATERIAL_OGDEN:
      gradient[i] = 0.5 * m->alpha[i];
      gradient[m->terms + i] = 0.5 * m->c[i];
      break;
    }
  }
  for (int i = 0; i < r->count; i++) {
    for (int j = 0; j < r->count; j++) {
      variance += gradient[i] * r->covariance[i * FIT_COEFFICIENTS_MAX + j] * gradient[j];
    }
  }
  return r->student * sqrt(fmax(variance, 0.0));
}

static void set_with_error(json_t *metrics, const char *key, double value, double half_width) {
  char name[60];
  json_set_finite(metrics, key, value);
  snprintf(name, sizeof name, "%s_error", key);
  json_set_finite(metrics, name, half_width);
}

static json_t *metrics_object(const struct fit *fit) {
  const struct regression *r = &fit->regression;
  json_t *metrics = json_object();
  for (int i = 0; i < r->count; i++) {
    bool exponent = fit_coefficient_is_exponent(&fit->spec->fit, i);
    double unit = exponent ? 1.0 : 1e-6;
    char key[30];
    snprintf(key, sizeof key, "%s%s", fit_coefficient_name(&fit->spec->fit, i),
             exponent ? "" : "_MPa");
    set_with_error(metrics, key, unit * r->coefficient[i], unit * regression_half_width(r, i));
  }
  set_with_error(metrics, "initial_shear_modulus_MPa", 1e-6 * material_shear_modulus(&r->material),
                 1e-6 * shear_half_width(r));
  json_set_finite(metrics, "r_squared", r->r_squared);
  json_set_finite(metrics, "rmse_MPa", 1e-6 * r->rmse);
  json_set_finite(metrics, "points", (double)fit->curve.count);
  json_set_finite(metrics, "strain_from", fit->low);
  json_set_finite(metrics, "strain_to", fit->high);
  json_set_finite(metrics, "condition_number", r->condition);
  return metrics;
}

static json_t *coefficients_array(const struct fit *fit) {
  const struct regression *r = &fit->regression;
  json_t *array = json_array();
  for (int i = 0; i < r->count; i++) {
    bool exponent = fit_coefficient_is_exponent(&fit->spec->fit, i);
    double unit = exponent ? 1.0 : 1e-6;
    json_t *o = json_pack("{s:s, s:s, s:f, s:b}", "name", fit_coefficient_name(&fit->spec->fit, i),
                          "unit", exponent ? "1" : "MPa", "value", unit * r->coefficient[i],
                          "at_bound", r->at_bound[i]);
    json_set_finite(o, "half_width", unit * regression_half_width(r, i));
    json_array_append_new(array, o);
  }
  return array;
}

static json_t *samples_array(const struct fit *fit) {
  json_t *samples = json_array();
  for (size_t i = 0; i < fit->curve.count; i++) {
    double stretch = 1.0 + fit->curve.strain[i];
    json_t *o = json_object();
    json_set_finite(o, "strain", fit->curve.strain[i]);
    json_set_finite(o, "stretch", stretch);
    json_set_finite(o, "measured_stress_MPa", 1e-6 * fit->curve.stress[i]);
    json_set_finite(o, "fitted_stress_MPa",
                    1e-6 *
                        law_stress(&fit->regression.material, DEFORMATION_UNIAXIAL, stretch, NULL));
    json_set_finite(o, "band_MPa", 1e-6 * regression_band(&fit->regression, stretch));
    json_array_append_new(samples, o);
  }
  return samples;
}

/* ---- the material ----------------------------------------------------------------------- */

static json_t *moduli(const double *value, int count) {
  json_t *array = json_array();
  for (int i = 0; i < count; i++) {
    json_array_append_new(array, json_sprintf("%.8g MPa", 1e-6 * value[i]));
  }
  return array;
}

/* The law as a job takes it, a new reference. */
static json_t *material_object(const struct fit *fit) {
  const struct material_spec *m = &fit->regression.material;
  const json_t *document = fit->spec->document;
  json_t *o = json_object();
  json_object_set(o, "model", json_object_get(document, "model"));
  switch (m->model) {
  case MATERIAL_NEO_HOOKE:
    json_object_set_new(o, "mu", json_sprintf("%.8g MPa", 1e-6 * m->c[0]));
    break;
  case MATERIAL_YEOH:
    json_object_set_new(o, "C", moduli(m->c, m->terms));
    break;
  case MATERIAL_MOONEY_RIVLIN:
    json_object_set_new(o, "C10", json_sprintf("%.8g MPa", 1e-6 * m->c[0]));
    json_object_set_new(o, "C01", json_sprintf("%.8g MPa", 1e-6 * m->c[1]));
    break;
  case MATERIAL_OGDEN:
    json_object_set_new(o, "mu", moduli(m->c, m->terms));
    json_object_set_new(o, "alpha", json_array());
    for (int i = 0; i < m->terms; i++) {
      json_array_append_new(json_object_get(o, "alpha"), json_real(m->alpha[i]));
    }
    break;
  }
  json_object_set(o, "density", json_object_get(document, "density"));
  json_object_set(o, "bulk_ratio", json_object_get(document, "bulk_ratio"));
  json_object_set_new(o, "source",
                      json_sprintf("%.*s: fit to a uniaxial curve, strain %.3g to %.3g, R2 %.4f",
                                   (int)text_prefix(fit->spec->name, 70), fit->spec->name, fit->low,
                                   fit->high, fit->regression.r_squared));
  if (fit->high > 0.0) {
    json_object_set_new(o, "fit_stretch_max", json_real(1.0 + fit->high));
  }
  return o;
}

/* ---- warnings --------------------------------------------------------------------------- */

static void warn(const struct fit *fit, json_t *sentence) {
  json_array_append_new(fit->warnings, sentence);
}

static void warn_of_coefficients(const struct fit *fit) {
  const struct regression *r = &fit->regression;
  for (int i = 0; i < r->count; i++) {
    const char *name = fit_coefficient_name(&fit->spec->fit, i);
    bool exponent = fit_coefficient_is_exponent(&fit->spec->fit, i);
    double unit = exponent ? 1.0 : 1e-6, half_width = regression_half_width(r, i);
    if (r->at_bound[i]) {
      warn(fit, json_sprintf("%s is held at its bound, %.6g%s", name, unit * r->coefficient[i],
                             exponent ? "" : " MPa"));
    } else if (!(half_width < fabs(r->coefficient[i]))) {
      warn(fit,
           json_sprintf("the curve does not determine %s: %.4g +- %.4g%s (95 %%); fewer terms "
                        "or a wider range can help",
                        name, unit * r->coefficient[i], unit * half_width, exponent ? "" : " MPa"));
    }
  }
  if (r->condition > 1e4) {
    warn(fit, json_sprintf("the coefficients can hardly be told apart (condition number %.2g): "
                           "other sets of them fit the curve about as well",
                           r->condition));
  }
}

static void warn_of_curve(const struct fit *fit) {
  if (fit->curve.stress_driven) {
    warn(fit, json_string("the stresses are evenly spaced and the strains are not: were the "
                          "columns exchanged?"));
  }
  if (fit->regression.r_squared < 0.9) {
    warn(fit, json_sprintf("the law explains little of the curve: R2 is %.3f",
                           fit->regression.r_squared));
  }
}

/* ---- the job ---------------------------------------------------------------------------- */

static void find_range(struct fit *fit) {
  fit->low = INFINITY;
  fit->high = -INFINITY;
  for (size_t i = 0; i < fit->curve.count; i++) {
    fit->low = fmin(fit->low, fit->curve.strain[i]);
    fit->high = fmax(fit->high, fit->curve.strain[i]);
  }
}

/* Adds what only a fit that has settled can tell. */
static enum status add_material(const struct fit *fit, json_t *document) {
  /* The specimen has seen these stretches along its length, and their inverse roots across. */
  double low = fmin(1.0 + fit->low, 1.0 / sqrt(1.0 + fit->high));
  double high = fmax(1.0 + fit->high, 1.0 / sqrt(1.0 + fit->low));
  json_t *stability = NULL;
  enum status status =
      stability_report(&fit->regression.material, low, high, &stability, fit->warnings);
  if (status == STATUS_OK &&
      (json_object_set(document, "stability", stability) != 0 ||
       json_object_set_new(document, "material", material_object(fit)) != 0)) {
    status = STATUS_NO_MEMORY;
  }
  json_decref(stability);
  return status;
}

enum status fit_job(const struct job_spec *spec, bool (*cancelled)(void *context),
                    json_t **document, enum status *ending, struct error *error) {
  struct document_parts parts = {.wall_s = clock_wall_s(), .cpu_s = clock_cpu_s()};
  struct fit fit = {.spec = spec, .warnings = json_array()};
  struct regression_control control = {spec->timeout_s > 0 ? parts.wall_s + spec->timeout_s : 0,
                                       cancelled};
  struct error end = {.status = STATUS_OK};
  *document = NULL;
  enum status status = tensile_read(spec->document, &spec->fit, &fit.curve, error);
  if (status != STATUS_OK) {
    goto done;
  }
  find_range(&fit);
  *ending = regression_fit(&spec->fit, &fit.curve, &control, &fit.regression, &end);
  if (*ending == STATUS_NO_MEMORY) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "%s", end.message);
    goto done;
  }
  warn_of_curve(&fit);
  if (*ending == STATUS_OK) {
    warn_of_coefficients(&fit);
  }
  parts.metrics = metrics_object(&fit);
  parts.samples = samples_array(&fit);
  parts.warnings = json_incref(fit.warnings);
  parts.iterations = fit.regression.iterations;
  *document = document_make(spec, "fit-material", *ending, &end, &parts);
  status =
      *document && json_object_set_new(*document, "coefficients", coefficients_array(&fit)) == 0
          ? STATUS_OK
          : STATUS_NO_MEMORY;
  if (status == STATUS_OK && *ending == STATUS_OK) {
    status = add_material(&fit, *document);
  }
  if (status != STATUS_OK) {
    json_decref(*document);
    *document = NULL;
    error_set(error, status, NULL, "no memory for the result document");
  }
done:
  json_decref(fit.warnings);
  tensile_release(&fit.curve);
  return status;
}
