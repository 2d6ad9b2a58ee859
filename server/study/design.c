#include "server/study/design.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/study/criteria.h"
#include "solver/job/json.h"
#include "solver/job/study.h"

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the job of a design.");
}

/* Whether a value of the study is shown as `word`. */
static bool is_word(const json_t *value, const char *word) {
  if (json_is_string(value)) {
    return strcmp(json_string_value(value), word) == 0;
  }
  char *text = value ? json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT) : NULL;
  bool same = text && strcmp(text, word) == 0;
  free(text);
  return same;
}

/* The value that the study's document gives for a word, borrowed, or NULL. */
static json_t *find_word(const json_t *study, const char *pointer, const char *word) {
  json_t *item, *value;
  size_t i, k;
  json_array_foreach(json_object_get(study, "parameters"), i, item) {
    const char *of = json_string_value(json_object_get(item, "pointer"));
    json_array_foreach(json_object_get(item, "values"), k, value) {
      if (of && strcmp(of, pointer) == 0 && is_word(value, word)) {
        return value;
      }
    }
  }
  json_array_foreach(json_object_get(study, "designs"), i, item) {
    value = json_object_get(json_object_get(item, "set"), pointer);
    if (value && is_word(value, word)) {
      return value;
    }
  }
  return NULL;
}

/* A number as a job has it: with the unit, or as it is. */
static json_t *quantity(double number, const char *unit) {
  char text[80];
  if (unit[0]) {
    snprintf(text, sizeof text, "%.10g %.30s", number, strcmp(unit, "°") == 0 ? "deg" : unit);
    return json_string(text);
  }
  bool whole = number == round(number) && fabs(number) < 1e15;
  return whole ? json_integer((json_int_t)number) : json_real(number);
}

static enum status set_value(json_t *document, const json_t *study, const struct study_table *table,
                             const char *pointer, json_t *given, struct error *error) {
  struct json_pointer at = {.text = ""};
  size_t column;
  json_pointer_key(&at, "values");
  json_pointer_key(&at, pointer);
  enum status status = criteria_parameter(table, pointer, &column, error);
  if (status != STATUS_OK) {
    error_carry(error, at.text, "%s", "");
    return status;
  }
  const struct study_column *of = &table->parameter[column];
  json_t *found = json_is_string(given) && of->categorical
                      ? find_word(study, pointer, json_string_value(given))
                      : NULL;
  json_t *value = json_is_number(given) && !of->categorical
                      ? quantity(json_number_value(given), of->unit)
                      : json_incref(found ? found : given);
  if (!value) {
    return no_memory(error);
  }
  status = study_set(document, pointer, value, error);
  json_decref(value);
  if (status != STATUS_OK) {
    error_carry(error, at.text, "%s", "");
  }
  return status;
}

static enum status set_common(json_t *document, const json_t *study, struct error *error) {
  const char *pointer;
  json_t *value;
  enum status status = STATUS_OK;
  json_object_foreach(json_object_get(study, "set"), pointer, value) {
    status = status == STATUS_OK ? study_set(document, pointer, value, error) : status;
  }
  return status;
}

/* Name and labels; those of the base stay. */
static enum status set_name(json_t *document, const struct study_table *table, const char *name,
                            struct error *error) {
  char id[24];
  snprintf(id, sizeof id, "%" PRId64, table->study_id);
  json_t *labels = json_object_get(document, "labels");
  int failed = json_object_set_new(document, "name", json_string(name));
  if (!json_is_object(labels)) {
    labels = json_object();
    failed |= json_object_set_new(document, "labels", labels);
  }
  failed |= json_object_set_new(labels, "study", json_string(id));
  json_object_del(document, "comment");
  return failed ? no_memory(error) : STATUS_OK;
}

enum status design_document(const json_t *study, const struct study_table *table,
                            const json_t *values, const char *name, json_t **document,
                            struct error *error) {
  const char *pointer;
  json_t *value, *made = json_deep_copy(json_object_get(study, "base"));
  *document = NULL;
  enum status status = made ? set_common(made, study, error) : no_memory(error);
  json_object_foreach((json_t *)values, pointer, value) {
    status = status == STATUS_OK ? set_value(made, study, table, pointer, value, error) : status;
  }
  if (status == STATUS_OK) {
    status = set_name(made, table, name, error);
  }
  if (status != STATUS_OK) {
    json_decref(made);
    return status;
  }
  *document = made;
  return STATUS_OK;
}
