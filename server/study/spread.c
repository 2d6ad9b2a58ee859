#include "server/study/spread.h"

#include <stdlib.h>

#include "solver/explore/random.h"
#include "solver/explore/sequence.h"

enum { COUNT_MIN = 1 << 8, COUNT_MAX = 1 << 12 };

static const double effort = 4e7; /* evaluations times points of the surrogate */

void spread_clear(struct spread *spread) {
  free(spread->room);
  spread->room = NULL;
}

static double value_at(const struct model *model, const double *u) {
  double design[SURROGATE_PARAMETERS_MAX], value;
  space_design(&model->space, u, design);
  model_predict(model, design, &value, NULL);
  return value;
}

static void evaluate(const struct model *model, struct spread *spread, int at, double *u,
                     double *v) {
  spread->a[at] = value_at(model, u);
  spread->b[at] = value_at(model, v);
  for (size_t k = 0; k < spread->parameters; k++) {
    double first = u[k], second = v[k];
    u[k] = second;
    spread->mixed[k][at] = value_at(model, u);
    u[k] = first;
    if (spread->back[k]) {
      v[k] = first;
      spread->back[k][at] = value_at(model, v);
      v[k] = second;
    }
  }
}

static bool make_room(struct spread *spread, bool back) {
  size_t n = (size_t)spread->count, sets = 2 + (back ? 2 : 1) * spread->parameters;
  spread->room = malloc(n * sets * sizeof *spread->room);
  if (!spread->room) {
    return false;
  }
  spread->a = spread->room;
  spread->b = spread->a + n;
  for (size_t k = 0; k < spread->parameters; k++) {
    spread->mixed[k] = spread->b + n * (1 + k);
    spread->back[k] = back ? spread->b + n * (1 + spread->parameters + k) : NULL;
  }
  return true;
}

enum status spread_make(const struct model *model, bool back, struct spread *spread,
                        struct error *error) {
  size_t parameters = model->space.parameters;
  double u[2 * SURROGATE_PARAMETERS_MAX];
  double each = (double)((back ? 2 : 1) * parameters + 2) * (double)model->points;
  struct sequence *sequence = NULL;
  uint64_t random = 1;
  *spread = (struct spread){.count = COUNT_MAX, .parameters = parameters};
  while (spread->count > COUNT_MIN && spread->count * each > effort) {
    spread->count /= 2;
  }
  if (!make_room(spread, back)) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the analysis of a study.");
  }
  if (2 * parameters <= SEQUENCE_DIMENSIONS_MAX) {
    enum status status =
        sequence_create(SEQUENCE_SOBOL, 2 * (int)parameters, true, 1, &sequence, error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  for (int i = 0; i < spread->count; i++) {
    if (sequence) {
      sequence_next(sequence, u);
    }
    for (size_t k = 0; k < 2 * parameters && !sequence; k++) {
      u[k] = random_uniform(&random);
    }
    evaluate(model, spread, i, u, u + parameters);
  }
  sequence_destroy(sequence);
  return STATUS_OK;
}
