#include "solver/identify/estimate.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multilarge_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/identify/covariance.h"
#include "solver/identify/doubt.h"
#include "solver/identify/start.h"

enum { ROUNDS_MAX = 4, ITERATIONS_MAX = 50 };

/* One call of the least-squares solver. */
struct task {
  struct identification *id;
  struct group *group;
  const struct layout *layout;
  double *x; /* at which the points' residuals and Jacobians were computed */
  enum status status;
  struct error *error;
};

void identification_parameters(const struct identification *id, size_t point,
                               double parameter[POINT_PARAMETERS]) {
  memcpy(parameter, id->estimate[point].value, IDENTIFY_COEFFICIENTS * sizeof *parameter);
  parameter[POINT_REST] = id->rest[id->point[point].mode].value;
  parameter[POINT_MASS] = id->mass.value;
  parameter[POINT_GAMMA] = id->gamma.value;
}

const struct group *estimate_group(const struct identification *id, size_t point) {
  size_t g = 0;
  while (point >= id->group[g].first + id->group[g].count) {
    g++;
  }
  return &id->group[g];
}

double estimate_half_width(double stderror, double freedom) {
  return gsl_cdf_tdist_Pinv(0.975, fmax(freedom, 1.0)) * stderror;
}

/* ---- what the solver calls ---------------------------------------------------------------- */

/* Takes parameters over; false where one is out of bounds. */
static bool take_over(struct task *task, const double *x) {
  const struct layout *l = task->layout;
  bool inside = true;
  for (int i = 0; i < l->count; i++) {
    *l->slot[i] = x[i] * l->scale[i];
    inside = inside && isfinite(x[i]) && (l->sign[i] == 0.0 || *l->slot[i] * l->sign[i] > 0.0);
  }
  return inside;
}

static bool must_stop(struct task *task) {
  const struct identification *id = task->id;
  if (id->cancelled && id->cancelled(NULL)) {
    task->status = error_set(task->error, STATUS_CANCELLED, NULL, "cancelled");
  } else if (id->deadline_s > 0.0 && clock_wall_s() > id->deadline_s) {
    task->status = error_set(task->error, STATUS_TIMEOUT, NULL,
                             "the time limit was reached before the coefficients settled");
  }
  return task->status != STATUS_OK;
}

/* Evaluates all points of the group at x, unless that is where they stand. */
static bool evaluate(struct task *task, const double *x) {
  struct identification *id = task->id;
  size_t bytes = (size_t)task->layout->count * sizeof *x;
  if (memcmp(task->x, x, bytes) == 0) {
    return true;
  }
  task->x[0] = NAN;
  if (must_stop(task) || !take_over(task, x)) {
    return false;
  }
  for (size_t i = task->group->first; i < task->group->first + task->group->count; i++) {
    double parameter[POINT_PARAMETERS];
    identification_parameters(id, i, parameter);
    enum status status = point_evaluate(&id->point[i], id->trials, id->sigma, parameter, true,
                                        id->response, task->error);
    if (status != STATUS_OK) {
      task->status = status == STATUS_NO_MEMORY ? status : task->status;
      return false;
    }
  }
  memcpy(task->x, x, bytes);
  return true;
}

/* Residuals. Out of bounds they are so large that the solver turns back. */
static int residuals(const gsl_vector *x, void *context, gsl_vector *f) {
  struct task *task = context;
  if (!evaluate(task, x->data)) {
    gsl_vector_set_all(f, 1e20);
    return task->status == STATUS_OK ? GSL_SUCCESS : GSL_EFAILED;
  }
  size_t row = 0;
  for (size_t i = task->group->first; i < task->group->first + task->group->count; i++) {
    const struct point *point = &task->id->point[i];
    memcpy(f->data + row, point->residual, point->rows * sizeof *f->data);
    row += point->rows;
  }
  return GSL_SUCCESS;
}

/* v = J u or J^T u, and the lower half of J^T J; J = -(jacobian of the points) scale. */
static int derivatives(CBLAS_TRANSPOSE_t transpose, const gsl_vector *x, const gsl_vector *u,
                       void *context, gsl_vector *v, gsl_matrix *normal) {
  struct task *task = context;
  if (!evaluate(task, x->data)) {
    return GSL_EFAILED;
  }
  if (v) {
    gsl_vector_set_zero(v);
    layout_multiply(task->layout, task->id, task->group, transpose == CblasTrans, u->data, v->data);
  }
  if (normal) {
    gsl_matrix_set_zero(normal);
    layout_normal(task->layout, task->id, task->group, normal);
  }
  return GSL_SUCCESS;
}

/* ---- one group ---------------------------------------------------------------------------- */

static size_t group_rows(const struct identification *id, const struct group *group) {
  size_t rows = 0;
  for (size_t i = group->first; i < group->first + group->count; i++) {
    rows += id->point[i].rows;
  }
  return rows;
}

/* The scaled parameters as they stand. */
static void set_x(const struct layout *layout, gsl_vector *x) {
  for (int i = 0; i < layout->count; i++) {
    gsl_vector_set(x, (size_t)i, *layout->slot[i] / layout->scale[i]);
  }
}

/* Sum of the squares of the residuals. */
static double cost(const gsl_multilarge_nlinear_workspace *work) {
  double square;
  const gsl_vector *f = gsl_multilarge_nlinear_residual(work);
  gsl_blas_ddot(f, f, &square);
  return square;
}

/* Whether a step has changed nothing that counts: the parameters by less than a millionth, or the
 * sum of squares by less than a hundredth of a standard error does. */
static bool has_settled(const gsl_multilarge_nlinear_workspace *work, double before) {
  int info;
  const gsl_vector *x = gsl_multilarge_nlinear_position(work);
  const gsl_vector *step = gsl_multilarge_nlinear_step(work);
  double after = cost(work), freedom = (double)(work->n - work->p), largest = 0.0;
  for (size_t i = 0; i < step->size; i++) {
    largest = fmax(largest, fabs(gsl_vector_get(step, i)) / (fabs(gsl_vector_get(x, i)) + 0.01));
  }
  return gsl_multilarge_nlinear_test(1e-6, 1e-9, 0.0, &info, work) == GSL_SUCCESS ||
         (largest < 0.01 && before - after < 1e-4 * after / freedom);
}

/* Reports an iteration of a fit. Nobody knows how many are to come: every iteration gains a part of
 * what the fit had left, every round of fits half of the whole. */
static void tell(struct identification *id, int iteration) {
  double fitted = (double)id->fitting + 1.0 - 1.0 / (1.0 + 0.3 * iteration);
  double done = 1.0 - pow(0.5, id->round + fitted / (double)id->group_count);
  id->iterations++;
  id->reported = fmax(id->reported, done);
  if (id->events) {
    fprintf(id->events,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"step\":%zu,\"steps\":%zu,"
            "\"iteration\":%d}\n",
            id->reported, id->fitting + 1, id->group_count, id->iterations);
    fflush(id->events);
  }
}

static enum status run_solver(struct task *task, gsl_multilarge_nlinear_workspace *work,
                              gsl_vector *x) {
  gsl_multilarge_nlinear_fdf fdf = {.f = residuals,
                                    .df = derivatives,
                                    .n = group_rows(task->id, task->group),
                                    .p = (size_t)task->layout->count,
                                    .params = task};
  int flag = gsl_multilarge_nlinear_init(x, &fdf, work);
  task->group->converged = false;
  for (int i = 0; i < ITERATIONS_MAX && flag == GSL_SUCCESS && !task->group->converged; i++) {
    double before = cost(work);
    flag = gsl_multilarge_nlinear_iterate(work);
    task->group->iterations++;
    tell(task->id, i + 1);
    task->group->converged = flag == GSL_SUCCESS && has_settled(work, before);
  }
  /* No progress to the last digit is an end, too. */
  task->group->converged = task->group->converged || flag == GSL_ENOPROG;
  if (task->status == STATUS_OK && !evaluate(task, gsl_multilarge_nlinear_position(work)->data) &&
      task->status == STATUS_OK) {
    task->status = error_set(task->error, STATUS_DIVERGED, NULL,
                             "the coefficients leave what an actuator can have");
  }
  return task->status;
}

enum status estimate_fit(struct identification *id, struct group *group, struct error *error) {
  struct layout layout;
  struct task task = {.id = id, .group = group, .layout = &layout, .error = error};
  gsl_multilarge_nlinear_workspace *work = NULL;
  gsl_vector *x = NULL;
  gsl_multilarge_nlinear_parameters options = gsl_multilarge_nlinear_default_parameters();
  options.solver = gsl_multilarge_nlinear_solver_mcholesky;
  enum status status = layout_create(id, group, &layout, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t count = (size_t)layout.count;
  task.x = calloc(count, sizeof *task.x);
  x = gsl_vector_alloc(count);
  work = gsl_multilarge_nlinear_alloc(gsl_multilarge_nlinear_trust, &options, group_rows(id, group),
                                      count);
  if (!task.x || !x || !work) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the least squares");
    goto done;
  }
  task.x[0] = NAN;
  set_x(&layout, x);
  status = run_solver(&task, work, x);
done:
  gsl_multilarge_nlinear_free(work);
  gsl_vector_free(x);
  free(task.x);
  layout_release(&layout);
  return status;
}

/* ---- noise -------------------------------------------------------------------------------- */

/* Adds the squares of the residuals of a point to those of their trials, h and pressure apart. */
static void add_squares(const struct point *point, double *sum, double *count) {
  size_t row = 0;
  for (size_t i = 0; i < point->step_count; i++) {
    const struct step *step = point->step[i];
    for (int q = 0; q < 2; q++) {
      for (size_t k = 0; k < step->count; k++) {
        double r = point->residual[row++];
        sum[2 * step->trial + (size_t)q] += r * r;
      }
      count[2 * step->trial + (size_t)q] += (double)step->count;
    }
    row += step->settled ? 2 : 0;
  }
}

/* The noise of each trial from its residuals. Returns the largest factor by which the weight of h
 * against pressure changed. */
static enum status update_noise(struct identification *id, double *change, struct error *error) {
  size_t trials = id->trials->count;
  double *sum = calloc(4 * trials, sizeof *sum), *count = sum ? sum + 2 * trials : NULL;
  if (!sum) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the noise");
  }
  double parameters = 0.0, samples = 0.0, typical[2] = {0.0, 0.0}, seen[2] = {0.0, 0.0};
  *change = 1.0;
  for (size_t i = 0; i < id->point_count; i++) {
    add_squares(&id->point[i], sum, count);
    parameters += IDENTIFY_COEFFICIENTS + (double)id->point[i].starts;
    samples += 2.0 * (double)id->point[i].samples;
  }
  double left = samples > parameters ? samples / (samples - parameters) : 1.0;
  for (size_t i = 0; i < 2 * trials; i++) {
    int q = (int)(i % 2);
    double floor = id->spec->tolerance * id->steps->range[q];
    if (count[i] > 0.0 && id->spec->noise[q] == 0.0) {
      double factor = sqrt(left * sum[i] / count[i]), now = fmax(factor * id->sigma[i], floor);
      *change = fmax(*change, fmax(now / id->sigma[i], id->sigma[i] / now));
      id->sigma[i] = now;
    }
    if (count[i] > 0.0) {
      typical[q] += id->sigma[i];
      seen[q] += 1.0;
    }
  }
  for (size_t i = 0; i < 2 * trials; i++) { /* of trials that are held out */
    if (count[i] == 0.0 && id->spec->noise[i % 2] == 0.0) {
      id->sigma[i] = typical[i % 2] / seen[i % 2];
    }
  }
  free(sum);
  return STATUS_OK;
}

/* ---- all groups --------------------------------------------------------------------------- */

static enum status form_groups(struct identification *id, struct error *error) {
  bool all = id->gamma.free || id->mass.free;
  id->group = calloc(id->point_count, sizeof *id->group);
  if (!id->group) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the groups");
  }
  for (size_t i = 0; i < id->point_count; i++) {
    int mode = id->point[i].mode;
    bool joins = i > 0 && (all || (id->rest[mode].free && id->point[i - 1].mode == mode));
    if (!joins) {
      id->group[id->group_count++].first = i;
    }
    id->group[id->group_count - 1].count++;
  }
  return STATUS_OK;
}

/* Fits every group until its noise stays. */
static enum status fit_rounds(struct identification *id, struct error *error) {
  enum status status = STATUS_OK;
  double change = INFINITY;
  for (int round = 0; round < ROUNDS_MAX && change > 1.05 && status == STATUS_OK; round++) {
    id->round = round;
    for (size_t g = 0; g < id->group_count && status == STATUS_OK; g++) {
      id->fitting = g;
      status = estimate_fit(id, &id->group[g], error);
    }
    if (status == STATUS_OK) {
      status = update_noise(id, &change, error);
    }
  }
  return status;
}

enum status estimate_points(struct identification *id, struct error *error) {
  enum status status = start_noise(id, error);
  if (status == STATUS_OK) {
    status = start_values(id, error);
  }
  if (status == STATUS_OK) {
    status = form_groups(id, error);
  }
  if (status == STATUS_OK) {
    status = fit_rounds(id, error);
  }
  if (status == STATUS_OK) {
    status = doubt_swings(id, error);
  }
  if (status == STATUS_OK && (id->mass.free || id->gamma.free)) {
    status = doubt_inertia(id, error);
  }
  for (size_t g = 0; g < id->group_count && status == STATUS_OK; g++) {
    status = covariance_fill(id, &id->group[g], error);
  }
  return status;
}
