/* The second variation of recorded states in circumferential harmonics. */
#include <stdlib.h>

#include "solver/base/clock.h"
#include "solver/snap/study.h"

static struct snap_waves *append(struct snap_study *study) {
  if (study->waves_count == study->waves_capacity) {
    int capacity = study->waves_capacity > 0 ? 2 * study->waves_capacity : 32;
    struct snap_waves *grown = realloc(study->waves, sizeof *grown * (size_t)capacity);
    if (!grown) {
      return NULL;
    }
    study->waves = grown;
    study->waves_capacity = capacity;
  }
  struct snap_waves *waves = &study->waves[study->waves_count];
  *waves = (struct snap_waves){
      .negative = calloc((size_t)study->spec->harmonics_to + 1, sizeof *waves->negative)};
  study->waves_count += waves->negative != NULL;
  return waves->negative ? waves : NULL;
}

/* Number of waves of the first harmonic that lowers the energy; 0 where none does. */
static int first_unstable(const struct snap_study *study, const int *negative) {
  for (int n = 1; n <= study->spec->harmonics_to; n++) {
    if (negative[n] > 0) {
      return n;
    }
  }
  return 0;
}

/* Between harmonics, which take their time. */
static enum status interrupted(const struct snap_study *study, struct error *error) {
  if (study->cancelled && study->cancelled(NULL)) {
    return error_set(error, STATUS_CANCELLED, NULL, "the work was cancelled");
  }
  if (study->deadline_s > 0.0 && clock_wall_s() > study->deadline_s) {
    return error_set(error, STATUS_TIMEOUT, NULL, "the time limit was reached");
  }
  return STATUS_OK;
}

static enum status count_negative(struct snap_study *study, const struct axi_state *state,
                                  int *negative, struct error *error) {
  enum { AT_ONCE = 8 };
  int last = study->spec->harmonics_to;
  enum status status = STATUS_OK;
  for (int n = 0; status == STATUS_OK && n <= last; n += AT_ONCE) {
    int to = n + AT_ONCE <= last ? n + AT_ONCE - 1 : last;
    status = interrupted(study, error);
    if (status == STATUS_OK) {
      status = study->body.harmonics(study->body.self, state, n, to, negative + n, error);
    }
  }
  return status;
}

enum status snap_test_waves(struct snap_study *study, const char *path,
                            const struct axi_state *state, struct error *error) {
  struct snap_waves *waves = append(study);
  if (!waves) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for harmonics");
  }
  waves->path = path;
  waves->pressure = state->pressure;
  waves->elongation = state->elongation;
  waves->inverted = study->body.inverted(study->body.self, state->u);
  enum status status = count_negative(study, state, waves->negative, error);
  if (status != STATUS_OK) {
    free(waves->negative);
    study->waves_count--;
    return status == STATUS_INVERTED ? STATUS_OK : status;
  }
  int index = study->waves_count - 1;
  bool follows = index > 0 && study->waves[index - 1].path == path;
  int now = first_unstable(study, waves->negative);
  int before = follows ? first_unstable(study, study->waves[index - 1].negative) : 0;
  if (now > 0 && before == 0) {
    snap_study_event(study, SNAP_LOSS_OF_AXISYMMETRY, path, state, now);
  }
  return STATUS_OK;
}
