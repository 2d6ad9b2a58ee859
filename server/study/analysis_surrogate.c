#include <math.h>

#include "server/study/analysis.h"

/* ---- quality ------------------------------------------------------------------------------ */

/* The lengths of a parameter: one, or one for each word. */
static json_t *lengths_view(const struct study_column *column, const struct space_axis *axis,
                            const struct surrogate_fit *fit) {
  json_t *lengths = json_array();
  for (int i = 0; i < axis->width; i++) {
    json_array_append_new(lengths, analysis_number(fit->length[axis->first + i]));
  }
  json_t *one = analysis_column(column);
  json_object_set_new(one, "coding", json_string(space_coding_word(axis->coding)));
  json_object_set_new(one, "lengths", lengths);
  return one;
}

/* The points in columns: members, jobs, known, predicted, deviation. */
static json_t *left_out_view(const struct study_table *table, const struct model *model) {
  json_t *members = json_array(), *jobs = json_array(), *known = json_array();
  json_t *predicted = json_array(), *deviation = json_array();
  for (size_t i = 0; i < model->points; i++) {
    size_t row = model->row[i];
    json_array_append_new(members, json_integer(table->member[row]));
    json_array_append_new(jobs, json_integer((json_int_t)table->job_id[row]));
    json_array_append_new(known, analysis_number(model->known[i]));
    json_array_append_new(predicted, analysis_number(model->left_out[i]));
    json_array_append_new(deviation, analysis_number(model->deviation[i]));
  }
  return json_pack("{s:o, s:o, s:o, s:o, s:o}", "members", members, "jobs", jobs, "known", known,
                   "predicted", predicted, "deviation", deviation);
}

enum status analysis_surrogate(const struct study_table *table, const struct model *model,
                               size_t metric, json_t **answer, struct error *error) {
  const struct surrogate_fit *fit = surrogate_fit(model->surrogate);
  json_t *parameters = json_array();
  for (size_t k = 0; k < table->parameters; k++) {
    json_array_append_new(parameters,
                          lengths_view(&table->parameter[k], &model->space.axis[k], fit));
  }
  *answer =
      json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "metric",
                analysis_column(&table->metric[metric]), "surrogate", model_view(model), "mean",
                analysis_number(fit->mean), "deviation", analysis_number(fit->deviation), "noise",
                analysis_number(fit->noise), "log_likelihood", analysis_number(fit->log_likelihood),
                "parameters", parameters, "left_out", left_out_view(table, model));
  return analysis_made(*answer, error);
}

/* ---- slices ------------------------------------------------------------------------------- */

/* The value of an axis at place i of `count`. */
static double place_value(const struct space_axis *axis, int i, int count) {
  double part = count > 1 ? (double)i / (count - 1) : 0.0;
  if (axis->words) {
    return i;
  }
  return axis->coding == SPACE_LOGARITHM ? axis->low * pow(axis->high / axis->low, part)
                                         : axis->low + part * (axis->high - axis->low);
}

static int place_count(const struct space_axis *axis, int resolution) {
  return axis->words ? (int)axis->words : resolution;
}

static json_t *axis_view(const struct study_column *column, const struct space_axis *axis,
                         int count) {
  json_t *values = json_array(), *one = analysis_column(column);
  for (int i = 0; i < count; i++) {
    size_t word = (size_t)i;
    json_array_append_new(values, axis->words == 0 ? analysis_number(place_value(axis, i, count))
                                  : word < column->word_count ? json_string(column->words[word])
                                                              : json_null());
  }
  json_object_set_new(one, "logarithmic", json_boolean(axis->coding == SPACE_LOGARITHM));
  json_object_set_new(one, "values", values);
  return one;
}

/* One row of a slice: along x. */
static void add_row(const struct model *model, size_t x, int count, double *design, json_t *means,
                    json_t *deviations) {
  for (int i = 0; i < count; i++) {
    double mean, deviation;
    design[x] = place_value(&model->space.axis[x], i, count);
    model_predict(model, design, &mean, &deviation);
    json_array_append_new(means, analysis_number(mean));
    json_array_append_new(deviations, analysis_number(deviation));
  }
}

enum status analysis_slice(const struct study_table *table, const struct model *model,
                           size_t metric, size_t x, int y, int resolution, const double *at,
                           json_t **answer, struct error *error) {
  double design[SURROGATE_PARAMETERS_MAX];
  const struct space *space = &model->space;
  json_t *means = json_array(), *deviations = json_array();
  int across = place_count(&space->axis[x], resolution);
  int along = y < 0 ? 1 : place_count(&space->axis[y], resolution);
  space_middle(space, design);
  for (size_t k = 0; k < space->parameters; k++) {
    design[k] = isnan(at[k]) ? design[k] : at[k];
  }
  json_t *fixed = space_values(table, design);
  json_object_del(fixed, table->parameter[x].key);
  if (y >= 0) {
    json_object_del(fixed, table->parameter[y].key);
  }
  for (int i = 0; i < along; i++) {
    json_t *mean = json_array(), *deviation = json_array();
    if (y >= 0) {
      design[y] = place_value(&space->axis[y], i, along);
    }
    add_row(model, x, across, design, mean, deviation);
    json_array_append_new(means, mean);
    json_array_append_new(deviations, deviation);
  }
  *answer = json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "metric",
                      analysis_column(&table->metric[metric]), "surrogate", model_view(model), "x",
                      axis_view(&table->parameter[x], &space->axis[x], across), "y",
                      y < 0 ? json_null() : axis_view(&table->parameter[y], &space->axis[y], along),
                      "at", fixed, "mean", means, "deviation", deviations);
  return analysis_made(*answer, error);
}
