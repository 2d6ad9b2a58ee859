#include "server/http/compare.h"

#include <string.h>

#include "server/http/handlers.h"

struct comparison {
  struct job_record records[COMPARE_MAX];
  json_t *parameters[COMPARE_MAX]; /* pointer -> { value, text, unit } */
  size_t count;
};

static void comparison_clear(struct comparison *comparison) {
  for (size_t i = 0; i < comparison->count; i++) {
    job_record_clear(&comparison->records[i]);
    json_decref(comparison->parameters[i]);
  }
}

static enum status comparison_read(struct store *store, const int64_t *ids, size_t count,
                                   struct comparison *comparison, struct error *error) {
  comparison->count = 0;
  for (size_t i = 0; i < count; i++) {
    enum status status = store_job(store, ids[i], &comparison->records[i], error);
    if (status != STATUS_OK) {
      return status;
    }
    comparison->parameters[i] = NULL;
    comparison->count++;
    status = store_parameters(store, ids[i], &comparison->parameters[i], error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* Whether a parameter is not the same in all jobs. Quantities are compared by their SI value, so
 * that "1.5 mm" and "0.0015 m" agree. */
static bool parameter_differs(const struct comparison *comparison, const char *pointer) {
  const json_t *first = json_object_get(comparison->parameters[0], pointer);
  for (size_t i = 1; i < comparison->count; i++) {
    const json_t *other = json_object_get(comparison->parameters[i], pointer);
    const json_t *a = json_object_get(first, "value"), *b = json_object_get(other, "value");
    if (!first != !other) {
      return true;
    }
    if (json_is_number(a) && json_is_number(b)) {
      if (json_number_value(a) != json_number_value(b)) {
        return true;
      }
    } else if (first && !json_equal(first, other)) {
      return true;
    }
  }
  return false;
}

/* One row: the values of a parameter in every job, null where a job leaves it to its default. */
static json_t *parameter_row(const struct comparison *comparison, const char *pointer) {
  json_t *values = json_array(), *texts = json_array();
  const char *unit = "";
  for (size_t i = 0; i < comparison->count; i++) {
    json_t *cell = json_object_get(comparison->parameters[i], pointer);
    json_t *value = json_object_get(cell, "value"), *text = json_object_get(cell, "text");
    json_array_append(values, json_is_number(value) ? value : text ? text : json_null());
    json_array_append(texts, text ? text : json_null());
    if (cell && json_string_value(json_object_get(cell, "unit"))[0]) {
      unit = json_string_value(json_object_get(cell, "unit"));
    }
  }
  return json_pack("{s:s, s:s, s:o, s:o}", "pointer", pointer, "unit", unit, "values", values,
                   "texts", texts);
}

static json_t *parameters_view(const struct comparison *comparison, bool differing) {
  json_t *rows = json_array(), *seen = json_object();
  for (size_t i = 0; i < comparison->count; i++) {
    const char *pointer;
    json_t *cell;
    json_object_foreach(comparison->parameters[i], pointer, cell) {
      if (!json_object_get(seen, pointer)) {
        json_object_set_new(seen, pointer, json_true());
        if (parameter_differs(comparison, pointer) == differing) {
          json_array_append_new(rows, parameter_row(comparison, pointer));
        }
      }
    }
  }
  json_decref(seen);
  return rows;
}

static json_t *metrics_view(const struct comparison *comparison) {
  json_t *rows = json_array(), *names = json_object();
  for (size_t i = 0; i < comparison->count; i++) {
    json_object_update_missing(names, comparison->records[i].metrics);
  }
  const char *name;
  json_t *ignored;
  json_object_foreach(names, name, ignored) {
    json_t *values = json_array();
    for (size_t i = 0; i < comparison->count; i++) {
      json_t *value = json_object_get(comparison->records[i].metrics, name);
      json_array_append(values, value ? value : json_null());
    }
    json_array_append_new(rows, json_pack("{s:s, s:o}", "name", name, "values", values));
  }
  json_decref(names);
  return rows;
}

static json_t *jobs_view(const struct comparison *comparison) {
  json_t *jobs = json_array();
  for (size_t i = 0; i < comparison->count; i++) {
    const struct job_record *record = &comparison->records[i];
    json_array_append_new(jobs, json_pack("{s:I, s:s, s:s, s:s, s:s}", "id", (json_int_t)record->id,
                                          "name", record->name, "kind", record->kind, "state",
                                          job_state_word(record->state), "reason_code",
                                          record->reason_code));
  }
  return jobs;
}

enum status compare_read(struct store *store, const int64_t *ids, size_t count, bool all,
                         json_t **view, struct error *error) {
  struct comparison comparison;
  enum status status = comparison_read(store, ids, count, &comparison, error);
  if (status == STATUS_OK) {
    *view = json_pack("{s:o, s:o, s:o}", "jobs", jobs_view(&comparison), "parameters",
                      parameters_view(&comparison, true), "metrics", metrics_view(&comparison));
  }
  if (status == STATUS_OK && all && *view) {
    json_object_set_new(*view, "same", parameters_view(&comparison, false));
  }
  comparison_clear(&comparison);
  return status;
}

void compare_show(struct request *request, struct reply *reply) {
  struct error error;
  int64_t ids[COMPARE_MAX];
  size_t count;
  json_t *view = NULL;
  if (!request_query_jobs(request, reply, "jobs", COMPARE_MAX, ids, &count)) {
    return;
  }
  if (compare_read(request->service->store, ids, count, false, &view, &error) == STATUS_OK) {
    reply_json(reply, 200, view);
  } else {
    reply_error(reply, &error);
  }
}
