/* Error estimates of the metrics, from the same load on a finer mesh. */
#include <math.h>
#include <string.h>
#include "solver/post/result_internal.h"

/* What the finer mesh still lacks is covered by a factor on the difference, larger for the volume,
 * whose error is not where the mesh is refined. */
static const double safety = 2;
static const double safety_volume = 4;
/* An estimate is never below this part of the value. */
static const double smallest = 5e-4;
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

/* Sets "<key>_error" for a metric that is there: `part` of its own value. */
static void set_part(json_t *metrics, const char *key, double part) {
  char name[64];
  json_t *value = json_object_get(metrics, key);
  if (value && isfinite(part)) {
    snprintf(name, sizeof name, "%s_error", key);
    json_object_set_new(metrics, name,
                        json_real(fmax(part, smallest) * fabs(json_real_value(value))));
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
  double whole = shared * fmax(fmax(angle, chord), fmax(end, tip));
  double bending = safety * fmax(angle, whole);
  set_part(metrics, "bending_angle_deg", bending);
  set_part(metrics, "chord_angle_deg", safety * fmax(chord, whole));
  set_part(metrics, "end_face_angle_deg", safety * fmax(end, whole));
  set_part(metrics, "tip_deflection_mm", safety * fmax(tip, whole));
  set_part(metrics, "cavity_volume_mm3",
           safety_volume * relative(s->cavity_volume, f->cavity_volume));
  set_part(metrics, "max_stretch", safety * relative(s->max_stretch, f->max_stretch));
  /* Both are slopes of the angle over the same pressures. */
  set_part(metrics, "sensitivity_deg_per_kPa", bending);
  set_part(metrics, "intercept_deg", bending);
  set_part(metrics, "cai_rad_per_m_kPa", bending);
  set_part(metrics, "contact_onset_kPa", bending);
}
