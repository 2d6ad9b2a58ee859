#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

#include "server/study/analysis.h"
#include "server/study/spread.h"
#include "solver/explore/importance.h"
#include "solver/explore/sequence.h"

enum { LEVELS = 17, AROUND = 256, PAIRS_MAX = 100 };

/* ---- main effects ------------------------------------------------------------------------- */

/* The designs over which the other parameters are averaged: u[AROUND][parameters]. */
static double *spread_others(size_t parameters, struct error *error) {
  struct sequence *sequence = NULL;
  double *u = malloc(AROUND * parameters * sizeof *u);
  if (!u) {
    analysis_made(NULL, error);
    return NULL;
  }
  if (sequence_create(SEQUENCE_SOBOL, (int)parameters, true, 2, &sequence, error) != STATUS_OK) {
    free(u);
    return NULL;
  }
  for (size_t i = 0; i < AROUND; i++) {
    sequence_next(sequence, u + i * parameters);
  }
  sequence_destroy(sequence);
  return u;
}

/* The value of a parameter at a level, for people. */
static json_t *level_view(const struct study_column *column, const struct space_axis *axis,
                          double value) {
  size_t word = value >= 0.0 ? (size_t)value : 0;
  return axis->words == 0            ? analysis_number(value)
         : word < column->word_count ? json_string(column->words[word])
                                     : json_null();
}

static double level_value(const struct space_axis *axis, int level, int levels) {
  double part = levels > 1 ? (double)level / (levels - 1) : 0.0;
  if (axis->words) {
    return level;
  }
  double value = axis->coding == SPACE_LOGARITHM ? axis->low * pow(axis->high / axis->low, part)
                                                 : axis->low + part * (axis->high - axis->low);
  return axis->whole ? round(value) : value;
}

/* As many as there are words or whole numbers, at most LEVELS. */
static int level_count(const struct space_axis *axis) {
  if (axis->words) {
    return (int)axis->words;
  }
  if (axis->high <= axis->low) {
    return 1;
  }
  return axis->whole ? (int)fmin(axis->high - axis->low + 1.0, LEVELS) : LEVELS;
}

static json_t *effect_view(const struct study_table *table, const struct model *model,
                           size_t parameter, const double *u) {
  const struct space_axis *axis = &model->space.axis[parameter];
  json_t *at = json_array(), *mean = json_array(), *low = json_array(), *high = json_array();
  int levels = level_count(axis);
  for (int level = 0; level < levels; level++) {
    double design[SURROGATE_PARAMETERS_MAX], values[AROUND];
    double value = level_value(axis, level, levels);
    for (size_t i = 0; i < AROUND; i++) {
      space_design(&model->space, u + i * model->space.parameters, design);
      design[parameter] = value;
      model_predict(model, design, &values[i], NULL);
    }
    gsl_sort(values, 1, AROUND);
    json_array_append_new(at, level_view(&table->parameter[parameter], axis, value));
    json_array_append_new(mean, analysis_number(gsl_stats_mean(values, 1, AROUND)));
    json_array_append_new(
        low, analysis_number(gsl_stats_quantile_from_sorted_data(values, 1, AROUND, 0.1)));
    json_array_append_new(
        high, analysis_number(gsl_stats_quantile_from_sorted_data(values, 1, AROUND, 0.9)));
  }
  json_t *one = analysis_column(&table->parameter[parameter]);
  json_object_set_new(one, "at", at);
  json_object_set_new(one, "mean", mean);
  json_object_set_new(one, "low", low);
  json_object_set_new(one, "high", high);
  return one;
}

static enum status main_effects(const struct study_table *table, const struct model *model,
                                json_t *list, struct error *error) {
  double *u = spread_others(model->space.parameters, error);
  if (!u) {
    return error->status;
  }
  for (size_t k = 0; k < model->space.parameters; k++) {
    json_array_append_new(list, effect_view(table, model, k, u));
  }
  free(u);
  return STATUS_OK;
}

/* ---- pairs -------------------------------------------------------------------------------- */

struct pair {
  struct share share;
  size_t one, other;
};

static int compare_pairs(const void *left, const void *right) {
  const struct pair *a = left, *b = right;
  if (a->share.value != b->share.value) {
    return a->share.value > b->share.value ? -1 : 1;
  }
  return a->one != b->one ? (a->one < b->one ? -1 : 1) : a->other < b->other ? -1 : 1;
}

/* The pairs that interact most, at most PAIRS_MAX. */
static enum status pair_effects(const struct study_table *table, const struct model *model,
                                json_t *list, int *samples, struct error *error) {
  size_t n = model->space.parameters, count = 0;
  struct spread spread;
  struct share *share = malloc(n * n * sizeof *share);
  struct pair *pair = malloc(n * n * sizeof *pair);
  enum status status = share && pair ? STATUS_OK : analysis_made(NULL, error);
  spread = (struct spread){.count = 0};
  if (status == STATUS_OK) {
    status = spread_make(model, true, &spread, error);
  }
  if (status == STATUS_OK) {
    status =
        importance_pairs(spread.a, spread.b, (const double *const *)spread.mixed,
                         (const double *const *)spread.back, spread.count, (int)n, 1, share, error);
  }
  for (size_t i = 0; i < n && status == STATUS_OK; i++) {
    for (size_t k = i + 1; k < n; k++) {
      pair[count++] = (struct pair){share[i * n + k], i, k};
    }
  }
  if (count > 0) {
    qsort(pair, count, sizeof *pair, compare_pairs);
  }
  for (size_t i = 0; i < count && i < PAIRS_MAX; i++) {
    json_array_append_new(list,
                          json_pack("{s:[s, s], s:o}", "keys", table->parameter[pair[i].one].key,
                                    table->parameter[pair[i].other].key, "share",
                                    analysis_share(&pair[i].share)));
  }
  *samples = spread.count;
  spread_clear(&spread);
  free(share);
  free(pair);
  return status;
}

enum status analysis_effects(const struct study_table *table, const struct model *model,
                             size_t metric, json_t **answer, struct error *error) {
  json_t *effects = json_array(), *pairs = json_array();
  int samples = 0;
  *answer = NULL;
  enum status status = main_effects(table, model, effects, error);
  if (status == STATUS_OK) {
    status = pair_effects(table, model, pairs, &samples, error);
  }
  if (status == STATUS_OK) {
    *answer = json_pack("{s:o, s:o, s:i, s:O, s:O}", "metric",
                        analysis_column(&table->metric[metric]), "surrogate", model_view(model),
                        "samples", samples, "main", effects, "pairs", pairs);
    status = analysis_made(*answer, error);
  }
  json_decref(effects);
  json_decref(pairs);
  return status;
}
