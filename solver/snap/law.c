/* Force against length at constant pressures: held at the natural length, then let go both ways. */
#include <math.h>
#include <stdlib.h>

#include "solver/snap/study.h"

/* ---- held at the natural length ----------------------------------------------------------- */

static bool until_held(struct snap_walk *walk, const struct axi_state *state,
                       const struct continuation_point *point) {
  (void)walk;
  (void)state;
  return !((point->events & CONTINUATION_TARGET) && point->lambda >= 1.0 - 1e-9);
}

/* The natural length held while the pressure goes to `pressure`. */
static enum status hold(struct snap_study *study, struct snap_path *path, double pressure,
                        const double share[2], struct axi_state *state, struct error *error) {
  enum { STEPS = 8 };
  double target[STEPS];
  for (int k = 0; k < STEPS; k++) {
    target[k] = (k + 1.0) / STEPS;
  }
  struct snap_walk walk = {.study = study,
                           .path = path,
                           .go_on = until_held,
                           .quiet = true,
                           .share = {share[0], share[1]},
                           .error = error};
  struct axi_ramp ramp = {.to = {.pressure = pressure}, .held = true};
  return snap_walk_along(&walk, &ramp, 1, STEPS, target, state);
}

enum status snap_follow_held(struct snap_study *study, struct error *error) {
  static const double share[2] = {0.75, 0.8};
  const struct snap_spec *spec = study->spec;
  struct axi_state state;
  study->held = (struct snap_path){.name = "held", .control = SNAP_BY_PRESSURE_HELD};
  if (spec->extension_at == 0.0) {
    return STATUS_OK;
  }
  enum status status = snap_study_copy(study, SNAP_NATURAL, &state, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = hold(study, &study->held, spec->extension_at, share, &state, error);
  if (status == STATUS_OK) {
    double both = 0.0, square = 0.0;
    for (int i = 0; i < study->held.count; i++) {
      const struct snap_point *p = &study->held.point[i];
      both -= p->force * p->pressure;
      square += p->pressure * p->pressure;
    }
    study->metrics.held_force = -state.force;
    study->metrics.force_per_pressure = both / square;
  }
  axi_state_destroy(&state);
  return status;
}

/* ---- one pressure ------------------------------------------------------------------------- */

/* Elongations between which a law is wanted. */
struct range {
  double low, high;
};

static bool within(struct snap_walk *walk, const struct axi_state *state,
                   const struct continuation_point *point) {
  const struct range *range = walk->context;
  (void)point;
  return state->elongation >= range->low && state->elongation <= range->high;
}

static void reverse(struct snap_path *path) {
  for (int i = 0, j = path->count - 1; i < j; i++, j--) {
    struct snap_point swap = path->point[i];
    path->point[i] = path->point[j];
    path->point[j] = swap;
  }
}

/* Both ways from the held state, into one path that starts compressed. */
static enum status both_ways(struct snap_study *study, struct snap_path *path, double pressure,
                             const double share[2], struct axi_state *from, struct axi_state *state,
                             struct error *error) {
  const struct axi_state *compressed = &study->state[SNAP_COMPRESSED];
  double travel = fabs(compressed->elongation);
  double far = isfinite(study->metrics.stretched) ? study->metrics.stretched : travel;
  struct range range = {compressed->elongation - 0.05 * travel, far + 0.25 * travel};
  struct snap_walk walk = {.study = study,
                           .path = path,
                           .go_on = within,
                           .context = &range,
                           .quiet = true,
                           .share = {share[0], share[1]},
                           .error = error};
  double step = fabs(from->force) + snap_force_scale(study->spec);
  struct axi_ramp ramp = {.from = {.pressure = pressure, .force = from->force},
                          .to = {.pressure = pressure, .force = from->force + step}};
  snap_body_copy(&study->body, from, state);
  state->lambda = 0.0;
  enum status status = snap_walk_along(&walk, &ramp, -1, 0, NULL, state);
  if (status != STATUS_OK) {
    return status;
  }
  reverse(path);
  path->count -= path->count > 0;
  snap_body_copy(&study->body, from, state);
  state->lambda = 0.0;
  return snap_walk_along(&walk, &ramp, 1, 0, NULL, state);
}

static enum status follow_law(struct snap_study *study, int index, struct axi_state *from,
                              struct axi_state *state, struct error *error) {
  const struct snap_spec *spec = study->spec;
  double pressure = spec->law[index], width = 0.2 / spec->law_count;
  const double share[2] = {0.8 + width * index, 0.8 + width * (index + 1)};
  struct snap_path *path = &study->law[study->law_count++], start = {.name = "law"};
  *path = (struct snap_path){.name = "law", .control = SNAP_BY_FORCE};
  snap_body_copy(&study->body, &study->state[SNAP_NATURAL], from);
  from->lambda = 0.0;
  enum status status = STATUS_OK;
  if (pressure != 0.0) {
    status = hold(study, &start, pressure, share, from, error);
  }
  snap_path_release(&start);
  return status == STATUS_OK ? both_ways(study, path, pressure, share, from, state, error) : status;
}

enum status snap_follow_laws(struct snap_study *study, struct error *error) {
  struct axi_state from, state;
  enum status status = snap_study_copy(study, SNAP_NATURAL, &from, error), first = STATUS_OK;
  if (status != STATUS_OK) {
    return status;
  }
  status = snap_study_copy(study, SNAP_NATURAL, &state, error);
  for (int i = 0; status == STATUS_OK && i < study->spec->law_count; i++) {
    struct error local = {.status = STATUS_OK};
    enum status one = follow_law(study, i, &from, &state, &local);
    if (one != STATUS_OK && first == STATUS_OK) {
      first =
          error_set(error, one, NULL, "at %.6g kPa: %s", 1e-3 * study->spec->law[i], local.message);
    }
    status = snap_is_final(one) ? one : STATUS_OK;
  }
  axi_state_destroy(&from);
  axi_state_destroy(&state);
  return first != STATUS_OK ? first : status;
}
