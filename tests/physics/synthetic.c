#include "tests/physics/synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/physics/hybrid_exact.h"

#define PSI 6894.757293168361

/* Where a run stands: it was in the state x at `start` and has moved freely since. */
struct motion {
  const struct hlpv_spec *model;
  struct synthetic_trial *trial;
  int mode;
  double start, set_point, x[HLPV_STATES];
};

static void state_at(const struct motion *m, double time, double x[HLPV_STATES]) {
  struct exact_input input = {.u = m->set_point};
  if (time > m->start) {
    exact_state(m->model, m->mode, &input, m->x, time - m->start, x);
  } else {
    memcpy(x, m->x, sizeof m->x);
  }
}

/* Goes to a time, through the switches until then. */
static void go_to(struct motion *m, double time) {
  for (int i = 0; i < m->model->transition_count; i++) {
    const struct hlpv_transition *t = &m->model->transition[i];
    struct exact_input input = {.u = m->set_point};
    if (t->from != m->mode || !(time > m->start)) {
      continue;
    }
    double passage = exact_passage(m->model, t, &input, m->x, time - m->start, 1e-3);
    if (isfinite(passage)) {
      double x[HLPV_STATES];
      state_at(m, m->start + passage, x);
      for (int k = 0; k < HLPV_STATES; k++) {
        m->x[k] = t->reset[k].factor * x[k] + t->reset[k].value;
      }
      m->start += passage;
      m->mode = t->to;
      i = -1;
    }
  }
}

static void add_row(struct motion *m, double time) {
  struct synthetic_trial *trial = m->trial;
  double x[HLPV_STATES];
  if (trial->count == trial->room) {
    trial->room = trial->room ? 2 * trial->room : 256;
    double **column[] = {&trial->time, &trial->set_point, &trial->h, &trial->pressure};
    for (int i = 0; i < 4; i++) {
      *column[i] = realloc(*column[i], trial->room * sizeof **column[i]);
      if (!*column[i]) {
        abort();
      }
    }
  }
  state_at(m, time, x);
  trial->time[trial->count] = time;
  trial->set_point[trial->count] = m->set_point;
  trial->h[trial->count] = x[HLPV_H];
  trial->pressure[trial->count++] = x[HLPV_PRESSURE];
}

/* Samples from `from` to `to`, the step at `from` included. Guards are looked for from sample to
 * sample. */
static void hold(struct motion *m, double set_point, double from, double to, double fast_to,
                 const struct synthetic_plan *plan) {
  double x[HLPV_STATES], time = from;
  state_at(m, from, x);
  memcpy(m->x, x, sizeof x);
  m->start = from;
  m->set_point = set_point;
  while (time < to - 1e-9) {
    if (time > m->start) {
      /* From a state that is not sampled, as after a switch, motions start exactly. */
      go_to(m, time);
    }
    add_row(m, time);
    state_at(m, time, x);
    memcpy(m->x, x, sizeof x);
    m->start = time;
    time += 1.0 / (plan->fast_time == 0.0 || time < fast_to - 1e-9 ? plan->fast : plan->slow);
  }
  go_to(m, to);
}

void synthetic_make(const struct hlpv_spec *model, const struct synthetic_run *run,
                    const struct synthetic_plan *plan, struct synthetic_trial *trial) {
  *trial = (struct synthetic_trial){.count = 0};
  struct motion m = {.model = model, .trial = trial, .mode = run->mode, .start = -plan->before};
  m.x[HLPV_H] = model->mode[run->mode].rest;
  hold(&m, 0.0, -plan->before, 0.0, 0.0, plan);
  hold(&m, run->up, 0.0, plan->hold, plan->fast_time, plan);
  hold(&m, run->down, plan->hold, 2.0 * plan->hold, plan->hold + plan->fast_time, plan);
}

void synthetic_release(struct synthetic_trial *trial) {
  free(trial->time);
  free(trial->set_point);
  free(trial->h);
  free(trial->pressure);
  *trial = (struct synthetic_trial){.count = 0};
}

size_t synthetic_protocol(int repeats, struct synthetic_run run[SYNTHETIC_RUNS_MAX]) {
  static const int steps[2] = {4, 8};
  size_t count = 0;
  for (int mode = 0; mode < 2; mode++) {
    for (int step = 1; step <= steps[mode]; step++) {
      for (int i = 0; i < repeats && count < SYNTHETIC_RUNS_MAX; i++) {
        run[count++] = (struct synthetic_run){mode, step * PSI, 0.0};
      }
    }
  }
  return count;
}

double synthetic_range(const double *value, size_t count) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    low = fmin(low, value[i]);
    high = fmax(high, value[i]);
  }
  return high - low;
}
