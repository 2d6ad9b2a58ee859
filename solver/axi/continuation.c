#include "solver/axi/continuation_internal.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is located on the path: zeros of dlambda/ds, of lambda - target[i], of the watched
 * quantities, in this order. */
struct follower {
  struct path_work work;
  struct path_state now, next, trial; /* at the last visit, the candidate, one in between */
  continuation_visit *visit;
  void *visit_context;
  int count;     /* of quantities */
  double *value; /* 3 x count: at now (with the sign of the way ahead), at next, at trial */
  double *room;
  double step;  /* next length */
  double angle; /* by which the tangent may turn now */
  int visited;  /* factorisations until the last visit */
  int settled;  /* negative pivots at the last state that was no limit point */
  int limits;   /* limit points since */
};

struct continuation_options continuation_defaults(double size) {
  return (struct continuation_options){.step = 1e-3 * size,
                                       .step_min = 1e-8 * size,
                                       .step_max = 0.05 * size,
                                       .tolerance = 1e-8 * size,
                                       .swing = 1,
                                       .angle_max = 0.5,
                                       .increment_max = 0.2 * size,
                                       .event_tolerance = 1e-4,
                                       .iterations_max = 12,
                                       .iterations_wanted = 4,
                                       .steps_max = 2000};
}

/* ---- quantities whose zeros are located ---- */

static struct continuation_point point_of(const struct path_state *state) {
  return (struct continuation_point){.x = state->x,
                                     .tangent = state->t,
                                     .lambda = state->lambda,
                                     .lambda_rate = state->rate,
                                     .arc = state->arc,
                                     .negative = state->negative};
}

static void quantities(const struct follower *f, const struct path_state *state, double *value) {
  const struct continuation_options *o = f->work.options;
  value[0] = state->rate;
  for (int i = 0; i < o->target_count; i++) {
    value[1 + i] = state->lambda - o->target[i];
  }
  if (o->watch) {
    struct continuation_point point = point_of(state);
    o->watch(o->watch_context, &point, value + 1 + o->target_count);
  }
}

/* The quantity that passes 0 first between two states, by the chord; -1: none. A value of exactly
 * 0 at the first one is no passage. */
static int first_passage(int count, const double *a, const double *b, double *fraction) {
  int first = -1;
  *fraction = 2;
  for (int i = 0; i < count; i++) {
    if ((a[i] < 0 && b[i] >= 0) || (a[i] > 0 && b[i] <= 0)) {
      double at = a[i] / (a[i] - b[i]);
      if (at < *fraction) {
        *fraction = at;
        first = i;
      }
    }
  }
  return first;
}

/* ---- steps ------------------------------------------------------------------------------- */

static void exchange(struct path_state *a, struct path_state *b) {
  struct path_state t = *a;
  *a = *b;
  *b = t;
}

/* Cosine of the angle between the tangents, which have unit length. */
static double cosine(const struct follower *f, const struct path_state *a,
                     const struct path_state *b) {
  double scale = f->work.options->lambda_scale;
  return continuation_product(f->work.system, a->t, b->t) + scale * scale * a->rate * b->rate;
}

/* Whether the candidate is further from the tangent than twice what an arc would be that turns by
 * the largest angle: then it is on another branch. Where points of contact change their partner the
 * path itself has small steps: they are let pass. */
static bool strayed(const struct follower *f, double step) {
  const struct continuation_system *s = f->work.system;
  double scale = f->work.options->lambda_scale;
  double aside = scale * (f->next.lambda - f->now.lambda - step * f->now.rate), sum = aside * aside;
  for (int i = 0; i < s->size; i++) {
    double d = f->next.x[i] - f->now.x[i] - step * f->now.t[i];
    sum += s->weight[i] * d * d;
  }
  double small = 0.1 * f->work.options->step;
  return sqrt(sum) > fmax(small, 2 * tan(0.5 * f->angle) * fabs(step));
}

/* From now by `step` along the tangent to f->next. */
static enum status advance(struct follower *f, double step, double *turned, struct error *error) {
  int size = f->work.system->size;
  for (int i = 0; i < size; i++) {
    f->next.x[i] = f->now.x[i] + step * f->now.t[i];
  }
  f->next.lambda = f->now.lambda + step * f->now.rate;
  f->next.arc = f->now.arc + step;
  enum status status = path_correct(&f->work, &f->now, step, &f->next, error);
  *turned = status == STATUS_OK ? acos(fmin(1, cosine(f, &f->now, &f->next))) : 0;
  if (status == STATUS_OK && (*turned > f->angle || strayed(f, step))) {
    status = error_set(error, STATUS_DIVERGED, NULL, "the path turns too sharply");
  }
  return status;
}

/* A state between now and next, at the fraction `part` of the step, to f->trial: the guess is the
 * parabola through both with the tangent of the first. */
static enum status between(struct follower *f, double step, double part, struct error *error) {
  int size = f->work.system->size;
  double h = part * step, q = part * part;
  for (int i = 0; i < size; i++) {
    double bend = f->next.x[i] - f->now.x[i] - step * f->now.t[i];
    f->trial.x[i] = f->now.x[i] + h * f->now.t[i] + q * bend;
  }
  double bend = f->next.lambda - f->now.lambda - step * f->now.rate;
  f->trial.lambda = f->now.lambda + h * f->now.rate + q * bend;
  f->trial.arc = f->now.arc + h;
  return path_correct(&f->work, &f->now, h, &f->trial, error);
}

/* Brings the trial state to the requested lambda exactly, by Newton's method at fixed lambda. Near
 * a limit point it may not find it: the state then stays as it is. */
static enum status land(struct follower *f, double lambda, struct error *error) {
  const struct continuation_system *s = f->work.system;
  int iterations = 0, negative = 0;
  enum status status =
      continuation_correct(s, f->work.options, lambda, f->trial.x, &negative, &iterations, error);
  f->work.factorisations += iterations;
  if (status == STATUS_OK) {
    f->trial.lambda = lambda;
    f->trial.negative = negative;
  }
  return continuation_retry(status) ? STATUS_OK : status;
}

/* Locates the zero of quantity i within the step by regula falsi (Illinois); it ends up in
 * f->trial. */
static enum status locate(struct follower *f, int i, double step, struct error *error) {
  const struct continuation_options *o = f->work.options;
  double a = 0, b = 1, va = f->value[i], vb = f->value[f->count + i];
  double *value = f->value + 2 * f->count;
  int side = 0;
  for (int k = 0; k < 30; k++) {
    double part = a + (b - a) * fmin(1 - 1e-6, fmax(1e-6, va / (va - vb)));
    enum status status = between(f, step, part, error);
    if (status != STATUS_OK) {
      return status;
    }
    quantities(f, &f->trial, value);
    bool before = (value[i] < 0) == (f->value[i] < 0) && value[i] != 0;
    double tolerance = o->event_tolerance * fabs(f->value[i] - f->value[f->count + i]);
    if (fabs(value[i]) <= tolerance || b - a < 1e-9) {
      break;
    }
    if (before) {
      a = part;
      va = value[i];
      vb *= side > 0 ? 0.5 : 1;
    } else {
      b = part;
      vb = value[i];
      va *= side < 0 ? 0.5 : 1;
    }
    side = before ? 1 : -1; /* which end moved: the other one's weight falls when it stays twice */
  }
  if (i > 0 && i <= o->target_count) {
    return land(f, o->target[i - 1], error);
  }
  return STATUS_OK;
}

/* Shortens the step to the first passage of a quantity, if there is one. *passed receives its
 * number or -1. */
static enum status stop_at_passage(struct follower *f, int *passed, struct error *error) {
  double fraction = 0;
  quantities(f, &f->next, f->value + f->count);
  *passed = first_passage(f->count, f->value, f->value + f->count, &fraction);
  enum status status = STATUS_OK;
  for (int tries = 0; *passed >= 0 && tries < f->count; tries++) {
    double step = f->next.arc - f->now.arc;
    status = locate(f, *passed, step, error);
    if (status != STATUS_OK) {
      return status;
    }
    exchange(&f->next, &f->trial);
    quantities(f, &f->next, f->value + f->count);
    /* Another one may have been passed even before. */
    double *end = f->value + f->count, kept = end[*passed];
    end[*passed] = f->value[*passed];
    int other = first_passage(f->count, f->value, end, &fraction);
    end[*passed] = kept;
    if (other < 0) {
      break;
    }
    *passed = other;
  }
  return status;
}

/* ---- visits ------------------------------------------------------------------------------ */

/* The event of a changed number of negative pivots, or 0. */
static unsigned branching(struct follower *f, bool limit, int *change) {
  *change = 0;
  if (limit) {
    f->limits++;
    return 0;
  }
  int more = f->now.negative - f->settled;
  bool explained = abs(more) <= f->limits && (f->limits - abs(more)) % 2 == 0;
  f->settled = f->now.negative;
  f->limits = 0;
  *change = explained ? 0 : more;
  return explained ? CONTINUATION_STEP : CONTINUATION_BIFURCATION;
}

/* Shows the state f->now, at which quantity `passed` (-1: none) is 0. */
static bool show(struct follower *f, int passed, unsigned events) {
  const struct continuation_options *o = f->work.options;
  struct continuation_point point = point_of(&f->now);
  point.events = events;
  if (passed == 0) {
    point.events |= CONTINUATION_LIMIT;
  } else if (passed > 0) {
    bool target = passed <= o->target_count;
    point.events |= target ? CONTINUATION_TARGET : CONTINUATION_WATCH;
    point.index = passed - 1 - (target ? 0 : o->target_count);
  }
  point.events |= branching(f, passed == 0, &point.change);
  point.iterations = f->work.factorisations - f->visited;
  f->visited = f->work.factorisations;
  if (o->verbose > 0) {
    fprintf(stderr, "path s %.5g lambda %.8g rate %.4g step %.3g negative %d events %u (%d)\n",
            point.arc, point.lambda, point.lambda_rate, f->step, point.negative, point.events,
            point.iterations);
  }
  return f->visit(f->visit_context, &point);
}

/* Makes the candidate the present state. Values that are 0 there get the sign of the way ahead. */
static void accept(struct follower *f, int passed) {
  exchange(&f->now, &f->next);
  for (int i = 0; i < f->count; i++) {
    double before = f->value[i], after = f->value[f->count + i];
    if (i == passed) {
      after = before < 0 ? DBL_MIN : -DBL_MIN;
    }
    f->value[i] = after;
  }
}

/* The tangent at the first state. */
static enum status begin(struct follower *f, int direction, const double *along,
                         struct error *error) {
  const struct continuation_system *s = f->work.system;
  enum status status = continuation_correct(s, f->work.options, f->now.lambda, f->now.x,
                                            &f->now.negative, &f->work.factorisations, error);
  if (status == STATUS_OK) {
    status = s->evaluate(s->context, f->now.x, f->now.lambda, true, f->work.residual, f->work.load,
                         error);
  }
  if (status == STATUS_OK) {
    f->work.factorisations++;
    status = s->factor(s->context, &f->now.negative, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  s->solve(s->context, f->work.load, f->work.load);
  path_tangent(&f->work, NULL, &f->now);
  bool back = along ? continuation_product(s, along, f->now.t) < 0 : direction < 0;
  for (int i = 0; back && i < s->size; i++) {
    f->now.t[i] = -f->now.t[i];
  }
  f->now.rate = back ? -f->now.rate : f->now.rate;
  f->settled = f->now.negative;
  quantities(f, &f->now, f->value);
  return STATUS_OK;
}

/* Length of the next step after one that took `iterations` and turned the tangent. */
static double next_step(const struct continuation_options *o, double step, int iterations,
                        double turned) {
  double factor = sqrt(fmax(1, o->iterations_wanted) / fmax(1, iterations));
  if (turned > 0) {
    factor = fmin(factor, 0.4 * o->angle_max / turned);
  }
  return fmin(o->step_max, step * fmin(2, fmax(0.4, factor)));
}

/* A step of a given length with everything located on it. *go_on is what the visitor says. */
static enum status step_by(struct follower *f, double step, bool *go_on, struct error *error) {
  const struct continuation_options *o = f->work.options;
  int before = f->work.factorisations, passed = -1;
  double turned = 0;
  enum status status = advance(f, step, &turned, error);
  double grown = next_step(o, step, f->work.factorisations - before, turned);
  if (status == STATUS_OK) {
    status = stop_at_passage(f, &passed, error);
  }
  if (status == STATUS_OK) {
    accept(f, passed);
    f->step = passed >= 0 ? fmin(grown, step) : grown;
    *go_on = show(f, passed, 0);
  } else if (o->verbose > 0) {
    fprintf(stderr, "path: step %.3g failed: %s\n", step, error ? error->message : "");
  }
  return status;
}

/* Where steps fail however short, the path has a gap: a point of contact is between two partners,
 * and with either of them there is no equilibrium. The path goes on beyond, at the shortest of some
 * distances that is far enough, where it may have turned more than elsewhere. */
static enum status leap(struct follower *f, bool *go_on, struct error *error) {
  static const double reach[] = {0.01, 0.03, 0.1, 0.3, 1, 3};
  enum status status = STATUS_DIVERGED;
  f->angle = fmax(f->angle, 1.2);
  for (size_t k = 0; k < sizeof reach / sizeof *reach && continuation_retry(status); k++) {
    status = step_by(f, reach[k] * f->work.options->step, go_on, error);
  }
  f->angle = f->work.options->angle_max;
  return status;
}

static enum status step_once(struct follower *f, bool *go_on, struct error *error) {
  const struct continuation_options *o = f->work.options;
  for (;;) {
    double step = f->step;
    if (o->lambda_step_max > 0 && fabs(step * f->now.rate) > o->lambda_step_max) {
      step = o->lambda_step_max / fabs(f->now.rate);
    }
    enum status status = step_by(f, step, go_on, error);
    if (!continuation_retry(status)) {
      return status;
    }
    f->step = 0.35 * step;
    if (f->step < o->step_min) {
      status = leap(f, go_on, error);
      return !continuation_retry(status)
                 ? status
                 : error_set(error, STATUS_STEP_MINIMUM, NULL,
                             "the step along the path fell below %.3g at lambda = %.6g",
                             o->step_min, f->now.lambda);
    }
  }
}

/* ---- public ------------------------------------------------------------------------------ */

static enum status reserve(struct follower *f, struct error *error) {
  size_t size = (size_t)f->work.system->size;
  f->count = 1 + f->work.options->target_count +
             (f->work.options->watch ? f->work.options->watch_count : 0);
  f->room = calloc(8 * size + 3 * (size_t)f->count, sizeof *f->room);
  if (!f->room) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path of %zu unknowns", size);
  }
  double *next = f->room;
  struct path_state *state[] = {&f->now, &f->next, &f->trial};
  for (int k = 0; k < 3; k++, next += 2 * size) {
    state[k]->x = next;
    state[k]->t = next + size;
  }
  f->work.residual = next;
  f->work.load = next + size;
  f->value = next + 2 * size;
  return STATUS_OK;
}

enum status continuation_follow(const struct continuation_system *system,
                                const struct continuation_options *options, int direction,
                                const double *along, continuation_visit *visit, void *visit_context,
                                double *x, double *lambda, struct error *error) {
  struct follower f = {.work = {.system = system, .options = options},
                       .visit = visit,
                       .visit_context = visit_context,
                       .step = fmin(options->step, options->step_max),
                       .angle = options->angle_max};
  enum status status = reserve(&f, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t bytes = sizeof *x * (size_t)system->size;
  memcpy(f.now.x, x, bytes);
  f.now.lambda = *lambda;
  status = begin(&f, direction, along, error);
  if (status == STATUS_OK) {
    bool go_on = show(&f, -1, CONTINUATION_START);
    for (int k = 0; status == STATUS_OK && go_on && k < options->steps_max; k++) {
      status = step_once(&f, &go_on, error);
    }
    memcpy(x, f.now.x, bytes);
    *lambda = f.now.lambda;
  }
  free(f.room);
  return status;
}
