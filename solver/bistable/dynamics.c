#include "solver/bistable/dynamics.h"

#include <math.h>

#include "solver/base/clock.h"
#include "solver/bistable/computed_law.h"
#include "solver/bistable/hybrid.h"
#include "solver/bistable/simulate.h"
#include "solver/job/json.h"
#include "solver/job/snap.h"

/* Metrics of the motion under names beside those of the paths. */
static const char *const renamed[][2] = {{"snap_speed_m_s", "snap_speed_m_s"},
                                         {"snap_time_s", "snap_time_s"},
                                         {"snap_travel_mm", "snap_travel_mm"},
                                         {"snap_count", "snap_count"},
                                         {"pressure_drop_kPa", "pressure_drop_kPa"},
                                         {"trigger_pressure_kPa", "dynamic_trigger_pressure_kPa"},
                                         {"extension_ratio", "dynamic_extension_ratio"},
                                         {"energy_balance_error_mJ", "energy_balance_error_mJ"}};

static void warn(json_t *document, const char *text) {
  json_t *warnings = json_object_get(document, "warnings");
  if (json_is_array(warnings)) {
    json_array_append_new(warnings, json_string(text));
  }
}

static void add_metrics(json_t *document, const struct bistable_system *system,
                        const struct bistable_trajectory *t) {
  json_t *metrics = json_object_get(document, "metrics");
  json_t *all = bistable_metrics(system, t);
  for (size_t i = 0; i < sizeof renamed / sizeof *renamed; i++) {
    json_t *value = json_object_get(all, renamed[i][0]);
    if (value && metrics) {
      json_object_set(metrics, renamed[i][1], value);
    }
  }
  json_decref(all);
}

static json_t *hybrid_object(const struct hybrid *hybrid) {
  json_t *o = json_object();
  json_set_finite(o, "trigger_kPa", 1e-3 * hybrid->trigger);
  json_set_finite(o, "release_kPa", 1e-3 * hybrid->release);
  json_set_finite(o, "gamma_N_per_kPa", 1e3 * hybrid->gamma);
  json_set_finite(o, "natural_h_mm", 1e3 * hybrid->natural);
  json_set_finite(o, "compressed_difference_mm", 1e3 * hybrid->error[0]);
  json_set_finite(o, "stretched_difference_mm", 1e3 * hybrid->error[1]);
  return o;
}

static void add_hybrid(const struct job_spec *spec, const struct bistable_system *system,
                       const struct bistable_trajectory *t, json_t *document) {
  struct hybrid hybrid;
  struct error error = {.status = STATUS_OK};
  double to = spec->snap->pressure_to;
  if (hybrid_derive(system, to, t, &hybrid, &error) != STATUS_OK) {
    warn(document, error.message);
    return;
  }
  json_t *job = hybrid_job(&hybrid, spec->name, spec->bistable->rest_length, to);
  if (job) {
    json_object_set_new(document, "hlpv", job);
    json_object_set_new(document, "hybrid", hybrid_object(&hybrid));
    json_t *metrics = json_object_get(document, "metrics");
    json_set_finite(metrics, "hybrid_difference_pct",
                    100.0 * fmax(hybrid.error[0], hybrid.error[1]) / hybrid.natural);
  }
}

/* The length of the row at h = 0: of one pair that of the job, or the compressed one of the paths.
 */
static double rest_length(const struct job_spec *spec, const json_t *document) {
  const json_t *length =
      json_object_get(json_object_get(document, "metrics"), "compressed_length_mm");
  double pair =
      spec->snap->rest_length > 0.0 ? spec->snap->rest_length : 1e-3 * json_number_value(length);
  return pair * spec->bistable->cell_count;
}

static void add_motion(const struct bistable_system *system, const struct bistable_trajectory *t,
                       json_t *document) {
  json_t *motion = bistable_parts(system, t);
  for (int i = 0; i < t->warning_count; i++) {
    warn(document, t->warning[i]);
  }
  json_object_set_new(document, "motion", motion);
  add_metrics(document, system, t);
}

/* When the time limit of the job is reached, whose paths have taken what the document says. */
static double deadline(const struct job_spec *spec, const json_t *document) {
  const json_t *taken = json_object_get(json_object_get(document, "statistics"), "wall_s");
  return spec->timeout_s > 0.0 ? clock_wall_s() + spec->timeout_s - json_number_value(taken) : 0.0;
}

enum status bistable_dynamics(const struct job_spec *spec,
                              const struct result_bistable_options *options, json_t *document,
                              struct error *error) {
  struct bistable_spec *bistable = spec->bistable;
  struct bistable_options simulation = {
      .deadline_s = deadline(spec, document),
      .cancelled = options->cancelled,
  };
  struct bistable_trajectory t = {0};
  struct bistable_system system = {0};
  struct error end = {.status = STATUS_OK};
  enum status status =
      computed_law_take(document, bistable->law[0].pointer, &bistable->law[0].table, &end);
  if (status == STATUS_OK) {
    bistable->rest_length = rest_length(spec, document);
    status = system_open(bistable, &system, &end);
  }
  if (status == STATUS_OK) {
    status = bistable_simulate(&system, &simulation, &t, &end);
    add_motion(&system, &t, document);
    add_hybrid(spec, &system, status == STATUS_OK ? &t : NULL, document);
  }
  if (status == STATUS_NO_MEMORY || status == STATUS_INTERNAL) {
    *error = end;
  } else if (status != STATUS_OK) {
    warn(document, end.message);
    status = STATUS_OK;
  }
  bistable_trajectory_release(&t);
  system_close(&system);
  return status;
}
