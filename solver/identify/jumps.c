#include "solver/identify/jumps.h"

#include <math.h>
#include <string.h>

enum { LAST_ROWS = 4 };

/* What the switches by one guard add up to. */
struct gathered {
  double inner, outer; /* bounds of the level, as if the guard were passed upwards */
  double weight[HLPV_STATES], sum[HLPV_STATES], square[HLPV_STATES];
};

/* The last elongation before a switch, and the one that the motion would have reached in the next
 * row: by the model where it tells the step, otherwise by a line through the last rows. */
static void last_motion(const struct identification *id, const struct outcome *outcome,
                        size_t index, size_t next, double *h, double *ahead) {
  const struct step *step = &id->steps->step[index];
  const struct trial *trial = &id->trials->trial[step->trial];
  size_t end = step->first + step->count, rows = step->count < LAST_ROWS ? step->count : LAST_ROWS;
  const double *simulated = outcome->simulated + 2 * outcome->first[step->trial];
  double n = (double)rows, mt = 0.0, mh = 0.0, tt = 0.0, th = 0.0;
  bool told = outcome->has_start[index] && step->count >= LAST_ROWS;
  for (size_t i = end - rows; i < end; i++) {
    mt += trial->time[i] / n;
    mh += (told ? simulated[2 * i] : trial->h[i]) / n;
  }
  for (size_t i = end - rows; i < end; i++) {
    double off = trial->time[i] - mt;
    tt += off * off;
    th += off * ((told ? simulated[2 * i] : trial->h[i]) - mh);
  }
  double slope = tt > 0.0 ? th / tt : 0.0;
  *h = told ? simulated[2 * (end - 1)] : mh + slope * (trial->time[end - 1] - mt);
  *ahead = *h + slope * (trial->time[next] - trial->time[end - 1]);
}

static struct jump *find_jump(struct outcome *outcome, int from, int to) {
  for (int i = 0; i < outcome->jump_count; i++) {
    if (outcome->jump[i].from == from && outcome->jump[i].to == to) {
      return &outcome->jump[i];
    }
  }
  if (outcome->jump_count == HLPV_TRANSITIONS_MAX) {
    return NULL;
  }
  struct jump *jump = &outcome->jump[outcome->jump_count++];
  *jump = (struct jump){.from = from, .to = to, .direction = to > from ? 1 : -1};
  return jump;
}

/* Narrows the bounds, which noise widens by two standard errors of what the step is told by. */
static void add_level(const struct identification *id, const struct outcome *outcome, size_t index,
                      size_t next, const struct jump *jump, struct gathered *g) {
  const struct step *step = &id->steps->step[index];
  double h, ahead, side = jump->direction;
  double margin = 2.0 * id->sigma[2 * step->trial] / sqrt((double)step->count);
  last_motion(id, outcome, index, next, &h, &ahead);
  g->inner = fmax(g->inner, side * h - margin);
  g->outer = fmin(g->outer, fmax(side * ahead, side * h) + margin);
}

/* Takes a state and its covariance back by a time, along the tangent: x - time f(x), f being
 * affine. */
static void take_back(const struct hlpv_spec *model, double set_point, double time,
                      const double *covariance, double x[HLPV_STATES], double rate[HLPV_STATES],
                      double variance[HLPV_STATES]) {
  double m[HLPV_STATES][HLPV_STATES];
  hlpv_derivative(model, 0, set_point, x, rate);
  for (int k = 0; k < HLPV_STATES; k++) {
    double moved[HLPV_STATES], moved_rate[HLPV_STATES];
    memcpy(moved, x, sizeof moved);
    moved[k] += 1.0;
    hlpv_derivative(model, 0, set_point, moved, moved_rate);
    for (int i = 0; i < HLPV_STATES; i++) {
      m[i][k] = (i == k) - time * (moved_rate[i] - rate[i]);
    }
  }
  for (int i = 0; i < HLPV_STATES; i++) {
    variance[i] = 0.0;
    for (int k = 0; k < HLPV_STATES; k++) {
      for (int j = 0; j < HLPV_STATES; j++) {
        variance[i] += m[i][k] * covariance[k * HLPV_STATES + j] * m[i][j];
      }
    }
    x[i] -= time * rate[i];
  }
}

/* The state at the first row after a switch, half an interval earlier. */
static void add_reset(const struct identification *id, const struct outcome *outcome,
                      const struct trial *trial, size_t index, double interval,
                      struct gathered *g) {
  const struct step *after = &id->steps->step[index];
  const struct point_start *start = &outcome->start[index];
  const double *sigma = id->sigma + 2 * after->trial;
  struct hlpv_spec model = {.mass = id->mass.value, .gamma = id->gamma.value, .mode_count = 1};
  model.mode[0] = outcome->mode[after->mode];
  double rate[HLPV_STATES] = {0.0, 0.0, 0.0};
  double x[HLPV_STATES] = {trial->h[after->first], 0.0, trial->pressure[after->first]};
  double variance[HLPV_STATES] = {sigma[0] * sigma[0], INFINITY, sigma[1] * sigma[1]};
  if (outcome->has_start[index]) {
    memcpy(x, start->x, sizeof x);
    take_back(&model, after->set_point, 0.5 * interval, start->covariance, x, rate, variance);
  }
  for (int k = 0; k < HLPV_STATES; k++) {
    double way = interval * rate[k];
    double weight = 1.0 / (variance[k] + way * way / 12.0 + 1e-30);
    g->weight[k] += weight;
    g->sum[k] += weight * x[k];
    g->square[k] += weight * x[k] * x[k];
  }
}

/* Means of the resets; scatter beyond what each error allows widens them. */
static void finish(struct jump *jump, struct gathered *g) {
  jump->low = jump->direction > 0 ? fmin(g->inner, g->outer) : -fmax(g->inner, g->outer);
  jump->high = jump->direction > 0 ? fmax(g->inner, g->outer) : -fmin(g->inner, g->outer);
  jump->level = 0.5 * (jump->low + jump->high);
  for (int k = 0; k < HLPV_STATES; k++) {
    double mean = g->weight[k] > 0.0 ? g->sum[k] / g->weight[k] : 0.0;
    double scatter = g->square[k] - g->weight[k] * mean * mean;
    double factor = jump->count > 1 ? fmax(1.0, scatter / (jump->count - 1)) : 1.0;
    jump->reset[k] = mean;
    jump->reset_stderror[k] = g->weight[k] > 0.0 ? sqrt(factor / g->weight[k]) : INFINITY;
  }
}

void jumps_fill(const struct identification *id, struct outcome *outcome) {
  struct gathered gathered[HLPV_TRANSITIONS_MAX];
  for (int i = 0; i < HLPV_TRANSITIONS_MAX; i++) {
    gathered[i] = (struct gathered){.inner = -INFINITY, .outer = INFINITY};
  }
  for (size_t i = 0; i + 1 < id->steps->count; i++) {
    const struct step *before = &id->steps->step[i], *after = before + 1;
    const struct trial *trial = &id->trials->trial[before->trial];
    if (before->trial != after->trial || before->mode == after->mode || trial->held_out) {
      continue;
    }
    struct jump *jump = find_jump(outcome, before->mode, after->mode);
    if (jump) {
      struct gathered *g = &gathered[jump - outcome->jump];
      size_t end = before->first + before->count;
      add_level(id, outcome, i, end, jump, g);
      add_reset(id, outcome, trial, i + 1, trial->time[end] - trial->time[end - 1], g);
      jump->count++;
    }
  }
  for (int i = 0; i < outcome->jump_count; i++) {
    finish(&outcome->jump[i], &gathered[i]);
  }
}
