#include "server/plot/study_answer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/study_axis.h"

enum { OBJECTIVES = 3, TEXT = 300, CRITERIA = 8, BLOCKS = 64 };

struct study_answer {
  json_t *answer; /* texts are borrowed from it */
  void *block[BLOCKS];
  size_t blocks;
  char method[TEXT], fixed[TEXT], part[CRITERIA][TEXT];
  const char *part_name[CRITERIA];
  size_t metric[OBJECTIVES];
  bool maximise[OBJECTIVES];
  double reference[OBJECTIVES];
  struct study_pareto pareto;
  struct study_importance importance;
  struct study_effects effects;
  struct study_slice slice;
  struct study_left_out left_out;
  struct study_ranking ranking;
  struct study_history history;
};

/* Zeroed memory that lives as long as the answer; NULL when it ran out. */
static void *room(struct study_answer *read, size_t count, size_t size) {
  void *memory = read->blocks < BLOCKS ? calloc(count > 0 ? count : 1, size) : NULL;
  if (memory) {
    read->block[read->blocks++] = memory;
  }
  return memory;
}

static const json_t *at(const json_t *object, const char *key) {
  return json_object_get(object, key);
}

static double number(const json_t *value) {
  return json_is_number(value) ? json_number_value(value) : NAN;
}

static const char *text(const json_t *value) {
  const char *string = json_string_value(value);
  return string ? string : "";
}

static size_t find(const struct study_column *columns, size_t count, const json_t *view) {
  const char *key = text(at(view, "key"));
  size_t i = 0;
  while (i < count && strcmp(columns[i].key, key) != 0) {
    i++;
  }
  return i;
}

static size_t metric_of(const struct study_table *table, const json_t *view) {
  size_t i = find(table->metric, table->metrics, view);
  return i < table->metrics ? i : 0;
}

/* An array of numbers, or of words of a column as their indices; NULL without memory. */
static double *numbers(struct study_answer *read, const json_t *list,
                       const struct study_column *column) {
  size_t count = json_array_size(list);
  double *values = room(read, count, sizeof *values);
  for (size_t i = 0; values && i < count; i++) {
    const json_t *value = json_array_get(list, i);
    values[i] = number(value);
    for (size_t w = 0; column && json_is_string(value) && w < column->word_count; w++) {
      values[i] = strcmp(column->words[w], text(value)) == 0 ? (double)w : values[i];
    }
  }
  return values;
}

/* "Gaussian process, R² 0.981" */
static const char *set_method(struct study_answer *read) {
  double r2 = number(at(at(read->answer, "surrogate"), "r2"));
  snprintf(read->method, sizeof read->method, isnan(r2) ? "Gaussian process" : "surrogate, R² %.3f",
           r2);
  return read->method;
}

static bool read_pareto(struct study_answer *read, const struct study_table *table) {
  const json_t *objectives = at(read->answer, "objectives"), *designs = at(read->answer, "designs");
  const json_t *design;
  size_t count = json_array_size(objectives), index;
  int *front = room(read, table->members, sizeof *front);
  if (!front) {
    return false;
  }
  for (size_t k = 0; k < count && k < OBJECTIVES; k++) {
    const json_t *one = json_array_get(objectives, k);
    read->metric[k] = metric_of(table, one);
    read->maximise[k] = strcmp(text(at(one, "direction")), "max") == 0;
    read->reference[k] = number(at(one, "reference"));
  }
  /* designs of a layer come in the order of the rows */
  size_t row = 0;
  json_array_foreach(designs, index, design) {
    json_int_t member = json_integer_value(at(design, "member"));
    for (size_t tried = 0; tried < table->members && table->member[row] != member; tried++) {
      row = (row + 1) % table->members;
    }
    if (row < table->members && table->member[row] == member) {
      front[row] = (int)json_integer_value(at(design, "layer"));
    }
  }
  read->pareto =
      (struct study_pareto){.count = count < OBJECTIVES ? count : OBJECTIVES,
                            .metric = read->metric,
                            .maximise = read->maximise,
                            .front = front,
                            .hypervolume = number(at(at(read->answer, "hypervolume"), "value")),
                            .reference = read->reference};
  return true;
}

static struct share share_of(const json_t *view) {
  return (struct share){number(at(view, "value")), number(at(view, "low")),
                        number(at(view, "high"))};
}

static bool read_importance(struct study_answer *read, const struct study_table *table) {
  const json_t *parameters = at(read->answer, "parameters"), *one;
  size_t index;
  struct importance *shares = room(read, table->parameters, sizeof *shares);
  if (!shares) {
    return false;
  }
  json_array_foreach(parameters, index, one) {
    size_t k = find(table->parameter, table->parameters, one);
    if (k < table->parameters) {
      shares[k] = (struct importance){share_of(at(one, "first")), share_of(at(one, "total"))};
    }
  }
  read->importance =
      (struct study_importance){.metric = metric_of(table, at(read->answer, "metric")),
                                .share = shares,
                                .method = set_method(read)};
  return true;
}

/* How far the mean moves over a parameter. */
static double reach_of(const struct study_effect *effect) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < effect->count; i++) {
    low = fmin(low, effect->mean[i]);
    high = fmax(high, effect->mean[i]);
  }
  return high - low;
}

static bool read_effect(struct study_answer *read, const struct study_table *table,
                        const json_t *one, struct study_effect *effect) {
  size_t k = find(table->parameter, table->parameters, one), count = json_array_size(at(one, "at"));
  bool whole = k < table->parameters && json_array_size(at(one, "mean")) == count &&
               json_array_size(at(one, "low")) == count &&
               json_array_size(at(one, "high")) == count;
  *effect = (struct study_effect){.parameter = whole ? k : 0, .count = whole ? count : 0};
  effect->x = numbers(read, at(one, "at"), whole ? &table->parameter[k] : NULL);
  effect->mean = numbers(read, at(one, "mean"), NULL);
  effect->low = numbers(read, at(one, "low"), NULL);
  effect->high = numbers(read, at(one, "high"), NULL);
  return effect->x && effect->mean && effect->low && effect->high;
}

static bool read_effects(struct study_answer *read, const struct study_table *table) {
  enum { MOST = 12 }; /* four blocks each */
  const json_t *list = at(read->answer, "main"), *one;
  struct study_effect *effects = room(read, MOST, sizeof *effects);
  size_t count = 0, index;
  if (!effects) {
    return false;
  }
  json_array_foreach(list, index, one) {
    struct study_effect effect;
    if (count == MOST) {
      break;
    }
    if (!read_effect(read, table, one, &effect)) {
      return false;
    }
    /* the one that moves the metric most comes first */
    size_t place = effect.count > 1 ? count++ : MOST;
    for (; place > 0 && place < MOST && reach_of(&effects[place - 1]) < reach_of(&effect);
         place--) {
      effects[place] = effects[place - 1];
    }
    if (place < MOST) {
      effects[place] = effect;
    }
  }
  read->effects = (struct study_effects){.metric = metric_of(table, at(read->answer, "metric")),
                                         .effect = effects,
                                         .count = count,
                                         .method = set_method(read),
                                         .band = "10 to 90 % over the others"};
  return true;
}

/* "gap 2 mm, shape round" */
static void set_fixed(struct study_answer *read, const struct study_table *table) {
  size_t used = 0;
  for (size_t k = 0; k < table->parameters && used < TEXT - 1; k++) {
    const struct study_column *column = &table->parameter[k];
    const json_t *value = at(at(read->answer, "at"), column->key);
    char words[100] = "";
    if (!value || json_is_null(value)) {
      continue;
    }
    if (json_is_string(value)) {
      snprintf(words, sizeof words, "%.80s", text(value));
    } else {
      const char *space = *column->unit && strcmp(column->unit, "°") != 0 ? " " : "";
      snprintf(words, sizeof words, "%.4g%s%.20s", number(value), space, column->unit);
    }
    int more = snprintf(read->fixed + used, TEXT - used, "%s%.60s %s", used ? ", " : "",
                        column->title, words);
    used += more > 0 ? (size_t)more : 0;
  }
}

/* A grid of numbers, row by row; NULL without memory, or when a row has another length. */
static double *grid(struct study_answer *read, const json_t *rows, size_t columns) {
  size_t count = json_array_size(rows);
  double *values = room(read, count * columns, sizeof *values);
  for (size_t k = 0; values && k < count * columns; k++) {
    values[k] = number(json_array_get(json_array_get(rows, k / columns), k % columns));
  }
  return values;
}

static bool read_slice(struct study_answer *read, const struct study_table *table) {
  const json_t *x = at(read->answer, "x"), *y = at(read->answer, "y");
  struct study_slice *slice = &read->slice;
  size_t k = find(table->parameter, table->parameters, x);
  size_t j = find(table->parameter, table->parameters, y);
  *slice = (struct study_slice){.metric = metric_of(table, at(read->answer, "metric")),
                                .x = k < table->parameters ? k : 0,
                                .y = j < table->parameters ? j : 0,
                                .columns = json_array_size(at(x, "values")),
                                .rows = json_array_size(at(y, "values")),
                                .fixed = read->fixed,
                                .method = set_method(read)};
  slice->x_value = numbers(read, at(x, "values"), &table->parameter[slice->x]);
  slice->y_value = numbers(read, at(y, "values"), &table->parameter[slice->y]);
  slice->mean = grid(read, at(read->answer, "mean"), slice->columns);
  slice->deviation = grid(read, at(read->answer, "deviation"), slice->columns);
  set_fixed(read, table);
  return slice->x_value && slice->y_value && slice->mean && slice->deviation;
}

static bool read_left_out(struct study_answer *read, const struct study_table *table) {
  const json_t *columns = at(read->answer, "left_out");
  const json_t *surrogate = at(read->answer, "surrogate");
  size_t count = json_array_size(at(columns, "known"));
  bool whole = json_array_size(at(columns, "predicted")) == count &&
               json_array_size(at(columns, "deviation")) == count;
  struct study_left_out *left_out = &read->left_out;
  *left_out = (struct study_left_out){.metric = metric_of(table, at(read->answer, "metric")),
                                      .count = whole ? count : 0,
                                      .known = numbers(read, at(columns, "known"), NULL),
                                      .predicted = numbers(read, at(columns, "predicted"), NULL),
                                      .deviation = numbers(read, at(columns, "deviation"), NULL),
                                      .r2 = number(at(surrogate, "r2")),
                                      .within = number(at(surrogate, "within_95"))};
  return left_out->known && left_out->predicted && left_out->deviation;
}

/* "0.5 × bending angle", or "0.5 × (1 − mass)" where less is better. */
static void name_part(struct study_answer *read, const json_t *criterion, size_t k) {
  bool less = strcmp(text(at(criterion, "direction")), "min") == 0;
  snprintf(read->part[k], TEXT, less ? "%.2g × (1 − %.200s)" : "%.2g × %.200s",
           number(at(criterion, "weight")), text(at(criterion, "title")));
  read->part_name[k] = read->part[k];
}

static bool read_ranking(struct study_answer *read, const struct study_table *table) {
  const json_t *criteria = at(read->answer, "criteria"), *designs = at(read->answer, "designs");
  size_t parts = json_array_size(criteria), count = json_array_size(designs);
  (void)table;
  parts = parts < CRITERIA ? parts : CRITERIA;
  const char **names = room(read, count, sizeof *names);
  double *part = room(read, count * parts, sizeof *part);
  if (!names || !part) {
    return false;
  }
  for (size_t k = 0; k < parts; k++) {
    name_part(read, json_array_get(criteria, k), k);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *design = json_array_get(designs, i);
    names[i] = text(at(design, "name"));
    for (size_t k = 0; k < parts; k++) {
      double weight = number(at(json_array_get(criteria, k), "weight"));
      part[i * parts + k] = weight * number(json_array_get(at(design, "parts"), k));
    }
  }
  double ranked = number(at(read->answer, "compared"));
  read->ranking = (struct study_ranking){.count = count,
                                         .parts = parts,
                                         .name = names,
                                         .part = part,
                                         .part_name = read->part_name,
                                         .score = "Score, each part 0 to 1 over the members",
                                         .ranked = ranked > 0 ? (size_t)ranked : 0};
  return true;
}

/* What the values of an optimisation are, from its document's "objective". */
static void set_objective(struct study_answer *read, const struct study_table *table) {
  const json_t *objective = at(read->answer, "objective");
  const json_t *target = at(objective, "target");
  const char *metric = text(at(objective, "minimise"));
  struct study_history *history = &read->history;
  history->target = NAN;
  history->maximise = json_is_string(at(objective, "maximise"));
  metric = history->maximise ? text(at(objective, "maximise")) : metric;
  snprintf(read->method, TEXT, "%s",
           json_object_get(objective, "profile") ? "Distance to the profile, rms (mm)"
           : target                              ? "Deviation from the targets, rms, relative"
                                                 : "Objective");
  for (size_t k = 0; k < table->metrics; k++) {
    if (strcmp(table->metric[k].key, metric) == 0) {
      struct study_axis axis = study_axis_metric(table, k);
      study_axis_label(&axis, read->fixed);
      snprintf(read->method, TEXT, "%s", read->fixed);
    }
  }
  history->label = read->method;
}

/* Of an optimisation that has ended, from its result; the tolerance of its limits is relative. */
static bool read_history(struct study_answer *read, const struct study_table *table) {
  static const double tolerance = 1e-3;
  const json_t *list = at(read->answer, "history"), *one;
  double *value = room(read, table->members, sizeof *value);
  bool *feasible = room(read, table->members, sizeof *feasible);
  size_t index, row = 0;
  if (!value || !feasible) {
    return false;
  }
  set_objective(read, table);
  for (size_t i = 0; i < table->members; i++) {
    value[i] = NAN;
  }
  json_array_foreach(list, index, one) {
    json_int_t member = json_integer_value(at(one, "member"));
    while (row < table->members && table->member[row] < member) {
      row++;
    }
    if (row < table->members && table->member[row] == member) {
      value[row] = number(at(one, "value"));
      feasible[row] = !(number(at(one, "violation")) > tolerance);
    }
  }
  read->history.value = value;
  read->history.feasible = feasible;
  return true;
}

void study_answer_destroy(struct study_answer *read) {
  if (!read) {
    return;
  }
  for (size_t i = 0; i < read->blocks; i++) {
    free(read->block[i]);
  }
  json_decref(read->answer);
  free(read);
}

enum status study_answer_read(const char *plot, json_t *answer, const struct study_table *table,
                              struct study_plot_input *input, struct study_answer **made,
                              struct error *error) {
  const struct {
    const char *plot;
    bool (*read)(struct study_answer *, const struct study_table *);
  } readers[] = {{"pareto", read_pareto},   {"importance", read_importance},
                 {"effects", read_effects}, {"contour", read_slice},
                 {"ranking", read_ranking}, {"surrogate", read_left_out},
                 {"history", read_history}};
  struct study_answer *read = *made = calloc(1, sizeof *read);
  bool fine = read != NULL;
  if (read) {
    read->answer = json_incref(answer);
  }
  for (size_t i = 0; fine && i < sizeof readers / sizeof *readers; i++) {
    fine = strcmp(readers[i].plot, plot) != 0 || readers[i].read(read, table);
  }
  if (!fine) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  input->pareto = strcmp(plot, "pareto") == 0 ? &read->pareto : NULL;
  input->importance = strcmp(plot, "importance") == 0 ? &read->importance : NULL;
  input->effects = strcmp(plot, "effects") == 0 ? &read->effects : NULL;
  input->slice = strcmp(plot, "contour") == 0 ? &read->slice : NULL;
  input->ranking = strcmp(plot, "ranking") == 0 ? &read->ranking : NULL;
  input->history = strcmp(plot, "history") == 0 ? &read->history : NULL;
  input->left_out = strcmp(plot, "surrogate") == 0 ? &read->left_out : NULL;
  return STATUS_OK;
}
