#include "solver/fe/dynamics_carry.h"

#include <math.h>
#include "solver/base/clock.h"

/* After a rest that was not one, the kinetic energy has to fall by this factor before the next. */
static const double patience = 0.25;

struct carry_options carry_defaults(const struct dynamics *d) {
  return (struct carry_options){.longest = 4000 * dynamics_scale(d),
                                .steps = 400,
                                .wall_s = 60,
                                .quiet = 1e-3,
                                .leftover = 1e-2,
                                .near = 2e-3 * d->solver->length};
}

/* Root mean square way of the nodes between two displacements. */
static double distance(const struct fe_model *m, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < 3 * m->mesh->node_count; i++) {
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return sqrt(sum / m->mesh->node_count);
}

/* One carrying in progress. */
struct carry {
  struct dynamics *d;
  const struct carry_options *options;
  struct fe_load *load;
  struct fe_state *state;
  struct motion *motion;
  struct energy *energy, first; /* now, and at the start */
  double start;                 /* s */
  double loudest;               /* kinetic energy below which rest may be tried again, J */
  struct carry_report *report;
};

/* Whether the equilibrium in d->rest is that to which the state is about to come: near it, stable,
 * and with hardly less energy. */
static bool is_rest(const struct carry *c) {
  struct dynamics *d = c->d;
  struct energy after = *c->energy;
  struct energy_step step = {.kinetic = 0};
  step.weight_work = d->object ? free_object_weight_work(d->object) : 0;
  energy_record(&after, d->model, &d->rest, c->load, &step);
  double gone = c->energy->damping - c->first.damping + c->energy->friction - c->first.friction;
  return d->solver->negative_pivots == 0 &&
         distance(d->model, d->rest.u, c->state->u) <= c->options->near &&
         after.remainder - c->energy->remainder <=
             c->options->leftover * fmax(c->report->peak_kinetic, gone);
}

/* Whether there is such an equilibrium; the state then becomes it. */
static bool comes_to_rest(struct carry *c) {
  struct dynamics *d = c->d;
  int iterations;
  state_copy(d->model, &d->rest, c->state);
  if (d->object) {
    free_object_begin(d->object);
  }
  d->solver->factor_fits = false;
  enum status status =
      equilibrium_solve(d->solver, c->load, c->load->pressure, &d->rest, &iterations);
  d->statistics.iterations += iterations;
  d->solver->factor_fits = false;
  if (status != STATUS_OK || !is_rest(c)) {
    if (d->object) {
      free_object_return(d->object);
    }
    return false;
  }
  struct energy_step step = {.kinetic = 0};
  double time = c->motion->time;
  state_copy(d->model, c->state, &d->rest);
  dynamics_commit(d, c->state, &step);
  motion_clear(d->model, c->motion);
  c->motion->time = time;
  energy_record(c->energy, d->model, c->state, c->load, &step);
  return true;
}

static bool quiet_enough(struct carry *c) {
  const struct motion *motion = c->motion;
  c->report->peak_kinetic = fmax(c->report->peak_kinetic, motion->kinetic);
  bool driven = motion->time - c->start < c->options->driven;
  return c->options->duration == 0 && !driven && motion->kinetic < c->loudest &&
         motion->kinetic < c->options->quiet * c->report->peak_kinetic;
}

static enum status carry_on(struct carry *c) {
  const struct carry_options *o = c->options;
  struct carry_report *r = c->report;
  double end = c->start + (o->duration > 0 ? o->duration : o->longest);
  int taken = c->d->statistics.steps;
  while (c->d->statistics.steps - taken < o->steps && c->motion->time < end) {
    enum status status =
        dynamics_advance(c->d, &o->drive, end, c->load, c->state, c->motion, c->energy, &r->reason);
    if (status != STATUS_OK) {
      return status;
    }
    if (quiet_enough(c)) {
      c->loudest = patience * c->motion->kinetic;
      if (comes_to_rest(c)) {
        r->rested = true;
        return STATUS_OK;
      }
    }
  }
  return o->duration > 0 && c->motion->time >= end ? STATUS_OK : STATUS_DIVERGED;
}

/* Deadline of the solver while it carries. */
static double deadline(const struct equilibrium *solver, const struct carry_options *options) {
  double own = options->wall_s > 0 ? clock_wall_s() + options->wall_s : INFINITY;
  double outer = solver->options.deadline_s > 0 ? solver->options.deadline_s : INFINITY;
  double sooner = fmin(own, outer);
  return isfinite(sooner) ? sooner : 0;
}

static enum status explain(const struct carry_report *r, enum status status, struct error *error) {
  if (status == STATUS_OK) {
    return status;
  }
  const char *why = status == STATUS_DIVERGED ? "it still moves" : status_sentence(status);
  return error_set(error, status, "/load",
                   "the body did not come to rest: after %.4g ms and %d steps in time: %s%s%s",
                   1e3 * r->time, r->steps, why, r->reason != STATUS_OK ? "; last attempt: " : "",
                   r->reason != STATUS_OK ? status_sentence(r->reason) : "");
}

enum status dynamics_carry(struct dynamics *d, const struct carry_options *options,
                           struct fe_load *load, struct fe_state *state, struct motion *motion,
                           struct energy *energy, struct carry_report *report,
                           struct error *error) {
  struct dynamics_statistics before = d->statistics;
  struct energy own;
  double outer = d->solver->options.deadline_s;
  if (!energy) {
    energy = &own;
    energy_start(energy, d->model, state, load, motion->kinetic);
  }
  struct carry c = {d,      options, load,         state,    motion,
                    energy, *energy, motion->time, INFINITY, report};
  *report = (struct carry_report){.rested = false};
  d->solver->options.deadline_s = deadline(d->solver, options);
  if (motion->step <= 0) {
    motion->step = dynamics_scale(d) / 20;
  }
  enum status status = carry_on(&c);
  d->solver->options.deadline_s = outer;
  report->time = motion->time - c.start;
  report->steps = d->statistics.steps - before.steps;
  report->rejected = d->statistics.rejected - before.rejected;
  report->iterations = d->statistics.iterations - before.iterations;
  report->damping = energy->damping - c.first.damping;
  report->friction = energy->friction - c.first.friction;
  report->remainder = energy->remainder - c.first.remainder;
  return explain(report, status, error);
}
