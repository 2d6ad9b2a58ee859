/* Error estimates of the metrics, from the same load on a finer mesh. */
#include <math.h>
#include <string.h>
#include "solver/post/result_internal.h"

/* An estimate is `factor` times the difference of the two meshes, for what the finer one still
 * lacks, plus `part` of the value, for the directions in which it is no finer. Found by measurement
 * (tests/bench/bench_error.c). */
struct margin {
  double factor, part;
};
static const struct margin deflection_margin = {2, 6e-3};
static const struct margin volume_margin = {2, 2e-3};
static const struct margin stretch_margin = {1.6, 5e-2}; /* largest in singular corners */

/* Parts of the tiers, relative to those of standard. */
static const double tier_share[] = {
    [ACCURACY_DRAFT] = 3, [ACCURACY_FAST] = 2, [ACCURACY_STANDARD] = 1, [ACCURACY_FINE] = 0.4};

/* A metric whose own difference happens to be small is taken to be uncertain by this share of the
 * relative difference of the whole deflection. */
static const double shared = 0.3;

void result_compare(struct result *r, const struct sample *finer, const struct error *error,
                    double cpu_s) {
  r->compared = finer != NULL;
  r->estimate_s = cpu_s;
  if (finer) {
    r->finer = *finer;
  } else if (error) {
    r->estimate = *error;
  }
}

static double relative(double value, double finer) {
  return value != 0 ? fabs((finer - value) / value) : 0;
}

/* Sets "<key>_error" for a metric that is there and differs by the part `difference`. */
static void set_error(const struct result *r, json_t *metrics, const char *key,
                      const struct margin *margin, double difference) {
  char name[64];
  const json_t *value = json_object_get(metrics, key);
  double share = margin == &stretch_margin ? 1 : tier_share[r->spec->accuracy];
  double part = margin->factor * difference + share * margin->part;
  if (value && isfinite(part)) {
    snprintf(name, sizeof name, "%s_error", key);
    json_object_set_new(metrics, name, json_real(part * fabs(json_real_value(value))));
  }
}

void result_set_errors(const struct result *r, json_t *metrics) {
  if (!r->compared || r->sample_count == 0) {
    return;
  }
  const struct sample *s = &r->sample[r->sample_count - 1], *f = &r->finer;
  double angle = relative(s->shape.bending_angle, f->shape.bending_angle);
  double chord = relative(s->shape.chord_angle, f->shape.chord_angle);
  double end = relative(s->shape.end_face_angle, f->shape.end_face_angle);
  double tip = relative(s->tip_deflection, f->tip_deflection);
  double twist = relative(s->spatial.twist, f->spatial.twist);
  double contraction = relative(s->spatial.contraction, f->spatial.contraction);
  double whole = shared * fmax(fmax(angle, chord), fmax(end, tip));
  double bending = fmax(angle, whole);
  /* Those of the fits are proportional to the angle, the onset comes with the same motion. */
  const struct {
    const char *key;
    double difference;
  } deflections[] = {
      {"bending_angle_deg", bending},           {"chord_angle_deg", fmax(chord, whole)},
      {"end_face_angle_deg", fmax(end, whole)}, {"tip_deflection_mm", fmax(tip, whole)},
      {"sensitivity_deg_per_kPa", bending},     {"intercept_deg", bending},
      {"cai_rad_per_m_kPa", bending},           {"contact_onset_kPa", bending},
      {"twist_angle_deg", fmax(twist, whole)},  {"contraction_pct", fmax(contraction, whole)}};
  for (size_t k = 0; k < sizeof deflections / sizeof *deflections; k++) {
    set_error(r, metrics, deflections[k].key, &deflection_margin, deflections[k].difference);
  }
  set_error(r, metrics, "cavity_volume_mm3", &volume_margin,
            relative(s->cavity_volume, f->cavity_volume));
  set_error(r, metrics, "max_stretch", &stretch_margin, relative(s->max_stretch, f->max_stretch));
}
