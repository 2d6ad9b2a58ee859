#include "solver/hlpv/integrator.h"

#include <stdlib.h>
#include <string.h>

#include "solver/hlpv/ode.h"

struct integrator {
  const struct hlpv_spec *spec;
  int mode;
  struct set_point set_point;
  struct ode *ode;
};

double set_point_at(const struct set_point *set_point, double time) {
  return set_point->input->profile == HLPV_SINE
             ? hlpv_set_point(set_point->input, time)
             : set_point->value + set_point->slope * (time - set_point->start);
}

/* ---- the mode as an initial value problem ------------------------------------------------- */

static bool derivative(void *context, double time, const double x[], double rate[]) {
  const struct integrator *in = context;
  hlpv_derivative(in->spec, in->mode, set_point_at(&in->set_point, time), x, rate);
  return true;
}

/* d(h', v', p') / d(h, v, p), columns one after the other. */
static bool jacobian(void *context, double time, const double x[], const double rate[],
                     double *const column[]) {
  (void)x, (void)rate;
  const struct integrator *in = context;
  const struct hlpv_mode *mode = &in->spec->mode[in->mode];
  double u = set_point_at(&in->set_point, time), mass = in->spec->mass;
  for (int i = 0; i < HLPV_STATES; i++) {
    memset(column[i], 0, HLPV_STATES * sizeof *column[i]);
  }
  column[HLPV_H][HLPV_VELOCITY] = -hlpv_polynomial_value(&mode->stiffness, u) / mass;
  column[HLPV_VELOCITY][HLPV_H] = 1.0;
  column[HLPV_VELOCITY][HLPV_VELOCITY] = -hlpv_polynomial_value(&mode->damping, u) / mass;
  column[HLPV_PRESSURE][HLPV_VELOCITY] = in->spec->gamma / mass;
  column[HLPV_PRESSURE][HLPV_PRESSURE] = hlpv_polynomial_value(&mode->alpha, u);
  return true;
}

/* For each transition its guard and the rate of its quantity; those of other modes never vanish. */
static bool roots(void *context, double time, const double x[], double value[]) {
  const struct integrator *in = context;
  double rate[HLPV_STATES];
  hlpv_derivative(in->spec, in->mode, set_point_at(&in->set_point, time), x, rate);
  for (int i = 0; i < in->spec->transition_count; i++) {
    const struct hlpv_transition *transition = &in->spec->transition[i];
    bool here = transition->from == in->mode;
    value[2 * i] = here ? x[transition->quantity] - transition->level : 1.0;
    value[2 * i + 1] = here ? rate[transition->quantity] : 1.0;
  }
  return true;
}

/* ---- creation ----------------------------------------------------------------------------- */

enum status integrator_create(const struct hlpv_spec *spec, const double size[HLPV_STATES],
                              struct integrator **integrator, struct error *error) {
  int direction[2 * HLPV_TRANSITIONS_MAX];
  struct integrator *in = calloc(1, sizeof *in);
  *integrator = NULL;
  if (!in) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  in->spec = spec;
  for (int i = 0; i < spec->transition_count; i++) {
    direction[2 * i] = spec->transition[i].direction;
    direction[2 * i + 1] = -spec->transition[i].direction;
  }
  struct ode_problem problem = {.states = HLPV_STATES,
                                .method = ODE_ADAMS,
                                .tolerance = spec->tolerance,
                                .size = size,
                                .root_count = 2 * spec->transition_count,
                                .direction = direction,
                                .derivative = derivative,
                                .jacobian = jacobian,
                                .roots = roots,
                                .context = in};
  enum status status = ode_create(&problem, &in->ode, error);
  if (status != STATUS_OK) {
    free(in);
    return status;
  }
  *integrator = in;
  return STATUS_OK;
}

void integrator_destroy(struct integrator *in) {
  if (in) {
    ode_destroy(in->ode);
    free(in);
  }
}

/* ---- integration -------------------------------------------------------------------------- */

enum status integrator_restart(struct integrator *in, int mode, const struct set_point *set_point,
                               double time, const double x[HLPV_STATES], double stop,
                               struct error *error) {
  in->mode = mode;
  in->set_point = *set_point;
  return ode_restart(in->ode, time, x, stop, error);
}

enum status integrator_step(struct integrator *in, double *time, double x[HLPV_STATES],
                            int root[HLPV_TRANSITIONS_MAX], struct error *error) {
  int found[2 * HLPV_TRANSITIONS_MAX] = {0};
  enum status status = ode_step(in->ode, time, x, found, error);
  memset(root, 0, HLPV_TRANSITIONS_MAX * sizeof *root);
  for (int i = 0; i < in->spec->transition_count; i++) {
    root[i] = (found[2 * i] ? ROOT_GUARD : 0) | (found[2 * i + 1] ? ROOT_EXTREMUM : 0);
  }
  return status;
}

void integrator_interpolate(struct integrator *in, double time, double x[HLPV_STATES]) {
  ode_interpolate(in->ode, time, x);
}

void integrator_count(struct integrator *in, struct hlpv_counts *counts) {
  ode_count(in->ode, counts);
}
