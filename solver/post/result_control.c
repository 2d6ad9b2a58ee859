#include "solver/post/result_control.h"

#include <math.h>

#include "solver/hlpv/tracking.h"
#include "solver/job/json.h"

void result_control_metrics(json_t *metrics, const struct hlpv_trajectory *t) {
  const struct tracking *tracking = t->tracking;
  /* fmax takes the other one for NAN: a step without a value does not count. */
  double overshoot = NAN, rise = NAN, settling = NAN, steady = NAN;
  int unsettled = 0, cycles = 0, missed = 0;
  for (size_t i = 0; i < tracking->count; i++) {
    const struct tracking_step *step = &tracking->step[i];
    overshoot = fmax(overshoot, step->changes ? 100 * step->beyond : NAN);
    rise = fmax(rise, tracking_rise(step));
    settling = fmax(settling, tracking_settling(step));
    steady = fmax(steady, 1e3 * fabs(tracking_steady_error(step)));
    unsettled += step->changes && isnan(tracking_settling(step));
    cycles += tracking_cycles(step);
    missed += !step->reached;
  }
  json_set_finite(metrics, "overshoot_pct", overshoot);
  json_set_finite(metrics, "rise_time_s", rise);
  json_set_finite(metrics, "settling_time_s", settling);
  json_set_finite(metrics, "steady_error_mm", steady);
  if (tracking->room > 0) {
    json_object_set_new(metrics, "unsettled_steps", json_integer(unsettled));
    json_object_set_new(metrics, "limit_cycles", json_integer(cycles));
    json_object_set_new(metrics, "targets_out_of_reach", json_integer(missed));
  }
  json_object_set_new(metrics, "switch_count", json_integer((json_int_t)t->event_count));
  json_set_finite(metrics, "saturation_time_s", tracking->saturated);
  json_set_finite(metrics, "tracking_rms_mm", 1e3 * sqrt(tracking->squares / t->time));
  json_set_finite(metrics, "tracking_error_max_mm", 1e3 * tracking->most);
}

static json_t *step_object(const struct hlpv_spec *spec, const struct tracking_step *step) {
  json_t *o = json_object();
  json_set_finite(o, "start_s", step->start);
  json_set_finite(o, "end_s", step->end);
  json_set_finite(o, "reference_mm", 1e3 * step->reference);
  json_object_set_new(o, "in_reach", json_boolean(step->reached));
  json_set_finite(o, "target_mm", 1e3 * step->aim);
  json_object_set_new(o, "mode", json_string(spec->mode[step->mode].name));
  json_object_set_new(o, "switches", json_integer(step->switches));
  json_set_finite(o, "start_h_mm", 1e3 * step->first);
  json_set_finite(o, "end_h_mm", 1e3 * step->last);
  json_set_finite(o, "overshoot_pct", step->changes ? 100 * step->beyond : NAN);
  json_set_finite(o, "rise_time_s", tracking_rise(step));
  json_set_finite(o, "settling_time_s", tracking_settling(step));
  json_set_finite(o, "steady_error_mm", 1e3 * tracking_steady_error(step));
  json_set_finite(o, "saturation_time_s", step->saturated);
  json_object_set_new(o, "limit_cycle", json_boolean(tracking_cycles(step)));
  return o;
}

static json_t *region_object(const struct design_region *r) {
  json_t *eigenvalues = json_array(), *observer = json_array();
  for (int i = 0; i < DESIGN_STATES; i++) {
    json_array_append_new(eigenvalues,
                          json_pack("[f, f]", r->eigenvalue[i][0], r->eigenvalue[i][1]));
  }
  for (int i = 0; i < HLPV_STATES; i++) {
    json_array_append_new(observer, json_pack("[f, f]", r->observer[i][0], r->observer[i][1]));
  }
  return json_pack("{s:f, s:f, s:[f, f, f, f], s:o, s:o}", "set_point_kPa", 1e-3 * r->set_point,
                   "rest_h_mm", 1e3 * r->rest[HLPV_H], "gains_si", r->gain[0], r->gain[1],
                   r->gain[2], r->gain[3], "filter_si", observer, "eigenvalues", eigenvalues);
}

void result_control_store(json_t *document, const struct hlpv_spec *spec,
                          const struct hlpv_trajectory *t) {
  json_t *steps = json_array(), *modes = json_object();
  for (size_t i = 0; i < t->tracking->count; i++) {
    json_array_append_new(steps, step_object(spec, &t->tracking->step[i]));
  }
  for (int mode = 0; mode < spec->mode_count; mode++) {
    json_t *regions = json_array();
    for (int i = 0; i < t->design->regions; i++) {
      const struct design_region *region = &t->design->region[mode][i];
      if (region->valid) {
        json_array_append_new(regions, region_object(region));
      }
    }
    json_object_set_new(modes, spec->mode[mode].name, regions);
  }
  json_object_set_new(document, "steps", steps);
  json_object_set_new(
      document, "control",
      json_pack("{s:f, s:o}", "interval_s", spec->control->interval, "regions", modes));
}
