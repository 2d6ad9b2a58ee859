/* States and paths of a model: the equations that the continuation solves. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/continuation_internal.h"
#include "solver/axi/model_internal.h"

/* One solve. With h held the unknowns of the continuation are all but the last one. */
struct problem {
  struct axi_model *model;
  struct axi_ramp ramp;
  double *x; /* size of the model */
  axi_visit *visit;
  void *visit_context;
  struct axi_state *state;
  enum status status; /* of the last visit */
  struct error *error;
};

static double at(double from, double to, double lambda) {
  return from + lambda * (to - from);
}

static struct axi_load load_at(const struct axi_ramp *r, double lambda) {
  return (struct axi_load){.pressure = at(r->from.pressure, r->to.pressure, lambda),
                           .force = at(r->from.force, r->to.force, lambda),
                           .elongation = at(r->from.elongation, r->to.elongation, lambda)};
}

/* Completes the unknowns of the continuation by h where it is held. */
static void complete(struct problem *p, const double *x, double lambda) {
  int size = p->model->size - (p->ramp.held ? 1 : 0);
  memcpy(p->x, x, sizeof *x * (size_t)size);
  if (p->ramp.held) {
    p->x[size] = load_at(&p->ramp, lambda).elongation;
  }
}

/* K e_h */
static void elongation_column(struct axi_model *m, double *unit, double *column) {
  memset(unit, 0, sizeof *unit * (size_t)m->size);
  unit[m->size - 1] = 1;
  axi_model_product(m, unit, column);
}

static enum status evaluate(void *context, const double *x, double lambda, bool tangent,
                            double *residual, double *load, struct error *error) {
  struct problem *p = context;
  struct axi_model *m = p->model;
  const struct axi_ramp *r = &p->ramp;
  struct axi_load now = load_at(r, lambda);
  complete(p, x, lambda);
  enum status status = axi_model_evaluate(m, p->x, now.pressure, tangent, error);
  if (status != STATUS_OK) {
    return status;
  }
  int size = m->size - (r->held ? 1 : 0);
  double slope = r->to.pressure - r->from.pressure;
  if (load && r->held) {
    elongation_column(m, p->x, m->column);
  }
  for (int i = 0; i < size; i++) {
    residual[i] = m->force[i] - now.pressure * m->volume_gradient[i];
    if (load) {
      double column = r->held ? m->column[i] * (r->to.elongation - r->from.elongation) : 0;
      load[i] = column - slope * m->volume_gradient[i];
    }
  }
  if (m->elongation && !r->held) {
    residual[size - 1] -= now.force;
    if (load) {
      load[size - 1] -= r->to.force - r->from.force;
    }
  }
  return STATUS_OK;
}

static enum status factor(void *context, int *negative, struct error *error) {
  struct problem *p = context;
  return axi_model_factor(p->model, p->ramp.held, negative, error);
}

static void solve(void *context, const double *b, double *x) {
  struct problem *p = context;
  ldlt_solve(p->model->factor[p->ramp.held], b, x);
}

/* dF/dh at fixed pressure by the factor at hand, and from its sign the number of negative pivots
 * in the other kind of control: that of K is that of K without h plus that of the Schur complement
 * S = K_hh - K_hu K_uu^-1 K_uh = dF/dh, and 1/S = (K^-1)_hh. */
static void stability(struct problem *p, int negative) {
  struct axi_model *m = p->model;
  struct axi_state *s = p->state;
  s->negative_free = s->negative_held = negative;
  s->stiffness = NAN;
  if (!m->elongation) {
    return;
  }
  int last = m->size - 1;
  double *column = m->column;
  if (p->ramp.held) {
    elongation_column(m, p->x, column);
    double sum = column[last];
    memcpy(p->x, column, sizeof *column * (size_t)last);
    ldlt_solve(m->factor[1], column, column);
    for (int i = 0; i < last; i++) {
      sum -= column[i] * p->x[i];
    }
    s->stiffness = sum;
    s->negative_free += sum < 0;
  } else {
    memset(column, 0, sizeof *column * (size_t)m->size);
    column[last] = 1;
    ldlt_solve(m->factor[0], column, column);
    s->stiffness = 1 / column[last];
    s->negative_held -= column[last] < 0;
  }
}

/* Everything of the state at the unknowns x, with the factor of the tangent there. */
static enum status fill(struct problem *p, const double *x, double lambda, int negative,
                        struct error *error) {
  struct axi_model *m = p->model;
  struct axi_state *s = p->state;
  struct axi_load now = load_at(&p->ramp, lambda);
  stability(p, negative);
  complete(p, x, lambda);
  enum status status = axi_model_evaluate(m, p->x, now.pressure, false, error);
  memcpy(s->x, p->x, sizeof *s->x * (size_t)m->size);
  memcpy(s->u, m->u, sizeof *s->u * 2 * (size_t)m->mesh->node_count);
  s->lambda = lambda;
  s->pressure = now.pressure;
  s->force = now.force;
  s->elongation = 0;
  if (m->elongation) {
    int h = m->size - 1;
    s->elongation = s->x[h];
    s->force = p->ramp.held ? m->force[h] - now.pressure * m->volume_gradient[h] : now.force;
  }
  s->volume = m->volume;
  s->energy = m->energy;
  s->contact_energy = m->contact_energy;
  s->touching = m->contact && m->contact->touch_count > 0;
  s->contact_overlap = s->touching ? fmax(0, -m->contact->min_gap) : 0;
  return status;
}

static enum status problem_open(struct problem *p, struct axi_model *model,
                                const struct axi_ramp *ramp, struct axi_state *state,
                                struct error *error) {
  *p = (struct problem){.model = model, .ramp = *ramp, .state = state, .error = error};
  if (ramp->held && !model->elongation) {
    return error_set(error, STATUS_INVALID, NULL,
                     "a body without a plate has no elongation to hold");
  }
  if (!model->elongation && (ramp->from.force != 0 || ramp->to.force != 0)) {
    return error_set(error, STATUS_INVALID, NULL, "a body without a plate cannot be pulled at");
  }
  p->x = calloc((size_t)model->size, sizeof *p->x);
  return p->x ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", model->size);
}

static struct continuation_system system_of(struct problem *p) {
  return (struct continuation_system){.size = p->model->size - (p->ramp.held ? 1 : 0),
                                      .context = p,
                                      .weight = p->model->weight,
                                      .evaluate = evaluate,
                                      .factor = factor,
                                      .solve = solve};
}

/* Moves x by `change` of lambda along the tangent at lambda. A guess may have none: it then stays.
 */
static enum status predict(struct problem *p, const struct continuation_system *system,
                           double lambda, double change, double *x, struct error *error) {
  double *room = malloc(sizeof *room * 2 * (size_t)system->size);
  if (!room) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", system->size);
  }
  double *load = room + system->size;
  int negative = 0;
  enum status status = evaluate(p, x, lambda, true, room, load, error);
  if (status == STATUS_OK) {
    status = factor(p, &negative, error);
  }
  if (status == STATUS_OK) {
    solve(p, load, load);
    for (int i = 0; i < system->size; i++) {
      x[i] -= change * load[i];
    }
  }
  free(room);
  return continuation_retry(status) ? STATUS_OK : status;
}

/* Brings h from where the guess has it to where it is held, at once or in shorter and shorter
 * steps. */
static enum status move(struct problem *p, const struct continuation_options *options,
                        int *negative, int *iterations, struct error *error) {
  const struct continuation_system system = system_of(p);
  size_t bytes = sizeof(double) * (size_t)p->model->size;
  double *start = malloc(bytes), *x = p->state->x;
  enum status status =
      start ? STATUS_OK : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a state");
  double done = 0, step = 1;
  while (status == STATUS_OK && done < 1) {
    int count = 0;
    memcpy(start, x, bytes);
    status = predict(p, &system, done, step, x, error);
    if (status == STATUS_OK) {
      status = continuation_correct(&system, options, done + step, x, negative, &count, error);
      *iterations += count + 1;
    }
    if (status == STATUS_OK) {
      done += step;
    } else if (continuation_retry(status) && step > 1.0 / 128) {
      memcpy(x, start, bytes);
      step *= 0.5;
      status = STATUS_OK;
    }
  }
  free(start);
  return status;
}

enum status axi_equilibrium(struct axi_model *model, const struct axi_load *load, bool held,
                            const struct continuation_options *options, struct axi_state *state,
                            int *iterations, struct error *error) {
  struct problem p;
  struct axi_ramp ramp = {.from = *load, .to = *load, .held = held};
  int negative = 0, count = 0;
  if (held && model->elongation) {
    ramp.from.elongation = state->x[model->size - 1];
  }
  enum status status = problem_open(&p, model, &ramp, state, error);
  if (status == STATUS_OK && ramp.from.elongation != ramp.to.elongation) {
    status = move(&p, options, &negative, &count, error);
  } else if (status == STATUS_OK) {
    struct continuation_system system = system_of(&p);
    status = continuation_correct(&system, options, 1, state->x, &negative, &count, error);
  }
  if (status == STATUS_OK) {
    double lambda = state->lambda;
    status = fill(&p, state->x, 1, negative, error);
    state->lambda = lambda;
  }
  if (iterations) {
    *iterations = count;
  }
  free(p.x);
  return status;
}

static bool show(void *context, const struct continuation_point *point) {
  struct problem *p = context;
  p->status = fill(p, point->x, point->lambda, point->negative, p->error);
  return p->status == STATUS_OK && p->visit(p->visit_context, p->state, point);
}

enum status axi_follow(struct axi_model *model, const struct axi_ramp *ramp,
                       const struct continuation_options *options, int direction,
                       const double *along, axi_visit *visit, void *visit_context,
                       struct axi_state *state, struct error *error) {
  struct problem p;
  bool moves = ramp->from.pressure != ramp->to.pressure ||
               (ramp->held ? ramp->from.elongation != ramp->to.elongation
                           : ramp->from.force != ramp->to.force);
  if (!moves) {
    return error_set(error, STATUS_INVALID, NULL, "a path needs a load that changes");
  }
  enum status status = problem_open(&p, model, ramp, state, error);
  double *x = status == STATUS_OK ? malloc(sizeof *x * (size_t)model->size) : NULL;
  if (status == STATUS_OK && !x) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", model->size);
  }
  if (status == STATUS_OK) {
    struct continuation_system system = system_of(&p);
    double lambda = state->lambda;
    p.visit = visit;
    p.visit_context = visit_context;
    memcpy(x, state->x, sizeof *x * (size_t)model->size);
    status = continuation_follow(&system, options, direction, along, show, &p, x, &lambda, error);
    status = status == STATUS_OK ? p.status : status;
  }
  free(x);
  free(p.x);
  return status;
}

enum status axi_assess(struct axi_model *model, bool held, struct axi_state *state,
                       double *residual, struct error *error) {
  struct problem p;
  struct axi_load load = {state->pressure, state->force, state->elongation};
  struct axi_ramp ramp = {.from = load, .to = load, .held = held};
  enum status status = problem_open(&p, model, &ramp, state, error);
  double *r = status == STATUS_OK ? calloc((size_t)model->size, sizeof *r) : NULL;
  if (status == STATUS_OK && !r) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", model->size);
  }
  int negative = 0;
  if (status == STATUS_OK) {
    status = evaluate(&p, state->x, state->lambda, true, r, NULL, error);
  }
  if (status == STATUS_OK) {
    status = factor(&p, &negative, error);
  }
  if (status == STATUS_OK) {
    status = fill(&p, state->x, state->lambda, negative, error);
  }
  if (status == STATUS_OK && residual) {
    *residual = 0;
    for (int i = 0; i < model->size; i++) {
      *residual = fmax(*residual, fabs(r[i]));
    }
  }
  free(r);
  free(p.x);
  return status;
}

enum status axi_evaluate(struct axi_model *model, const double *x, const struct axi_load *load,
                         double *potential, double *residual, const double *direction,
                         double *product, struct error *error) {
  enum status status = axi_model_evaluate(model, x, load->pressure, direction != NULL, error);
  if (status != STATUS_OK) {
    return status;
  }
  int h = model->elongation ? model->size - 1 : -1;
  *potential = model->energy + model->contact_energy - load->pressure * model->volume -
               (h >= 0 ? load->force * x[h] : 0);
  for (int i = 0; residual && i < model->size; i++) {
    residual[i] =
        model->force[i] - load->pressure * model->volume_gradient[i] - (i == h ? load->force : 0);
  }
  if (direction) {
    axi_model_product(model, direction, product);
  }
  return STATUS_OK;
}
