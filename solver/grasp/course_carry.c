/* Parts of the course that are followed in motion. */
#include <math.h>
#include <stdio.h>
#include "solver/grasp/course_internal.h"

/* After so many carryings with hardly a rest between them the body is not waited for to rest: only
 * at the end of a spell of so many. Steps in time after which one that does not rest moves on. */
enum { RESTLESS = 3, SPELL = 8, STEPS = 120 };

/* What a carrying drives: the stage goes on at its rate up to `target`. */
struct drive {
  struct course *c;
  double start; /* of the motion's time, s */
  double target;
};

static double driven_along(const struct drive *d, double time) {
  double seconds = d->c->stage.seconds;
  return fmin(d->target, d->c->along + (time - d->start) / seconds);
}

static enum status drive(void *context, double time, struct fe_load *load) {
  struct drive *d = context;
  double along = driven_along(d, time);
  *load = course_load_at(d->c, along);
  course_place_object(d->c, along);
  return STATUS_OK;
}

/* Looks at the suckers; ends the motion of an object that has left the finger. */
static enum status watch(void *context, const struct motion *motion, const struct fe_state *state,
                         const struct fe_load *load) {
  const struct drive *d = context;
  (void)motion;
  (void)state;
  (void)load;
  cups_watch(d->c->f);
  return d->c->f->loose.object && loose_watch(d->c->f) ? STATUS_DIVERGED : STATUS_OK;
}

enum status course_carry(struct course *c, double target) {
  struct finger *f = c->f;
  struct drive driven = {c, f->motion.time, target};
  struct carry_options options = carry_defaults(f->dynamics);
  struct carry_report report;
  double seconds = (target - c->along) * c->stage.seconds, start = f->motion.time;
  struct fe_load load = course_load_at(c, c->along);
  options.drive = (struct dynamics_drive){drive, watch, &driven};
  bool onward = !f->loose.object && c->unrest >= RESTLESS && c->unrest % SPELL != 0;
  options.driven = seconds;
  options.duration = onward ? seconds : 0;
  options.longest += seconds;
  options.steps = f->loose.object ? options.steps : STEPS;
  options.wall_s = 0; /* the time limit of the job holds */
  if (!c->afoot) {
    motion_clear(f->solve.model, &f->motion);
    f->motion.time = start;
    f->motion.step = 0;
    c->jumps++;
    c->report->carried++;
  }
  enum status status = dynamics_carry(f->dynamics, &options, &load, &f->solve.state, &f->motion,
                                      &f->energy, &report, c->error);
  if (f->solve.solver->verbose) {
    fprintf(stderr, "  %s %.5g in motion: %s, %d steps, %.4g s, %s\n",
            grasp_stage_word(c->stage.kind), target, status_word(status), report.steps, report.time,
            report.rested ? "rests" : "moves");
  }
  course_tell_energy(c);
  bool arrived = f->motion.time - driven.start >= seconds && !f->loose.object;
  if (f->loose.fell || (status == STATUS_DIVERGED && arrived)) {
    target = driven_along(&driven, f->motion.time);
    status = STATUS_OK;
  }
  c->afoot = status == STATUS_OK && !report.rested && !f->loose.fell;
  c->unrest++;
  c->short_steps = 0;
  c->moving += target - c->along;
  c->stages += target - c->along;
  c->time += report.time;
  c->along = target;
  f->solve.solver->factor_fits = false;
  return status;
}
