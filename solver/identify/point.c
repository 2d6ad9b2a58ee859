#include "solver/identify/point.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/numbers.h"

enum { N = HLPV_STATES };

/* ---- creation ----------------------------------------------------------------------------- */

static bool belongs(const struct trials *trials, const struct step *step, int mode,
                    double set_point, bool all) {
  return step->mode == mode && step->set_point == set_point &&
         (all ? step->count >= 2 : step->point >= 0 && !trials->trial[step->trial].held_out);
}

/* Gathers the times of all samples, each once; equal ones differ by less than a nanosecond. */
static void gather_times(const struct trials *trials, struct point *point) {
  size_t n = 0;
  for (size_t i = 0; i < point->step_count; i++) {
    const struct step *step = point->step[i];
    const double *time = trials->trial[step->trial].time + step->first;
    for (size_t k = 0; k < step->count; k++) {
      point->time[n++] = time[k] - time[0];
    }
  }
  qsort(point->time, n, sizeof *point->time, numbers_compare);
  point->time_count = 0;
  for (size_t i = 0; i < n; i++) {
    if (i == 0 || point->time[i] - point->time[point->time_count - 1] > 1e-9) {
      point->time[point->time_count++] = point->time[i];
    }
  }
}

static void find_places(const struct trials *trials, struct point *point) {
  size_t n = 0;
  for (size_t i = 0; i < point->step_count; i++) {
    const struct step *step = point->step[i];
    const double *time = trials->trial[step->trial].time + step->first;
    size_t at = 0;
    for (size_t k = 0; k < step->count; k++) {
      while (at + 1 < point->time_count && point->time[at + 1] <= time[k] - time[0]) {
        at++;
      }
      point->place[n++] = at;
    }
  }
}

static bool reserve(struct point *point) {
  size_t samples = point->samples;
  point->residual = calloc(point->rows, sizeof *point->residual);
  point->jacobian = calloc(point->rows * POINT_PARAMETERS, sizeof *point->jacobian);
  point->start = calloc(point->step_count, sizeof *point->start);
  point->time = calloc(samples, sizeof *point->time);
  point->place = calloc(samples, sizeof *point->place);
  point->value = calloc(samples * RESPONSE_FUNCTIONS, sizeof *point->value);
  point->slope = calloc(samples * RESPONSE_PARAMETERS * RESPONSE_FUNCTIONS, sizeof *point->slope);
  return point->residual && point->jacobian && point->start && point->time && point->place &&
         point->value && point->slope;
}

enum status point_create(const struct trials *trials, const struct steps *steps, int mode,
                         double set_point, bool all, struct point *point, struct error *error) {
  *point = (struct point){.mode = mode, .set_point = set_point};
  point->step = calloc(steps->count, sizeof *point->step);
  for (size_t i = 0; point->step && i < steps->count; i++) {
    const struct step *step = &steps->step[i];
    if (belongs(trials, step, mode, set_point, all)) {
      point->step[point->step_count++] = step;
      point->samples += step->count;
      point->rows += 2 * step->count + (step->settled ? 2 : 0);
      point->starts += step->settled ? 2 : N;
    }
  }
  if (!point->step || (point->step_count > 0 && !reserve(point))) {
    point_release(point);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the steps to a set-point");
  }
  if (point->step_count > 0) {
    gather_times(trials, point);
    find_places(trials, point);
  }
  return STATUS_OK;
}

void point_release(struct point *point) {
  free(point->step);
  free(point->start);
  free(point->residual);
  free(point->jacobian);
  free(point->time);
  free(point->place);
  free(point->value);
  free(point->slope);
  *point = (struct point){.mode = 0};
}

/* ---- the motion --------------------------------------------------------------------------- */

/* The state of rest, which motions are relative to:
 *   p_s = -beta u / alpha,   h_s = rest + gamma p_s / k. */
struct rest {
  double h, p;
  double h_by[POINT_PARAMETERS], p_by[POINT_PARAMETERS];
};

static struct rest find_rest(const double *parameter, double u) {
  double k = parameter[POINT_STIFFNESS], alpha = parameter[POINT_ALPHA];
  double gamma = parameter[POINT_GAMMA];
  struct rest rest = {.p = -parameter[POINT_BETA] * u / alpha};
  rest.h = parameter[POINT_REST] + gamma * rest.p / k;
  rest.p_by[POINT_ALPHA] = -rest.p / alpha;
  rest.p_by[POINT_BETA] = -u / alpha;
  for (int j = POINT_ALPHA; j <= POINT_BETA; j++) {
    rest.h_by[j] = gamma / k * rest.p_by[j];
  }
  rest.h_by[POINT_STIFFNESS] = -gamma * rest.p / (k * k);
  rest.h_by[POINT_GAMMA] = rest.p / k;
  rest.h_by[POINT_REST] = 1.0;
  return rest;
}

/* Column of the Jacobian for each parameter of the response. */
static const int column_of[RESPONSE_PARAMETERS] = {POINT_STIFFNESS, POINT_DAMPING, POINT_ALPHA,
                                                   POINT_MASS, POINT_GAMMA};

static void simulate(const double *f, const struct rest *rest, const double *x, double *h,
                     double *p) {
  *h = rest->h + f[RESPONSE_HH] * (x[0] - rest->h) + f[RESPONSE_HV] * x[1] +
       f[RESPONSE_HP] * (x[2] - rest->p);
  *p = rest->p + f[RESPONSE_PP] * (x[2] - rest->p);
}

void point_simulated(const struct point *point, const double parameter[POINT_PARAMETERS],
                     size_t step, size_t sample, double *h, double *pressure) {
  struct rest rest = find_rest(parameter, point->set_point);
  const double *f = point->value + point->place[sample] * RESPONSE_FUNCTIONS;
  simulate(f, &rest, point->start[step].x, h, pressure);
}

/* Derivatives of h and p with the state at the start held. */
static void differentiate(const double *f, const double *slope, const struct rest *rest,
                          const double *x, double *h_by, double *p_by) {
  double off[N] = {x[0] - rest->h, x[1], x[2] - rest->p};
  for (int j = 0; j < POINT_PARAMETERS; j++) {
    h_by[j] = rest->h_by[j] * (1.0 - f[RESPONSE_HH]) - rest->p_by[j] * f[RESPONSE_HP];
    p_by[j] = rest->p_by[j] * (1.0 - f[RESPONSE_PP]);
  }
  for (int j = 0; j < RESPONSE_PARAMETERS; j++) {
    const double *s = slope + j * RESPONSE_FUNCTIONS;
    h_by[column_of[j]] +=
        s[RESPONSE_HH] * off[0] + s[RESPONSE_HV] * off[1] + s[RESPONSE_HP] * off[2];
    p_by[column_of[j]] += s[RESPONSE_PP] * off[2];
  }
}

/* ---- the state at the start --------------------------------------------------------------- */

/* Rows of one step: derivatives z of the residuals to the state at the start, its normal matrix. */
struct rows {
  size_t count;
  double *residual, *jacobian;
  double (*z)[N];
};

/* Inverse of a positive semidefinite matrix; rows and columns that nothing determines become 0. */
static void invert(const double a[N][N], const bool skip[N], double inverse[N * N]) {
  double l[N][N] = {{0}}, size[N];
  bool out[N];
  for (int i = 0; i < N; i++) {
    size[i] = sqrt(a[i][i]);
    out[i] = skip[i] || !(size[i] > 0.0);
  }
  for (int j = 0; j < N; j++) {
    double d = out[j] ? 0.0 : 1.0;
    for (int k = 0; k < j; k++) {
      d -= l[j][k] * l[j][k];
    }
    out[j] = out[j] || d < 1e-12;
    for (int i = j; i < N; i++) {
      double sum = out[i] || out[j] ? 0.0 : a[i][j] / (size[i] * size[j]);
      for (int k = 0; k < j; k++) {
        sum -= l[i][k] * l[j][k];
      }
      l[i][j] = out[j] ? (i == j) : out[i] && i != j ? 0.0 : sum / sqrt(d);
    }
  }
  for (int c = 0; c < N; c++) {
    double x[N] = {0};
    x[c] = out[c] ? 0.0 : 1.0;
    for (int i = 0; i < N; i++) {
      for (int k = 0; k < i; k++) {
        x[i] -= l[i][k] * x[k];
      }
      x[i] /= l[i][i];
    }
    for (int i = N - 1; i >= 0; i--) {
      for (int k = i + 1; k < N; k++) {
        x[i] -= l[k][i] * x[k];
      }
      x[i] /= l[i][i];
    }
    for (int i = 0; i < N; i++) {
      inverse[i * N + c] = out[i] || out[c] ? 0.0 : x[i] / (size[i] * size[c]);
    }
  }
}

static void multiply(const double *inverse, const double *b, double *x) {
  for (int i = 0; i < N; i++) {
    x[i] = 0.0;
    for (int k = 0; k < N; k++) {
      x[i] += inverse[i * N + k] * b[k];
    }
  }
}

/* Takes out of the columns of the Jacobian what the state at the start can follow. */
static void project(const struct rows *rows, const double *inverse) {
  double b[POINT_PARAMETERS][N] = {{0}}, w[POINT_PARAMETERS][N];
  for (size_t i = 0; i < rows->count; i++) {
    const double *line = rows->jacobian + i * POINT_PARAMETERS;
    for (int j = 0; j < POINT_PARAMETERS; j++) {
      for (int k = 0; k < N; k++) {
        b[j][k] += rows->z[i][k] * line[j];
      }
    }
  }
  for (int j = 0; j < POINT_PARAMETERS; j++) {
    multiply(inverse, b[j], w[j]);
  }
  for (size_t i = 0; i < rows->count; i++) {
    double *line = rows->jacobian + i * POINT_PARAMETERS;
    for (int j = 0; j < POINT_PARAMETERS; j++) {
      for (int k = 0; k < N; k++) {
        line[j] -= rows->z[i][k] * w[j][k];
      }
    }
  }
}

/* ---- one step ----------------------------------------------------------------------------- */

/* Fills z, and the residuals of the state of rest alone. */
static void begin_rows(const struct point *point, const struct step *step,
                       const struct trial *trial, const double *sigma, const struct rest *rest,
                       size_t sample, struct rows *rows) {
  size_t n = step->count;
  const double origin[N] = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < n; i++) {
    const double *f = point->value + point->place[sample + i] * RESPONSE_FUNCTIONS;
    double h, p, *zh = rows->z[i], *zp = rows->z[n + i];
    simulate(f, rest, origin, &h, &p);
    rows->residual[i] = (trial->h[step->first + i] - h) / sigma[0];
    rows->residual[n + i] = (trial->pressure[step->first + i] - p) / sigma[1];
    zh[0] = f[RESPONSE_HH] / sigma[0];
    zh[1] = f[RESPONSE_HV] / sigma[0];
    zh[2] = f[RESPONSE_HP] / sigma[0];
    zp[0] = zp[1] = 0.0;
    zp[2] = f[RESPONSE_PP] / sigma[1];
  }
  rows->count = 2 * n;
  for (int q = 0; q < 2 && step->settled; q++) {
    double weight = sqrt((double)step->before_count) / sigma[q];
    double *z = rows->z[rows->count];
    z[0] = q == 0 ? weight : 0.0;
    z[1] = 0.0;
    z[2] = q == 1 ? weight : 0.0;
    rows->residual[rows->count++] = weight * step->before[q];
  }
}

static void solve_start(const struct rows *rows, bool settled, struct point_start *start) {
  double a[N][N] = {{0}}, b[N] = {0};
  const bool skip[N] = {false, settled, false};
  for (size_t i = 0; i < rows->count; i++) {
    for (int k = 0; k < N; k++) {
      b[k] += rows->z[i][k] * rows->residual[i];
      for (int j = 0; j < N; j++) {
        a[k][j] += rows->z[i][k] * rows->z[i][j];
      }
    }
  }
  invert((const double(*)[N])a, skip, start->covariance);
  multiply(start->covariance, b, start->x);
  for (size_t i = 0; i < rows->count; i++) {
    for (int k = 0; k < N; k++) {
      rows->residual[i] -= rows->z[i][k] * start->x[k];
    }
  }
}

static void differentiate_rows(const struct point *point, const struct step *step,
                               const double *sigma, const struct rest *rest, size_t sample,
                               const double *x, struct rows *rows) {
  size_t n = step->count;
  memset(rows->jacobian + 2 * n * POINT_PARAMETERS, 0,
         (rows->count - 2 * n) * POINT_PARAMETERS * sizeof *rows->jacobian);
  for (size_t i = 0; i < n; i++) {
    size_t place = point->place[sample + i];
    double *h_by = rows->jacobian + i * POINT_PARAMETERS;
    double *p_by = rows->jacobian + (n + i) * POINT_PARAMETERS;
    differentiate(point->value + place * RESPONSE_FUNCTIONS,
                  point->slope + place * RESPONSE_PARAMETERS * RESPONSE_FUNCTIONS, rest, x, h_by,
                  p_by);
    for (int j = 0; j < POINT_PARAMETERS; j++) {
      h_by[j] /= sigma[0];
      p_by[j] /= sigma[1];
    }
  }
}

enum status point_evaluate(struct point *point, const struct trials *trials, const double *sigma,
                           const double parameter[POINT_PARAMETERS], bool jacobian,
                           struct response *response, struct error *error) {
  const struct response_system system = {parameter[POINT_STIFFNESS], parameter[POINT_DAMPING],
                                         parameter[POINT_ALPHA], parameter[POINT_MASS],
                                         parameter[POINT_GAMMA]};
  struct rest rest = find_rest(parameter, point->set_point);
  size_t longest = 0, sample = 0, row = 0;
  enum status status = response_evaluate(response, &system, point->time, point->time_count,
                                         point->value, jacobian ? point->slope : NULL, error);
  for (size_t i = 0; i < point->step_count; i++) {
    longest = point->step[i]->count > longest ? point->step[i]->count : longest;
  }
  double(*z)[N] = status == STATUS_OK ? malloc((2 * longest + 2) * sizeof *z) : NULL;
  if (status == STATUS_OK && !z) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for residuals");
  }
  for (size_t i = 0; i < point->step_count && status == STATUS_OK; i++) {
    const struct step *step = point->step[i];
    const double *weight = sigma + 2 * step->trial;
    struct rows rows = {.residual = point->residual + row,
                        .jacobian = point->jacobian + row * POINT_PARAMETERS,
                        .z = z};
    begin_rows(point, step, &trials->trial[step->trial], weight, &rest, sample, &rows);
    solve_start(&rows, step->settled, &point->start[i]);
    if (jacobian) {
      differentiate_rows(point, step, weight, &rest, sample, point->start[i].x, &rows);
      project(&rows, point->start[i].covariance);
    }
    row += rows.count;
    sample += step->count;
  }
  free(z);
  return status;
}
