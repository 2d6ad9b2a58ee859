/* The second variation of recorded states in circumferential harmonics. */
#include <stdlib.h>

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

enum status snap_test_waves(struct snap_study *study, const char *path,
                            const struct axi_state *state, struct error *error) {
  struct snap_waves *waves = append(study);
  if (!waves) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for harmonics");
  }
  waves->path = path;
  waves->pressure = state->pressure;
  waves->elongation = state->elongation;
  enum status status = study->body.harmonics(study->body.self, state, study->spec->harmonics_to,
                                             waves->negative, error);
  if (status == STATUS_INVERTED) {
    free(waves->negative);
    study->waves_count--;
    return STATUS_OK;
  }
  int index = study->waves_count - 1;
  bool follows = index > 0 && study->waves[index - 1].path == path;
  int now = first_unstable(study, waves->negative);
  int before = follows ? first_unstable(study, study->waves[index - 1].negative) : 0;
  if (status == STATUS_OK && now > 0 && before == 0) {
    snap_study_event(study, SNAP_LOSS_OF_AXISYMMETRY, path, state, now);
  }
  return status;
}
