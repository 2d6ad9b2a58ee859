#include <math.h>
#include <stdlib.h>

#include "server/study/analysis.h"
#include "solver/explore/pareto.h"
#include "solver/explore/sequence.h"

/* Where the exact volume of a front takes more than about a tenth of a second: members of the front
 * by number of objectives. Its time grows with a power of the number of members that grows with
 * that of objectives. */
static const size_t exact_most[CRITERIA_MAX + 1] = {0,  10000, 4000, 600, 150, 80,
                                                    50, 40,    30,   25,  20};

enum { SAMPLES = 1 << 15, SAMPLE_EFFORT = 100000000 };

/* The members that are compared and what is minimised of them. */
struct field {
  const struct criterion *objectives;
  size_t count; /* of objectives */
  size_t members;
  size_t *row;
  double *y; /* [members * count] */
  int *front;
  double best[CRITERIA_MAX], worst[CRITERIA_MAX], reference[CRITERIA_MAX];
};

static double sign_of(const struct criterion *criterion) {
  return criterion->maximise ? -1.0 : 1.0;
}

static void field_clear(struct field *field) {
  free(field->row);
  free(field->y);
  free(field->front);
}

static bool field_gather(const struct study_table *table, struct field *field) {
  size_t room = table->members + 1;
  field->row = malloc(room * sizeof *field->row);
  field->y = malloc(room * field->count * sizeof *field->y);
  field->front = malloc(room * sizeof *field->front);
  if (!field->row || !field->y || !field->front) {
    return false;
  }
  for (size_t k = 0; k < field->count; k++) {
    field->best[k] = INFINITY;
    field->worst[k] = -INFINITY;
  }
  for (size_t i = 0; i < table->members; i++) {
    double *y = field->y + field->members * field->count;
    bool counts = row_counts(table, i);
    for (size_t k = 0; k < field->count && counts; k++) {
      y[k] = sign_of(&field->objectives[k]) *
             table->result[i * table->metrics + field->objectives[k].metric];
      counts = isfinite(y[k]);
    }
    for (size_t k = 0; k < field->count && counts; k++) {
      field->best[k] = fmin(field->best[k], y[k]);
      field->worst[k] = fmax(field->worst[k], y[k]);
    }
    if (counts) {
      field->row[field->members++] = i;
    }
  }
  for (size_t k = 0; k < field->count; k++) {
    double given = field->objectives[k].number;
    field->reference[k] = isnan(given) ? field->worst[k] : sign_of(&field->objectives[k]) * given;
  }
  return true;
}

/* ---- hypervolume -------------------------------------------------------------------------- */

struct volume {
  double value, share, error; /* share of the box between best and reference; error of the value */
  bool exact;
};

/* The members of the first front, one after the other, each better than the reference. */
static size_t first_front(const struct field *field, double *front) {
  size_t found = 0;
  for (size_t i = 0; i < field->members; i++) {
    bool inside = field->front[i] == 1;
    for (size_t k = 0; k < field->count && inside; k++) {
      front[found * field->count + k] = field->y[i * field->count + k];
      inside = field->y[i * field->count + k] < field->reference[k];
    }
    found += inside;
  }
  return found;
}

static bool dominated(const double *front, size_t size, size_t count, const double *point) {
  for (size_t i = 0; i < size; i++) {
    size_t k = 0;
    while (k < count && front[i * count + k] <= point[k]) {
      k++;
    }
    if (k == count) {
      return true;
    }
  }
  return false;
}

/* The share of the box that the front dominates, from points spread over it. */
static enum status sample_share(const struct field *field, const double *front, size_t size,
                                struct volume *volume, struct error *error) {
  struct sequence *sequence;
  double u[CRITERIA_MAX], point[CRITERIA_MAX];
  size_t hits = 0, samples = SAMPLES;
  while (samples > 1024 && samples * size * field->count > SAMPLE_EFFORT) {
    samples /= 2;
  }
  enum status status =
      sequence_create(SEQUENCE_SOBOL, (int)field->count, true, 1, &sequence, error);
  for (size_t i = 0; i < samples && status == STATUS_OK; i++) {
    sequence_next(sequence, u);
    for (size_t k = 0; k < field->count; k++) {
      point[k] = field->best[k] + u[k] * (field->reference[k] - field->best[k]);
    }
    hits += dominated(front, size, field->count, point);
  }
  sequence_destroy(sequence);
  volume->share = (double)hits / (double)samples;
  volume->error = sqrt(volume->share * (1.0 - volume->share) / (double)samples);
  return status;
}

static enum status measure_volume(const struct field *field, struct volume *volume,
                                  struct error *error) {
  double box = 1.0;
  double *front = malloc((field->members + 1) * field->count * sizeof *front);
  *volume = (struct volume){.exact = true};
  if (!front) {
    return analysis_made(NULL, error);
  }
  for (size_t k = 0; k < field->count; k++) {
    box *= fmax(field->reference[k] - field->best[k], 0.0);
  }
  size_t size = first_front(field, front);
  enum status status = STATUS_OK;
  if (size > 0 && size <= exact_most[field->count]) {
    status =
        pareto_hypervolume(front, size, (int)field->count, field->reference, &volume->value, error);
    volume->share = box > 0.0 ? volume->value / box : 0.0;
  } else if (size > 0) {
    volume->exact = false;
    status = sample_share(field, front, size, volume, error);
    volume->value = volume->share * box;
    volume->error *= box;
  }
  free(front);
  return status;
}

/* ---- the answer --------------------------------------------------------------------------- */

static json_t *objectives_view(const struct study_table *table, const struct field *field) {
  json_t *list = json_array();
  for (size_t k = 0; k < field->count; k++) {
    double sign = sign_of(&field->objectives[k]);
    json_t *one = analysis_column(&table->metric[field->objectives[k].metric]);
    json_object_set_new(one, "direction", json_string(sign < 0.0 ? "max" : "min"));
    json_object_set_new(one, "best", analysis_number(sign * field->best[k]));
    json_object_set_new(one, "reference", analysis_number(sign * field->reference[k]));
    json_array_append_new(list, one);
  }
  return list;
}

/* The designs of the first layers, layer by layer, and how many each layer has. */
static json_t *designs_view(const struct study_table *table, const struct field *field, int layers,
                            json_t *sizes) {
  json_t *designs = json_array();
  for (int layer = 1; layer <= layers; layer++) {
    json_int_t size = 0;
    for (size_t i = 0; i < field->members; i++) {
      if (field->front[i] != layer) {
        continue;
      }
      json_t *one = analysis_member(table, field->row[i]), *values = json_array();
      for (size_t k = 0; k < field->count; k++) {
        json_array_append_new(values, analysis_number(sign_of(&field->objectives[k]) *
                                                      field->y[i * field->count + k]));
      }
      json_object_set_new(one, "layer", json_integer(layer));
      json_object_set_new(one, "values", values);
      json_array_append_new(designs, one);
      size++;
    }
    if (size == 0) {
      break;
    }
    json_array_append_new(sizes, json_integer(size));
  }
  return designs;
}

enum status analysis_pareto(const struct study_table *table, const struct criterion *objectives,
                            size_t count, int layers, json_t **answer, struct error *error) {
  struct field field = {.objectives = objectives, .count = count};
  struct volume volume;
  *answer = NULL;
  enum status status = field_gather(table, &field) ? STATUS_OK : analysis_made(NULL, error);
  if (status == STATUS_OK) {
    status = pareto_fronts(field.y, field.members, (int)count, field.front, error);
  }
  if (status == STATUS_OK) {
    status = measure_volume(&field, &volume, error);
  }
  if (status == STATUS_OK) {
    json_t *sizes = json_array(), *designs = designs_view(table, &field, layers, sizes);
    *answer = json_pack(
        "{s:o, s:{s:o, s:o, s:b, s:o}, s:I, s:I, s:o, s:o}", "objectives",
        objectives_view(table, &field), "hypervolume", "value", analysis_number(volume.value),
        "share", analysis_number(volume.share), "exact", volume.exact, "standard_error",
        analysis_number(volume.error), "compared", (json_int_t)field.members, "excluded",
        (json_int_t)(table->members - field.members), "layers", sizes, "designs", designs);
    status = analysis_made(*answer, error);
  }
  field_clear(&field);
  return status;
}
