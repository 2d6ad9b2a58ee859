#include "solver/job/steps.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/numbers.h"
#include "solver/base/text.h"

/* Everything on the way from the trials to the steps. */
struct parting {
  const struct identify_spec *spec;
  const struct trials *trials;
  struct steps *steps;
  size_t room;
  double *set_point; /* all there are, rising */
  size_t set_point_count;
  struct error *error;
};

static const double same_set_point = 1e-3; /* of the largest */
static const double moving = 0.05;         /* of the range over all trials */

static enum status no_memory(const struct parting *p) {
  return error_set(p->error, STATUS_NO_MEMORY, NULL, "no memory for the steps");
}

/* ---- ranges, modes and set-points --------------------------------------------------------- */

/* A column of all trials, sorted, owned by the caller. */
static double *sorted_column(const struct trials *trials, size_t offset, size_t *count) {
  *count = 0;
  for (size_t i = 0; i < trials->count; i++) {
    *count += trials->trial[i].count;
  }
  double *value = malloc(*count * sizeof *value);
  for (size_t i = 0, n = 0; value && i < trials->count; i++) {
    const struct trial *trial = &trials->trial[i];
    const double *column = *(const double *const *)((const char *)trial + offset);
    memcpy(value + n, column, trial->count * sizeof *value);
    n += trial->count;
  }
  if (value) {
    qsort(value, *count, sizeof *value, numbers_compare);
  }
  return value;
}

/* The middles of the widest empty stretches between sorted elongations, rising. */
static enum status find_levels(struct parting *p, const double *h, size_t count) {
  int wanted = p->spec->mode_count - 1;
  double width[HLPV_MODES_MAX] = {0};
  double *level = p->steps->level;
  for (size_t i = 1; i < count; i++) {
    double gap = h[i] - h[i - 1];
    int place = wanted;
    while (place > 0 && gap > width[place - 1]) {
      place--;
    }
    for (int k = wanted - 1; k > place; k--) {
      width[k] = width[k - 1];
      level[k] = level[k - 1];
    }
    if (place < wanted) {
      width[place] = gap;
      level[place] = 0.5 * (h[i] + h[i - 1]);
    }
  }
  qsort(level, (size_t)wanted, sizeof *level, numbers_compare);
  if (wanted > 0 && !(width[wanted - 1] > moving * p->steps->range[0])) {
    return error_set(
        p->error, STATUS_INVALID, "/modes",
        "no jump of the elongation parts the %d modes: the widest empty stretches are down to %.3g "
        "mm\n\"levels\" between the modes, for example [\"21 mm\"], or one mode",
        p->spec->mode_count, 1e3 * width[wanted - 1]);
  }
  return STATUS_OK;
}

static enum status find_modes(struct parting *p) {
  size_t count;
  double *h = sorted_column(p->trials, offsetof(struct trial, h), &count);
  if (!h) {
    return no_memory(p);
  }
  p->steps->range[0] = h[count - 1] - h[0];
  enum status status = STATUS_OK;
  if (p->spec->level_count > 0) {
    memcpy(p->steps->level, p->spec->level, sizeof p->spec->level);
  } else {
    status = find_levels(p, h, count);
  }
  free(h);
  return status;
}

static enum status find_set_points(struct parting *p) {
  size_t count;
  double *pressure = sorted_column(p->trials, offsetof(struct trial, pressure), &count);
  p->steps->range[1] = pressure ? pressure[count - 1] - pressure[0] : 0.0;
  p->set_point =
      pressure ? sorted_column(p->trials, offsetof(struct trial, set_point), &count) : NULL;
  free(pressure);
  if (!p->set_point) {
    return no_memory(p);
  }
  double *u = p->set_point, same = same_set_point * fmax(fabs(u[0]), fabs(u[count - 1]));
  for (size_t i = 0; i < count; i++) {
    if (p->set_point_count == 0 || u[i] - u[p->set_point_count - 1] > same) {
      u[p->set_point_count++] = u[i];
    }
  }
  return STATUS_OK;
}

/* The place of a set-point among all. */
static size_t place_of(const struct parting *p, double u) {
  size_t low = 0, high = p->set_point_count;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(p->set_point[middle] <= u ? &low : &high) = middle;
  }
  return low;
}

static int mode_of(const struct parting *p, double h) {
  int mode = 0;
  while (mode + 1 < p->spec->mode_count && h > p->steps->level[mode]) {
    mode++;
  }
  return mode;
}

/* ---- one step ----------------------------------------------------------------------------- */

static double mean(const double *value, size_t from, size_t to) {
  double sum = 0.0;
  for (size_t i = from; i < to; i++) {
    sum += value[i];
  }
  return sum / (double)(to - from);
}

static bool column_moves(const double *value, size_t count, double range) {
  size_t few = count > 8 ? 2 : 1;
  double end = mean(value, count - count / 4 - 1, count);
  double begin = mean(value, 0, few), middle = mean(value, count / 2, count / 2 + few);
  return fmax(fabs(begin - end), fabs(middle - end)) > moving * range;
}

/* Whether the last fifth of a column is level: its halves have the same mean but for the noise. */
static bool is_level(const double *value, size_t from, size_t count, double range) {
  size_t half = (from + count) / 2;
  double a = mean(value, from, half), b = mean(value, half, count), square = 0.0;
  for (size_t i = from; i < count; i++) {
    double off = value[i] - (i < half ? a : b);
    square += off * off;
  }
  double n = (double)(count - from), noise = sqrt(square / (n - 2.0));
  return fabs(a - b) < 1e-4 * range + 2.0 * noise * sqrt(4.0 / n);
}

/* Time after which a column stays within 37 % of its way to its end. */
static double way_time(const double *time, const double *value, size_t count) {
  double end = mean(value, count - count / 5 - 1, count);
  double way = 0.37 * fabs(value[0] - end);
  size_t i = count;
  while (i > 0 && fabs(value[i - 1] - end) < way) {
    i--;
  }
  return i < count ? time[i] - time[0] : INFINITY;
}

/* Whether the state was at rest at the end of a step: moved long ago, or never, and level since. */
static bool ends_settled(const struct parting *p, const struct step *step, size_t from) {
  const struct trial *trial = &p->trials->trial[step->trial];
  const double *time = trial->time + step->first, *h = trial->h + step->first;
  const double *pressure = trial->pressure + step->first;
  double quiet = step->moves ? 7.0 * way_time(time, pressure, step->count) : 0.0;
  return step->count - from >= STEP_ROWS_MIN && time[from] - time[0] >= quiet &&
         is_level(h, from, step->count, p->steps->range[0]) &&
         is_level(pressure, from, step->count, p->steps->range[1]);
}

/* Takes the state before a step from the step before it in the same trial and mode. */
static void look_back(const struct parting *p, struct step *step, const struct step *before) {
  if (before->trial != step->trial || before->mode != step->mode || step->after_switch ||
      p->spec->free_start) {
    return;
  }
  size_t from = before->moves ? before->count - before->count / 5 : 0;
  const struct trial *trial = &p->trials->trial[before->trial];
  if (ends_settled(p, before, from)) {
    step->settled = true;
    step->before_count = before->count - from;
    step->before[0] = mean(trial->h + before->first, from, before->count);
    step->before[1] = mean(trial->pressure + before->first, from, before->count);
  }
}

static enum status add_step(struct parting *p, const struct step *step) {
  struct steps *steps = p->steps;
  const struct trial *trial = &p->trials->trial[step->trial];
  if (steps->count == p->room) {
    p->room = p->room ? 2 * p->room : 128;
    struct step *grown = realloc(steps->step, p->room * sizeof *grown);
    if (!grown) {
      return no_memory(p);
    }
    steps->step = grown;
  }
  struct step *added = &steps->step[steps->count++];
  *added = *step;
  added->moves = column_moves(trial->h + step->first, step->count, steps->range[0]) ||
                 column_moves(trial->pressure + step->first, step->count, steps->range[1]);
  if (steps->count > 1) {
    look_back(p, added, added - 1);
  }
  return STATUS_OK;
}

/* ---- one trial ---------------------------------------------------------------------------- */

static enum status refuse_ramp(const struct parting *p, const struct trial *trial, size_t row) {
  return error_set(
      p->error, STATUS_INVALID, trial->pointer,
      "line %d of the table: the set-point is not held: it changes again, to %.6g kPa, less than "
      "%d rows after its last change\nsteps with a set-point that stays the same to a thousandth",
      trial->line[row], 1e-3 * trial->set_point[row], STEP_ROWS_MIN);
}

/* Parts rows [first, last) of one set-point by their modes. A mode lasts at least as long as a
 * switch takes; the rows of the switch itself are left out. */
static enum status part_modes(struct parting *p, size_t index, size_t first, size_t last) {
  const struct trial *trial = &p->trials->trial[index];
  bool switched = first > 0 && mode_of(p, trial->h[first]) != mode_of(p, trial->h[first - 1]);
  enum status status = STATUS_OK;
  while (first < last && status == STATUS_OK) {
    size_t to = first + 1;
    int mode = mode_of(p, trial->h[first]);
    while (to < last && mode_of(p, trial->h[to]) == mode) {
      to++;
    }
    bool ends = to < trial->count && mode_of(p, trial->h[to]) != mode;
    struct step step = {.trial = index,
                        .first = first,
                        .count = to - first,
                        .mode = mode,
                        .point = -1,
                        .set_point = p->set_point[place_of(p, trial->set_point[first])],
                        .after_switch = switched,
                        .before_switch = ends};
    status = add_step(p, &step);
    for (first = to;
         first < last && ends && trial->time[first] - trial->time[to] < p->spec->transit; first++) {
    }
    switched = ends;
  }
  return status;
}

static enum status part_trial(struct parting *p, size_t index) {
  const struct trial *trial = &p->trials->trial[index];
  size_t first = 0, before = p->steps->count;
  enum status status = STATUS_OK;
  for (size_t i = 1; i <= trial->count && status == STATUS_OK; i++) {
    if (i < trial->count &&
        place_of(p, trial->set_point[i]) == place_of(p, trial->set_point[first])) {
      continue;
    }
    if (i < trial->count && first > 0 && i - first < STEP_ROWS_MIN) {
      return refuse_ramp(p, trial, i);
    }
    status = part_modes(p, index, first, i);
    first = i;
  }
  bool moves = false;
  for (size_t i = before; i < p->steps->count; i++) {
    moves = moves || p->steps->step[i].moves || p->steps->step[i].after_switch;
  }
  if (status == STATUS_OK && !moves) {
    char name[60];
    status =
        error_set(p->error, STATUS_INVALID, trial->pointer,
                  "line %d of the table: nothing moves in the trial %s that begins here\na trial "
                  "has a step of the set-point",
                  trial->line[0], text_quote(name, sizeof name, trial->name));
  }
  return status;
}

/* ---- points ------------------------------------------------------------------------------- */

/* Whether a step can count: long enough, and not just the way to a switch. */
static bool is_usable(const struct step *step) {
  return step->count >= STEP_ROWS_USED && !step->before_switch;
}

static enum status add_point(struct parting *p, int mode, double set_point) {
  struct steps *steps = p->steps;
  size_t count = steps->point_count;
  bool found = false;
  for (size_t i = 0; i < steps->count; i++) {
    const struct step *step = &steps->step[i];
    found = found || (step->mode == mode && step->set_point == set_point && is_usable(step) &&
                      step->moves && !p->trials->trial[step->trial].held_out);
  }
  if (!found) {
    return STATUS_OK;
  }
  if (count == STEP_POINTS_MAX) {
    return error_set(
        p->error, STATUS_TOO_LARGE, "/columns/set_point",
        "there are steps to more than %d set-points\nat most %d; is the column another one?",
        STEP_POINTS_MAX, STEP_POINTS_MAX);
  }
  struct step_point *grown = realloc(steps->point, (count + 1) * sizeof *grown);
  if (!grown) {
    return no_memory(p);
  }
  steps->point = grown;
  steps->point[count] = (struct step_point){mode, set_point};
  steps->point_count++;
  for (size_t i = 0; i < steps->count; i++) {
    struct step *step = &steps->step[i];
    if (step->mode == mode && step->set_point == set_point && is_usable(step)) {
      step->point = (int)count;
    }
  }
  return STATUS_OK;
}

static enum status find_points(struct parting *p) {
  for (int mode = 0; mode < p->spec->mode_count; mode++) {
    size_t before = p->steps->point_count;
    for (size_t i = 0; i < p->set_point_count; i++) {
      enum status status = add_point(p, mode, p->set_point[i]);
      if (status != STATUS_OK) {
        return status;
      }
    }
    if (p->steps->point_count == before) {
      char name[60], pointer[40];
      snprintf(pointer, sizeof pointer, "/modes/%d", mode);
      return error_set(p->error, STATUS_INVALID, pointer,
                       "the mode %s has no step of its own\none with %d rows or more in which "
                       "something moves, and that does not end with a switch",
                       text_quote(name, sizeof name, p->spec->mode[mode].name), STEP_ROWS_USED);
    }
  }
  return STATUS_OK;
}

enum status steps_part(const struct identify_spec *spec, const struct trials *trials,
                       struct steps *steps, struct error *error) {
  struct parting p = {.spec = spec, .trials = trials, .steps = steps, .error = error};
  *steps = (struct steps){.count = 0};
  enum status status = find_modes(&p);
  if (status == STATUS_OK) {
    status = find_set_points(&p);
  }
  for (size_t i = 0; i < trials->count && status == STATUS_OK; i++) {
    status = part_trial(&p, i);
  }
  if (status == STATUS_OK) {
    status = find_points(&p);
  }
  free(p.set_point);
  if (status != STATUS_OK) {
    steps_release(steps);
  }
  return status;
}

void steps_release(struct steps *steps) {
  free(steps->step);
  free(steps->point);
  *steps = (struct steps){.count = 0};
}
