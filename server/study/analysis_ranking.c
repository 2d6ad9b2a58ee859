#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/study/analysis.h"

static const double tie = 1e-9; /* scores that agree to this share a rank */

struct scored {
  size_t row;
  double score;
};

/* Best first; of equals the member that comes first. */
static int compare_scores(const void *left, const void *right) {
  const struct scored *a = left, *b = right;
  if (a->score != b->score) {
    return a->score > b->score ? -1 : 1;
  }
  return a->row < b->row ? -1 : 1;
}

/* Extremes of a metric over the members that are compared. */
struct extremes {
  double low, high;
};

static double metric_of(const struct study_table *table, const struct criterion *criterion,
                        size_t row) {
  return table->result[row * table->metrics + criterion->metric];
}

/* 0 for the worst member, 1 for the best. */
static double normalise(const struct criterion *criterion, const struct extremes *extremes,
                        double value) {
  if (extremes->high <= extremes->low) {
    return 0.0;
  }
  double share = (value - extremes->low) / (extremes->high - extremes->low);
  return criterion->maximise ? share : 1.0 - share;
}

static double weight_of(const struct criterion *criterion) {
  return isnan(criterion->number) ? 1.0 : criterion->number;
}

/* Finds the members with all metrics and the extremes of each. Returns their number. */
static size_t compared_rows(const struct study_table *table, const struct criterion *criteria,
                            size_t count, struct scored *scored, struct extremes *extremes) {
  size_t found = 0;
  for (size_t k = 0; k < count; k++) {
    extremes[k] = (struct extremes){INFINITY, -INFINITY};
  }
  for (size_t i = 0; i < table->members; i++) {
    bool counts = row_counts(table, i);
    for (size_t k = 0; k < count && counts; k++) {
      counts = isfinite(metric_of(table, &criteria[k], i));
    }
    for (size_t k = 0; k < count && counts; k++) {
      double value = metric_of(table, &criteria[k], i);
      extremes[k].low = fmin(extremes[k].low, value);
      extremes[k].high = fmax(extremes[k].high, value);
    }
    if (counts) {
      scored[found++].row = i;
    }
  }
  return found;
}

static json_t *criteria_view(const struct study_table *table, const struct criterion *criteria,
                             size_t count, const struct extremes *extremes, double weights) {
  json_t *list = json_array();
  for (size_t k = 0; k < count; k++) {
    json_t *one = analysis_column(&table->metric[criteria[k].metric]);
    json_object_set_new(one, "direction", json_string(criteria[k].maximise ? "max" : "min"));
    json_object_set_new(one, "weight", analysis_number(weight_of(&criteria[k]) / weights));
    json_object_set_new(one, "low", analysis_number(extremes[k].low));
    json_object_set_new(one, "high", analysis_number(extremes[k].high));
    json_array_append_new(list, one);
  }
  return list;
}

static enum status check_weights(const struct criterion *criteria, size_t count, double *sum,
                                 struct error *error) {
  *sum = 0.0;
  for (size_t k = 0; k < count; k++) {
    *sum += weight_of(&criteria[k]);
    if (weight_of(&criteria[k]) <= 0.0) {
      return error_set(error, STATUS_INVALID, NULL,
                       "a weight is %g\nweights above 0, the direction being max or min",
                       weight_of(&criteria[k]));
    }
  }
  return STATUS_OK;
}

enum status analysis_ranking(const struct study_table *table, const struct criterion *criteria,
                             size_t count, size_t limit, json_t **answer, struct error *error) {
  struct extremes extremes[CRITERIA_MAX];
  double weights;
  *answer = NULL;
  enum status status = check_weights(criteria, count, &weights, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct scored *scored = malloc((table->members + 1) * sizeof *scored);
  if (!scored) {
    return analysis_made(NULL, error);
  }
  size_t found = compared_rows(table, criteria, count, scored, extremes);
  for (size_t i = 0; i < found; i++) {
    scored[i].score = 0.0;
    for (size_t k = 0; k < count; k++) {
      scored[i].score +=
          weight_of(&criteria[k]) / weights *
          normalise(&criteria[k], &extremes[k], metric_of(table, &criteria[k], scored[i].row));
    }
  }
  qsort(scored, found, sizeof *scored, compare_scores);
  json_t *designs = json_array();
  size_t rank = 1;
  for (size_t i = 0; i < found && i < limit; i++) {
    json_t *parts = json_array(), *one = analysis_member(table, scored[i].row);
    rank = i > 0 && scored[i - 1].score - scored[i].score <= tie ? rank : i + 1;
    for (size_t k = 0; k < count; k++) {
      double value = metric_of(table, &criteria[k], scored[i].row);
      json_array_append_new(parts, analysis_number(normalise(&criteria[k], &extremes[k], value)));
    }
    json_object_set_new(one, "rank", json_integer((json_int_t)rank));
    json_object_set_new(one, "score", analysis_number(scored[i].score));
    json_object_set_new(one, "parts", parts);
    json_array_append_new(designs, one);
  }
  *answer = json_pack("{s:n, s:o, s:I, s:I, s:o}", "preset", "criteria",
                      criteria_view(table, criteria, count, extremes, weights), "compared",
                      (json_int_t)found, "excluded", (json_int_t)(table->members - found),
                      "designs", designs);
  free(scored);
  return analysis_made(*answer, error);
}

/* ---- the formula of the paper -------------------------------------------------------------- */

/* The row of the member with this index, or the number of rows. */
static size_t row_of_member(const struct study_table *table, json_int_t member) {
  size_t row = 0;
  while (row < table->members && table->member[row] != member) {
    row++;
  }
  return row;
}

static double number_of(const json_t *object, const char *key) {
  return json_number_value(json_object_get(object, key));
}

static json_t *stored_design(const struct study_table *table, const json_t *design) {
  size_t row = row_of_member(table, json_integer_value(json_object_get(design, "member")));
  json_t *one = row < table->members ? analysis_member(table, row) : NULL;
  json_object_set_new(one, "rank", json_incref(json_object_get(design, "rank")));
  json_object_set_new(one, "score", analysis_number(number_of(design, "final")));
  json_object_set_new(one, "parts",
                      json_pack("[f, f]", number_of(design, "mean_weighted"),
                                1.0 - number_of(design, "normalised_variance")));
  return one;
}

/* One of the two parts of the final score, which lie between 0 and 1. */
static json_t *stored_criterion(const char *key, const char *title, const char *direction,
                                double weight) {
  return json_pack("{s:s, s:s, s:s, s:s, s:f, s:f, s:f}", "key", key, "title", title, "unit", "",
                   "direction", direction, "weight", weight, "low", 0.0, "high", 1.0);
}

enum status analysis_ranking_stored(const struct study_table *table, const json_t *result,
                                    size_t limit, json_t **answer, struct error *error) {
  const json_t *ranking = json_object_get(result, "ranking");
  const json_t *listed = json_object_get(ranking, "designs"), *design;
  size_t index;
  *answer = NULL;
  if (!json_is_array(listed)) {
    return error_set(error, STATUS_INVALID, NULL,
                     "the study's document asks for no ranking\ncriteria=max:KEY:WEIGHT,"
                     "min:KEY:WEIGHT, or a study with \"ranking\"");
  }
  double mean_weight = number_of(ranking, "mean_weight");
  json_t *designs = json_array();
  json_array_foreach(listed, index, design) {
    json_t *one = index < limit ? stored_design(table, design) : NULL;
    if (one) {
      json_array_append_new(designs, one);
    }
  }
  size_t compared = json_array_size(listed);
  *answer = json_pack(
      "{s:s, s:[o, o], s:I, s:I, s:o}", "preset", "taper", "criteria",
      stored_criterion("mean_weighted", "weighted mean over the stations", "max", mean_weight),
      stored_criterion("normalised_variance", "variance of the slope", "min", 1.0 - mean_weight),
      "compared", (json_int_t)compared, "excluded",
      (json_int_t)(table->members > compared ? table->members - compared : 0), "designs", designs);
  return analysis_made(*answer, error);
}
