#include "solver/hlpv/ode.h"

#include <assert.h>
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

struct ode {
  struct ode_problem problem;
  double stop;
  SUNContext context;
  void *cvode;
  N_Vector x, tolerance;
  SUNMatrix jacobian;
  SUNLinearSolver solver;
};

/* ---- what CVODE calls --------------------------------------------------------------------- */

static int derivative(double time, N_Vector x, N_Vector rate, void *context) {
  const struct ode_problem *problem = &((const struct ode *)context)->problem;
  return problem->derivative(problem->context, time, NV_DATA_S(x), NV_DATA_S(rate)) ? 0 : 1;
}

static int jacobian(double time, N_Vector x, N_Vector rate, SUNMatrix matrix, void *context,
                    N_Vector work1, N_Vector work2, N_Vector work3) {
  (void)work1, (void)work2, (void)work3;
  const struct ode_problem *problem = &((const struct ode *)context)->problem;
  bool good =
      problem->jacobian(problem->context, time, NV_DATA_S(x), NV_DATA_S(rate), SM_COLS_D(matrix));
  return good ? 0 : 1;
}

static int roots(double time, N_Vector x, double *value, void *context) {
  const struct ode_problem *problem = &((const struct ode *)context)->problem;
  return problem->roots(problem->context, time, NV_DATA_S(x), value) ? 0 : -1;
}

/* ---- creation ----------------------------------------------------------------------------- */

static bool set_roots(struct ode *ode, const int *direction) {
  int count = ode->problem.root_count, wanted[ODE_ROOTS_MAX];
  if (count == 0) {
    return true;
  }
  memcpy(wanted, direction, (size_t)count * sizeof *wanted); /* CVODE takes no const */
  return CVodeRootInit(ode->cvode, count, roots) == CV_SUCCESS &&
         CVodeSetRootDirection(ode->cvode, wanted) == CV_SUCCESS &&
         CVodeSetNoInactiveRootWarn(ode->cvode) == CV_SUCCESS;
}

/* Failures come back as flags, and are not written to standard error. */
static bool set_up(struct ode *ode) {
  const struct ode_problem *problem = &ode->problem;
  ode->cvode = CVodeCreate(problem->method == ODE_ADAMS ? CV_ADAMS : CV_BDF, ode->context);
  return ode->cvode && CVodeSetErrFile(ode->cvode, NULL) == CV_SUCCESS &&
         CVodeInit(ode->cvode, derivative, 0.0, ode->x) == CV_SUCCESS &&
         CVodeSetUserData(ode->cvode, ode) == CV_SUCCESS &&
         CVodeSVtolerances(ode->cvode, problem->tolerance, ode->tolerance) == CV_SUCCESS &&
         CVodeSetLinearSolver(ode->cvode, ode->solver, ode->jacobian) == CV_SUCCESS &&
         CVodeSetJacFn(ode->cvode, jacobian) == CV_SUCCESS && set_roots(ode, problem->direction);
}

enum status ode_create(const struct ode_problem *problem, struct ode **ode, struct error *error) {
  struct ode *o = calloc(1, sizeof *o);
  assert(problem->root_count <= ODE_ROOTS_MAX);
  *ode = NULL;
  if (!o || SUNContext_Create(NULL, &o->context) != 0) {
    free(o);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  o->problem = *problem;
  o->x = N_VNew_Serial(problem->states, o->context);
  o->tolerance = N_VNew_Serial(problem->states, o->context);
  o->jacobian = SUNDenseMatrix(problem->states, problem->states, o->context);
  if (o->x && o->tolerance && o->jacobian) {
    N_VEnableFusedOps_Serial(o->x, SUNTRUE); /* vectors of few states cost little but the calls */
    N_VConst(0.0, o->x);
    for (int i = 0; i < problem->states; i++) {
      NV_Ith_S(o->tolerance, i) = problem->tolerance * problem->size[i];
    }
    o->solver = SUNLinSol_Dense(o->x, o->jacobian, o->context);
  }
  if (!o->solver || !set_up(o)) {
    ode_destroy(o);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  o->problem.size = NULL; /* the caller's, no longer needed */
  o->problem.direction = NULL;
  *ode = o;
  return STATUS_OK;
}

void ode_destroy(struct ode *ode) {
  if (!ode) {
    return;
  }
  if (ode->cvode) {
    CVodeFree(&ode->cvode);
  }
  if (ode->solver) {
    SUNLinSolFree(ode->solver);
  }
  if (ode->jacobian) {
    SUNMatDestroy(ode->jacobian);
  }
  if (ode->tolerance) {
    N_VDestroy(ode->tolerance);
  }
  if (ode->x) {
    N_VDestroy(ode->x);
  }
  SUNContext_Free(&ode->context);
  free(ode);
}

/* ---- integration -------------------------------------------------------------------------- */

static bool start_at(struct ode *ode, double time, const double x[]) {
  memcpy(NV_DATA_S(ode->x), x, (size_t)ode->problem.states * sizeof *x);
  return CVodeReInit(ode->cvode, time, ode->x) == CV_SUCCESS &&
         CVodeSetStopTime(ode->cvode, ode->stop) == CV_SUCCESS;
}

enum status ode_restart(struct ode *ode, double time, const double x[], double stop,
                        struct error *error) {
  ode->stop = stop;
  if (!start_at(ode, time, x)) {
    return error_set(error, STATUS_INTERNAL, NULL, "the integrator refuses its state at %.9g s",
                     time);
  }
  return STATUS_OK;
}

enum status ode_step(struct ode *ode, double *time, double x[], int found[], struct error *error) {
  memset(found, 0, (size_t)ode->problem.root_count * sizeof *found);
  int flag = CVode(ode->cvode, ode->stop, ode->x, time, CV_ONE_STEP);
  if (flag == CV_ILL_INPUT && start_at(ode, *time, x)) {
    /* Two roots closer than round-off, as of a state at rest: what follows is a fresh start. */
    flag = CVode(ode->cvode, ode->stop, ode->x, time, CV_ONE_STEP);
  }
  if (flag == CV_TOO_CLOSE) {
    *time = ode->stop; /* what is left is round-off */
  } else if (flag < 0) {
    return error_set(error, STATUS_DIVERGED, NULL,
                     "no step of the integration meets the tolerance after %.9g s (CVODE: %d)",
                     *time, flag);
  } else if (flag == CV_ROOT_RETURN) {
    CVodeGetRootInfo(ode->cvode, found);
  }
  memcpy(x, NV_DATA_S(ode->x), (size_t)ode->problem.states * sizeof *x);
  return STATUS_OK;
}

void ode_interpolate(struct ode *ode, double time, double x[]) {
  /* CVODE keeps ode->x apart from its history, so that it may serve as output here. */
  if (CVodeGetDky(ode->cvode, time, 0, ode->x) == CV_SUCCESS) {
    memcpy(x, NV_DATA_S(ode->x), (size_t)ode->problem.states * sizeof *x);
  }
}

void ode_count(struct ode *ode, struct hlpv_counts *counts) {
  long steps = 0, evaluations = 0;
  CVodeGetNumSteps(ode->cvode, &steps);
  CVodeGetNumRhsEvals(ode->cvode, &evaluations);
  counts->steps += steps;
  counts->evaluations += evaluations;
  counts->restarts++;
}
