#include <math.h>
#include <stdlib.h>

#include "server/study/analysis.h"
#include "server/study/spread.h"
#include "solver/explore/importance.h"

/* ---- correlation -------------------------------------------------------------------------- */

/* Correlations of a parameter with the metric over all members that have both; false where the
 * words of the parameter have no order. */
static enum status correlate(const struct study_table *table, const struct space_axis *axis,
                             size_t parameter, size_t metric, double *linear, double *rank,
                             struct error *error) {
  double *x = malloc((2 * table->members + 1) * sizeof *x), *y = x ? x + table->members : NULL;
  int count = 0;
  *linear = *rank = NAN;
  if (!x) {
    return analysis_made(NULL, error);
  }
  for (size_t i = 0; i < table->members && axis->words <= 2; i++) {
    double from = table->value[i * table->parameters + parameter];
    double to = table->result[i * table->metrics + metric];
    if (row_counts(table, i) && isfinite(from) && isfinite(to)) {
      x[count] = from;
      y[count++] = to;
    }
  }
  enum status status = STATUS_OK;
  if (count > 1) {
    status = importance_correlation(x, y, count, linear, rank, error);
  }
  free(x);
  return status;
}

/* ---- importance --------------------------------------------------------------------------- */

struct ordered {
  double total;
  size_t parameter;
};

static int compare_totals(const void *left, const void *right) {
  const struct ordered *a = left, *b = right;
  if (a->total != b->total) {
    return a->total > b->total ? -1 : 1;
  }
  return a->parameter < b->parameter ? -1 : 1;
}

/* The parameters, the most important first. */
static enum status parameters_view(const struct study_table *table, const struct model *model,
                                   size_t metric, const struct importance *importance, json_t *list,
                                   struct error *error) {
  struct ordered order[SURROGATE_PARAMETERS_MAX];
  enum status status = STATUS_OK;
  for (size_t k = 0; k < table->parameters; k++) {
    order[k] = (struct ordered){importance[k].total.value, k};
  }
  qsort(order, table->parameters, sizeof *order, compare_totals);
  for (size_t i = 0; i < table->parameters && status == STATUS_OK; i++) {
    size_t k = order[i].parameter;
    double linear, rank;
    json_t *one = analysis_column(&table->parameter[k]);
    status = correlate(table, &model->space.axis[k], k, metric, &linear, &rank, error);
    json_object_set_new(one, "first", analysis_share(&importance[k].first));
    json_object_set_new(one, "total", analysis_share(&importance[k].total));
    json_object_set_new(one, "pearson", analysis_number(linear));
    json_object_set_new(one, "spearman", analysis_number(rank));
    json_array_append_new(list, one);
  }
  return status;
}

enum status analysis_importance(const struct study_table *table, const struct model *model,
                                size_t metric, json_t **answer, struct error *error) {
  struct importance importance[SURROGATE_PARAMETERS_MAX];
  struct spread spread;
  json_t *list = json_array();
  *answer = NULL;
  enum status status = spread_make(model, false, &spread, error);
  if (status == STATUS_OK) {
    status = importance_sobol(spread.a, spread.b, (const double *const *)spread.mixed, spread.count,
                              (int)spread.parameters, 1, importance, error);
  }
  if (status == STATUS_OK) {
    status = parameters_view(table, model, metric, importance, list, error);
  }
  if (status == STATUS_OK) {
    *answer =
        json_pack("{s:o, s:o, s:s, s:i, s:O}", "metric", analysis_column(&table->metric[metric]),
                  "surrogate", model_view(model), "method",
                  "Sobol' indices of the surrogate: first order by Saltelli et al. 2010, "
                  "total by Jansen 1999; intervals of 95 % by bootstrap, of the integration",
                  "samples", spread.count, "parameters", list);
    status = analysis_made(*answer, error);
  }
  spread_clear(&spread);
  json_decref(list);
  return status;
}
