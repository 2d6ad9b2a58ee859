/* The paths of a study: from which state, under which load, to where. */
#include <math.h>
#include <string.h>

#include "solver/snap/study.h"

static struct snap_path *new_path(struct snap_study *study, const char *name,
                                  enum snap_control control) {
  struct snap_path *path = &study->path[study->path_count++];
  *path = (struct snap_path){.name = name, .control = control};
  return path;
}

double snap_force_scale(const struct snap_spec *spec) {
  return spec->pressure_to * M_PI * spec->crest_radius * spec->crest_radius;
}

static bool is_unloaded(const struct axi_state *state) {
  return state->pressure == 0.0 && state->force == 0.0;
}

/* ---- the compressed state ----------------------------------------------------------------- */

static bool is_compressed(const struct snap_study *study, const struct axi_state *state) {
  const struct snap_body *body = &study->body;
  return state->negative_free == 0 &&
         body->inverted(body->self, state->u) == study->spec->pair_count;
}

static bool until_compressed(struct snap_walk *walk, const struct axi_state *state,
                             const struct continuation_point *point) {
  (void)point;
  if (is_unloaded(state) && is_compressed(walk->study, state)) {
    walk->status = snap_study_keep(walk->study, SNAP_COMPRESSED, state, walk->error);
    return false;
  }
  double limit = walk->study->body.length;
  return state->elongation < limit && state->elongation > -limit;
}

/* By way of foam. */
static enum status compressed_by_folding(struct snap_study *study, struct axi_state *state,
                                         struct error *error) {
  struct folded_limits limits = {study->deadline_s, study->cancelled};
  enum status status = study->body.fold(study->body.self, &limits, state, error);
  return status == STATUS_OK ? snap_study_keep(study, SNAP_COMPRESSED, state, error) : status;
}

/* From the natural state by pushing. */
static enum status compressed_by_force(struct snap_study *study, struct axi_state *state,
                                       struct error *error) {
  static const double unloaded = 0.0;
  struct snap_path path = {.name = "push", .control = SNAP_BY_FORCE};
  struct snap_walk walk = {.study = study,
                           .path = &path,
                           .go_on = until_compressed,
                           .quiet = true,
                           .share = {0.0, 0.15},
                           .error = error};
  struct axi_ramp ramp = {.to = {.force = snap_force_scale(study->spec)}};
  snap_body_copy(&study->body, &study->state[SNAP_NATURAL], state);
  state->lambda = 0.0;
  enum status status = snap_walk_along(&walk, &ramp, -1, 1, &unloaded, state);
  snap_path_release(&path);
  if (status == STATUS_OK && !study->has[SNAP_COMPRESSED]) {
    status = error_set(error, STATUS_UNSTABLE_PATH, NULL,
                       "no state with all shells inside out is stable without load");
  }
  return status;
}

enum status snap_find_compressed(struct snap_study *study, struct error *error) {
  struct axi_state state;
  struct error first = {.status = STATUS_OK};
  enum status status = snap_study_copy(study, SNAP_NATURAL, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = compressed_by_folding(study, &state, &first);
  if (status != STATUS_OK &&
      (snap_is_final(status) || compressed_by_force(study, &state, error) != STATUS_OK)) {
    *error = first;
  } else {
    status = STATUS_OK;
  }
  axi_state_destroy(&state);
  if (status == STATUS_OK) {
    study->metrics.compressed = study->state[SNAP_COMPRESSED].elongation;
  }
  return status;
}

/* ---- by force ----------------------------------------------------------------------------- */

struct axial {
  double highest;     /* energy of the unloaded states on the way */
  double most, least; /* force */
};

/* From the compressed to the natural state, and then as far as the pressure would drive it. */
static bool until_natural(struct snap_walk *walk, const struct axi_state *state,
                          const struct continuation_point *point) {
  struct snap_study *study = walk->study;
  struct axial *axial = walk->context;
  const struct axi_state *compressed = &study->state[SNAP_COMPRESSED];
  double energy = state->energy + state->contact_energy;
  bool back = isfinite(study->metrics.barrier);
  if (point->events & CONTINUATION_START) {
    *axial = (struct axial){.highest = -INFINITY};
  }
  if (!back) {
    axial->most = fmax(axial->most, state->force);
    axial->least = fmin(axial->least, state->force);
    axial->highest = is_unloaded(state) ? fmax(axial->highest, energy) : axial->highest;
  }
  if (study->spec->pair_count > 1 && is_unloaded(state) && state->negative_free == 0) {
    walk->status = snap_stairs_note(study, state, walk->error);
  }
  if (!back && is_unloaded(state) && state->negative_free == 0 &&
      study->body.inverted(study->body.self, state->u) == 0) {
    study->metrics.barrier = axial->highest - compressed->energy - compressed->contact_energy;
    study->metrics.return_barrier = axial->highest - energy;
    study->metrics.snap_force = axial->most;
    study->metrics.return_force = -axial->least;
  }
  double limit = study->body.length;
  return state->elongation < limit && state->elongation > -limit &&
         !(back && state->force >= snap_force_scale(study->spec));
}

enum status snap_follow_axial(struct snap_study *study, struct error *error) {
  static const double unloaded = 0.0;
  struct axi_state state;
  struct axial axial;
  struct snap_walk walk = {.study = study,
                           .go_on = until_natural,
                           .context = &axial,
                           .share = {0.15, 0.35},
                           .error = error};
  struct axi_ramp ramp = {.to = {.force = snap_force_scale(study->spec)}};
  enum status status = snap_study_copy(study, SNAP_COMPRESSED, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  walk.path = new_path(study, "axial", SNAP_BY_FORCE);
  status = snap_walk_along(&walk, &ramp, 1, 1, &unloaded, &state);
  axi_state_destroy(&state);
  return status;
}

/* ---- by pressure -------------------------------------------------------------------------- */

/* Where folds close, a path may have a limit point behind which the body gives way a little and is
 * stable again on the same side of its snap. The limit point that counts is the one that asks most
 * of the pressure (`more` of what is known) before a shell turns. */
static void note_limit(struct snap_walk *walk, const struct axi_state *state, enum snap_mark mark,
                       bool more, double *pressure) {
  struct snap_study *study = walk->study;
  if (!study->has[mark] || more) {
    *pressure = state->pressure;
    walk->status = snap_study_keep(study, mark, state, walk->error);
  }
}

static bool until_stretched(struct snap_walk *walk, const struct axi_state *state,
                            const struct continuation_point *point) {
  struct snap_study *study = walk->study;
  double *trigger = &study->metrics.trigger_pressure;
  bool folded = study->body.inverted(study->body.self, state->u) == study->spec->pair_count;
  if ((point->events & CONTINUATION_LIMIT) && state->pressure > 0.0) {
    note_limit(walk, state, SNAP_TRIGGER, folded && state->pressure > *trigger, trigger);
  }
  /* Of a row the way on leads through every order in which its pairs may snap. */
  bool only = walk->context || study->spec->pair_count > 1;
  if (only && study->has[SNAP_TRIGGER] && (!folded || state->pressure < 0.0)) {
    return false;
  }
  double limit = 2.0 * study->body.length;
  bool deep = state->pressure < study->spec->vacuum_to && study->has[SNAP_TRIGGER];
  return !(point->events & CONTINUATION_TARGET) && !deep && state->elongation < limit;
}

/* Up to the trigger only, where `only` is not NULL. */
static enum status follow_pressure(struct snap_study *study, bool *only, struct error *error) {
  static const double full = 1.0;
  struct axi_state state;
  struct snap_walk walk = {.study = study,
                           .go_on = until_stretched,
                           .context = only,
                           .share = {0.35, 0.55},
                           .error = error,
                           .quiet = only != NULL};
  struct axi_ramp ramp = {.to = {.pressure = study->spec->pressure_to}};
  enum status status = snap_study_copy(study, SNAP_COMPRESSED, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  walk.path = new_path(study, "pressure", SNAP_BY_PRESSURE);
  status = snap_walk_along(&walk, &ramp, 1, 1, &full, &state);
  axi_state_destroy(&state);
  return status;
}

enum status snap_follow_pressure(struct snap_study *study, struct error *error) {
  return follow_pressure(study, NULL, error);
}

static bool until_release(struct snap_walk *walk, const struct axi_state *state,
                          const struct continuation_point *point) {
  struct snap_study *study = walk->study;
  double *release = &study->metrics.release_pressure;
  bool turned = study->body.inverted(study->body.self, state->u) > 0;
  if (point->events & CONTINUATION_LIMIT) {
    note_limit(walk, state, SNAP_RELEASE, !turned && state->pressure < *release, release);
  }
  bool full = point->events & CONTINUATION_TARGET;
  if (full && state->negative_free == 0 && !turned) { /* it stands all of the vacuum */
    study->has[SNAP_RELEASE] = false;
    *release = NAN;
  }
  return !full && !(study->has[SNAP_RELEASE] && (turned || state->pressure >= 0.0));
}

enum status snap_follow_vacuum(struct snap_study *study, struct error *error) {
  static const double full = 1.0;
  struct axi_state state;
  struct snap_walk walk = {
      .study = study, .go_on = until_release, .share = {0.55, 0.65}, .error = error};
  struct axi_ramp ramp = {.to = {.pressure = study->spec->vacuum_to}};
  if (ramp.to.pressure == 0.0) {
    return STATUS_OK;
  }
  enum status status = snap_study_copy(study, SNAP_NATURAL, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  walk.path = new_path(study, "vacuum", SNAP_BY_PRESSURE);
  status = snap_walk_along(&walk, &ramp, 1, 1, &full, &state);
  axi_state_destroy(&state);
  if ((status == STATUS_STEP_MINIMUM || status == STATUS_DIVERGED) && study->has[SNAP_RELEASE]) {
    snap_study_warn(study,
                    "the path under vacuum is lost behind its limit point at %.4g kPa: the body "
                    "may have to be brought lower to return",
                    1e-3 * study->metrics.release_pressure);
    status = STATUS_OK;
  }
  return status;
}

static bool until_full(struct snap_walk *walk, const struct axi_state *state,
                       const struct continuation_point *point) {
  struct snap_study *study = walk->study;
  const struct snap_spec *spec = study->spec;
  const double *near = walk->context; /* the pressure where the body has snapped */
  if ((point->events & CONTINUATION_START) && spec->extension_at == 0.0) {
    study->metrics.stretched = state->elongation;
  }
  if (point->events & CONTINUATION_TARGET) {
    if (fabs(state->pressure - *near) <= 1e-9 * *near) {
      const struct axi_state *trigger = &study->state[SNAP_TRIGGER];
      study->metrics.released = trigger->energy + trigger->contact_energy -
                                trigger->pressure * trigger->volume - state->energy -
                                state->contact_energy + state->pressure * state->volume;
      walk->status = snap_study_keep(study, SNAP_SNAPPED, state, walk->error);
    }
    if (fabs(state->pressure - spec->extension_at) <= 1e-9 * spec->extension_at) {
      study->metrics.stretched = state->elongation;
    }
    if (state->pressure >= spec->pressure_to * (1.0 - 1e-9)) {
      walk->status = snap_study_keep(study, SNAP_STRETCHED, state, walk->error);
      return false;
    }
  }
  return !(point->events & CONTINUATION_LIMIT);
}

enum status snap_follow_stretched(struct snap_study *study, struct error *error) {
  const struct snap_spec *spec = study->spec;
  double to = spec->pressure_to, trigger = study->metrics.trigger_pressure, target[3] = {1.0};
  int targets = 1;
  if (spec->extension_at < to && spec->extension_at > 0.0) {
    target[targets++] = spec->extension_at / to;
  }
  if (trigger < to * (1.0 - 1e-9) && trigger != spec->extension_at) {
    target[targets++] = trigger / to;
  }
  struct axi_state state;
  struct snap_walk walk = {.study = study,
                           .go_on = until_full,
                           .context = &trigger,
                           .share = {0.65, 0.75},
                           .error = error};
  struct axi_ramp ramp = {.to = {.pressure = to}};
  enum status status = snap_study_copy(study, SNAP_NATURAL, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  walk.path = new_path(study, "pressure from natural", SNAP_BY_PRESSURE);
  status = snap_walk_along(&walk, &ramp, 1, targets, target, &state);
  axi_state_destroy(&state);
  return status;
}

/* ---- one metric --------------------------------------------------------------------------- */

enum status snap_study_metric(struct snap_study *study, const char *metric, double *value,
                              struct error *error) {
  bool only = true;
  enum status status;
  *value = NAN;
  if (strcmp(metric, "release_pressure_kPa") == 0) {
    status = snap_follow_vacuum(study, error);
    *value = study->metrics.release_pressure;
  } else {
    status = snap_find_compressed(study, error);
    if (status == STATUS_OK && strcmp(metric, "trigger_pressure_kPa") == 0) {
      status = follow_pressure(study, &only, error);
    }
    *value = strcmp(metric, "travel_per_pair_mm") == 0
                 ? -study->metrics.compressed / study->spec->pair_count
                 : study->metrics.trigger_pressure;
  }
  if (status == STATUS_OK && !isfinite(*value)) {
    status = error_set(error, STATUS_DIVERGED, NULL, "the body has no %s up to the limits of load",
                       metric);
  }
  return status;
}
