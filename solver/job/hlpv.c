#include "solver/job/hlpv.h"

#include <math.h>
#include <stdlib.h>

#include "solver/job/hlpv_control.h"

void hlpv_input_release(struct hlpv_input *input) {
  free(input->time);
  free(input->value);
  *input = (struct hlpv_input){0};
}

void hlpv_control_destroy(struct hlpv_control *control) {
  if (control) {
    hlpv_input_release(&control->reference);
    free(control);
  }
}

void hlpv_spec_destroy(struct hlpv_spec *spec) {
  if (spec) {
    hlpv_control_destroy(spec->control);
    hlpv_input_release(&spec->input);
    free(spec);
  }
}

double hlpv_polynomial_value(const struct hlpv_polynomial *polynomial, double set_point) {
  double u = set_point / polynomial->per, value = 0.0;
  for (int i = polynomial->count - 1; i >= 0; i--) {
    value = value * u + polynomial->c[i];
  }
  return value;
}

void hlpv_derivative(const struct hlpv_spec *spec, int mode, double set_point,
                     const double x[HLPV_STATES], double derivative[HLPV_STATES]) {
  const struct hlpv_mode *m = &spec->mode[mode];
  double k = hlpv_polynomial_value(&m->stiffness, set_point);
  double b = hlpv_polynomial_value(&m->damping, set_point);
  derivative[HLPV_H] = x[HLPV_VELOCITY];
  derivative[HLPV_VELOCITY] =
      (spec->gamma * x[HLPV_PRESSURE] - k * (x[HLPV_H] - m->rest) - b * x[HLPV_VELOCITY]) /
      spec->mass;
  derivative[HLPV_PRESSURE] = hlpv_polynomial_value(&m->alpha, set_point) * x[HLPV_PRESSURE] +
                              hlpv_polynomial_value(&m->beta, set_point) * set_point;
}

/* Index of the last point at or before `time`, found by halving. */
static size_t point_before(const struct hlpv_input *input, double time) {
  size_t low = 0, high = input->count;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (input->time[middle] <= time) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

double hlpv_set_point(const struct hlpv_input *input, double time) {
  if (input->profile == HLPV_SINE) {
    return input->mean +
           input->amplitude * sin(2.0 * acos(-1.0) * input->frequency * time + input->phase);
  }
  size_t i = point_before(input, time);
  if (input->profile == HLPV_HELD || i + 1 == input->count) {
    return input->value[i];
  }
  double part = (time - input->time[i]) / (input->time[i + 1] - input->time[i]);
  return input->value[i] + part * (input->value[i + 1] - input->value[i]);
}

double hlpv_rest(const struct hlpv_spec *spec, int mode, double set_point) {
  const struct hlpv_mode *m = &spec->mode[mode];
  return m->rest + spec->gamma * set_point / hlpv_polynomial_value(&m->stiffness, set_point);
}

bool hlpv_is_crossed(const struct hlpv_spec *spec, const struct hlpv_transition *transition,
                     double set_point, const double x[HLPV_STATES]) {
  double beyond = transition->direction * (x[transition->quantity] - transition->level);
  if (beyond != 0.0) {
    return beyond > 0.0;
  }
  double derivative[HLPV_STATES];
  hlpv_derivative(spec, transition->from, set_point, x, derivative);
  return transition->direction * derivative[transition->quantity] > 0.0;
}
