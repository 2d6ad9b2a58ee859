#include "server/study/search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/study/design.h"
#include "solver/job/reader.h"
#include "solver/job/study_constraint.h"

/* Candidates that are looked at more closely: some are no valid jobs. */
enum { CANDIDATES = 60 };

/* ---- what it takes ------------------------------------------------------------------------ */

static enum status add_metric(struct search *search, struct quantity_of of, struct error *error) {
  for (size_t i = 0; i < search->metrics; i++) {
    if (of.parameter || search->metric[i] == of.column) {
      return STATUS_OK;
    }
  }
  if (of.parameter) {
    return STATUS_OK;
  }
  if (search->metrics == SEARCH_METRICS_MAX) {
    return error_set(error, STATUS_INVALID, NULL,
                     "the search is about more than %d metrics\nat most %d", SEARCH_METRICS_MAX,
                     SEARCH_METRICS_MAX);
  }
  search->metric[search->metrics++] = of.column;
  return STATUS_OK;
}

static enum status choose_metrics(struct search *search, struct error *error) {
  enum status status = add_metric(search, search->query->goal, error);
  for (size_t i = 0; i < search->query->conditions && status == STATUS_OK; i++) {
    status = add_metric(search, search->query->condition[i].of, error);
  }
  if (status == STATUS_OK && search->metrics == 0) {
    status = error_set(error, STATUS_INVALID, NULL,
                       "the search is about no metric\na metric as goal or in a limit, as in "
                       "where=bending_angle_deg>=60&least=mass_g");
  }
  return status;
}

/* The constraints of the study in the units in which its parameters are shown. */
static enum status read_sums(struct search *search, const struct search_means *means,
                             struct error *error) {
  struct study_constraints constraints = {.count = 0};
  struct reader reader = {.units = job_reader_units(means->reader), .error = error};
  const json_t *listed = json_object_get(means->document, "parameters");
  enum status status = json_object_get(means->document, "constraints")
                           ? study_constraints_read(&reader, means->document, &constraints)
                           : STATUS_OK;
  search->sum = calloc(constraints.count + 1, sizeof *search->sum);
  if (!search->sum) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a search.");
  }
  search->sums = status == STATUS_OK ? constraints.count : 0;
  for (size_t i = 0; i < search->sums && status == STATUS_OK; i++) {
    const struct study_constraint *constraint = &constraints.constraint[i];
    search->sum[i].low = constraint->low;
    search->sum[i].high = constraint->high;
    for (size_t k = 0; k < constraints.parameters && status == STATUS_OK; k++) {
      const char *pointer =
          json_string_value(json_object_get(json_array_get(listed, k), "pointer"));
      size_t column;
      double scale = 1.0;
      if (constraint->factor[k] == 0.0 ||
          criteria_parameter(search->table, pointer, &column, NULL) != STATUS_OK) {
        continue;
      }
      if (constraint->unit[0]) {
        char one[48];
        snprintf(one, sizeof one, "1 %.40s", search->table->parameter[column].unit);
        status = units_read(reader.units, one, constraint->unit, &scale, error);
      }
      search->sum[i].factor[column] = constraint->factor[k] * scale;
    }
  }
  return status;
}

static double spread_of(const struct model *model) {
  return surrogate_fit(model->surrogate)->deviation;
}

static enum status prepare(struct search *search, const struct search_means *means,
                           struct error *error) {
  enum status status = choose_metrics(search, error);
  for (size_t i = 0; i < search->metrics && status == STATUS_OK; i++) {
    status = models_get(means->models, search->table, search->metric[i], &search->model[i], error);
    if (status == STATUS_OK) {
      search->spread[i] = spread_of(search->model[i]);
    }
  }
  if (status == STATUS_OK) {
    search->space = &search->model[0]->space;
    status = read_sums(search, means, error);
  }
  return status;
}

static void search_clear(struct search *search) {
  for (size_t i = 0; i < search->metrics; i++) {
    model_release(search->model[i]);
  }
  free(search->sum);
}

/* ---- stored designs ----------------------------------------------------------------------- */

struct found {
  size_t row;
  double goal; /* less is better */
};

static int compare_found(const void *left, const void *right) {
  const struct found *a = left, *b = right;
  if (a->goal != b->goal) {
    return a->goal < b->goal ? -1 : 1;
  }
  return a->row < b->row ? -1 : 1;
}

static bool row_meets(const struct search *search, size_t row) {
  for (size_t i = 0; i < search->query->conditions; i++) {
    const struct condition *condition = &search->query->condition[i];
    double value = quantity_value(search->table, condition->of, row);
    if (!(condition->at_least ? value >= condition->limit : value <= condition->limit)) {
      return false;
    }
  }
  return row_counts(search->table, row) &&
         isfinite(quantity_value(search->table, search->query->goal, row));
}

static json_t *stored_view(const struct search *search, size_t row) {
  const struct study_table *table = search->table;
  json_t *one = analysis_member(table, row), *metrics = json_array();
  for (size_t i = 0; i < search->metrics; i++) {
    size_t k = search->metric[i];
    json_array_append_new(
        metrics, json_pack("{s:s, s:o, s:n}", "key", table->metric[k].key, "value",
                           analysis_number(table->result[row * table->metrics + k]), "deviation"));
  }
  json_object_set_new(one, "predicted", json_false());
  json_object_set_new(one, "values", space_values(table, table->value + row * table->parameters));
  json_object_set_new(one, "metrics", metrics);
  return one;
}

/* The best of the members that meet all limits; *meeting of them in all. */
static json_t *stored_designs(const struct search *search, size_t *meeting) {
  struct found *found = malloc((search->table->members + 1) * sizeof *found);
  json_t *list = found ? json_array() : NULL;
  *meeting = 0;
  for (size_t i = 0; found && i < search->table->members; i++) {
    if (row_meets(search, i)) {
      double goal = quantity_value(search->table, search->query->goal, i);
      found[(*meeting)++] = (struct found){i, search->query->most ? -goal : goal};
    }
  }
  if (found) {
    qsort(found, *meeting, sizeof *found, compare_found);
  }
  for (size_t i = 0; list && i < *meeting && i < search->query->limit; i++) {
    json_array_append_new(list, stored_view(search, found[i].row));
  }
  free(found);
  return list;
}

/* ---- predicted designs -------------------------------------------------------------------- */

/* The newest job that solves the same, with its metrics; null when there is none. */
static json_t *solved_view(const struct search *search, const struct search_means *means,
                           const char *hash) {
  struct job_record record;
  int64_t id = 0;
  if (store_equal_job(means->store, hash, &id, NULL) != STATUS_OK || id == 0 ||
      store_job(means->store, id, &record, NULL) != STATUS_OK) {
    return json_null();
  }
  json_t *metrics = json_array();
  for (size_t i = 0; i < search->metrics; i++) {
    const char *key = search->table->metric[search->metric[i]].key;
    const json_t *value = json_object_get(record.metrics, key);
    json_array_append_new(
        metrics, json_pack("{s:s, s:o}", "key", key, "value",
                           value ? analysis_number(json_number_value(value)) : json_null()));
  }
  json_t *view = json_pack("{s:I, s:s, s:o}", "job", (json_int_t)id, "state",
                           job_state_word(record.state), "metrics", metrics);
  job_record_clear(&record);
  return view;
}

static json_t *metrics_view(const struct search *search, const struct candidate *candidate) {
  json_t *metrics = json_array();
  for (size_t i = 0; i < search->metrics; i++) {
    json_array_append_new(metrics, json_pack("{s:s, s:o, s:o}", "key",
                                             search->table->metric[search->metric[i]].key, "value",
                                             analysis_number(candidate->mean[i]), "deviation",
                                             analysis_number(candidate->deviation[i])));
  }
  return metrics;
}

/* A candidate whose job is valid; else NULL. */
static json_t *predicted_view(const struct search *search, const struct search_means *means,
                              const struct candidate *candidate) {
  char name[200];
  struct error error;
  struct job_spec spec;
  json_t *document = NULL, *values = space_values(search->table, candidate->design);
  snprintf(name, sizeof name, "%.150s: a predicted design", search->table->name);
  enum status status =
      design_document(means->document, search->table, values, name, &document, &error);
  json_t *checked = status == STATUS_OK ? json_deep_copy(document) : NULL;
  if (!checked || job_reader_check(means->reader, checked, &spec, &error) != STATUS_OK) {
    json_decref(checked);
    json_decref(document);
    json_decref(values);
    return NULL;
  }
  json_t *view =
      json_pack("{s:b, s:o, s:o, s:o, s:b, s:o, s:o}", "predicted", 1, "values", values, "metrics",
                metrics_view(search, candidate), "chance", analysis_number(candidate->chance),
                "meets", candidate->chance >= search->query->chance, "document", document, "solved",
                solved_view(search, means, spec.hash));
  job_spec_release(&spec);
  json_decref(checked);
  return view;
}

static enum status predicted_designs(const struct search *search, const struct search_means *means,
                                     json_t **list, struct error *error) {
  size_t count = 0;
  struct candidate *best = malloc(CANDIDATES * sizeof *best);
  *list = json_array();
  enum status status = best && *list ? search_candidates(search, best, CANDIDATES, &count, error)
                                     : analysis_made(NULL, error);
  for (size_t i = 0; i < count && json_array_size(*list) < search->query->limit; i++) {
    json_t *one = predicted_view(search, means, &best[i]);
    if (one) {
      json_array_append_new(*list, one);
    }
  }
  free(best);
  return status;
}

/* ---- the answer --------------------------------------------------------------------------- */

static json_t *models_view(const struct search *search) {
  json_t *list = json_array();
  for (size_t i = 0; i < search->metrics; i++) {
    json_t *one = analysis_column(&search->table->metric[search->metric[i]]);
    json_object_set_new(one, "surrogate", model_view(search->model[i]));
    json_array_append_new(list, one);
  }
  return list;
}

enum status search_run(const struct study_table *table, const struct search_means *means,
                       const struct search_query *query, json_t **answer, struct error *error) {
  struct search search = {.table = table, .query = query};
  json_t *predicted = NULL;
  size_t meeting = 0;
  *answer = NULL;
  enum status status = prepare(&search, means, error);
  if (status == STATUS_OK) {
    status = predicted_designs(&search, means, &predicted, error);
  }
  if (status == STATUS_OK) {
    json_t *stored = stored_designs(&search, &meeting);
    *answer = json_pack("{s:{s:s, s:s}, s:f, s:o, s:I, s:o, s:O}", "goal", "key",
                        quantity_column(table, query->goal)->key, "direction",
                        query->most ? "max" : "min", "chance", query->chance, "metrics",
                        models_view(&search), "meeting", (json_int_t)meeting, "stored", stored,
                        "predicted", predicted);
    status = analysis_made(*answer, error);
  }
  json_decref(predicted);
  search_clear(&search);
  return status;
}
