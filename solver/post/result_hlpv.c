#include "solver/post/result_hlpv.h"

#include <math.h>
#include "solver/base/clock.h"
#include "solver/hlpv/simulate.h"
#include "solver/job/hlpv_control.h"
#include "solver/job/json.h"
#include "solver/post/result_control.h"

static void set_extension_ratio(json_t *object, const char *key, const struct hlpv_spec *spec,
                                double h) {
  if (spec->rest_length > 0.0) {
    json_set_finite(object, key, h / spec->rest_length);
  }
}

/* ---- parts of the document ---------------------------------------------------------------- */

static json_t *state_object(const double x[HLPV_STATES]) {
  json_t *o = json_object();
  json_set_finite(o, "h_m", x[HLPV_H]);
  json_set_finite(o, "velocity_m_s", x[HLPV_VELOCITY]);
  json_set_finite(o, "pressure_Pa", x[HLPV_PRESSURE]);
  return o;
}

static json_t *events_array(const struct hlpv_spec *spec, const struct hlpv_trajectory *t) {
  json_t *events = json_array();
  for (size_t i = 0; i < t->event_count; i++) {
    const struct hlpv_event *event = &t->event[i];
    const struct hlpv_transition *transition = &spec->transition[event->transition];
    json_t *o = json_pack("{s:f, s:s, s:s, s:i, s:b}", "time_s", event->time, "from",
                          spec->mode[transition->from].name, "to", spec->mode[transition->to].name,
                          "transition", event->transition, "grazing", event->grazing);
    json_object_set_new(o, "before", state_object(event->before));
    json_object_set_new(o, "after", state_object(event->after));
    json_array_append_new(events, o);
  }
  return events;
}

static json_t *final_object(const struct hlpv_spec *spec, const struct hlpv_trajectory *t) {
  json_t *o = state_object(t->x);
  json_set_finite(o, "time_s", t->time);
  json_object_set_new(o, "mode", json_string(spec->mode[t->mode].name));
  set_extension_ratio(o, "extension_ratio", spec, t->x[HLPV_H]);
  return o;
}

static json_t *samples_array(const struct hlpv_spec *spec, const struct hlpv_trajectory *t) {
  json_t *samples = json_array();
  for (size_t i = 0; i < t->sample_count; i++) {
    const struct hlpv_sample *sample = &t->sample[i];
    json_t *o = json_object();
    json_set_finite(o, "time_s", sample->time);
    json_set_finite(o, "set_point_kPa", 1e-3 * sample->set_point);
    if (spec->control) {
      double wanted = hlpv_set_point(&spec->control->reference, sample->time);
      json_set_finite(o, "reference_mm", 1e3 * wanted);
    }
    json_set_finite(o, "h_mm", 1e3 * sample->x[HLPV_H]);
    json_set_finite(o, "velocity_m_s", sample->x[HLPV_VELOCITY]);
    json_set_finite(o, "pressure_kPa", 1e-3 * sample->x[HLPV_PRESSURE]);
    set_extension_ratio(o, "extension_ratio", spec, sample->x[HLPV_H]);
    json_object_set_new(o, "mode", json_string(spec->mode[sample->mode].name));
    json_array_append_new(samples, o);
  }
  return samples;
}

static json_t *holds_array(const struct hlpv_spec *spec, const struct hlpv_trajectory *t) {
  json_t *holds = json_array();
  for (size_t i = 0; i < t->hold_count; i++) {
    const struct hlpv_hold *hold = &t->hold[i];
    json_t *o = json_object();
    json_set_finite(o, "start_s", hold->start);
    json_set_finite(o, "end_s", hold->end);
    json_set_finite(o, "set_point_kPa", 1e-3 * hold->set_point);
    json_object_set_new(o, "mode", json_string(spec->mode[hold->mode].name));
    json_object_set_new(o, "switches", json_integer(hold->switches));
    json_set_finite(o, "end_h_mm", 1e3 * hold->last[HLPV_H]);
    json_set_finite(o, "end_pressure_kPa", 1e-3 * hold->last[HLPV_PRESSURE]);
    set_extension_ratio(o, "end_extension_ratio", spec, hold->last[HLPV_H]);
    json_set_finite(o, "steady_h_mm", 1e3 * hold->steady_h);
    json_set_finite(o, "steady_pressure_kPa", 1e-3 * hold->steady_pressure);
    set_extension_ratio(o, "steady_extension_ratio", spec, hold->steady_h);
    json_set_finite(o, "steady_force_N", spec->gamma * hold->steady_pressure);
    json_set_finite(o, "settling_time_s", hold->settling);
    json_set_finite(o, "peak_speed_m_s", hold->peak_speed);
    json_array_append_new(holds, o);
  }
  return holds;
}

static json_t *metrics_object(const struct hlpv_spec *spec, const struct hlpv_trajectory *t) {
  json_t *o = json_object();
  double settling = -INFINITY;
  for (size_t i = 0; i < t->hold_count; i++) {
    settling = fmax(settling, t->hold[i].settling);
  }
  set_extension_ratio(o, "extension_ratio", spec, t->highest[HLPV_H]);
  set_extension_ratio(o, "final_extension_ratio", spec, t->x[HLPV_H]);
  json_set_finite(o, "max_h_mm", 1e3 * t->highest[HLPV_H]);
  json_set_finite(o, "min_h_mm", 1e3 * t->lowest[HLPV_H]);
  json_set_finite(o, "max_pressure_kPa", 1e-3 * t->highest[HLPV_PRESSURE]);
  json_set_finite(o, "peak_speed_m_s", t->peak_speed);
  json_set_finite(o, "output_force_N", spec->gamma * t->highest[HLPV_PRESSURE]);
  json_set_finite(o, "settling_time_s", settling);
  json_object_set_new(o, "event_count", json_integer((json_int_t)t->event_count));
  if (t->event_count > 0) {
    json_set_finite(o, "first_event_s", t->event[0].time);
    json_set_finite(o, "last_event_s", t->event[t->event_count - 1].time);
    json_set_finite(o, "trigger_pressure_kPa", 1e-3 * t->event[0].before[HLPV_PRESSURE]);
  }
  if (t->tracking) {
    result_control_metrics(o, t);
  }
  return o;
}

static json_t *polynomial_object(const struct hlpv_polynomial *polynomial) {
  json_t *coefficients = json_array();
  for (int i = 0; i < polynomial->count; i++) {
    json_array_append_new(coefficients, json_real(polynomial->c[i]));
  }
  return json_pack("{s:f, s:o}", "per_Pa", polynomial->per, "coefficients_si", coefficients);
}

static json_t *transition_object(const struct hlpv_spec *spec, const struct hlpv_transition *t) {
  static const char *const levels[HLPV_STATES] = {"h_m", "velocity_m_s", "pressure_Pa"};
  json_t *reset = json_object();
  for (int k = 0; k < HLPV_STATES; k++) {
    if (t->reset[k].factor == 0.0) {
      json_set_finite(reset, levels[k], t->reset[k].value);
    }
  }
  return json_pack("{s:s, s:s, s:{s:f, s:s}, s:o}", "from", spec->mode[t->from].name, "to",
                   spec->mode[t->to].name, "when", levels[t->quantity], t->level, "direction",
                   t->direction > 0 ? "rising" : "falling", "reset", reset);
}

/* The model as it was computed, with what follows from states of rest. */
static json_t *model_object(const struct hlpv_spec *spec) {
  json_t *modes = json_object(), *transitions = json_array();
  for (int i = 0; i < spec->mode_count; i++) {
    const struct hlpv_mode *m = &spec->mode[i];
    json_t *mode =
        json_pack("{s:f, s:o, s:o, s:o, s:o}", "rest_m", m->rest, "stiffness",
                  polynomial_object(&m->stiffness), "damping", polynomial_object(&m->damping),
                  "alpha", polynomial_object(&m->alpha), "beta", polynomial_object(&m->beta));
    json_object_set_new(modes, m->name, mode);
  }
  for (int i = 0; i < spec->transition_count; i++) {
    json_array_append_new(transitions, transition_object(spec, &spec->transition[i]));
  }
  return json_pack("{s:f, s:f, s:f, s:o, s:o}", "mass_kg", spec->mass, "gamma_N_Pa", spec->gamma,
                   "rest_length_m", spec->rest_length, "modes", modes, "transitions", transitions);
}

json_t *result_hlpv_statistics(const struct hlpv_counts *counts, double wall_s, double cpu_s) {
  return json_pack("{s:I, s:I, s:I, s:f, s:f, s:f}", "steps", (json_int_t)counts->steps,
                   "evaluations", (json_int_t)counts->evaluations, "restarts",
                   (json_int_t)counts->restarts, "wall_s", wall_s, "cpu_s", cpu_s, "peak_memory_MB",
                   clock_peak_memory_MB());
}

/* What is over time, and the model. */
static void add_course(json_t *document, const struct hlpv_spec *spec,
                       const struct hlpv_trajectory *t) {
  json_object_set_new(document, "samples", samples_array(spec, t));
  json_object_set_new(document, "events", events_array(spec, t));
  json_object_set_new(document, "final", final_object(spec, t));
  json_object_set_new(document, "holds", holds_array(spec, t));
  if (t->tracking) {
    result_control_store(document, spec, t);
  }
  json_object_set_new(document, "model", model_object(spec));
}

/* ---- the job ------------------------------------------------------------------------------ */

enum status result_hlpv(const struct job_spec *spec, const struct result_hlpv_options *options,
                        json_t **document, enum status *ending, struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  struct hlpv_options simulation = {
      .deadline_s = spec->timeout_s > 0 ? wall + spec->timeout_s : 0,
      .cancelled = options->cancelled,
      .events = options->events,
      .no_samples = options->brief,
  };
  struct hlpv_trajectory t;
  struct error end = {.status = STATUS_OK};
  *document = NULL;
  *ending = hlpv_simulate(spec->hlpv, &simulation, &t, &end);
  double wall_s = clock_wall_s() - wall, cpu_s = clock_cpu_s() - cpu;
  bool good = *ending == STATUS_OK;
  enum status status = STATUS_OK;
  if (*ending == STATUS_NO_MEMORY || *ending == STATUS_INTERNAL) {
    *error = end;
    status = *ending;
    goto done;
  }
  *document =
      json_pack("{s:s, s:s, s:s, s:s, s:s, s:o}", "status", good ? "succeeded" : "diverged",
                "reason", good ? "" : status_word(*ending), "message", good ? "" : end.message,
                "kind", "hlpv", "name", spec->name, "metrics", metrics_object(spec->hlpv, &t));
  if (*document && !options->brief) {
    add_course(*document, spec->hlpv, &t);
  }
  json_t *rest =
      json_pack("{s:o, s:[], s:o, s:{s:s, s:s}}", "warnings",
                json_texts(t.warning[0], sizeof t.warning[0], t.warning_count), "artifacts",
                "statistics", result_hlpv_statistics(&t.counts, wall_s, cpu_s), "provenance",
                "version", PNEULAB_VERSION, "spec_hash", spec->hash);
  if (*document && json_object_update(*document, rest) != 0) {
    json_decref(*document);
    *document = NULL;
  }
  json_decref(rest);
  if (!*document) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
  }
done:
  hlpv_trajectory_release(&t);
  return status;
}
