/* Newton's method: at a fixed lambda, and in a plane normal to the path. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/continuation_internal.h"
#include "solver/base/clock.h"

double continuation_product(const struct continuation_system *system, const double *a,
                            const double *b) {
  double sum = 0;
  for (int i = 0; i < system->size; i++) {
    sum += system->weight[i] * a[i] * b[i];
  }
  return sum;
}

static double metric(const struct continuation_system *system, const double *v) {
  return sqrt(continuation_product(system, v, v));
}

static double largest(int n, const double *v) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    most = fabs(v[i]) > most ? fabs(v[i]) : most;
  }
  return most;
}

enum status continuation_interrupted(const struct continuation_options *options,
                                     struct error *error) {
  if (options->cancelled && options->cancelled(options->cancel_context)) {
    return error_set(error, STATUS_CANCELLED, NULL, "the work was cancelled");
  }
  if (options->deadline_s > 0 && clock_wall_s() > options->deadline_s) {
    return error_set(error, STATUS_TIMEOUT, NULL, "the time limit was reached");
  }
  return STATUS_OK;
}

bool continuation_retry(enum status status) {
  return status == STATUS_DIVERGED || status == STATUS_INVERTED;
}

/* ---- at a fixed lambda ------------------------------------------------------------------- */

/* Damped Newton's method with the natural monotonicity test of Deuflhard (2004): a step is taken
 * when the next correction with the same factor is shorter, whatever the tangent's inertia. */
struct newton {
  const struct continuation_system *system;
  const struct continuation_options *options;
  double lambda;
  double *x, *trial, *step, *next, *residual;
  double damping;
  int factorisations, negative;
};

static enum status linearise(struct newton *n, struct error *error) {
  const struct continuation_system *s = n->system;
  enum status status = s->evaluate(s->context, n->x, n->lambda, true, n->residual, NULL, error);
  if (status == STATUS_OK) {
    n->factorisations++;
    status = s->factor(s->context, &n->negative, error);
  }
  if (status == STATUS_OK) {
    s->solve(s->context, n->residual, n->step);
  }
  return status;
}

/* Finds the damping with which the simplified correction n->next gets shorter, and moves. */
static enum status damp(struct newton *n, double length, double *next, struct error *error) {
  const struct continuation_system *s = n->system;
  double limit = n->options->increment_max, top = largest(s->size, n->step);
  double damping = fmin(1, 4 * n->damping);
  if (limit > 0 && damping * top > limit) {
    damping = limit / top;
  }
  for (const double least = 1e-4 * damping; damping > least; damping *= 0.5) {
    for (int i = 0; i < s->size; i++) {
      n->trial[i] = n->x[i] - damping * n->step[i];
    }
    enum status status =
        s->evaluate(s->context, n->trial, n->lambda, false, n->residual, NULL, error);
    if (status == STATUS_INVERTED) {
      continue;
    }
    if (status != STATUS_OK) {
      return status;
    }
    s->solve(s->context, n->residual, n->next);
    *next = metric(s, n->next);
    double swing = n->options->swing;
    double settled = (length <= swing * n->options->tolerance ? swing : 1) * n->options->tolerance;
    if (*next <= (1 - 0.25 * damping) * length || *next <= settled) {
      memcpy(n->x, n->trial, sizeof *n->x * (size_t)s->size);
      n->damping = damping;
      return STATUS_OK;
    }
  }
  return error_set(error, STATUS_DIVERGED, NULL, "Newton's method found no descent");
}

static enum status iterate(struct newton *n, struct error *error) {
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < n->options->iterations_max; k++) {
    status = continuation_interrupted(n->options, error);
    if (status == STATUS_OK) {
      status = linearise(n, error);
    }
    double length = status == STATUS_OK ? metric(n->system, n->step) : 0, next = 0;
    if (status == STATUS_OK && !isfinite(length)) {
      return error_set(error, STATUS_DIVERGED, NULL, "the tangent is singular");
    }
    if (status == STATUS_OK) {
      status = damp(n, length, &next, error);
    }
    if (n->options->verbose > 1) {
      fprintf(stderr, "  newton %d: step %.3g next %.3g damping %.3g negative %d\n", k, length,
              next, n->damping, n->negative);
    }
    double swing = n->options->swing;
    bool swings = length <= swing * n->options->tolerance && next > 0.5 * length;
    bool small = next <= (swings ? swing : 1) * n->options->tolerance;
    if (status == STATUS_OK && n->damping == 1 && small) {
      for (int i = 0; i < n->system->size; i++) {
        n->x[i] -= n->next[i];
      }
      return STATUS_OK;
    }
  }
  return status != STATUS_OK ? status
                             : error_set(error, STATUS_DIVERGED, NULL,
                                         "Newton's method did not converge in %d "
                                         "iterations",
                                         n->options->iterations_max);
}

enum status continuation_correct(const struct continuation_system *system,
                                 const struct continuation_options *options, double lambda,
                                 double *x, int *negative, int *iterations, struct error *error) {
  size_t size = (size_t)system->size;
  double *room = calloc(5 * size + 1, sizeof *room);
  if (!room) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", system->size);
  }
  struct newton n = {.system = system,
                     .options = options,
                     .lambda = lambda,
                     .damping = 1,
                     .x = room,
                     .trial = room + size,
                     .step = room + 2 * size,
                     .next = room + 3 * size,
                     .residual = room + 4 * size};
  memcpy(n.x, x, sizeof *x * size);
  enum status status = iterate(&n, error);
  if (status == STATUS_OK) {
    memcpy(x, n.x, sizeof *x * size);
  }
  if (negative) {
    *negative = n.negative;
  }
  if (iterations) {
    *iterations = n.factorisations;
  }
  free(room);
  return status;
}

/* ---- normal to the path ------------------------------------------------------------------ */

static double squared(double v) {
  return v * v;
}

void path_tangent(struct path_work *work, const struct path_state *behind,
                  struct path_state *state) {
  const struct continuation_system *s = work->system;
  double scale = squared(work->options->lambda_scale);
  double length = sqrt(continuation_product(s, work->load, work->load) + scale);
  double sign = 1;
  if (behind) {
    double along = -continuation_product(s, work->load, behind->t) + scale * behind->rate;
    sign = along < 0 ? -1 : 1;
  }
  state->rate = sign / length;
  for (int i = 0; i < s->size; i++) {
    state->t[i] = -state->rate * work->load[i];
  }
}

/* One correction of `to`; *length receives its metric. */
static enum status plane_step(struct path_work *work, const struct path_state *from,
                              struct path_state *to, double *length, struct error *error) {
  const struct continuation_system *s = work->system;
  const struct continuation_options *o = work->options;
  double scale = squared(o->lambda_scale);
  enum status status =
      s->evaluate(s->context, to->x, to->lambda, true, work->residual, work->load, error);
  if (status == STATUS_OK) {
    work->factorisations++;
    status = s->factor(s->context, &to->negative, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  s->solve(s->context, work->residual, work->residual);
  s->solve(s->context, work->load, work->load);
  double along = continuation_product(s, from->t, work->load);
  double change = continuation_product(s, from->t, work->residual) / (scale * from->rate - along);
  for (int i = 0; i < s->size; i++) {
    work->residual[i] += change * work->load[i];
  }
  double d = continuation_product(s, work->residual, work->residual);
  *length = sqrt(d + scale * change * change);
  double top = largest(s->size, work->residual);
  if (!isfinite(*length) || (o->increment_max > 0 && top > o->increment_max)) {
    return error_set(error, STATUS_DIVERGED, NULL, "a correction of the path is too long");
  }
  for (int i = 0; i < s->size; i++) {
    to->x[i] -= work->residual[i];
  }
  to->lambda += change;
  return STATUS_OK;
}

enum status path_correct(struct path_work *work, const struct path_state *from, double step,
                         struct path_state *to, struct error *error) {
  const struct continuation_options *o = work->options;
  double before = fabs(step), length = 0;
  for (int k = 0; k < o->iterations_max; k++) {
    enum status status = continuation_interrupted(o, error);
    if (status == STATUS_OK) {
      status = plane_step(work, from, to, &length, error);
    }
    if (o->verbose > 1) {
      fprintf(stderr, "  path %d: correction %.3g lambda %.8g negative %d\n", k, length, to->lambda,
              to->negative);
    }
    if (status != STATUS_OK) {
      return status;
    }
    /* The next correction of a quadratic sequence is at most length^2 / before. */
    if (length <= o->tolerance ||
        (k > 0 && length < 1e-3 * fabs(step) && length * length / before < 0.1 * o->tolerance)) {
      path_tangent(work, from, to);
      return STATUS_OK;
    }
    if (k > 1 && length <= o->swing * o->tolerance && length > 0.5 * before) {
      path_tangent(work, from, to);
      return STATUS_OK;
    }
    if (k > 1 && length > before) {
      break;
    }
    before = length;
  }
  return error_set(error, STATUS_DIVERGED, NULL, "a step of %.3g along the path did not converge",
                   step);
}
