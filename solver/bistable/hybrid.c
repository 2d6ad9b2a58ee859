#include "solver/bistable/hybrid.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"

/* Time constant of a supply that has none, s. */
#define DIRECT 1e-3
#define KPA 1e3
/* Part of the set-points left out at either end: at limit points states of rest change with a
 * square root, which no polynomial follows. */
#define MARGIN 0.03

enum { POINTS = 60, BISECTIONS = 60, STEPS = 8 };

/* Everything about one side of the row. */
struct side {
  enum law_side side;
  double from, to; /* set-points */
  double rest;
  double u[POINTS], h[POINTS], volume[POINTS];
};

/* The set-point beyond which the side has no state of rest, between `good`, where it has one, and
 * `bad`. */
static double last_rest(const struct law *law, enum law_side side, double good, double bad) {
  for (int n = 0; n < BISECTIONS; n++) {
    double middle = 0.5 * (good + bad);
    if (isnan(law_rest(law, side, middle, 0.0))) {
      bad = middle;
    } else {
      good = middle;
    }
  }
  return good;
}

static enum status find_limits(const struct bistable_system *s, struct hybrid *hybrid,
                               struct error *error) {
  const struct law *law = s->cell[0].law;
  double h[2], p[2], n = s->spec->cell_count;
  law_range(law, h, p);
  bool starts = !isnan(law_rest(law, LAW_COMPRESSED, 0.0, 0.0)) &&
                !isnan(law_rest(law, LAW_STRETCHED, 0.0, 0.0));
  double high = fmax(2.0 * p[1], 1e3), low = fmin(2.0 * p[0], -1e3);
  if (!starts || !isnan(law_rest(law, LAW_COMPRESSED, high, 0.0)) ||
      !isnan(law_rest(law, LAW_STRETCHED, low, 0.0))) {
    return error_set(error, STATUS_INVALID, NULL,
                     "a hybrid model needs two states of rest at 0 kPa, a trigger below %.4g kPa "
                     "and a release above %.4g kPa",
                     1e-3 * high, 1e-3 * low);
  }
  hybrid->trigger = last_rest(law, LAW_COMPRESSED, 0.0, high);
  hybrid->release = last_rest(law, LAW_STRETCHED, 0.0, low);
  hybrid->trigger_h = n * law_rest(law, LAW_COMPRESSED, hybrid->trigger, 0.0);
  hybrid->release_h = n * law_rest(law, LAW_STRETCHED, hybrid->release, 0.0);
  hybrid->return_h = n * law_rest(law, LAW_COMPRESSED, hybrid->release, 0.0);
  hybrid->natural = n * law_rest(law, LAW_STRETCHED, 0.0, 0.0);
  return isnan(hybrid->return_h)
             ? error_set(error, STATUS_INVALID, NULL,
                         "the compressed side has no state of rest at the release, %.4g kPa",
                         1e-3 * hybrid->release)
             : STATUS_OK;
}

/* States of rest over the set-points of the side, measured from that at 0. */
static void find_rests(const struct bistable_system *s, struct side *side) {
  const struct law *law = s->cell[0].law;
  double n = s->spec->cell_count;
  for (int i = 0; i < POINTS; i++) {
    /* dense towards both ends, where polynomials err most */
    double part = 0.5 - 0.5 * cos(3.14159265358979323846 * (i + 0.5) / POINTS);
    part = MARGIN + (1.0 - 2.0 * MARGIN) * part;
    struct law_value value;
    side->u[i] = side->from + part * (side->to - side->from);
    if (fabs(side->u[i]) < 1e-6 * (side->to - side->from)) {
      side->u[i] = 1e-6 * (side->to - side->from); /* k is 0 / 0 at 0 */
    }
    double e = law_rest(law, side->side, side->u[i], 0.0);
    law_evaluate(law, side->side, e, side->u[i], &value);
    side->h[i] = n * e - side->rest;
    side->volume[i] = n * value.volume;
  }
}

/* Least squares of 1 - sum over j of k[j] u^j / k_i; the coefficients into k. */
static bool fit(const struct side *side, double gamma, int count, double k[]) {
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(POINTS, (size_t)count);
  gsl_matrix *x = gsl_matrix_alloc(POINTS, (size_t)count);
  gsl_matrix *covariance = gsl_matrix_alloc((size_t)count, (size_t)count);
  gsl_vector *y = gsl_vector_alloc(POINTS), *c = gsl_vector_alloc((size_t)count);
  bool good = work && x && covariance && y && c;
  double square;
  for (size_t i = 0; good && i < POINTS; i++) {
    double stiffness = gamma * side->u[i] / side->h[i], power = 1.0 / stiffness;
    gsl_vector_set(y, i, 1.0);
    for (size_t j = 0; j < (size_t)count; j++) {
      gsl_matrix_set(x, i, j, power);
      power *= side->u[i] / KPA;
    }
  }
  good = good && gsl_multifit_linear(x, y, c, covariance, &square, work) == GSL_SUCCESS;
  for (int j = 0; good && j < count; j++) {
    k[j] = gsl_vector_get(c, (size_t)j);
  }
  gsl_multifit_linear_free(work);
  gsl_matrix_free(x);
  gsl_matrix_free(covariance);
  gsl_vector_free(y);
  gsl_vector_free(c);
  return good;
}

/* k of the model. */
static double stiffness_at(const struct hybrid *hybrid, int index, double u) {
  double value = 0.0;
  for (int j = hybrid->count[index] - 1; j >= 0; j--) {
    value = value * (u / KPA) + hybrid->k[index][j];
  }
  return value;
}

/* The largest difference of a state of rest; infinite where a stiffness is not positive. */
static double misfit(const struct side *side, double gamma, int count, const double k[]) {
  double most = 0.0;
  for (int i = 0; i < POINTS; i++) {
    double u = side->u[i] / KPA, value = 0.0;
    for (int j = count - 1; j >= 0; j--) {
      value = value * u + k[j];
    }
    most = value > 0.0 ? fmax(most, fabs(gamma * side->u[i] / value - side->h[i])) : INFINITY;
  }
  return most;
}

static enum status fit_stiffness(const struct side *side, double travel, struct hybrid *hybrid,
                                 struct error *error) {
  int index = side->side == LAW_STRETCHED;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  hybrid->error[index] = INFINITY;
  for (int count = 1; count <= HLPV_TERMS_MAX && hybrid->error[index] > HYBRID_FIT * travel;
       count++) {
    double k[HLPV_TERMS_MAX] = {0};
    double most =
        fit(side, hybrid->gamma, count, k) ? misfit(side, hybrid->gamma, count, k) : INFINITY;
    if (most < hybrid->error[index]) {
      hybrid->error[index] = most;
      hybrid->count[index] = count;
      memcpy(hybrid->k[index], k, sizeof k);
    }
  }
  gsl_set_error_handler(handler);
  return isfinite(hybrid->error[index])
             ? STATUS_OK
             : error_set(error, STATUS_INVALID, NULL,
                         "no polynomial gives the states of rest of the %s side",
                         index ? "stretched" : "compressed");
}

/* 1 / tau of the supply. */
static double supply_rate(const struct bistable_system *s, const struct side *side) {
  const struct supply_spec *supply = &s->spec->actuator[0].supply;
  if (supply->model != SUPPLY_CHAMBER) {
    return 1.0 / (supply->model == SUPPLY_LAG ? supply->time_constant : DIRECT);
  }
  double mean = 0.0;
  for (int i = 1; i < POINTS; i++) {
    double u = 0.5 * (side->u[i] + side->u[i - 1]), step = side->u[i] - side->u[i - 1];
    double volume = supply->dead_volume + 0.5 * (side->volume[i] + side->volume[i - 1]);
    double growth = (side->volume[i] - side->volume[i - 1]) / step;
    mean += step * (volume / supply->exponent + (supply->atmosphere + u) * growth);
  }
  mean /= side->u[POINTS - 1] - side->u[0];
  return NORMAL_PRESSURE * supply->conductance / mean;
}

/* Mass that moves with the plate, when speeds rise evenly from the ground. */
static double moved_mass(const struct bistable_spec *spec) {
  int n = spec->cell_count;
  double mass = spec->plate_mass + 0.5 * spec->cell[n - 1].mass;
  for (int i = 1; i < n; i++) {
    double part = (double)i / n;
    mass += 0.5 * (spec->cell[i - 1].mass + spec->cell[i].mass) * part * part;
  }
  return mass;
}

static void find_reset(const struct bistable_system *s, const struct bistable_trajectory *t,
                       struct hybrid *hybrid) {
  const struct bistable_event *last = NULL;
  int snaps = 0;
  hybrid->reset_pressure = hybrid->trigger;
  hybrid->reset_h =
      s->spec->cell_count * law_rest(s->cell[0].law, LAW_STRETCHED, hybrid->trigger, 0.0);
  hybrid->reset_velocity = 0.0;
  for (size_t i = 0; t && i < t->event_count; i++) {
    if (t->event[i].type == EVENT_SNAP) {
      last = &t->event[i];
      snaps++;
    }
  }
  if (snaps != s->spec->cell_count || isnan(last->travel_end)) {
    return;
  }
  for (size_t i = 0; i < t->moment_count && t->moment[i].time <= last->travel_end; i++) {
    hybrid->reset_h = t->moment[i].h;
    hybrid->reset_velocity = t->moment[i].velocity;
    hybrid->reset_pressure = t->moment[i].pressure[0];
  }
}

enum status hybrid_derive(const struct bistable_system *s, double to,
                          const struct bistable_trajectory *t, struct hybrid *hybrid,
                          struct error *error) {
  const struct law *law = s->cell[0].law;
  *hybrid = (struct hybrid){0};
  enum status status = find_limits(s, hybrid, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct law_value held;
  law_evaluate(law, LAW_STRETCHED, hybrid->natural / s->spec->cell_count, to, &held);
  hybrid->gamma = -held.force / to;
  hybrid->mass = moved_mass(s->spec);
  hybrid->damping = s->spec->cell[0].damping / s->spec->cell_count;
  struct side sides[] = {
      {.side = LAW_COMPRESSED, .from = hybrid->release, .to = hybrid->trigger},
      {.side = LAW_STRETCHED, .from = hybrid->release, .to = to, .rest = hybrid->natural}};
  sides[0].rest = s->spec->cell_count * law_rest(law, LAW_COMPRESSED, 0.0, 0.0);
  for (int i = 0; i < 2 && status == STATUS_OK; i++) {
    find_rests(s, &sides[i]);
    hybrid->rate[i] = supply_rate(s, &sides[i]);
    status = fit_stiffness(&sides[i], hybrid->natural, hybrid, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  hybrid->guard[0] = hybrid->gamma * hybrid->trigger / stiffness_at(hybrid, 0, hybrid->trigger);
  hybrid->guard[1] = hybrid->natural - sides[0].rest +
                     hybrid->gamma * hybrid->release / stiffness_at(hybrid, 1, hybrid->release);
  find_reset(s, t, hybrid);
  double *elongations[] = {&hybrid->trigger_h, &hybrid->release_h, &hybrid->return_h,
                           &hybrid->reset_h, &hybrid->natural};
  for (size_t i = 0; i < sizeof elongations / sizeof *elongations; i++) {
    *elongations[i] -= sides[0].rest;
  }
  return status;
}

/* ---- the job ------------------------------------------------------------------------------ */

/* "value unit". */
static json_t *quantity(double value, const char *unit) {
  char text[64];
  snprintf(text, sizeof text, "%.9g %s", value, unit);
  return json_string(text);
}

static json_t *mode_object(const struct hybrid *hybrid, int index, double from, double to) {
  json_t *coefficients = json_array();
  for (int i = 0; i < hybrid->count[index]; i++) {
    json_array_append_new(coefficients, quantity(hybrid->k[index][i], "N/m"));
  }
  return json_pack("{s:o, s:{s:s, s:o}, s:o, s:o, s:o, s:[o, o]}", "rest",
                   quantity(index ? 1e3 * hybrid->natural : 0.0, "mm"), "stiffness", "per", "kPa",
                   "coefficients", coefficients, "damping", quantity(hybrid->damping, "N s/m"),
                   "alpha", quantity(-hybrid->rate[index], "1/s"), "beta",
                   quantity(hybrid->rate[index], "1/s"), "range", quantity(1e-3 * from, "kPa"),
                   quantity(1e-3 * to, "kPa"));
}

static json_t *transitions_array(const struct hybrid *hybrid) {
  return json_pack(
      "[{s:s, s:s, s:{s:o, s:s}, s:{s:o, s:o, s:o}}, {s:s, s:s, s:{s:o, s:s}, s:{s:o, s:o}}]",
      "from", "compressed", "to", "stretched", "when", "h", quantity(1e3 * hybrid->guard[0], "mm"),
      "direction", "rising", "reset", "h", quantity(1e3 * hybrid->reset_h, "mm"), "velocity",
      quantity(hybrid->reset_velocity, "m/s"), "pressure",
      quantity(1e-3 * hybrid->reset_pressure, "kPa"), "from", "stretched", "to", "compressed",
      "when", "h", quantity(1e3 * hybrid->guard[1], "mm"), "direction", "falling", "reset", "h",
      quantity(1e3 * hybrid->return_h, "mm"), "velocity", quantity(0.0, "m/s"));
}

/* Steps of ten time constants and a hundred of the slower decay, up and down. */
static json_t *hold_array(const struct hybrid *hybrid, double to, double *end) {
  json_t *hold = json_array();
  double slowest = 1.0 / fmin(hybrid->rate[0], hybrid->rate[1]);
  double decay = hybrid->damping > 0.0 ? 2.0 * hybrid->mass / hybrid->damping : 0.0;
  double step = ceil(10.0 * fmax(10.0 * slowest, 10.0 * decay)) / 10.0;
  for (int i = 0; i <= 2 * STEPS; i++) {
    double part = i <= STEPS ? (double)i / STEPS : 2.0 - (double)i / STEPS;
    json_array_append_new(
        hold, json_pack("[o, o]", quantity(i * step, "s"), quantity(1e-3 * part * to, "kPa")));
  }
  *end = (2 * STEPS + 1) * step;
  return hold;
}

json_t *hybrid_job(const struct hybrid *hybrid, const char *name, double rest_length, double to) {
  char title[200];
  double end;
  snprintf(title, sizeof title, "hybrid model of %.*s", (int)text_prefix(name, 120), name);
  json_t *hold = hold_array(hybrid, to, &end);
  json_t *model = json_pack(
      "{s:o, s:o, s:{s:o, s:o}, s:o}", "mass", quantity(1e3 * hybrid->mass, "g"), "gamma",
      quantity(1e3 * hybrid->gamma, "N/kPa"), "modes", "compressed",
      mode_object(hybrid, 0, hybrid->release, hybrid->trigger), "stretched",
      mode_object(hybrid, 1, hybrid->release, to), "transitions", transitions_array(hybrid));
  if (model && rest_length > 0.0) {
    json_object_set_new(model, "rest_length", quantity(1e3 * rest_length, "mm"));
  }
  return json_pack("{s:s, s:s, s:o, s:{s:s}, s:{s:o}, s:o, s:o}", "kind", "hlpv", "name", title,
                   "model", model, "initial", "mode", "compressed", "input", "hold", hold, "end",
                   quantity(end, "s"), "sample_rate", quantity(fmin(120.0, 20000.0 / end), "Hz"));
}
