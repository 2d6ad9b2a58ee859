#include "solver/grasp/guess.h"

#include <math.h>

static const double farthest = 2;

enum status guess_create(const struct fe_model *m, struct guess *guess) {
  guess->step = 0;
  return state_create(m, &guess->before);
}

void guess_release(struct guess *guess) {
  state_release(&guess->before);
}

void guess_note(const struct fe_model *m, struct guess *guess, const struct fe_state *state,
                double step) {
  state_copy(m, &guess->before, state);
  guess->step = step;
}

static void carry_on(double *now, const double *before, int count, double ratio) {
  for (int i = 0; i < count; i++) {
    now[i] += ratio * (now[i] - before[i]);
  }
}

void guess_apply(const struct fe_model *m, const struct guess *guess, double step,
                 struct fe_state *state) {
  if (guess->step > 0) {
    double ratio = fmin(step / guess->step, farthest);
    carry_on(state->u, guess->before.u, 3 * m->mesh->node_count, ratio);
    carry_on(state->p, guess->before.p, ELEMENT_PRESSURES * m->mesh->element_count, ratio);
  }
}
