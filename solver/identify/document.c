#include "solver/identify/document.h"

#include <math.h>

#include "solver/identify/estimate.h"
#include "solver/job/json.h"

enum { BAND_POINTS = 41 };

static const char *const state_keys[HLPV_STATES] = {"h_mm", "velocity_m_s", "pressure_kPa"};
static const double state_units[HLPV_STATES] = {1e-3, 1.0, 1e3};

/* ---- coefficients ------------------------------------------------------------------------- */

static bool is_per_mass(const struct identification *id) {
  return isnan(id->spec->mass) && isnan(id->spec->gamma);
}

static const char *coefficient_key(const struct identification *id, int coefficient) {
  static const char *const keys[2][IDENTIFY_COEFFICIENTS] = {
      {"stiffness_N_m", "damping_N_s_m", "alpha_1_s", "beta_1_s"},
      {"stiffness_per_mass_1_s2", "damping_per_mass_1_s", "alpha_1_s", "beta_1_s"}};
  return keys[is_per_mass(id)][coefficient];
}

/* { value, stderr, low, high } of a number in a unit; only the value of one that is given. */
static json_t *number_object(double value, double stderror, double freedom, double unit) {
  json_t *o = json_object();
  double half = estimate_half_width(stderror, freedom);
  json_set_finite(o, "value", value / unit);
  if (stderror > 0.0) {
    json_set_finite(o, "stderr", stderror / unit);
    json_set_finite(o, "low", (value - half) / unit);
    json_set_finite(o, "high", (value + half) / unit);
  }
  return o;
}

static json_t *point_object(const struct identification *id, size_t index) {
  const struct point *point = &id->point[index];
  const struct point_estimate *e = &id->estimate[index];
  const struct group *group = estimate_group(id, index);
  double chi_square = 0.0, noise[2] = {0.0, 0.0};
  for (size_t r = 0; r < point->rows; r++) {
    chi_square += point->residual[r] * point->residual[r];
  }
  for (size_t i = 0; i < point->step_count; i++) {
    noise[0] += id->sigma[2 * point->step[i]->trial] / (double)point->step_count;
    noise[1] += id->sigma[2 * point->step[i]->trial + 1] / (double)point->step_count;
  }
  json_t *o = json_pack("{s:f, s:I, s:I}", "set_point_kPa", 1e-3 * point->set_point, "steps",
                        (json_int_t)point->step_count, "samples", (json_int_t)point->samples);
  for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
    if (isfinite(e->stderror[c])) {
      json_object_set_new(o, coefficient_key(id, c),
                          number_object(e->value[c], e->stderror[c], group->freedom, 1.0));
    }
  }
  double left = (double)point->rows - (double)point->starts - e->visible;
  json_set_finite(o, "chi_square_per_freedom", chi_square / fmax(left, 1.0));
  json_set_finite(o, "noise_h_mm", 1e3 * noise[0]);
  json_set_finite(o, "noise_pressure_kPa", 1e-3 * noise[1]);
  return o;
}

/* The polynomial with its 95 % band over the set-points of its mode. */
static json_t *polynomial_object(const struct identification *id, const struct outcome *outcome,
                                 int mode, int coefficient) {
  const struct polynomial_fit *fit = &outcome->polynomial[mode][coefficient];
  const struct hlpv_mode *m = &outcome->mode[mode];
  json_t *coefficients = json_array(), *band = json_array();
  for (int i = 0; i < fit->value.count; i++) {
    double stderror = sqrt(fit->covariance[i * HLPV_TERMS_MAX + i]);
    json_array_append_new(coefficients,
                          number_object(fit->value.c[i], stderror, fit->freedom, 1.0));
  }
  for (int i = 0; i < BAND_POINTS; i++) {
    double u = m->from + (m->to - m->from) * i / (BAND_POINTS - 1);
    double value = hlpv_polynomial_value(&fit->value, u);
    double half = estimate_half_width(polynomial_stderror(fit, u), fit->freedom);
    json_t *o = json_object();
    json_set_finite(o, "set_point_kPa", 1e-3 * u);
    json_set_finite(o, "value", value);
    json_set_finite(o, "low", value - half);
    json_set_finite(o, "high", value + half);
    json_array_append_new(band, o);
  }
  json_t *o = json_pack("{s:s, s:i, s:i, s:o, s:o}", "per", id->spec->per_name, "degree",
                        fit->value.count - 1, "points", fit->points, "coefficients", coefficients,
                        "band", band);
  json_set_finite(o, "chi_square", fit->chi_square);
  json_set_finite(o, "chance", fit->chance);
  return o;
}

json_t *document_modes(const struct identification *id, const struct outcome *outcome) {
  json_t *modes = json_array();
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    json_t *points = json_array(), *polynomials = json_object();
    double freedom = outcome->polynomial[mode][0].freedom;
    for (size_t i = 0; i < id->point_count; i++) {
      if (id->point[i].mode == mode) {
        json_array_append_new(points, point_object(id, i));
      }
    }
    for (int c = 0; c < IDENTIFY_COEFFICIENTS; c++) {
      if (outcome->polynomial[mode][c].points > 0) {
        json_object_set_new(polynomials, coefficient_key(id, c),
                            polynomial_object(id, outcome, mode, c));
      }
    }
    const struct shared_estimate *rest = &id->rest[mode];
    json_t *o = json_pack("{s:s, s:o, s:o, s:o}", "name", id->spec->mode[mode].name, "rest_mm",
                          number_object(rest->value, rest->stderror, freedom, 1e-3), "points",
                          points, "polynomials", polynomials);
    json_array_append_new(modes, o);
  }
  return modes;
}

/* ---- switches ----------------------------------------------------------------------------- */

json_t *document_transitions(const struct identification *id, const struct outcome *outcome) {
  json_t *transitions = json_array();
  for (int i = 0; i < outcome->jump_count; i++) {
    const struct jump *jump = &outcome->jump[i];
    json_t *reset = json_object(), *level = json_object();
    json_set_finite(level, "value", 1e3 * jump->level);
    json_set_finite(level, "low", 1e3 * jump->low);
    json_set_finite(level, "high", 1e3 * jump->high);
    for (int k = 0; k < HLPV_STATES; k++) {
      json_object_set_new(
          reset, state_keys[k],
          number_object(jump->reset[k], jump->reset_stderror[k], 1e9, state_units[k]));
    }
    json_array_append_new(
        transitions, json_pack("{s:s, s:s, s:s, s:i, s:o, s:o}", "from",
                               id->spec->mode[jump->from].name, "to", id->spec->mode[jump->to].name,
                               "direction", jump->direction > 0 ? "rising" : "falling", "switches",
                               jump->count, "level_mm", level, "reset", reset));
  }
  return transitions;
}

/* ---- trials ------------------------------------------------------------------------------- */

/* The mode of a row, or -1 where it belongs to none. */
static int mode_of_row(const struct identification *id, size_t trial, size_t row) {
  for (size_t i = 0; i < id->steps->count; i++) {
    const struct step *step = &id->steps->step[i];
    if (step->trial == trial && row >= step->first && row < step->first + step->count) {
      return step->mode;
    }
  }
  return -1;
}

static json_t *sample_object(const struct identification *id, const struct outcome *outcome,
                             size_t index, size_t row) {
  const struct trial *trial = &id->trials->trial[index];
  const double *simulated = outcome->simulated + 2 * (outcome->first[index] + row);
  int mode = mode_of_row(id, index, row);
  json_t *o = json_object();
  json_set_finite(o, "time_s", trial->time[row]);
  json_set_finite(o, "set_point_kPa", 1e-3 * trial->set_point[row]);
  json_set_finite(o, "h_mm", 1e3 * trial->h[row]);
  json_set_finite(o, "pressure_kPa", 1e-3 * trial->pressure[row]);
  json_set_finite(o, "simulated_h_mm", 1e3 * simulated[0]);
  json_set_finite(o, "simulated_pressure_kPa", 1e-3 * simulated[1]);
  if (mode >= 0) {
    json_object_set_new(o, "mode", json_string(id->spec->mode[mode].name));
  }
  return o;
}

/* Names of the modes of a trial in the order in which they come. */
static json_t *trial_modes(const struct identification *id, size_t index) {
  json_t *modes = json_array();
  int last = -1;
  for (size_t i = 0; i < id->steps->count; i++) {
    const struct step *step = &id->steps->step[i];
    if (step->trial == index && step->mode != last) {
      last = step->mode;
      json_array_append_new(modes, json_string(id->spec->mode[last].name));
    }
  }
  return modes;
}

json_t *document_trials(const struct identification *id, const struct outcome *outcome) {
  json_t *trials = json_array();
  for (size_t i = 0; i < id->trials->count; i++) {
    const struct trial *trial = &id->trials->trial[i];
    json_t *samples = json_array();
    double range[2], rmse[2];
    size_t stride = (trial->count + IDENTIFY_SAMPLES_MAX - 1) / IDENTIFY_SAMPLES_MAX;
    for (size_t row = 0; row < trial->count; row += stride) {
      json_array_append_new(samples, sample_object(id, outcome, i, row));
    }
    for (int q = 0; q < 2; q++) {
      rmse[q] = outcome_trial_rmse(id, outcome, i, q, &range[q]);
    }
    json_t *o = json_pack("{s:s, s:o, s:b, s:I}", "name", trial->name, "modes", trial_modes(id, i),
                          "held_out", trial->held_out, "rows", (json_int_t)trial->count);
    json_set_finite(o, "rmse_h_mm", 1e3 * rmse[0]);
    json_set_finite(o, "rmse_pressure_kPa", 1e-3 * rmse[1]);
    json_set_finite(o, "nrmse_h", rmse[0] / range[0]);
    json_set_finite(o, "nrmse_pressure", rmse[1] / range[1]);
    json_object_set_new(o, "samples", samples);
    json_array_append_new(trials, o);
  }
  return trials;
}

json_t *document_metrics(const struct identification *id, const struct outcome *outcome) {
  static const char *const keys[2][4] = {
      {"nrmse_h", "nrmse_pressure", "r_squared_h", "r_squared_pressure"},
      {"held_out_nrmse_h", "held_out_nrmse_pressure", "held_out_r_squared_h",
       "held_out_r_squared_pressure"}};
  json_t *metrics = json_object();
  size_t held_out = 0, switches = 0;
  for (size_t i = 0; i < id->trials->count; i++) {
    held_out += id->trials->trial[i].held_out;
  }
  for (int i = 0; i < outcome->jump_count; i++) {
    switches += (size_t)outcome->jump[i].count;
  }
  json_set_finite(metrics, "trials", (double)id->trials->count);
  json_set_finite(metrics, "held_out_trials", (double)held_out);
  json_set_finite(metrics, "points", (double)id->point_count);
  json_set_finite(metrics, "switches", (double)switches);
  for (int part = 0; part < 2; part++) {
    const struct quality *quality = &outcome->quality[part];
    for (int q = 0; q < 2 && quality->samples > 0.0; q++) {
      json_set_finite(metrics, keys[part][q], quality->rmse[q]);
      json_set_finite(metrics, keys[part][2 + q], quality->r_squared[q]);
    }
  }
  json_set_finite(metrics, "residual_correlation_h", outcome->correlation[0]);
  json_set_finite(metrics, "residual_correlation_pressure", outcome->correlation[1]);
  if (id->gamma.free) {
    json_set_finite(metrics, is_per_mass(id) ? "gamma_per_mass_N_kPa_kg" : "gamma_N_kPa",
                    1e3 * id->gamma.value);
  }
  if (id->mass.free) {
    json_set_finite(metrics, "mass_kg", id->mass.value);
  }
  return metrics;
}

/* ---- the model ---------------------------------------------------------------------------- */

static json_t *quantity(double value, const char *unit) {
  return json_sprintf("%.9g %s", value, unit);
}

static json_t *model_polynomial(const struct identification *id,
                                const struct hlpv_polynomial *polynomial, const char *unit) {
  json_t *coefficients = json_array();
  for (int i = 0; i < polynomial->count; i++) {
    json_array_append_new(coefficients, quantity(polynomial->c[i], unit));
  }
  return json_pack("{s:s, s:o}", "per", id->spec->per_name, "coefficients", coefficients);
}

static json_t *model_mode(const struct identification *id, const struct hlpv_mode *m) {
  json_t *o = json_pack("{s:o, s:o, s:o, s:o, s:o}", "rest", quantity(1e3 * m->rest, "mm"),
                        "stiffness", model_polynomial(id, &m->stiffness, "N/m"), "damping",
                        model_polynomial(id, &m->damping, "N s/m"), "alpha",
                        model_polynomial(id, &m->alpha, "1/s"), "beta",
                        model_polynomial(id, &m->beta, "1/s"));
  if (m->to > m->from) {
    json_object_set_new(
        o, "range",
        json_pack("[o, o]", quantity(1e-3 * m->from, "kPa"), quantity(1e-3 * m->to, "kPa")));
  }
  return o;
}

static json_t *model_transition(const struct identification *id, const struct jump *jump) {
  return json_pack("{s:s, s:s, s:{s:o, s:s}, s:{s:o, s:o, s:o}}", "from",
                   id->spec->mode[jump->from].name, "to", id->spec->mode[jump->to].name, "when",
                   "h", quantity(1e3 * jump->level, "mm"), "direction",
                   jump->direction > 0 ? "rising" : "falling", "reset", "h",
                   quantity(1e3 * jump->reset[HLPV_H], "mm"), "velocity",
                   quantity(jump->reset[HLPV_VELOCITY], "m/s"), "pressure",
                   quantity(1e-3 * jump->reset[HLPV_PRESSURE], "kPa"));
}

json_t *document_model(const struct identification *id, const struct outcome *outcome) {
  json_t *modes = json_object(), *transitions = json_array();
  for (int mode = 0; mode < id->spec->mode_count; mode++) {
    json_object_set_new(modes, id->spec->mode[mode].name, model_mode(id, &outcome->mode[mode]));
  }
  for (int i = 0; i < outcome->jump_count; i++) {
    json_array_append_new(transitions, model_transition(id, &outcome->jump[i]));
  }
  json_t *model = json_pack("{s:o, s:o}", "mass", quantity(id->mass.value, "kg"), "gamma",
                            quantity(1e3 * id->gamma.value, "N/kPa"));
  if (id->spec->rest_length > 0.0) {
    json_object_set_new(model, "rest_length", quantity(1e3 * id->spec->rest_length, "mm"));
  }
  json_object_set_new(model, "modes", modes);
  json_object_set_new(model, "transitions", transitions);
  return model;
}
