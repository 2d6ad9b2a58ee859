#include "solver/identify/response.h"

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

/* States: h and v from a unit of h, of v, and of p, then p. They are scaled to be of order 1: v by
 * the frequency W = sqrt(k/m), h from v by 1/W, h from p by gamma/k. Then
 *   h' = W v,  v' = -W h - (b/m) v + W p,  p' = alpha p. */
enum { STATES = 7, PRESSURE = 6, PAIRS = 3 };

static const double swinging = 0.2; /* damping ratio below which Adams-Moulton is faster */

/* Derivatives are to parameters in these units: k, critical damping, |alpha|, m, gamma. */
struct rates {
  double frequency, damping, critical, alpha;
};

struct response {
  struct rates rates;
  SUNContext context;
  void *cvode;     /* that of the motion at hand */
  void *method[2]; /* BDF for what creeps, Adams-Moulton for what swings */
  N_Vector y, *slope;
  SUNMatrix jacobian[2];
  SUNLinearSolver solver[2];
  double tolerance;
  int parameters; /* differentiated by */
  long steps;
};

/* ---- what CVODES calls -------------------------------------------------------------------- */

static void flow(const struct rates *r, const double *y, double *rate) {
  for (int i = 0; i < PAIRS; i++) {
    rate[2 * i] = r->frequency * y[2 * i + 1];
    rate[2 * i + 1] = -r->frequency * y[2 * i] - r->damping * y[2 * i + 1];
  }
  rate[5] += r->frequency * y[PRESSURE];
  rate[PRESSURE] = r->alpha * y[PRESSURE];
}

static int derivative(double time, N_Vector y, N_Vector rate, void *context) {
  (void)time;
  const struct response *response = context;
  flow(&response->rates, NV_DATA_S(y), NV_DATA_S(rate));
  return 0;
}

static int jacobian(double time, N_Vector y, N_Vector rate, SUNMatrix matrix, void *context,
                    N_Vector work1, N_Vector work2, N_Vector work3) {
  (void)time, (void)y, (void)rate, (void)work1, (void)work2, (void)work3;
  const struct response *response = context;
  const struct rates *r = &response->rates;
  for (int i = 0; i < PAIRS; i++) {
    SM_ELEMENT_D(matrix, 2 * i, 2 * i + 1) = r->frequency;
    SM_ELEMENT_D(matrix, 2 * i + 1, 2 * i) = -r->frequency;
    SM_ELEMENT_D(matrix, 2 * i + 1, 2 * i + 1) = -r->damping;
  }
  SM_ELEMENT_D(matrix, 5, PRESSURE) = r->frequency;
  SM_ELEMENT_D(matrix, PRESSURE, PRESSURE) = r->alpha;
  return 0;
}

/* s' = A s + (dA/dparameter) y for each parameter. */
static int slopes(int count, double time, N_Vector y, N_Vector rate, N_Vector *s, N_Vector *out,
                  void *context, N_Vector work1, N_Vector work2) {
  (void)time, (void)rate, (void)work1, (void)work2;
  const struct response *response = context;
  const struct rates *r = &response->rates;
  const double *x = NV_DATA_S(y);
  for (int j = 0; j < count; j++) {
    flow(r, NV_DATA_S(s[j]), NV_DATA_S(out[j]));
  }
  for (int i = 0; i < PAIRS; i++) {
    double h = r->frequency * x[2 * i], v = x[2 * i + 1];
    NV_Ith_S(out[RESPONSE_BY_STIFFNESS], 2 * i + 1) -= h;
    NV_Ith_S(out[RESPONSE_BY_DAMPING], 2 * i + 1) -= r->critical * v;
    if (count > RESPONSE_BY_MASS) {
      NV_Ith_S(out[RESPONSE_BY_MASS], 2 * i + 1) += h + r->damping * v;
    }
  }
  NV_Ith_S(out[RESPONSE_BY_ALPHA], PRESSURE) += fabs(r->alpha) * x[PRESSURE];
  if (count > RESPONSE_BY_MASS) {
    double force = r->frequency * x[PRESSURE];
    NV_Ith_S(out[RESPONSE_BY_MASS], 5) -= force;
    NV_Ith_S(out[RESPONSE_BY_GAMMA], 5) += force;
  }
  return 0;
}

/* ---- creation ----------------------------------------------------------------------------- */

/* Sensitivities follow the steps of the states: a least-squares fit needs them less exactly.
 * Failures come back as flags, and are not written to standard error. */
static bool set_up(struct response *r, int method) {
  double absolute[RESPONSE_PARAMETERS];
  for (int j = 0; j < r->parameters; j++) {
    absolute[j] = r->tolerance;
  }
  void *cvode = r->method[method] = CVodeCreate(method == 0 ? CV_BDF : CV_ADAMS, r->context);
  return cvode && CVodeSetErrFile(cvode, NULL) == CV_SUCCESS &&
         CVodeInit(cvode, derivative, 0.0, r->y) == CV_SUCCESS &&
         CVodeSetUserData(cvode, r) == CV_SUCCESS &&
         CVodeSStolerances(cvode, r->tolerance, r->tolerance) == CV_SUCCESS &&
         CVodeSetLinearSolver(cvode, r->solver[method], r->jacobian[method]) == CV_SUCCESS &&
         CVodeSetJacFn(cvode, jacobian) == CV_SUCCESS &&
         CVodeSetMaxNumSteps(cvode, 1000000) == CV_SUCCESS &&
         CVodeSensInit(cvode, r->parameters, CV_SIMULTANEOUS, slopes, r->slope) == CV_SUCCESS &&
         CVodeSensSStolerances(cvode, r->tolerance, absolute) == CV_SUCCESS &&
         CVodeSetSensErrCon(cvode, SUNFALSE) == CV_SUCCESS;
}

enum status response_create(double tolerance, int parameters, struct response **response,
                            struct error *error) {
  struct response *r = calloc(1, sizeof *r);
  *response = NULL;
  if (!r || SUNContext_Create(NULL, &r->context) != 0) {
    free(r);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  r->tolerance = tolerance;
  r->parameters = parameters;
  r->y = N_VNew_Serial(STATES, r->context);
  if (r->y) {
    N_VEnableFusedOps_Serial(r->y, SUNTRUE);
    N_VConst(0.0, r->y);
    r->slope = N_VCloneVectorArray(parameters, r->y);
  }
  for (int j = 0; r->slope && j < parameters; j++) {
    N_VConst(0.0, r->slope[j]);
  }
  bool good = r->slope != NULL;
  for (int m = 0; m < 2 && good; m++) {
    r->jacobian[m] = SUNDenseMatrix(STATES, STATES, r->context);
    r->solver[m] = r->jacobian[m] ? SUNLinSol_Dense(r->y, r->jacobian[m], r->context) : NULL;
    good = r->solver[m] && set_up(r, m);
  }
  if (!good) {
    response_destroy(r);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the integrator");
  }
  *response = r;
  return STATUS_OK;
}

void response_destroy(struct response *r) {
  if (!r) {
    return;
  }
  for (int m = 0; m < 2; m++) {
    if (r->method[m]) {
      CVodeFree(&r->method[m]);
    }
    if (r->solver[m]) {
      SUNLinSolFree(r->solver[m]);
    }
    if (r->jacobian[m]) {
      SUNMatDestroy(r->jacobian[m]);
    }
  }
  if (r->slope) {
    N_VDestroyVectorArray(r->slope, r->parameters);
  }
  if (r->y) {
    N_VDestroy(r->y);
  }
  SUNContext_Free(&r->context);
  free(r);
}

long response_steps(const struct response *response) {
  return response->steps;
}

/* ---- integration -------------------------------------------------------------------------- */

static bool start(struct response *r, bool slope) {
  double *y = NV_DATA_S(r->y);
  memset(y, 0, STATES * sizeof *y);
  y[0] = y[3] = y[PRESSURE] = 1.0;
  for (int j = 0; j < r->parameters; j++) {
    N_VConst(0.0, r->slope[j]);
  }
  return CVodeReInit(r->cvode, 0.0, r->y) == CV_SUCCESS &&
         (slope ? CVodeSensReInit(r->cvode, CV_SIMULTANEOUS, r->slope) == CV_SUCCESS
                : CVodeSensToggleOff(r->cvode) == CV_SUCCESS);
}

/* Takes the functions out of a vector of states. */
static void take(const struct response_system *system, double frequency, const double *y,
                 double factor, double *out) {
  out[RESPONSE_HH] = factor * y[0];
  out[RESPONSE_HV] = factor / frequency * y[2];
  out[RESPONSE_HP] = factor * system->gamma / system->stiffness * y[4];
  out[RESPONSE_PP] = factor * y[PRESSURE];
}

static void take_at(struct response *r, const struct response_system *system, double time,
                    double *value, double *slope) {
  const double unit[RESPONSE_PARAMETERS] = {system->stiffness,
                                            2.0 * sqrt(system->stiffness * system->mass),
                                            fabs(system->alpha), system->mass, system->gamma};
  CVodeGetDky(r->cvode, time, 0, r->y);
  take(system, r->rates.frequency, NV_DATA_S(r->y), 1.0, value);
  if (!slope) {
    return;
  }
  CVodeGetSensDky(r->cvode, time, 0, r->slope);
  for (int j = 0; j < r->parameters; j++) {
    take(system, r->rates.frequency, NV_DATA_S(r->slope[j]), 1.0 / unit[j],
         slope + j * RESPONSE_FUNCTIONS);
  }
}

/* Whether the motion is over: all that follows is less than what the tolerance lets pass. */
static bool is_over(const struct response *r, bool slope) {
  double largest = N_VMaxNorm(r->y);
  for (int j = 0; slope && j < r->parameters; j++) {
    largest = fmax(largest, N_VMaxNorm(r->slope[j]));
  }
  return largest < 0.1 * r->tolerance;
}

enum status response_evaluate(struct response *r, const struct response_system *system,
                              const double *time, size_t count, double *value, double *slope,
                              struct error *error) {
  const size_t value_size = RESPONSE_FUNCTIONS;
  const size_t slope_size = RESPONSE_PARAMETERS * RESPONSE_FUNCTIONS;
  double frequency = sqrt(system->stiffness / system->mass), reached = 0.0;
  r->rates =
      (struct rates){frequency, system->damping / system->mass, 2.0 * frequency, system->alpha};
  r->cvode = r->method[r->rates.damping < swinging * r->rates.critical];
  memset(value, 0, count * value_size * sizeof *value);
  if (slope) {
    memset(slope, 0, count * slope_size * sizeof *slope);
  }
  if (!start(r, slope != NULL)) {
    return error_set(error, STATUS_INTERNAL, NULL, "the integrator refuses its state");
  }
  size_t i = 0;
  for (; i < count && time[i] <= 0.0; i++) {
    double *at = value + i * value_size; /* at 0 nothing depends on the coefficients */
    at[RESPONSE_HH] = at[RESPONSE_PP] = 1.0;
  }
  while (i < count) {
    int flag = CVode(r->cvode, time[count - 1], r->y, &reached, CV_ONE_STEP);
    if (flag < 0) {
      return error_set(error, STATUS_DIVERGED, NULL,
                       "no step of the integration meets the tolerance after %.6g s (CVODES: %d)",
                       reached, flag);
    }
    r->steps++;
    for (; i < count && time[i] <= reached; i++) {
      take_at(r, system, time[i], value + i * value_size, slope ? slope + i * slope_size : NULL);
    }
    if (slope) {
      CVodeGetSensDky(r->cvode, reached, 0, r->slope);
    }
    CVodeGetDky(r->cvode, reached, 0, r->y);
    if (is_over(r, slope != NULL)) {
      break;
    }
  }
  return STATUS_OK;
}
