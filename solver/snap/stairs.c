/* Rows of pairs: the pressure at which each state with some pairs folded gives way. */
#include <math.h>

#include "solver/snap/study.h"

enum status snap_stairs_note(struct snap_study *study, const struct axi_state *state,
                             struct error *error) {
  int folded = study->body.inverted(study->body.self, state->u);
  if (folded < 1 || folded > study->spec->pair_count || study->stair[folded - 1].known) {
    return STATUS_OK;
  }
  struct snap_stair *stair = &study->stair[folded - 1];
  enum status status = snap_body_state(&study->body, &stair->state, error);
  if (status == STATUS_OK) {
    snap_body_copy(&study->body, state, &stair->state);
    stair->known = true;
    stair->trigger = NAN;
  }
  return status;
}

/* As the trigger of the body: the limit point that asks most of the pressure before a shell turns.
 */
static bool until_turned(struct snap_walk *walk, const struct axi_state *state,
                         const struct continuation_point *point) {
  const struct snap_study *study = walk->study;
  struct snap_stair *stair = walk->context;
  int folded = 1 + (int)(stair - study->stair);
  bool turned = study->body.inverted(study->body.self, state->u) != folded;
  if ((point->events & CONTINUATION_LIMIT) && state->pressure > 0.0 &&
      (isnan(stair->trigger) || (!turned && state->pressure > stair->trigger))) {
    stair->trigger = state->pressure;
  }
  bool over = isfinite(stair->trigger) && (turned || state->pressure < 0.0);
  return !(point->events & CONTINUATION_TARGET) && !over;
}

enum status snap_follow_stairs(struct snap_study *study, struct error *error) {
  static const double full = 1.0;
  enum status status = STATUS_OK;
  for (int k = study->spec->pair_count - 1; k >= 0 && status == STATUS_OK; k--) {
    struct snap_stair *stair = &study->stair[k];
    if (!stair->known) {
      continue;
    }
    struct snap_path path = {.name = "stair", .control = SNAP_BY_PRESSURE};
    struct snap_walk walk = {.study = study,
                             .path = &path,
                             .go_on = until_turned,
                             .context = stair,
                             .quiet = true,
                             .share = {0.55, 0.55},
                             .error = error};
    struct axi_ramp ramp = {.to = {.pressure = study->spec->pressure_to}};
    struct axi_state state;
    status = snap_body_state(&study->body, &state, error);
    if (status == STATUS_OK) {
      snap_body_copy(&study->body, &stair->state, &state);
      state.lambda = 0.0;
      status = snap_walk_along(&walk, &ramp, 1, 1, &full, &state);
      axi_state_destroy(&state);
    }
    snap_path_release(&path);
  }
  return status;
}
