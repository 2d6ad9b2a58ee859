/* Following and recording of paths. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "solver/snap/study.h"

/* Distance between tests of harmonics along a path, in lengths of the body: states in between are
 * taken to be as stable as the one before. */
static const double waves_step = 0.012;

void snap_study_warn(struct snap_study *study, const char *format, ...) {
  if (study->warning_count == SNAP_WARNINGS_MAX) {
    return;
  }
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(study->warning[study->warning_count++], SNAP_SENTENCE, format, arguments);
  va_end(arguments);
}

void snap_study_event(struct snap_study *study, enum snap_event_type type, const char *path,
                      const struct axi_state *state, int harmonic) {
  if (study->event_count < SNAP_EVENTS_MAX) {
    study->event[study->event_count++] =
        (struct snap_event){type, path, state->pressure, state->force, state->elongation, harmonic};
  }
}

static enum status append(struct snap_walk *walk, const struct axi_state *state) {
  struct snap_path *path = walk->path;
  const struct snap_body *body = &walk->study->body;
  if (path->count == path->capacity) {
    int capacity = path->capacity > 0 ? 2 * path->capacity : 128;
    struct snap_point *grown = realloc(path->point, sizeof *grown * (size_t)capacity);
    if (!grown) {
      return error_set(walk->error, STATUS_NO_MEMORY, NULL, "no memory for a path of %d states",
                       capacity);
    }
    path->point = grown;
    path->capacity = capacity;
  }
  path->point[path->count++] = (struct snap_point){
      .pressure = state->pressure,
      .force = state->force,
      .elongation = state->elongation,
      .volume = state->volume,
      .energy = state->energy + state->contact_energy,
      .stiffness = state->stiffness,
      .pet_strain = body->pet_strain(body->self, state->u),
      .negative_free = state->negative_free,
      .negative_held = state->negative_held,
      .inverted = body->inverted(body->self, state->u),
      .touching = state->touching,
  };
  return STATUS_OK;
}

static void note_events(struct snap_walk *walk, const struct axi_state *state,
                        const struct continuation_point *point) {
  const struct snap_path *path = walk->path;
  struct snap_study *study = walk->study;
  const struct snap_point *now = &path->point[path->count - 1];
  const struct snap_point *before = path->count > 1 ? now - 1 : NULL;
  double yield = study->spec->pet_yield_strain;
  if (point->events & CONTINUATION_LIMIT) {
    snap_study_event(study, SNAP_LIMIT_POINT, path->name, state, -1);
  }
  if (now->touching && !(before && before->touching)) {
    snap_study_event(study, SNAP_TOUCH, path->name, state, -1);
  }
  if (now->pet_strain > yield && !(before && before->pet_strain > yield)) {
    snap_study_event(study, SNAP_YIELD, path->name, state, -1);
  }
  bool unloaded = now->pressure == 0.0 && now->force == 0.0;
  if (unloaded && now->negative_free == 0 && path->control != SNAP_BY_PRESSURE_HELD) {
    snap_study_event(study, SNAP_STABLE_STATE, path->name, state, -1);
  }
}

static void tell_progress(const struct snap_walk *walk, const struct axi_state *state) {
  if (walk->study->progress) {
    double n = walk->path->count, done = n / (n + 100.0);
    fprintf(walk->study->progress,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"stage\":\"%s\",\"pressure_kPa\":%.6g,"
            "\"force_N\":%.6g,\"step\":%ld}\n",
            walk->share[0] + done * (walk->share[1] - walk->share[0]), walk->path->name,
            1e-3 * state->pressure, state->force, walk->study->states);
    fflush(walk->study->progress);
  }
}

static bool is_due(const struct snap_walk *walk, const struct axi_state *state,
                   const struct continuation_point *point) {
  const struct snap_study *study = walk->study;
  return !walk->quiet && study->spec->harmonics_to > 0 && study->body.harmonics &&
         state->negative_free == 0 && walk->path->control != SNAP_BY_PRESSURE_HELD &&
         point->arc - walk->waves_at >= waves_step * study->body.length;
}

static bool visit(void *context, const struct axi_state *state,
                  const struct continuation_point *point) {
  struct snap_walk *walk = context;
  walk->study->states++;
  walk->status = append(walk, state);
  if (walk->status != STATUS_OK) {
    return false;
  }
  if (!walk->quiet) {
    note_events(walk, state, point);
  }
  tell_progress(walk, state);
  if (is_due(walk, state, point)) {
    walk->waves_at = point->arc;
    walk->status = snap_test_waves(walk->study, walk->path->name, state, walk->error);
  }
  walk->open =
      walk->status == STATUS_OK && walk->go_on(walk, state, point) && walk->status == STATUS_OK;
  return walk->open;
}

/* What was known before an attempt. */
struct record {
  int points, events, waves;
  struct snap_metrics metrics;
  bool has[SNAP_MARKS];
};

static struct record remember(const struct snap_walk *walk) {
  const struct snap_study *study = walk->study;
  struct record now = {.points = walk->path->count,
                       .events = study->event_count,
                       .waves = study->waves_count,
                       .metrics = study->metrics};
  memcpy(now.has, study->has, sizeof now.has);
  return now;
}

static void forget(struct snap_walk *walk, const struct record *before) {
  struct snap_study *study = walk->study;
  while (study->waves_count > before->waves) {
    free(study->waves[--study->waves_count].negative);
  }
  walk->path->count = before->points;
  study->event_count = before->events;
  study->metrics = before->metrics;
  memcpy(study->has, before->has, sizeof before->has);
}

/* How a path is followed: where walls come into touch it turns within nanometres, and what gets
 * through there differs from path to path. */
static const struct {
  double angle_max, tolerance, step; /* rad; the others relative to the defaults */
} manners[] = {{0.5, 1.0, 1.0}, {1.0, 100.0, 1.0}, {0.5, 10.0, 0.4}, {1.0, 100.0, 0.25}};
enum { MANNERS = sizeof manners / sizeof *manners };

static enum status attempt(struct snap_walk *walk, int manner, const struct axi_ramp *ramp,
                           int direction, int target_count, const double *target,
                           struct axi_state *state) {
  struct snap_study *study = walk->study;
  struct continuation_options options = study->body.options(study->body.self);
  options.target_count = target_count;
  options.target = target;
  options.deadline_s = study->deadline_s;
  options.cancelled = study->cancelled;
  options.steps_max = 4000;
  options.angle_max = manners[manner].angle_max;
  options.tolerance *= manners[manner].tolerance;
  options.step_max *= manners[manner].step;
  walk->waves_at = -INFINITY;
  walk->status = STATUS_OK;
  enum status status = study->body.follow(study->body.self, ramp, &options, direction, NULL, visit,
                                          walk, state, walk->error);
  if (status == STATUS_OK && walk->status == STATUS_OK && walk->open) {
    return error_set(walk->error, STATUS_DIVERGED, NULL, "there is no end of it within %d states",
                     options.steps_max);
  }
  return status == STATUS_OK ? walk->status : status;
}

enum status snap_walk_along(struct snap_walk *walk, const struct axi_ramp *ramp, int direction,
                            int target_count, const double *target, struct axi_state *state) {
  struct snap_study *study = walk->study;
  const struct record before = remember(walk);
  struct axi_state start;
  enum status status = snap_body_state(&study->body, &start, walk->error);
  if (status != STATUS_OK) {
    return status;
  }
  snap_body_copy(&study->body, state, &start);
  status = attempt(walk, 0, ramp, direction, target_count, target, state);
  for (int k = 1; k < MANNERS && (status == STATUS_STEP_MINIMUM || status == STATUS_DIVERGED);
       k++) {
    forget(walk, &before);
    snap_body_copy(&study->body, &start, state);
    status = attempt(walk, k, ramp, direction, target_count, target, state);
  }
  axi_state_destroy(&start);
  return status;
}
