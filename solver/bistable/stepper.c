#include "solver/bistable/stepper.h"

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

/* Acceleration in m/s2 by which the plate may pull at the load before they part: less is round-off
 * of a state at rest. */
#define ADHESION 1e-4

/* Part of a state's size by which it is moved for its derivatives. */
#define DIFFERENCE 1e-8

struct stepper {
  struct bistable_system *system;
  double size[SYSTEM_STATES_MAX];
  double stop;
  SUNContext context;
  void *cvode;
  N_Vector x, tolerance;
  SUNMatrix jacobian;
  SUNLinearSolver solver;
};

/* ---- what CVODE calls --------------------------------------------------------------------- */

static int derivative(double time, N_Vector x, N_Vector rate, void *context) {
  struct stepper *s = context;
  return system_derivative(s->system, time, NV_DATA_S(x), NV_DATA_S(rate)) ? 0 : 1;
}

/* Forward differences by steps of the size of each state: those that CVODE takes by itself drown in
 * round-off where a state is 0, as speeds are at the start, and Newton's method then seems to
 * converge at once. */
static int jacobian(double time, N_Vector x, N_Vector rate, SUNMatrix matrix, void *context,
                    N_Vector work1, N_Vector work2, N_Vector work3) {
  (void)work1, (void)work2, (void)work3;
  struct stepper *s = context;
  double *state = NV_DATA_S(x), moved[SYSTEM_STATES_MAX];
  for (int j = 0; j < s->system->states; j++) {
    double kept = state[j], step = DIFFERENCE * fmax(fabs(kept), s->size[j]);
    state[j] = kept + step;
    bool good = system_derivative(s->system, time, state, moved);
    step = state[j] - kept;
    state[j] = kept;
    if (!good) {
      return 1;
    }
    for (int i = 0; i < s->system->states; i++) {
      SM_ELEMENT_D(matrix, i, j) = (moved[i] - NV_Ith_S(rate, i)) / step;
    }
  }
  return 0;
}

static double or_one(double value) {
  return isfinite(value) ? value : 1.0;
}

bool stepper_roots(struct bistable_system *system, double time, const double x[], double root[]) {
  struct bistable_motion motion;
  int cells = system->spec->cell_count;
  if (!system_motion(system, time, x, &motion)) {
    return false;
  }
  for (int i = 0; i < cells; i++) {
    const struct cell *cell = &system->cell[i];
    double e = system_elongation(system, i, x), p = motion.pressure[cell->actuator];
    double sign = cell->side == LAW_COMPRESSED ? 1.0 : -1.0;
    double *r = root + i * ROOTS_PER_CELL;
    r[ROOT_LIMIT] = or_one(sign * (system_limit(system, i, cell->side, p) - e));
    r[ROOT_END] = or_one(sign * (system_end(system, i, cell->side, p) - e));
    r[ROOT_STOP_FROM] = or_one(e - cell->spec->stop_from);
    r[ROOT_STOP_TO] = or_one(cell->spec->stop_to - e);
  }
  root[cells * ROOTS_PER_CELL] = system->load < 0 ? 1.0
                                 : system->in_contact
                                     ? motion.contact_force + ADHESION * system->spec->load_mass
                                     : x[system->load] - x[0];
  return true;
}

static int roots(double time, N_Vector x, double *value, void *context) {
  struct stepper *s = context;
  return stepper_roots(s->system, time, NV_DATA_S(x), value) ? 0 : -1;
}

/* ---- creation ----------------------------------------------------------------------------- */

/* Failures come back as flags, and are not written to standard error. */
static bool set_up(struct stepper *s) {
  int direction[SYSTEM_ROOTS_MAX], count = s->system->spec->cell_count * ROOTS_PER_CELL + 1;
  for (int i = 0; i < count; i++) {
    direction[i] = -1;
  }
  s->cvode = CVodeCreate(CV_BDF, s->context);
  return s->cvode && CVodeSetErrFile(s->cvode, NULL) == CV_SUCCESS &&
         CVodeInit(s->cvode, derivative, 0.0, s->x) == CV_SUCCESS &&
         CVodeSetUserData(s->cvode, s) == CV_SUCCESS &&
         CVodeSVtolerances(s->cvode, s->system->spec->tolerance, s->tolerance) == CV_SUCCESS &&
         CVodeSetLinearSolver(s->cvode, s->solver, s->jacobian) == CV_SUCCESS &&
         CVodeSetJacFn(s->cvode, jacobian) == CV_SUCCESS &&
         CVodeRootInit(s->cvode, count, roots) == CV_SUCCESS &&
         CVodeSetRootDirection(s->cvode, direction) == CV_SUCCESS &&
         CVodeSetNoInactiveRootWarn(s->cvode) == CV_SUCCESS;
}

enum status stepper_create(struct bistable_system *system, const double size[],
                           struct stepper **stepper, struct error *error) {
  struct stepper *s = calloc(1, sizeof *s);
  *stepper = NULL;
  if (!s || SUNContext_Create(NULL, &s->context) != 0) {
    free(s);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  s->system = system;
  s->x = N_VNew_Serial(system->states, s->context);
  s->tolerance = N_VNew_Serial(system->states, s->context);
  s->jacobian = SUNDenseMatrix(system->states, system->states, s->context);
  if (s->x && s->tolerance && s->jacobian) {
    N_VConst(0.0, s->x);
    for (int i = 0; i < system->states; i++) {
      s->size[i] = size[i];
      NV_Ith_S(s->tolerance, i) = system->spec->tolerance * size[i];
    }
    s->solver = SUNLinSol_Dense(s->x, s->jacobian, s->context);
  }
  if (!s->solver || !set_up(s)) {
    stepper_destroy(s);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  *stepper = s;
  return STATUS_OK;
}

void stepper_destroy(struct stepper *s) {
  if (!s) {
    return;
  }
  if (s->cvode) {
    CVodeFree(&s->cvode);
  }
  if (s->solver) {
    SUNLinSolFree(s->solver);
  }
  if (s->jacobian) {
    SUNMatDestroy(s->jacobian);
  }
  if (s->tolerance) {
    N_VDestroy(s->tolerance);
  }
  if (s->x) {
    N_VDestroy(s->x);
  }
  SUNContext_Free(&s->context);
  free(s);
}

/* ---- integration -------------------------------------------------------------------------- */

enum status stepper_restart(struct stepper *s, double time, const double x[], double stop,
                            struct error *error) {
  s->stop = stop;
  memcpy(NV_DATA_S(s->x), x, (size_t)s->system->states * sizeof *x);
  if (CVodeReInit(s->cvode, time, s->x) != CV_SUCCESS ||
      CVodeSetStopTime(s->cvode, stop) != CV_SUCCESS) {
    return error_set(error, STATUS_INTERNAL, NULL, "the integrator refuses its state at %.9g s",
                     time);
  }
  return STATUS_OK;
}

enum status stepper_step(struct stepper *s, double *time, double x[], bool passed[SYSTEM_ROOTS_MAX],
                         struct error *error) {
  int found[SYSTEM_ROOTS_MAX] = {0}, count = s->system->spec->cell_count * ROOTS_PER_CELL + 1;
  memset(passed, 0, SYSTEM_ROOTS_MAX * sizeof *passed);
  int flag = CVode(s->cvode, s->stop, s->x, time, CV_ONE_STEP);
  if (flag == CV_ILL_INPUT) {
    /* Two roots closer than round-off, as of a state at rest: what follows is a fresh start. */
    memcpy(NV_DATA_S(s->x), x, (size_t)s->system->states * sizeof *x);
    CVodeReInit(s->cvode, *time, s->x);
    CVodeSetStopTime(s->cvode, s->stop);
    flag = CVode(s->cvode, s->stop, s->x, time, CV_ONE_STEP);
  }
  if (flag == CV_TOO_CLOSE) {
    *time = s->stop; /* what is left is round-off */
  } else if (flag < 0) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "no step of the integration meets the tolerance after %.9g s (CVODE: %d)",
                     *time, flag);
  } else if (flag == CV_ROOT_RETURN && CVodeGetRootInfo(s->cvode, found) == CV_SUCCESS) {
    for (int i = 0; i < count; i++) {
      passed[i] = found[i] != 0;
    }
  }
  memcpy(x, NV_DATA_S(s->x), (size_t)s->system->states * sizeof *x);
  return STATUS_OK;
}

void stepper_interpolate(struct stepper *s, double time, double x[]) {
  /* CVODE keeps s->x apart from its history, so that it may serve as output here. */
  if (CVodeGetDky(s->cvode, time, 0, s->x) == CV_SUCCESS) {
    memcpy(x, NV_DATA_S(s->x), (size_t)s->system->states * sizeof *x);
  }
}

void stepper_count(struct stepper *s, struct hlpv_counts *counts) {
  long steps = 0, evaluations = 0;
  CVodeGetNumSteps(s->cvode, &steps);
  CVodeGetNumRhsEvals(s->cvode, &evaluations);
  counts->steps += steps;
  counts->evaluations += evaluations;
  counts->restarts++;
}
