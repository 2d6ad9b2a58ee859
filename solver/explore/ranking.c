#include "solver/explore/ranking.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- scores ------------------------------------------------------------------------------- */

/* Smallest and largest value so far. */
struct range {
  double low, high;
};

static struct range widened(struct range range, double value) {
  return (struct range){fmin(range.low, value), fmax(range.high, value)};
}

static double normalised(struct range range, double value) {
  return range.high > range.low ? (value - range.low) / (range.high - range.low) : 0;
}

/* Measure number m of a member: bending, slope, deflection. */
static const double *measure(const struct ranking_measures *measures, int m) {
  return m == 0 ? measures->bending : m == 1 ? measures->slope : measures->deflection;
}

/* The range of measure m over all members, at station k or, for k < 0, at all `stations`. */
static struct range range_of(const struct ranking_measures *measures, size_t count, int m, int k,
                             int stations) {
  struct range range = {INFINITY, -INFINITY};
  int from = k < 0 ? 0 : k, to = k < 0 ? stations : k + 1;
  for (size_t i = 0; i < count; i++) {
    for (int j = from; j < to; j++) {
      range = widened(range, measure(&measures[i], m)[j]);
    }
  }
  return range;
}

static double variance(const double *values, int count) {
  double mean = 0, sum = 0;
  for (int k = 0; k < count; k++) {
    mean += values[k] / count;
  }
  for (int k = 0; k < count; k++) {
    sum += (values[k] - mean) * (values[k] - mean);
  }
  return sum / count;
}

static void add_means(const struct study_ranking *ranking, bool by_station,
                      const struct ranking_measures *measures, size_t count,
                      struct ranking_score *scores) {
  const double weight[3] = {ranking->bending, ranking->slope, ranking->deflection};
  int stations = ranking->station_count;
  for (int k = 0; k < stations; k++) {
    for (int m = 0; m < 3; m++) {
      struct range range = range_of(measures, count, m, by_station ? k : -1, stations);
      for (size_t i = 0; i < count; i++) {
        scores[i].mean += weight[m] * normalised(range, measure(&measures[i], m)[k]) / stations;
      }
    }
  }
}

void ranking_score(const struct study_ranking *ranking, bool by_station,
                   const struct ranking_measures *measures, size_t count,
                   struct ranking_score *scores) {
  struct range range = {INFINITY, -INFINITY};
  for (size_t i = 0; i < count; i++) {
    scores[i] =
        (struct ranking_score){.variance = variance(measures[i].slope, ranking->station_count)};
    range = widened(range, scores[i].variance);
  }
  add_means(ranking, by_station, measures, count, scores);
  for (size_t i = 0; i < count; i++) {
    double even = 1 - normalised(range, scores[i].variance);
    scores[i].normalised_variance = 1 - even;
    scores[i].final = ranking->mean_weight * scores[i].mean + (1 - ranking->mean_weight) * even;
  }
  for (size_t i = 0; i < count; i++) {
    scores[i].rank = 1;
    for (size_t j = 0; j < count; j++) {
      scores[i].rank += scores[j].final > scores[i].final + 1e-9;
    }
  }
}

/* ---- the document ------------------------------------------------------------------------- */

/* What is ranked. */
struct field {
  size_t count;
  size_t *member; /* index of each in the study */
  struct ranking_measures *measures;
  struct ranking_score *scores, *other; /* with the other normalisation */
};

/* Points [[x, y, z], ...] as numbers, for the caller to free; NULL when there are none. */
static double *points_of(const json_t *array, size_t *count) {
  *count = json_array_size(array);
  double *points = *count ? calloc(3 * *count, sizeof *points) : NULL;
  for (size_t p = 0; points && p < *count; p++) {
    for (size_t i = 0; i < 3; i++) {
      points[3 * p + i] = json_number_value(json_array_get(json_array_get(array, p), i));
    }
  }
  return points;
}

static bool measure_member(const struct study_ranking *ranking, const json_t *member,
                           struct ranking_measures *measures) {
  const char *status = json_string_value(json_object_get(member, "status"));
  const json_t *midlines = json_object_get(member, "midlines");
  const json_t *last = json_array_get(midlines, json_array_size(midlines) - 1);
  size_t before, after;
  double *rest = points_of(json_object_get(member, "rest_midline_mm"), &before);
  double *now = points_of(json_object_get(last, "points_mm"), &after);
  bool good =
      status && strcmp(status, "succeeded") == 0 && rest && now && before == after &&
      ranking_measure(rest, now, before, ranking->station, ranking->station_count, measures);
  free(rest);
  free(now);
  return good;
}

static json_t *numbers(const double *values, int count) {
  json_t *array = json_array();
  for (int k = 0; k < count; k++) {
    json_array_append_new(array, json_real(values[k]));
  }
  return array;
}

static json_t *row(const struct study_ranking *ranking, const struct field *field, size_t i,
                   const json_t *members) {
  const struct ranking_score *score = &field->scores[i];
  const struct ranking_measures *m = &field->measures[i];
  const json_t *member = json_array_get(members, field->member[i]);
  return json_pack("{s:i, s:i, s:O, s:O, s:f, s:f, s:f, s:f, s:i, s:f, s:f, s:o, s:o, s:o}", "rank",
                   score->rank, "member", (int)field->member[i], "name",
                   json_object_get(member, "name"), "labels", json_object_get(member, "labels"),
                   "mean_weighted", score->mean, "slope_variance_deg2_per_mm2", score->variance,
                   "normalised_variance", score->normalised_variance, "final", score->final,
                   "other_rank", field->other[i].rank, "other_mean_weighted", field->other[i].mean,
                   "other_final", field->other[i].final, "bending_deg",
                   numbers(m->bending, ranking->station_count), "slope_deg_per_mm",
                   numbers(m->slope, ranking->station_count), "deflection_mm",
                   numbers(m->deflection, ranking->station_count));
}

/* Rows by rank; members of one rank in the order of the study. */
static json_t *rows(const struct study_ranking *ranking, const struct field *field,
                    const json_t *members) {
  json_t *array = json_array();
  for (size_t rank = 1; rank <= field->count; rank++) {
    for (size_t i = 0; i < field->count; i++) {
      if (field->scores[i].rank == (int)rank) {
        json_array_append_new(array, row(ranking, field, i, members));
      }
    }
  }
  return array;
}

static json_t *left_out(const struct field *field, size_t members, json_t *warnings) {
  json_t *indices = json_array();
  for (size_t i = 0, next = 0; i < members; i++) {
    bool ranked = next < field->count && field->member[next] == i;
    next += ranked;
    if (!ranked) {
      json_array_append_new(indices, json_integer((json_int_t)i));
    }
  }
  if (json_array_size(indices) > 0) {
    char sentence[160];
    snprintf(sentence, sizeof sentence,
             "%zu of %zu members are not ranked, because they did not reach their load",
             json_array_size(indices), members);
    json_array_append_new(warnings, json_string(sentence));
  }
  return indices;
}

static void warn_of_order(const struct field *field, json_t *warnings) {
  for (size_t i = 0; i < field->count; i++) {
    if (field->scores[i].rank != field->other[i].rank) {
      json_array_append_new(warnings,
                            json_string("the ranking depends on the normalisation: \"other_rank\" "
                                        "is the one that extremes per station give in place of "
                                        "extremes over all stations, or the other way round"));
      return;
    }
  }
}

json_t *ranking_document(const struct study_ranking *ranking, const json_t *members,
                         json_t *warnings) {
  size_t total = json_array_size(members);
  struct field field = {.member = calloc(total, sizeof *field.member),
                        .measures = calloc(total, sizeof *field.measures),
                        .scores = calloc(total, sizeof *field.scores),
                        .other = calloc(total, sizeof *field.other)};
  json_t *document = NULL;
  if (!field.member || !field.measures || !field.scores || !field.other) {
    goto done;
  }
  for (size_t i = 0; i < total; i++) {
    if (measure_member(ranking, json_array_get(members, i), &field.measures[field.count])) {
      field.member[field.count++] = i;
    }
  }
  ranking_score(ranking, ranking->by_station, field.measures, field.count, field.scores);
  ranking_score(ranking, !ranking->by_station, field.measures, field.count, field.other);
  json_t *stations = json_array();
  for (int k = 0; k < ranking->station_count; k++) {
    json_array_append_new(stations, json_real(1e3 * ranking->station[k]));
  }
  warn_of_order(&field, warnings);
  document = json_pack(
      "{s:o, s:{s:f, s:f, s:f}, s:f, s:s, s:o, s:o}", "stations_mm", stations, "weights", "bending",
      ranking->bending, "slope", ranking->slope, "deflection", ranking->deflection, "mean_weight",
      ranking->mean_weight, "normalisation", ranking->by_station ? "station" : "all", "designs",
      rows(ranking, &field, members), "left_out", left_out(&field, total, warnings));
done:
  free(field.member);
  free(field.measures);
  free(field.scores);
  free(field.other);
  return document;
}
