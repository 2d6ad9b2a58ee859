#include "solver/grasp/course_internal.h"

#include <math.h>
#include <stdio.h>
#include "solver/base/vec3.h"

enum {
  EASY_ITERATIONS = 8,
  STEPS_MAX = 4000, /* of a stage */
  JUMPS_MAX = 60,   /* of a stage */
  TIRED = 2,        /* carryings after which a step that fails is carried at once */
  CRAWL = 8         /* short steps, likewise */
};

static const double cut_factor = 0.4, grow_factor = 1.6;
/* Shortest step in equilibrium and length of what is tried in motion, in longest steps. */
static const double shortest = 0.03, carried_step = 0.25;
/* A leap that moves the body so many times as far as the steps before it is a jump. */
static const double jump_factor = 3;
/* Error of the works of a step, as a part of them. */
static const double works_error = 0.1;

/* ---- what a stage does -------------------------------------------------------------------- */

struct fe_load course_load_at(const struct course *c, double along) {
  enum grasp_stage kind = c->stage.kind;
  double to = c->f->spec.load.pressure_to;
  double pressure = kind < STAGE_INFLATION    ? 0
                    : kind == STAGE_INFLATION ? along * to
                    : kind == STAGE_RELEASE   ? (1 - along) * to
                                              : to;
  double dead = kind == STAGE_GRAVITY ? along : 1;
  return (struct fe_load){pressure, pressure, dead};
}

/* Part of the pull that has passed. */
static double pulled_at(const struct course *c, double along) {
  return c->stage.kind == STAGE_PULL ? along : c->stage.kind == STAGE_RELEASE ? c->pulled : 0;
}

/* Part of their suction that the suckers have. */
static double suction_at(const struct course *c, double along) {
  return c->stage.kind < STAGE_SUCTION    ? 0
         : c->stage.kind == STAGE_SUCTION ? along
         : c->stage.kind == STAGE_RELEASE ? 1 - along
                                          : 1;
}

void course_place_object(struct course *c, double along) {
  struct finger *f = c->f;
  double pulled = pulled_at(c, along), from[3];
  cups_pull(f, suction_at(c, along));
  if (f->loose.object) {
    loose_apply(f, c->stage.kind == STAGE_LETTING_GO ? 1 - along : 0, pulled);
    return;
  }
  double away = c->stage.kind == STAGE_GRAVITY    ? 1
                : c->stage.kind == STAGE_APPROACH ? 1 - along
                                                  : 0;
  for (int i = 0; i < 3; i++) {
    from[i] = away * f->grasp.approach.from[i];
  }
  grasp_lead_at(&f->grasp, from, pulled, &f->lead);
  model_place_obstacle(f->solve.model, f->obstacle, &f->lead.pose);
}

/* ---- states ------------------------------------------------------------------------------- */

static bool is_record(const struct course *c) {
  double place = c->along * c->stage.records;
  return fabs(place - round(place)) < 1e-9 * c->stage.records;
}

/* Takes the present state into the series. */
static enum status take(struct course *c, bool dynamic) {
  struct grasp_sample sample = {
      .stage = c->stage.kind, .along = c->along, .dynamic = dynamic, .recorded = is_record(c)};
  sample.value[GRASP_TIME] = c->time;
  sample.value[GRASP_PRESSURE] = course_load_at(c, c->along).pressure;
  sample.value[GRASP_SHIFT] = c->f->loose.object ? loose_way(c->f) : c->f->lead.way;
  sample.value[GRASP_TURNED] = c->f->lead.turned;
  enum status status = finger_measure(c->f, &sample);
  if (status == STATUS_OK) {
    status = grasp_series_add(&c->report->series, &sample);
  }
  return status == STATUS_OK && c->visit->visit ? c->visit->visit(c->visit->context, c->f, &sample)
                                                : status;
}

static bool final(enum status status) {
  return status_is_final(status) || status == STATUS_IO;
}

void course_tell_energy(const struct course *c) {
  const struct energy *e = &c->f->energy;
  if (c->f->solve.solver->verbose) {
    const struct fe_statistics *s = &c->f->solve.model->statistics;
    fprintf(
        stderr,
        "  energy: pressure %.4g weight %.4g object %.4g strain %.4g friction %.4g damping %.4g "
        "missing %.4g mJ\n",
        1e3 * e->pressure_work, 1e3 * e->weight_work, 1e3 * e->obstacle_work, 1e3 * e->strain,
        1e3 * e->friction, 1e3 * e->damping, 1e3 * e->remainder);
    fprintf(stderr,
            "  spent: %d factorisations %.2f s, %d solves %.2f s, %d tangents %.2f s, %d residuals "
            "%.2f s, contact %.2f s\n",
            s->factorizations, s->factor_s, s->solves, s->solve_s, s->assemblies, s->assembly_s,
            s->residuals, s->residual_s, s->contact_s);
  }
}

/* Takes over the state that was tried, with its part of the ledger. */
static void accept(struct course *c, const struct fe_load *load) {
  struct finger *f = c->f;
  struct energy_step step = {.kinetic = 0};
  dynamics_commit(f->dynamics, &f->trial, &step);
  state_copy(f->solve.model, &f->solve.state, &f->trial);
  energy_record(&f->energy, f->solve.model, &f->solve.state, load, &step);
  cups_watch(f);
  if (f->loose.object) {
    loose_watch(f);
  }
  course_tell_energy(c);
}

/* Root mean square way of the nodes from the last state to the one that was tried, m. */
static double way_of(const struct finger *f) {
  const struct mesh *mesh = &f->solve.mesh;
  double sum = 0;
  for (int i = 0; i < 3 * mesh->node_count; i++) {
    double d = f->trial.u[i] - f->solve.state.u[i];
    sum += d * d;
  }
  return sqrt(sum / mesh->node_count);
}

/* Whether energy is lost on the way to the state that was tried, which a body that rests all the
 * way has no means for: more than the works may err by, which are means over the step. */
static bool loses_energy(struct course *c, const struct fe_load *load) {
  struct finger *f = c->f;
  const struct energy *before = &f->energy;
  struct energy after = *before;
  struct obstacle_work work = model_obstacle_work(f->solve.model, &f->trial, f->obstacle);
  struct energy_step step = {.friction = work.friction, .obstacle_work = work.motion};
  energy_record(&after, f->solve.model, &f->trial, load, &step);
  double pumped = (after.pressure - before->pressure) * (after.volume - before->volume);
  return after.remainder - before->remainder >
         works_error * (fabs(work.friction) + fabs(work.motion) + fabs(pumped));
}

/* Whether the state that was tried is that of a body that has jumped, as Newton's method may do
 * without a word: in a leap, and in the pull, where a body that goes with the object moves about as
 * far as it. */
static bool has_jumped(struct course *c, double target, const struct fe_load *load) {
  if (!c->leaps && c->stage.kind != STAGE_PULL) {
    return false;
  }
  if (c->leaps && loses_energy(c, load)) {
    return true;
  }
  double usual = fmax(c->pace, c->f->grasp.longest_step / c->stage.full);
  return way_of(c->f) > jump_factor * usual * (target - c->along);
}

static bool is_stable(const struct finger *f) {
  const struct free_object *object = f->loose.object;
  return f->solve.solver->negative_pivots == 0 && (!object || free_object_stable(object));
}

/* One step in equilibrium to `target`; on failure everything is as before. */
static enum status rest_at(struct course *c, double target, int *iterations) {
  struct finger *f = c->f;
  struct fe_model *m = f->solve.model;
  struct fe_load load = course_load_at(c, target);
  double before = course_load_at(c, c->along).pressure;
  if (f->loose.object) {
    free_object_begin(f->loose.object);
  }
  course_place_object(c, target);
  state_copy(m, &f->trial, &f->solve.state);
  guess_apply(m, &c->guess, target - c->along, &f->trial);
  c->guess.step = 0;
  enum status status = equilibrium_solve(f->solve.solver, &load, before, &f->trial, iterations);
  if (status == STATUS_OK && !is_stable(f)) {
    status = STATUS_UNSTABLE_PATH;
  }
  if (status == STATUS_OK && has_jumped(c, target, &load)) {
    status = STATUS_UNSTABLE_PATH;
  }
  if (f->solve.solver->verbose) {
    fprintf(stderr, "  %s %.5g: %s after %d factorisations\n", grasp_stage_word(c->stage.kind),
            target, status_word(status), *iterations);
  }
  if (status != STATUS_OK) {
    f->solve.solver->factor_fits = false;
    model_reject_obstacles(m);
    return status;
  }
  c->pace = way_of(f) / (target - c->along);
  if (c->stage.kind == STAGE_PULL && !f->loose.object) {
    guess_note(m, &c->guess, &f->solve.state, target - c->along);
  }
  accept(c, &load);
  c->time += (target - c->along) * c->stage.seconds;
  c->stages += target - c->along;
  c->along = target;
  return STATUS_OK;
}

/* ---- stages ------------------------------------------------------------------------------- */

/* Whether the stage is over because the object has come free, and far enough away. */
static bool is_free(struct course *c) {
  if (c->f->loose.object || c->stage.kind != STAGE_PULL) {
    return c->f->loose.fell;
  }
  const struct grasp_series *series = &c->report->series;
  if (series->sample[series->count - 1].value[GRASP_AREA] > 0) {
    c->touched = true;
    c->report->came_free = false;
    return false;
  }
  if (c->touched || c->along == 0) {
    c->report->came_free = true;
    c->report->free_at = c->along;
    c->touched = false;
  }
  return c->report->came_free &&
         c->along - c->report->free_at > c->f->grasp.pull.after_contact - 1e-9;
}

/* The way to the goal in equal steps: a short one at its end would gain nothing. */
static double next_target(const struct course *c, double goal, double step) {
  double count = ceil((goal - c->along) / step - 0.05);
  return count <= 1 ? goal : c->along + (goal - c->along) / count;
}

/* What is let go is not held again: it comes free whole. */
static double carried_target(const struct course *c, double goal) {
  /* The more often, the farther: afterwards steps begin short again. */
  double step = ldexp(carried_step, c->unrest < 2 ? c->unrest : 2) * c->stage.full;
  return c->stage.kind == STAGE_LETTING_GO ? 1 : next_target(c, goal, step);
}

/* Where steps have become too short, tries long ones: the place at which Newton's method fails may
 * be a narrow one. What the body would have to jump for is left to its motion. */
static enum status leap(struct course *c, double goal) {
  static const double lengths[] = {0.3, 0.8};
  enum status status = STATUS_STEP_MINIMUM;
  c->leaps = true;
  for (size_t k = 0; k < sizeof lengths / sizeof *lengths && status != STATUS_OK; k++) {
    int iterations = 0;
    status = rest_at(c, fmin(goal, c->along + lengths[k] * c->stage.full), &iterations);
    if (final(status)) {
      break;
    }
  }
  c->leaps = false;
  return status;
}

/* What came of the attempt to go on in equilibrium. */
enum outcome { OUTCOME_RESTS, OUTCOME_AGAIN, OUTCOME_MOVES, OUTCOME_ENDS };

static enum outcome took_step(struct course *c, double part, int iterations) {
  bool brief = part < 0.99 * carried_step * c->stage.full;
  c->unrest = brief ? c->unrest : 0;
  c->short_steps = brief ? c->short_steps + 1 : 0;
  if (iterations <= EASY_ITERATIONS) {
    c->step = fmin(grow_factor * c->step, c->stage.full);
  }
  return OUTCOME_RESTS;
}

/* One attempt; a shorter one is to follow, or the motion. Where the last ones came to little,
 * motion is what costs less. */
static enum outcome try_rest(struct course *c, double goal, enum status *status) {
  int iterations = 0;
  double target = next_target(c, goal, c->step), part = target - c->along;
  bool may_move = c->f->grasp.dynamics && c->jumps < JUMPS_MAX;
  bool tired = may_move && (c->unrest >= TIRED || c->short_steps >= CRAWL);
  *status = rest_at(c, target, &iterations);
  if (*status == STATUS_OK) {
    return took_step(c, part, iterations);
  }
  if (final(*status)) {
    return OUTCOME_ENDS;
  }
  c->failure = *status;
  c->step = cut_factor * part;
  if (!tired && c->step >= shortest * c->stage.full) {
    return OUTCOME_AGAIN;
  }
  c->step = carried_step * c->stage.full;
  *status = tired ? STATUS_STEP_MINIMUM : leap(c, goal);
  if (*status == STATUS_OK || final(*status)) {
    return *status == STATUS_OK ? OUTCOME_RESTS : OUTCOME_ENDS;
  }
  *status = STATUS_STEP_MINIMUM;
  return may_move ? OUTCOME_MOVES : OUTCOME_ENDS;
}

/* Goes on to `goal`, a recorded place of the stage. *over: the stage ends before it. */
static enum status reach(struct course *c, double goal, bool *over) {
  while (c->along < goal && !*over) {
    enum status status = STATUS_STEP_MINIMUM;
    if (++c->steps > STEPS_MAX) {
      return status;
    }
    enum outcome outcome = c->afoot ? OUTCOME_MOVES : try_rest(c, goal, &status);
    if (outcome == OUTCOME_ENDS) {
      return status;
    }
    if (outcome == OUTCOME_AGAIN) {
      continue;
    }
    if (outcome == OUTCOME_MOVES) {
      status = course_carry(c, carried_target(c, goal));
    }
    if (status == STATUS_OK) {
      status = take(c, outcome == OUTCOME_MOVES);
    }
    if (status != STATUS_OK) {
      return status;
    }
    *over = is_free(c);
  }
  return STATUS_OK;
}

static enum status follow_stage(struct course *c, const struct stage *stage) {
  bool over = false;
  c->stage = *stage;
  c->along = 0;
  stage_enter_leg(&c->stage, c->f, 0);
  c->step = 0.5 * c->stage.full;
  c->steps = c->jumps = 0;
  c->unrest = c->short_steps = 0;
  c->afoot = false;
  c->pace = 0;
  c->report->stage = stage->kind;
  enum status status = take(c, false);
  over = status == STATUS_OK && is_free(c);
  for (int k = 1; k <= stage->records && status == STATUS_OK && !over; k++) {
    stage_enter_leg(&c->stage, c->f, (double)k / stage->records);
    c->step = fmin(c->step, c->stage.full);
    status = reach(c, (double)k / stage->records, &over);
  }
  c->pulled = pulled_at(c, c->along);
  return status;
}

static void close_ledger(struct course *c) {
  const struct energy *e = &c->f->energy;
  double work = fabs(e->pressure_work) + fabs(e->weight_work) + fabs(e->obstacle_work);
  c->report->energy_error = work > 0 ? fabs(e->remainder) / work : 0;
  c->report->in_motion = c->stages > 0 ? c->moving / c->stages : 0;
  c->report->along = c->along;
}

/* Says how far the course came and why it ended there. */
static void explain(const struct course *c, enum status status) {
  bool known = c->failure != STATUS_OK && c->failure != status;
  error_set(c->error, status, "/grasp", "stopped in the %s, after %.3g %% of it: %s%s%s%s",
            grasp_stage_word(c->stage.kind), 100 * c->along, status_sentence(status),
            known ? " (last attempt: " : "", known ? status_sentence(c->failure) : "",
            known ? ")" : "");
}

enum status course_follow(struct finger *f, const struct course_visit *visit,
                          struct course_report *report, struct error *error) {
  struct stage stages[STAGE_COUNT];
  struct course c = {.f = f, .visit = visit, .report = report, .error = error};
  int count = stages_plan(f, stages);
  *report = (struct course_report){.along = 0};
  c.stage = stages[0];
  course_place_object(&c, 0);
  struct fe_load none = course_load_at(&c, 0);
  enum status status = model_evaluate(f->solve.model, &f->solve.state, &none, false);
  model_commit_obstacles(f->solve.model, &f->solve.state);
  energy_start(&f->energy, f->solve.model, &f->solve.state, &none, 0);
  if (status == STATUS_OK) {
    status = guess_create(f->solve.model, &c.guess);
  }
  for (int k = 0; k < count && status == STATUS_OK && !f->loose.fell; k++) {
    if (stages[k].kind == STAGE_SUCTION && cups_close(f) == 0) {
      continue;
    }
    status = stages[k].kind == STAGE_LETTING_GO ? loose_begin(f, error) : STATUS_OK;
    if (status == STATUS_OK) {
      status = follow_stage(&c, &stages[k]);
    }
  }
  close_ledger(&c);
  if (status != STATUS_OK) {
    explain(&c, status);
  }
  guess_release(&c.guess);
  return status;
}

void course_report_release(struct course_report *report) {
  grasp_series_release(&report->series);
}
