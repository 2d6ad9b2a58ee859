#include "solver/hlpv/check.h"

#include <math.h>
#include "solver/job/hlpv_control.h"

/* A soft actuator of a hand's size pushes with less than this at 8 psi. */
#define FORCE_MAX 200.0
#define FORCE_PRESSURE 55158.1

/* ---- sizes -------------------------------------------------------------------------------- */

/* Largest magnitude of the set-point. */
static double largest_set_point(const struct hlpv_spec *spec) {
  const struct hlpv_input *input = &spec->input;
  if (spec->control) {
    return fmax(fabs(spec->control->lowest), fabs(spec->control->highest));
  }
  double largest = input->profile == HLPV_SINE ? fabs(input->mean) + fabs(input->amplitude) : 0.0;
  for (size_t i = 0; i < input->count; i++) {
    largest = fmax(largest, fabs(input->value[i]));
  }
  return largest;
}

/* Elongation at rest under the set-point u, the largest of all modes. */
static double largest_rest(const struct hlpv_spec *spec, double u) {
  double largest = 0.0;
  for (int i = 0; i < spec->mode_count; i++) {
    double k = fabs(hlpv_polynomial_value(&spec->mode[i].stiffness, u));
    if (k > 0.0) {
      largest = fmax(largest, spec->gamma * u / k);
    }
  }
  return largest;
}

/* Elongations relax no faster than the pressure that drives them, or else by themselves. */
static double rate_of_change(const struct hlpv_spec *spec, double u, const double size[]) {
  double rate = 0.0, own = 0.0;
  for (int i = 0; i < spec->mode_count; i++) {
    rate = fmax(rate, fabs(hlpv_polynomial_value(&spec->mode[i].alpha, u)));
    own = fmax(own, fabs(hlpv_polynomial_value(&spec->mode[i].stiffness, u)) / spec->mass);
  }
  if (rate == 0.0) {
    rate = sqrt(fmax(own, spec->gamma * size[HLPV_PRESSURE] / (spec->mass * size[HLPV_H])));
  }
  return rate > 0.0 ? rate : 1.0;
}

void check_sizes(const struct hlpv_spec *spec, double size[HLPV_STATES]) {
  double u = largest_set_point(spec);
  for (int i = 0; i < HLPV_STATES; i++) {
    size[i] = fabs(spec->initial[i]);
  }
  for (int i = 0; i < spec->mode_count; i++) {
    size[HLPV_H] = fmax(size[HLPV_H], fabs(spec->mode[i].rest));
  }
  for (int i = 0; i < spec->transition_count; i++) {
    const struct hlpv_transition *transition = &spec->transition[i];
    int q = transition->quantity;
    size[q] = fmax(size[q], fabs(transition->level));
    for (int k = 0; k < HLPV_STATES; k++) {
      size[k] = fmax(size[k], fabs(transition->reset[k].value));
    }
  }
  size[HLPV_PRESSURE] = fmax(size[HLPV_PRESSURE], u);
  if (size[HLPV_PRESSURE] == 0.0) {
    size[HLPV_PRESSURE] = 1.0;
  }
  if (size[HLPV_H] == 0.0) {
    size[HLPV_H] = largest_rest(spec, size[HLPV_PRESSURE]);
  }
  if (size[HLPV_H] == 0.0) {
    size[HLPV_H] = 1e-3;
  }
  size[HLPV_VELOCITY] = fmax(size[HLPV_VELOCITY], size[HLPV_H] * rate_of_change(spec, u, size));
}

/* ---- warnings ----------------------------------------------------------------------------- */

void check_model(struct recorder *recorder) {
  double force = recorder->spec->gamma * FORCE_PRESSURE;
  if (force > FORCE_MAX) {
    recorder_warn(
        recorder,
        "gamma makes %.4g N at 8 psi (55.16 kPa), over %.0f N: is its unit right? a gamma "
        "per psi that is taken for one per kPa is 6.9 times too large",
        force, FORCE_MAX);
  }
}

static void remark(struct recorder *recorder, int mode, enum hlpv_remark kind, double time,
                   double set_point) {
  static const char *const texts[REMARK_COUNT] = {
      "is outside the range for which its coefficients are given",
      "gives it no positive stiffness",
      "gives it a negative damping",
      "gives it a pressure that does not settle: alpha is not negative",
  };
  if (!recorder->told[mode][kind]) {
    recorder->told[mode][kind] = true;
    recorder_warn(recorder, "mode \"%.40s\": the set-point %.6g kPa, at %.6g s, %s",
                  recorder->spec->mode[mode].name, 1e-3 * set_point, time, texts[kind]);
  }
}

static void check_at(struct recorder *recorder, int mode, double time, double u) {
  const struct hlpv_mode *m = &recorder->spec->mode[mode];
  double slack = 1e-6 * fabs(u); /* units of pressure are rounded when they are converted */
  if (u < m->from - slack || u > m->to + slack) {
    remark(recorder, mode, REMARK_RANGE, time, u);
  }
  if (hlpv_polynomial_value(&m->stiffness, u) <= 0.0) {
    remark(recorder, mode, REMARK_STIFFNESS, time, u);
  }
  if (hlpv_polynomial_value(&m->damping, u) < 0.0) {
    remark(recorder, mode, REMARK_DAMPING, time, u);
  }
  if (hlpv_polynomial_value(&m->alpha, u) >= 0.0) {
    remark(recorder, mode, REMARK_PRESSURE, time, u);
  }
}

void check_coefficients(struct recorder *recorder, int mode, double time,
                        const struct set_point *set_point, double stop) {
  const struct hlpv_input *input = set_point->input;
  if (input->profile == HLPV_SINE) {
    check_at(recorder, mode, time, input->mean - fabs(input->amplitude));
    check_at(recorder, mode, time, input->mean + fabs(input->amplitude));
  } else {
    check_at(recorder, mode, time, set_point_at(set_point, time));
    check_at(recorder, mode, stop, set_point_at(set_point, stop));
  }
}
