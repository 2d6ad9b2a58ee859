#include "solver/snap/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- states and paths --------------------------------------------------------------------- */

bool snap_is_final(enum status status) {
  return status_is_final(status) || status == STATUS_INTERNAL;
}

void snap_path_release(struct snap_path *path) {
  free(path->point);
  path->point = NULL;
  path->count = path->capacity = 0;
}

enum status snap_study_keep(struct snap_study *study, enum snap_mark mark,
                            const struct axi_state *state, struct error *error) {
  if (!study->state[mark].x) {
    enum status status = snap_body_state(&study->body, &study->state[mark], error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  snap_body_copy(&study->body, state, &study->state[mark]);
  study->has[mark] = true;
  return STATUS_OK;
}

enum status snap_study_copy(struct snap_study *study, enum snap_mark mark, struct axi_state *state,
                            struct error *error) {
  enum status status = snap_body_state(&study->body, state, error);
  if (status == STATUS_OK) {
    snap_body_copy(&study->body, &study->state[mark], state);
    state->lambda = 0.0;
  }
  return status;
}

/* ---- opening ------------------------------------------------------------------------------ */

static enum status keep_natural(struct snap_study *study, struct error *error) {
  struct axi_state state;
  struct continuation_options options = study->body.options(study->body.self);
  struct axi_load none = {.pressure = 0.0};
  enum status status = snap_body_state(&study->body, &state, error);
  if (status == STATUS_OK) {
    status = study->body.equilibrium(study->body.self, &none, false, &options, &state, error);
  }
  if (status == STATUS_OK) {
    status = snap_study_keep(study, SNAP_NATURAL, &state, error);
  }
  axi_state_destroy(&state);
  return status;
}

enum status snap_study_open(const struct snap_spec *spec, struct snap_study *study,
                            struct error *error) {
  memset(study, 0, sizeof *study);
  study->spec = spec;
  study->metrics = (struct snap_metrics){NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN,
                                         NAN, NAN, NAN, NAN, NAN, NAN, -1,  0};
  enum status status = snap_body_create(spec, &study->body, error);
  return status == STATUS_OK ? keep_natural(study, error) : status;
}

void snap_study_close(struct snap_study *study) {
  for (int i = 0; i < study->path_count; i++) {
    snap_path_release(&study->path[i]);
  }
  for (int i = 0; i < study->law_count; i++) {
    snap_path_release(&study->law[i]);
  }
  snap_path_release(&study->held);
  for (int i = 0; i < study->waves_count; i++) {
    free(study->waves[i].negative);
  }
  free(study->waves);
  for (int m = 0; m < SNAP_MARKS; m++) {
    if (study->state[m].x) {
      axi_state_destroy(&study->state[m]);
    }
  }
  for (int k = 0; k < SNAP_PAIRS_MAX; k++) {
    if (study->stair[k].state.x) {
      axi_state_destroy(&study->stair[k].state);
    }
  }
  snap_body_release(&study->body);
  memset(study, 0, sizeof *study);
}

/* ---- what the paths say ------------------------------------------------------------------- */

static void look_at_points(struct snap_study *study) {
  struct snap_metrics *m = &study->metrics;
  for (int i = 0; i < study->path_count; i++) {
    const struct snap_path *path = &study->path[i];
    bool first = strcmp(path->name, "pressure") == 0;
    for (int k = 0; k < path->count; k++) {
      const struct snap_point *p = &path->point[k];
      /* An unstable state is never seen. */
      if (p->negative_free == 0) {
        m->pet_strain = fmax(m->pet_strain, p->pet_strain);
      }
      if (first && p->touching && !isfinite(m->contact_onset)) {
        m->contact_onset = p->pressure;
      }
    }
  }
  if (m->pet_strain > study->spec->pet_yield_strain) {
    snap_study_warn(study,
                    "the PET is strained by %.3g %%, beyond its yield at %.3g %%: it would keep a "
                    "part of it, which the elastic law leaves out",
                    100.0 * m->pet_strain, 100.0 * study->spec->pet_yield_strain);
  }
}

static bool is_state_of_rest(const struct snap_point *p) {
  return p->pressure == 0.0 && p->force == 0.0 && p->negative_free == 0;
}

/* Stable states without load: distinct ones on the paths by force and by pressure. A row has more
 * than a list would take, as many lengths as it has pairs and one more. */
static void count_stable(struct snap_study *study) {
  enum { STATES_MAX = 64 };
  double seen[STATES_MAX], apart = 1e-3 * study->body.length;
  int count = 0;
  for (int i = 0; i < study->path_count; i++) {
    for (int k = 0; k < study->path[i].count && count < STATES_MAX; k++) {
      const struct snap_point *p = &study->path[i].point[k];
      bool known = !is_state_of_rest(p);
      for (int j = 0; !known && j < count; j++) {
        known = fabs(seen[j] - p->elongation) < apart;
      }
      if (!known) {
        seen[count++] = p->elongation;
      }
    }
  }
  study->metrics.stable_states = count;
}

static const struct snap_path *path_named(const struct snap_study *study, const char *name) {
  for (int i = 0; i < study->path_count; i++) {
    if (strcmp(study->path[i].name, name) == 0 && study->path[i].count > 0) {
      return &study->path[i];
    }
  }
  return NULL;
}

/* Whether the path ends at that pressure. */
static bool ends_at(const struct snap_path *path, double pressure) {
  return path && fabs(path->point[path->count - 1].pressure - pressure) <= 1e-6 * fabs(pressure);
}

/* Metrics that are missing although no path failed. */
static void look_at_ends(struct snap_study *study) {
  const struct snap_spec *spec = study->spec;
  const struct snap_path *vacuum = path_named(study, "vacuum");
  if (!study->has[SNAP_TRIGGER] && ends_at(path_named(study, "pressure"), spec->pressure_to)) {
    snap_study_warn(study,
                    "the pressure has no limit point from the compressed state up to %.6g kPa: "
                    "raise /load/pressure_to to find the trigger",
                    1e-3 * spec->pressure_to);
  }
  if (study->has[SNAP_COMPRESSED] && !study->has[SNAP_RELEASE] &&
      ends_at(vacuum, spec->vacuum_to)) {
    snap_study_warn(study,
                    "the body does not return down to %.6g kPa: lower /load/vacuum_to to find the "
                    "release pressure",
                    1e-3 * spec->vacuum_to);
  }
  for (int i = 0; i < study->event_count; i++) {
    const struct snap_event *event = &study->event[i];
    if (event->type == SNAP_LIMIT_POINT && vacuum && event->path == vacuum->name) {
      if (event->pressure > study->metrics.release_pressure * (1.0 - 1e-6)) {
        snap_study_warn(study,
                        "the stretched body gives way a little at %.4g kPa, before it returns at "
                        "%.4g kPa: where it does depends on the mesh and on the skin",
                        1e-3 * event->pressure, 1e-3 * study->metrics.release_pressure);
      }
      break;
    }
  }
}

/* Up to which pressure the compressed branch is stable against waves around the circumference. */
static void look_at_waves(struct snap_study *study) {
  struct snap_metrics *m = &study->metrics;
  if (!study->body.harmonics) {
    snap_study_warn(study, "a shell does not touch itself and is not tested for waves around the "
                           "circumference: the model \"solid\" is");
  }
  for (int i = 0; i < study->waves_count; i++) {
    const struct snap_waves *waves = &study->waves[i];
    bool compressed = waves->inverted == study->spec->pair_count;
    if (strcmp(waves->path, "pressure") != 0 || !compressed) {
      continue;
    }
    for (int n = 1; n <= study->spec->harmonics_to; n++) {
      if (waves->negative[n] > 0) {
        m->critical_harmonic = n;
        return;
      }
    }
    m->axisymmetric_to = waves->pressure;
  }
}

/* ---- everything --------------------------------------------------------------------------- */

typedef enum status follow(struct snap_study *study, struct error *error);

/* Runs a part; remembers the first failure, or the one that ends the study, with the name of the
 * part. False when nothing more can be computed. */
static bool run_part(struct snap_study *study, follow *part, const char *name, enum status *status,
                     struct error *error) {
  struct error local = {.status = STATUS_OK};
  enum status one = part(study, &local);
  bool final = snap_is_final(one);
  if (final && *status != STATUS_OK) {
    snap_study_warn(study, "%.250s", error->message);
  }
  if (final || (one != STATUS_OK && *status == STATUS_OK)) {
    *status = error_set(error, one, NULL, "%s: %s", name, local.message);
  } else if (one != STATUS_OK) {
    snap_study_warn(study, "%s: %.200s", name, local.message);
  }
  return !final;
}

enum status snap_study_run(struct snap_study *study, struct error *error) {
  enum status status = STATUS_OK;
  bool on = run_part(study, snap_find_compressed, "the compressed state", &status, error);
  if (on && study->has[SNAP_COMPRESSED]) {
    on = run_part(study, snap_follow_axial, "the path by force", &status, error);
    on = on && run_part(study, snap_follow_pressure, "the path by pressure", &status, error);
  }
  on = on && run_part(study, snap_follow_stairs, "the stairs of the row", &status, error);
  on = on && run_part(study, snap_follow_vacuum, "the path under vacuum", &status, error);
  on = on && run_part(study, snap_follow_stretched, "the stretched branch", &status, error);
  on = on && run_part(study, snap_follow_held, "the held length", &status, error);
  if (on && study->has[SNAP_COMPRESSED] && study->spec->law_count > 0) {
    run_part(study, snap_follow_laws, "the law", &status, error);
  }
  look_at_points(study);
  look_at_ends(study);
  look_at_waves(study);
  count_stable(study);
  return status;
}
