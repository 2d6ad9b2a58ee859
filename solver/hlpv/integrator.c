#include "solver/hlpv/integrator.h"

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

struct integrator {
  const struct hlpv_spec *spec;
  int mode;
  struct set_point set_point;
  double stop;
  SUNContext context;
  void *cvode;
  N_Vector x, tolerance;
  SUNMatrix jacobian;
  SUNLinearSolver solver;
};

double set_point_at(const struct set_point *set_point, double time) {
  return set_point->input->profile == HLPV_SINE
             ? hlpv_set_point(set_point->input, time)
             : set_point->value + set_point->slope * (time - set_point->start);
}

/* ---- what CVODE calls --------------------------------------------------------------------- */

static int derivative(double time, N_Vector x, N_Vector rate, void *context) {
  const struct integrator *in = context;
  hlpv_derivative(in->spec, in->mode, set_point_at(&in->set_point, time), NV_DATA_S(x),
                  NV_DATA_S(rate));
  return 0;
}

/* d(h', v', p') / d(h, v, p), columns one after the other. */
static int jacobian(double time, N_Vector x, N_Vector rate, SUNMatrix matrix, void *context,
                    N_Vector work1, N_Vector work2, N_Vector work3) {
  (void)x, (void)rate, (void)work1, (void)work2, (void)work3;
  const struct integrator *in = context;
  const struct hlpv_mode *mode = &in->spec->mode[in->mode];
  double u = set_point_at(&in->set_point, time), mass = in->spec->mass;
  double *column[HLPV_STATES];
  for (int i = 0; i < HLPV_STATES; i++) {
    column[i] = SM_COLUMN_D(matrix, i);
    memset(column[i], 0, HLPV_STATES * sizeof *column[i]);
  }
  column[HLPV_H][HLPV_VELOCITY] = -hlpv_polynomial_value(&mode->stiffness, u) / mass;
  column[HLPV_VELOCITY][HLPV_H] = 1.0;
  column[HLPV_VELOCITY][HLPV_VELOCITY] = -hlpv_polynomial_value(&mode->damping, u) / mass;
  column[HLPV_PRESSURE][HLPV_VELOCITY] = in->spec->gamma / mass;
  column[HLPV_PRESSURE][HLPV_PRESSURE] = hlpv_polynomial_value(&mode->alpha, u);
  return 0;
}

/* For each transition its guard and the rate of its quantity; those of other modes never vanish. */
static int roots(double time, N_Vector x, double *value, void *context) {
  const struct integrator *in = context;
  double rate[HLPV_STATES];
  hlpv_derivative(in->spec, in->mode, set_point_at(&in->set_point, time), NV_DATA_S(x), rate);
  for (int i = 0; i < in->spec->transition_count; i++) {
    const struct hlpv_transition *transition = &in->spec->transition[i];
    bool here = transition->from == in->mode;
    value[2 * i] = here ? NV_Ith_S(x, transition->quantity) - transition->level : 1.0;
    value[2 * i + 1] = here ? rate[transition->quantity] : 1.0;
  }
  return 0;
}

/* ---- creation ----------------------------------------------------------------------------- */

static bool set_roots(struct integrator *in) {
  int count = in->spec->transition_count, direction[2 * HLPV_TRANSITIONS_MAX];
  for (int i = 0; i < count; i++) {
    direction[2 * i] = in->spec->transition[i].direction;
    direction[2 * i + 1] = -in->spec->transition[i].direction;
  }
  return count == 0 || (CVodeRootInit(in->cvode, 2 * count, roots) == CV_SUCCESS &&
                        CVodeSetRootDirection(in->cvode, direction) == CV_SUCCESS &&
                        CVodeSetNoInactiveRootWarn(in->cvode) == CV_SUCCESS);
}

/* Failures come back as flags, and are not written to standard error. */
static bool set_up(struct integrator *in) {
  in->cvode = CVodeCreate(CV_ADAMS, in->context);
  return in->cvode && CVodeSetErrFile(in->cvode, NULL) == CV_SUCCESS &&
         CVodeInit(in->cvode, derivative, 0.0, in->x) == CV_SUCCESS &&
         CVodeSetUserData(in->cvode, in) == CV_SUCCESS &&
         CVodeSVtolerances(in->cvode, in->spec->tolerance, in->tolerance) == CV_SUCCESS &&
         CVodeSetLinearSolver(in->cvode, in->solver, in->jacobian) == CV_SUCCESS &&
         CVodeSetJacFn(in->cvode, jacobian) == CV_SUCCESS && set_roots(in);
}

enum status integrator_create(const struct hlpv_spec *spec, const double size[HLPV_STATES],
                              struct integrator **integrator, struct error *error) {
  struct integrator *in = calloc(1, sizeof *in);
  *integrator = NULL;
  if (!in || SUNContext_Create(NULL, &in->context) != 0) {
    free(in);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  in->spec = spec;
  in->x = N_VNew_Serial(HLPV_STATES, in->context);
  in->tolerance = N_VNew_Serial(HLPV_STATES, in->context);
  in->jacobian = SUNDenseMatrix(HLPV_STATES, HLPV_STATES, in->context);
  if (in->x && in->tolerance && in->jacobian) {
    N_VEnableFusedOps_Serial(in->x, SUNTRUE); /* vectors of three cost little but the calls */
    N_VConst(0.0, in->x);
    for (int i = 0; i < HLPV_STATES; i++) {
      NV_Ith_S(in->tolerance, i) = spec->tolerance * size[i];
    }
    in->solver = SUNLinSol_Dense(in->x, in->jacobian, in->context);
  }
  if (!in->solver || !set_up(in)) {
    integrator_destroy(in);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  *integrator = in;
  return STATUS_OK;
}

void integrator_destroy(struct integrator *in) {
  if (!in) {
    return;
  }
  if (in->cvode) {
    CVodeFree(&in->cvode);
  }
  if (in->solver) {
    SUNLinSolFree(in->solver);
  }
  if (in->jacobian) {
    SUNMatDestroy(in->jacobian);
  }
  if (in->tolerance) {
    N_VDestroy(in->tolerance);
  }
  if (in->x) {
    N_VDestroy(in->x);
  }
  SUNContext_Free(&in->context);
  free(in);
}

/* ---- integration -------------------------------------------------------------------------- */

enum status integrator_restart(struct integrator *in, int mode, const struct set_point *set_point,
                               double time, const double x[HLPV_STATES], double stop,
                               struct error *error) {
  in->mode = mode;
  in->set_point = *set_point;
  in->stop = stop;
  memcpy(NV_DATA_S(in->x), x, HLPV_STATES * sizeof *x);
  if (CVodeReInit(in->cvode, time, in->x) != CV_SUCCESS ||
      CVodeSetStopTime(in->cvode, stop) != CV_SUCCESS) {
    return error_set(error, STATUS_INTERNAL, NULL, "the integrator refuses its state at %.9g s",
                     time);
  }
  return STATUS_OK;
}

static void find_roots(struct integrator *in, int root[HLPV_TRANSITIONS_MAX]) {
  int found[2 * HLPV_TRANSITIONS_MAX] = {0};
  CVodeGetRootInfo(in->cvode, found);
  for (int i = 0; i < in->spec->transition_count; i++) {
    root[i] = (found[2 * i] ? ROOT_GUARD : 0) | (found[2 * i + 1] ? ROOT_EXTREMUM : 0);
  }
}

enum status integrator_step(struct integrator *in, double *time, double x[HLPV_STATES],
                            int root[HLPV_TRANSITIONS_MAX], struct error *error) {
  memset(root, 0, HLPV_TRANSITIONS_MAX * sizeof *root);
  int flag = CVode(in->cvode, in->stop, in->x, time, CV_ONE_STEP);
  if (flag == CV_ILL_INPUT) {
    /* Two roots closer than round-off, as of a state at rest: what follows is a fresh start. */
    memcpy(NV_DATA_S(in->x), x, HLPV_STATES * sizeof *x);
    CVodeReInit(in->cvode, *time, in->x);
    CVodeSetStopTime(in->cvode, in->stop);
    flag = CVode(in->cvode, in->stop, in->x, time, CV_ONE_STEP);
  }
  if (flag == CV_TOO_CLOSE) {
    *time = in->stop; /* what is left is round-off */
  } else if (flag < 0) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "no step of the integration meets the tolerance after %.9g s (CVODE: %d)",
                     *time, flag);
  } else if (flag == CV_ROOT_RETURN) {
    find_roots(in, root);
  }
  memcpy(x, NV_DATA_S(in->x), HLPV_STATES * sizeof *x);
  return STATUS_OK;
}

void integrator_interpolate(struct integrator *in, double time, double x[HLPV_STATES]) {
  /* CVODE keeps in->x apart from its history, so that it may serve as output here. */
  if (CVodeGetDky(in->cvode, time, 0, in->x) == CV_SUCCESS) {
    memcpy(x, NV_DATA_S(in->x), HLPV_STATES * sizeof *x);
  }
}

void integrator_count(struct integrator *in, struct hlpv_counts *counts) {
  long steps = 0, evaluations = 0;
  CVodeGetNumSteps(in->cvode, &steps);
  CVodeGetNumRhsEvals(in->cvode, &evaluations);
  counts->steps += steps;
  counts->evaluations += evaluations;
  counts->restarts++;
}
