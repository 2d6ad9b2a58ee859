#include "solver/snap/folded.h"

#include <math.h>
#include <stdlib.h>

#include "solver/snap/carry.h"

/* Ratios of bulk to shear modulus of the foam: as it is pushed, and as it is carried over. */
static const double foam = 0.3;
/* Part of the PET's modulus that is left as the body is pushed. */
static const double soft = 0.02;
/* Angle of a shell that counts as turned, relative to the one as moulded. */
static const double turned = 0.8;

/* Whether another way may lead further. */
static bool may_try_again(enum status status) {
  return status == STATUS_DIVERGED || status == STATUS_INVERTED || status == STATUS_STEP_MINIMUM ||
         status == STATUS_UNSTABLE_PATH;
}

/* ---- changing the material ---------------------------------------------------------------- */

/* Takes a positive coefficient of the material from its value to another one, in equilibrium with
 * the load, in steps that get shorter where Newton's method fails. It has the last value that was
 * reached. */
static enum status change(double *value, double to, struct axi_model *model,
                          const struct axi_load *load, bool held,
                          const struct continuation_options *limits, struct axi_state *state,
                          struct error *error) {
  struct continuation_options options = *limits;
  double factor = 2.0;
  options.iterations_max = 40;
  enum status status = STATUS_OK;
  while (status == STATUS_OK && *value != to) {
    double before = *value, ratio = to / before;
    *value = fabs(log(ratio)) <= log(factor) ? to : ratio > 1.0 ? before * factor : before / factor;
    enum status one = axi_equilibrium(model, load, held, &options, state, NULL, error);
    if (one == STATUS_DIVERGED || one == STATUS_INVERTED) {
      *value = before;
      factor = sqrt(factor);
      status = factor < 1.002 ? one : STATUS_OK;
    } else {
      status = one;
      factor = fmin(pow(factor, 1.3), 4.0);
    }
  }
  return status;
}

/* ---- pushing ------------------------------------------------------------------------------ */

struct push {
  const struct snap_spec *spec;
  const struct bellows *bellows;
  bool found;
};

static bool is_folded(const struct push *push, const struct axi_state *state) {
  int pairs = push->spec->pair_count;
  return state->negative_free == 0 && bellows_inverted(push->bellows, pairs, state->u) == pairs;
}

static bool until_turned(void *context, const struct axi_state *state,
                         const struct continuation_point *point) {
  struct push *push = context;
  (void)point;
  push->found = true;
  for (int k = 0; k < push->spec->pair_count; k++) {
    double angle = bellows_shell_angle(push->bellows, k, state->u);
    push->found = push->found && angle < -turned * push->spec->pair[k].snapping_angle;
  }
  return !push->found && fabs(state->elongation) < push->bellows->line.length;
}

static bool until_reached(void *context, const struct axi_state *state,
                          const struct continuation_point *point) {
  (void)context;
  (void)state;
  return !(point->events & CONTINUATION_TARGET);
}

static enum status push_through(const struct snap_spec *spec, const struct bellows *bellows,
                                struct axi_model *model, const struct continuation_options *options,
                                struct axi_state *state, struct error *error) {
  struct push push = {spec, bellows, false};
  double radius = spec->crest_radius;
  struct axi_ramp ramp = {
      .to = {.force = material_shear_modulus(&spec->silicone) * radius * radius}};
  enum status status =
      axi_follow(model, &ramp, options, -1, NULL, until_turned, &push, state, error);
  if (status == STATUS_OK && !push.found) {
    status = error_set(error, STATUS_UNSTABLE_PATH, NULL,
                       "the shells do not turn inside out as the body is pushed");
  }
  return status;
}

/* Gives the PET its modulus back at the length that was reached, then lets the body go. */
static enum status let_go(struct bellows *bellows, struct axi_model *model, double modulus,
                          const struct continuation_options *options, struct axi_state *state,
                          struct error *error) {
  static const double full = 1.0;
  struct axi_load held = {.elongation = state->elongation};
  enum status status = change(&bellows->mesh.region[BELLOWS_PET].c[0], modulus, model, &held, true,
                              options, state, error);
  if (status == STATUS_OK) {
    struct continuation_options path = *options;
    struct axi_ramp ramp = {.from = {.force = state->force}};
    path.target_count = 1;
    path.target = &full;
    state->lambda = 0.0;
    status = axi_follow(model, &ramp, &path, 1, NULL, until_reached, NULL, state, error);
  }
  return status;
}

/* ---- the folded body ---------------------------------------------------------------------- */

/* From one pressure to another. */
static enum status inflate(struct axi_model *model, double from, double to,
                           const struct continuation_options *options, struct axi_state *state,
                           struct error *error) {
  static const double full = 1.0;
  struct continuation_options path = *options;
  struct axi_ramp ramp = {.from = {.pressure = from}, .to = {.pressure = to}};
  if (from == to) {
    return STATUS_OK;
  }
  path.target_count = 1;
  path.target = &full;
  state->lambda = 0.0;
  return axi_follow(model, &ramp, &path, 1, NULL, until_reached, NULL, state, error);
}

/* From folded foam to silicone at a pressure that keeps the hinges open, and back to none. */
static enum status to_silicone(const struct push *push, struct bellows *bellows,
                               struct axi_model *model, double pressure,
                               const struct continuation_options *options, struct axi_state *state,
                               struct error *error) {
  const struct snap_spec *spec = push->spec;
  struct axi_load load = {.pressure = pressure};
  double *ratio = &bellows->mesh.region[BELLOWS_SILICONE].bulk_ratio;
  enum status status = inflate(model, 0.0, pressure, options, state, error);
  if (status == STATUS_OK) {
    status = change(ratio, spec->silicone.bulk_ratio, model, &load, false, options, state, error);
  }
  if (status == STATUS_OK && is_folded(push, state)) {
    status = inflate(model, pressure, 0.0, options, state, error);
  }
  if (status == STATUS_OK && !is_folded(push, state)) {
    status = error_set(error, STATUS_UNSTABLE_PATH, NULL,
                       "shells turned inside out do not stay so without load");
  }
  return status;
}

/* Tries one pressure after another. */
static enum status try_pressures(const struct push *push, struct bellows *bellows,
                                 struct axi_model *model,
                                 const struct continuation_options *options,
                                 struct axi_state *state, struct error *error) {
  static const double part[] = {1.0 / 3.0, 0.25, 0.4, 0.5, 0.15, 0.65, 0.0};
  enum { PARTS = sizeof part / sizeof *part };
  struct axi_state start;
  struct material_spec *silicone = &bellows->mesh.region[BELLOWS_SILICONE];
  double ratio = silicone->bulk_ratio;
  enum status status = axi_state_create(model, &start, error);
  if (status != STATUS_OK) {
    return status;
  }
  axi_state_copy(model, state, &start);
  status = STATUS_DIVERGED;
  for (int i = 0; i < PARTS && may_try_again(status); i++) {
    silicone->bulk_ratio = ratio;
    axi_state_copy(model, &start, state);
    status =
        to_silicone(push, bellows, model, part[i] * push->spec->pressure_to, options, state, error);
  }
  axi_state_destroy(&start);
  return status;
}

enum status folded_state(const struct snap_spec *spec, struct bellows *bellows,
                         struct axi_model *model, const struct folded_limits *limits,
                         struct axi_state *state, struct error *error) {
  struct push push = {spec, bellows, false};
  struct continuation_options options = axi_defaults(model);
  options.deadline_s = limits->deadline_s;
  options.cancelled = limits->cancelled;
  options.angle_max = 1.0;
  options.tolerance *= 100.0;
  struct material_spec *region = bellows->mesh.region;
  region[BELLOWS_SILICONE].bulk_ratio = fmin(foam, spec->silicone.bulk_ratio);
  region[BELLOWS_PET].c[0] *= soft;
  enum status status = push_through(spec, bellows, model, &options, state, error);
  if (status == STATUS_OK) {
    status = let_go(bellows, model, spec->pet.c[0], &options, state, error);
  }
  if (status == STATUS_OK) {
    status = try_pressures(&push, bellows, model, &options, state, error);
  }
  region[BELLOWS_SILICONE] = spec->silicone;
  region[BELLOWS_PET] = spec->pet;
  return status;
}

/* ---- from a single pair ------------------------------------------------------------------- */

/* The state at a pressure near the guess: as silicone, or as foam that becomes it. */
static enum status settle(const struct push *push, struct bellows *bellows, struct axi_model *model,
                          double pressure, const struct continuation_options *options,
                          struct axi_state *state, struct error *error) {
  const struct snap_spec *spec = push->spec;
  struct axi_load load = {.pressure = pressure};
  struct axi_state guess;
  double *ratio = &bellows->mesh.region[BELLOWS_SILICONE].bulk_ratio;
  enum status status = axi_state_create(model, &guess, error);
  if (status != STATUS_OK) {
    return status;
  }
  axi_state_copy(model, state, &guess);
  status = axi_equilibrium(model, &load, false, options, state, NULL, error);
  if (may_try_again(status)) {
    axi_state_copy(model, &guess, state);
    *ratio = fmin(foam, spec->silicone.bulk_ratio);
    status = axi_equilibrium(model, &load, false, options, state, NULL, error);
    if (status == STATUS_OK) {
      status = change(ratio, spec->silicone.bulk_ratio, model, &load, false, options, state, error);
    }
    *ratio = spec->silicone.bulk_ratio;
  }
  axi_state_destroy(&guess);
  return status;
}

/* What the ends of a row that goes on do at the elongation, as offsets of the plates. */
static void ends_of_row(const struct snap_spec *spec, const struct bellows *b, double elongation,
                        const double *u, double *offset) {
  for (int j = 0; spec->ends == SNAP_PLATES && j < b->column_count; j++) {
    int low = bellows_node(b, 0, j), high = bellows_node(b, b->row_count - 1, j);
    for (int i = 0; i < 2; i++) {
      offset[2 * low + i] = u[2 * low + i];
      offset[2 * high + i] = u[2 * high + i] - i * elongation;
    }
  }
}

static void set_ends(struct bellows *b, const double *offset, double share) {
  for (int i = 0; i < 2 * b->mesh.node_count; i++) {
    b->mesh.offset[i] = share * offset[i];
  }
}

/* Brings the ends to their plates, in steps that get shorter where Newton's method fails. */
static enum status bring_ends(struct bellows *b, struct axi_model *model, const double *offset,
                              const struct axi_load *load,
                              const struct continuation_options *options, struct axi_state *state,
                              struct error *error) {
  static const double smallest = 1e-3;
  double step = 0.1, left = 1.0;
  enum status status = STATUS_OK;
  while (status == STATUS_OK && left > 0.0) {
    double next = fmax(left - step, 0.0);
    set_ends(b, offset, next);
    enum status one = axi_equilibrium(model, load, false, options, state, NULL, error);
    if (one == STATUS_OK) {
      left = next;
      step *= 1.5;
    } else {
      step *= 0.5;
      status = may_try_again(one) && step > smallest ? STATUS_OK : one;
    }
  }
  return status;
}

/* The folded row at a pressure that is the last of its loads, and without load. */
static enum status fold_row(const struct push *push, struct bellows *bellows,
                            struct axi_model *model, double pressure, const double *offset,
                            const struct continuation_options *options, struct axi_state *state,
                            struct error *error) {
  struct axi_load load = {.pressure = pressure};
  set_ends(bellows, offset, 1.0);
  enum status status = settle(push, bellows, model, pressure, options, state, error);
  if (status == STATUS_OK && push->spec->ends == SNAP_PLATES) {
    status = bring_ends(bellows, model, offset, &load, options, state, error);
  }
  set_ends(bellows, offset, 0.0);
  if (status == STATUS_OK) {
    status = inflate(model, pressure, 0.0, options, state, error);
  }
  if (status == STATUS_OK && !is_folded(push, state)) {
    int pairs = push->spec->pair_count;
    status = error_set(error, STATUS_UNSTABLE_PATH, NULL,
                       "%d of %d shells turned inside out stay so without load",
                       bellows_inverted(bellows, pairs, state->u), pairs);
  }
  return status;
}

enum status folded_from_pair(const struct snap_spec *spec, struct bellows *bellows,
                             struct axi_model *model, const struct bellows *pair,
                             const struct axi_state *pair_state, const struct folded_limits *limits,
                             struct axi_state *state, struct error *error) {
  static const double part[] = {0.0, 1.0 / 3.0, 0.15, 0.5};
  enum { PARTS = sizeof part / sizeof *part };
  struct push push = {spec, bellows, false};
  struct continuation_options options = axi_defaults(model);
  options.deadline_s = limits->deadline_s;
  options.cancelled = limits->cancelled;
  options.iterations_max = 60;
  enum status status = STATUS_DIVERGED;
  double *offset = calloc(2 * (size_t)bellows->mesh.node_count, sizeof *offset);
  if (!offset) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a guess");
  }
  for (int i = 0; i < PARTS && may_try_again(status); i++) {
    double elongation = 0.0;
    status = carry_pair(pair, pair_state->u, pair_state->elongation, bellows, state->u, &elongation,
                        error);
    if (status == STATUS_OK) {
      ends_of_row(spec, bellows, elongation, state->u, offset);
      axi_model_gather(model, state->u, state->x);
      state->x[axi_model_size(model) - 1] = elongation;
      status = fold_row(&push, bellows, model, part[i] * spec->pressure_to, offset, &options, state,
                        error);
    }
  }
  free(offset);
  return status;
}
