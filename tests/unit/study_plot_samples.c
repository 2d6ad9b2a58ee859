#include "tests/unit/study_plot_samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WALL, GAP, STIFFNESS, SHAPE, CHAMBERS, PARAMETERS };
enum { ANGLE, MASS, FORCE, METRICS };
enum { SIDE = 48, POINTS = 40 };

/* Benchmarks use the samples, too: no checks of a test. */
static void require(bool fine) {
  if (!fine) {
    abort();
  }
}

static void *keep(struct study_sample *sample, size_t size) {
  void *memory = calloc(size > 0 ? size : 1, 1);
  require(memory && sample->memory_count < sizeof sample->memory / sizeof *sample->memory);
  sample->memory[sample->memory_count++] = memory;
  return memory;
}

void study_sample_destroy(struct study_sample *sample) {
  for (size_t i = 0; i < sample->memory_count; i++) {
    free(sample->memory[i]);
  }
  free(sample);
}

static char *words(const char *text) {
  return (char *)(uintptr_t)text;
}

static struct study_column column(const char *key, const char *title, const char *unit) {
  return (struct study_column){
      .key = words(key), .title = words(title), .unit = words(unit), .low = NAN, .high = NAN};
}

static struct study_sample *make(size_t members, size_t parameters, const char *sampling) {
  static char *shapes[] = {"rectangular", "trapezoidal", "round"};
  static const char *const text[PARAMETERS] = {"/actuator/top_wall", "/actuator/gap",
                                               "/material/C1", "/actuator/shape",
                                               "/actuator/chambers"};
  struct study_sample *sample = calloc(1, sizeof *sample);
  require(sample != NULL);
  struct study_table *t = &sample->table;
  *t = (struct study_table){.study_id = 12,
                            .name = words("fingers with a tapered top"),
                            .sampling = words(sampling),
                            .members = members,
                            .wanted = members,
                            .parameters = parameters,
                            .metrics = METRICS};
  t->parameter = keep(sample, PARAMETERS * sizeof *t->parameter);
  t->metric = keep(sample, METRICS * sizeof *t->metric);
  t->parameter[WALL] = column(text[WALL], "top wall", "mm");
  t->parameter[GAP] = column(text[GAP], "gap", "mm");
  t->parameter[STIFFNESS] = column(text[STIFFNESS], "stiffness", "kPa");
  t->parameter[STIFFNESS].logarithmic = true;
  t->parameter[SHAPE] = column(text[SHAPE], "shape", "");
  t->parameter[SHAPE].categorical = true;
  t->parameter[SHAPE].words = shapes;
  t->parameter[SHAPE].word_count = 3;
  t->parameter[CHAMBERS] = column(text[CHAMBERS], "chambers", "");
  t->metric[ANGLE] = column("bending_angle_deg", "Bending angle", "°");
  t->metric[MASS] = column("mass_g", "Mass", "g");
  t->metric[FORCE] = column("tip_force_N", "Tip force", "N");
  t->member = keep(sample, members * sizeof *t->member);
  t->job_id = keep(sample, members * sizeof *t->job_id);
  t->state = keep(sample, members * sizeof *t->state);
  t->reason = keep(sample, members * sizeof *t->reason);
  t->member_name = keep(sample, members * sizeof *t->member_name);
  t->value = keep(sample, members * parameters * sizeof *t->value);
  t->result = keep(sample, members * METRICS * sizeof *t->result);
  sample->input.table = t;
  return sample;
}

/* Metrics of a design; wall, gap in mm, stiffness in kPa. */
static void solve(const double design[PARAMETERS], double metric[METRICS]) {
  double soft = 60 / pow(design[STIFFNESS], 0.45), n = design[CHAMBERS];
  double shape = 1 - 0.12 * design[SHAPE];
  double swell = exp(-pow((design[GAP] - 3.2) / 2.4, 2));
  metric[ANGLE] = 9 * soft * shape * (0.4 + swell) * n / 8 / design[WALL];
  metric[MASS] = 6 + 5.5 * design[WALL] + 1.3 * n - 0.8 * design[GAP];
  metric[FORCE] = 0.35 * design[WALL] * sqrt(design[STIFFNESS]) / (1 + 0.15 * design[GAP]);
}

static void fill_row(struct study_sample *sample, size_t row, const double design[PARAMETERS],
                     int failed) {
  struct study_table *t = &sample->table;
  bool bad = (int)(row * 37 % 100) < failed;
  t->member[row] = (int)row;
  t->job_id[row] = 100 + (int64_t)row;
  t->state[row] = bad ? JOB_STATE_FAILED : JOB_STATE_SUCCEEDED;
  t->reason[row] = words(!bad ? "" : row % 3 ? "step below minimum" : "walls touch at rest");
  t->member_name[row] = words("a member");
  memcpy(&t->value[row * t->parameters], design, t->parameters * sizeof *design);
  solve(design, &t->result[row * METRICS]);
  for (size_t k = 0; bad && k < METRICS; k++) {
    t->result[row * METRICS + k] = NAN;
  }
}

/* The point of a low-discrepancy sequence (Roberts 2018). */
static double spread(size_t row, int dimension) {
  static const double alpha[PARAMETERS] = {0.8566748838545029, 0.733891856627126,
                                           0.6287067210378087, 0.5385972572236101,
                                           0.46140274277638993};
  double value = 0.5 + (double)(row + 1) * alpha[dimension];
  return value - floor(value);
}

static void add_pareto(struct study_sample *sample) {
  static const size_t metrics[2] = {MASS, ANGLE};
  static const bool maximise[2] = {false, true};
  const struct study_table *t = &sample->table;
  struct study_pareto *pareto = keep(sample, sizeof *pareto);
  int *front = keep(sample, t->members * sizeof *front);
  for (size_t a = 0; a < t->members; a++) {
    const double *one = &t->result[a * METRICS];
    front[a] = t->state[a] == JOB_STATE_SUCCEEDED;
    for (size_t b = 0; b < t->members && front[a]; b++) {
      const double *other = &t->result[b * METRICS];
      if (other[MASS] <= one[MASS] && other[ANGLE] >= one[ANGLE] &&
          (other[MASS] < one[MASS] || other[ANGLE] > one[ANGLE])) {
        front[a] = 2;
      }
    }
  }
  *pareto = (struct study_pareto){
      .count = 2, .metric = metrics, .maximise = maximise, .front = front, .hypervolume = 1234.5};
  sample->input.pareto = pareto;
}

static void add_importance(struct study_sample *sample) {
  static const struct importance shares[PARAMETERS] = {{{0.31, 0.27, 0.35}, {0.38, 0.33, 0.43}},
                                                       {{0.12, 0.09, 0.15}, {0.16, 0.13, 0.2}},
                                                       {{0.36, 0.31, 0.41}, {0.45, 0.4, 0.5}},
                                                       {{0.02, -0.01, 0.05}, {0.03, 0.02, 0.05}},
                                                       {{-0.01, -0.03, 0.02}, {0.06, 0.04, 0.08}}};
  struct study_importance *importance = keep(sample, sizeof *importance);
  *importance =
      (struct study_importance){.metric = ANGLE, .share = shares, .method = "surrogate, R² 0.981"};
  sample->input.importance = importance;
}

static void add_effects(struct study_sample *sample) {
  struct study_table *t = &sample->table;
  struct study_effects *effects = keep(sample, sizeof *effects);
  struct study_effect *list = keep(sample, t->parameters * sizeof *list);
  for (size_t k = 0; k < t->parameters; k++) {
    double *numbers = keep(sample, 4 * POINTS * sizeof *numbers);
    size_t count = k == SHAPE ? 3 : POINTS;
    for (size_t i = 0; i < count; i++) {
      double part = (double)i / ((double)count - 1), metric[METRICS];
      double design[PARAMETERS] = {2, 3, 100, 1, 9};
      design[k] = k == SHAPE       ? (double)i
                  : k == STIFFNESS ? pow(10, 1 + 2 * part)
                                   : (double[]){1 + 2 * part, 1 + 5 * part, 0, 0, 4 + 10 * part}[k];
      solve(design, metric);
      numbers[i] = design[k];
      numbers[POINTS + i] = metric[ANGLE];
      numbers[2 * POINTS + i] = 0.6 * metric[ANGLE];
      numbers[3 * POINTS + i] = 1.5 * metric[ANGLE];
    }
    list[k] = (struct study_effect){
        k, count, numbers, numbers + POINTS, numbers + 2 * POINTS, numbers + 3 * POINTS};
  }
  *effects = (struct study_effects){ANGLE, list, t->parameters, "surrogate, R² 0.981",
                                    "10 to 90 % of the designs"};
  sample->input.effects = effects;
}

static void add_slice(struct study_sample *sample) {
  struct study_slice *slice = keep(sample, sizeof *slice);
  double *x = keep(sample, SIDE * sizeof *x), *y = keep(sample, SIDE * sizeof *y);
  double *mean = keep(sample, SIDE * SIDE * sizeof *mean);
  double *deviation = keep(sample, SIDE * SIDE * sizeof *deviation);
  for (size_t k = 0; k < SIDE * SIDE; k++) {
    double u = (double)(k % SIDE) / (SIDE - 1), v = (double)(k / SIDE) / (SIDE - 1);
    double design[PARAMETERS] = {1 + 2 * u, 1 + 5 * v, 100, 1, 9}, metric[METRICS];
    solve(design, metric);
    x[k % SIDE] = design[WALL];
    y[k / SIDE] = design[GAP];
    mean[k] = metric[ANGLE];
    deviation[k] = 1 + 12 * pow(fmax(u, v), 6);
  }
  *slice = (struct study_slice){
      ANGLE,     WALL, GAP,  SIDE,      SIDE,
      x,         y,    mean, deviation, "stiffness 100 kPa, shape round, 9 chambers",
      "R² 0.981"};
  sample->input.slice = slice;
}

static void add_left_out(struct study_sample *sample) {
  const struct study_table *t = &sample->table;
  struct study_left_out *left_out = keep(sample, sizeof *left_out);
  double *numbers = keep(sample, 3 * t->members * sizeof *numbers);
  size_t count = 0;
  for (size_t row = 0; row < t->members; row++) {
    double value = t->result[row * METRICS + ANGLE];
    if (!isnan(value)) {
      double error = 0.08 * (spread(row, 1) + spread(row * 7, 2) - 1);
      numbers[count] = value;
      numbers[t->members + count] = value * (1 + error);
      numbers[2 * t->members + count] = 1 + 0.04 * value;
      count++;
    }
  }
  *left_out = (struct study_left_out){.metric = ANGLE,
                                      .count = count,
                                      .known = numbers,
                                      .predicted = numbers + t->members,
                                      .deviation = numbers + 2 * t->members,
                                      .r2 = 0.981,
                                      .within = 0.94};
  sample->input.left_out = left_out;
}

static void add_ranking(struct study_sample *sample) {
  enum { BEST = 15, PARTS = 3 };
  static const char *const parts[PARTS] = {"0.5 × bending angle", "0.3 × tip force",
                                           "0.2 × (1 − mass)"};
  const struct study_table *t = &sample->table;
  struct study_ranking *ranking = keep(sample, sizeof *ranking);
  const char **names = keep(sample, BEST * sizeof *names);
  double *part = keep(sample, (size_t)BEST * PARTS * sizeof *part);
  size_t count = t->members < BEST ? t->members : BEST;
  for (size_t i = 0; i < count; i++) {
    names[i] = t->member_name[i];
    part[i * PARTS] = 0.48 - 0.017 * (double)i;
    part[i * PARTS + 1] = 0.21 - 0.03 * spread(i, 1);
    part[i * PARTS + 2] = 0.11 + 0.04 * spread(i, 2);
  }
  *ranking = (struct study_ranking){count, PARTS, names, part, parts, "Score", t->members};
  sample->input.ranking = ranking;
}

static void add_shapes(struct study_sample *sample) {
  const struct study_plot_options options = {0};
  const struct study_table *t = &sample->table;
  struct study_cells cells;
  if (study_plot_cells(t, &options, &cells, NULL) != STATUS_OK) {
    return;
  }
  size_t count = cells.columns * cells.rows;
  struct study_shape *shapes = keep(sample, count * sizeof *shapes);
  double *lines = keep(sample, count * 2 * POINTS * sizeof *lines);
  for (size_t k = 0; k < count; k++) {
    size_t row = cells.row[k];
    double angle = row == SIZE_MAX ? NAN : t->result[row * METRICS + ANGLE] * acos(-1) / 180;
    double *line = lines + k * 2 * POINTS;
    for (size_t i = 1; i < POINTS; i++) {
      double turn = angle * (double)i / POINTS;
      line[2 * i] = line[2 * i - 2] + 3 * cos(turn);
      line[2 * i + 1] = line[2 * i - 1] - 3 * sin(turn);
    }
    shapes[k] = (struct study_shape){row, isnan(angle) ? 0 : POINTS, line};
  }
  sample->input.shapes = shapes;
  sample->input.shape_count = count;
}

static void add_all(struct study_sample *sample) {
  add_pareto(sample);
  add_importance(sample);
  add_effects(sample);
  add_slice(sample);
  add_left_out(sample);
  add_ranking(sample);
  add_shapes(sample);
}

struct study_sample *study_sample_spread(size_t members, int failed) {
  struct study_sample *sample = make(members, PARAMETERS, "sobol");
  for (size_t row = 0; row < members; row++) {
    double design[PARAMETERS] = {1 + 2 * spread(row, 0), 1 + 5 * spread(row, 1),
                                 pow(10, 1 + 2 * spread(row, 2)), floor(3 * spread(row, 3)),
                                 floor(4 + 11 * spread(row, 4))};
    fill_row(sample, row, design, failed);
  }
  add_all(sample);
  return sample;
}

struct study_sample *study_sample_grid(size_t columns, size_t rows, int failed) {
  struct study_sample *sample = make(columns * rows, 2, "grid");
  for (size_t row = 0; row < columns * rows; row++) {
    double x = (double)(row % columns) / fmax((double)columns - 1, 1);
    double y = (double)(row / columns) / fmax((double)rows - 1, 1);
    double design[PARAMETERS] = {1 + 2 * x, 1 + 5 * y, 100, 1, 9};
    fill_row(sample, row, design, failed);
  }
  add_all(sample);
  return sample;
}

struct study_sample *study_sample_course(size_t members) {
  struct study_sample *sample = study_sample_spread(members, 7);
  struct study_table *t = &sample->table;
  struct study_history *history = keep(sample, sizeof *history);
  double *value = keep(sample, members * sizeof *value);
  bool *feasible = keep(sample, members * sizeof *feasible);
  for (size_t row = 0; row < members; row++) {
    double left = exp(-(double)(row % 20) / 5);
    value[row] = t->state[row] == JOB_STATE_SUCCEEDED
                     ? 40 - 12 * (1 - left) + 4 * left * spread(row, 0)
                     : NAN;
    feasible[row] = row % 9 != 4;
  }
  t->sampling = words("optimise");
  *history = (struct study_history){
      .label = "Mass (g)", .value = value, .feasible = feasible, .target = NAN};
  sample->input.history = history;
  return sample;
}

void study_sample_rename(struct study_sample *sample, const char *name) {
  struct study_table *t = &sample->table;
  for (size_t k = 0; k < t->parameters; k++) {
    t->parameter[k].title = words(name);
  }
  for (size_t k = 0; k < t->metrics; k++) {
    t->metric[k].title = words(name);
  }
  for (size_t row = 0; row < t->members; row++) {
    t->member_name[row] = words(name);
  }
  t->name = words(name);
}
