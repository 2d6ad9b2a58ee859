#include "server/study/columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/quantity.h"

enum { COLUMNS_MAX = 64 };

struct column {
  const char *pointer, *name;
  char unit[QUANTITY_UNIT];  /* as shown */
  char given[QUANTITY_UNIT]; /* as jobs are written */
  double per_si;             /* of the unit; 0: plain numbers */
  bool categorical, logarithmic;
  double low, high;
};

struct columns {
  const struct units *units;
  const struct study *study;
  json_t *base; /* with what every member has */
  size_t count;
  struct column column[COLUMNS_MAX];
  char *text[COLUMNS_ROWS][COLUMNS_MAX];
};

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the parameters of a study.");
}

void columns_destroy(struct columns *columns) {
  if (!columns) {
    return;
  }
  for (size_t row = 0; row < COLUMNS_ROWS; row++) {
    for (size_t k = 0; k < columns->count; k++) {
      free(columns->text[row][k]);
    }
  }
  json_decref(columns->base);
  free(columns);
}

/* ---- values ------------------------------------------------------------------------------- */

/* The value that a pointer (RFC 6901) names, or NULL. */
static json_t *value_at(json_t *value, const char *pointer) {
  while (value && *pointer == '/') {
    char part[128];
    size_t length = 0;
    for (pointer++; *pointer && *pointer != '/' && length + 1 < sizeof part; pointer++) {
      bool escape = pointer[0] == '~' && (pointer[1] == '0' || pointer[1] == '1');
      part[length++] = escape ? pointer[1] == '1' ? '/' : '~' : *pointer;
      pointer += escape;
    }
    part[length] = '\0';
    if (json_is_array(value)) {
      value = json_array_get(value, strtoul(part, NULL, 10));
    } else {
      value = json_object_get(value, part);
    }
  }
  return value;
}

static json_t *member_value(const struct columns *columns, size_t member, size_t k) {
  const char *pointer = columns->column[k].pointer;
  json_t *value = json_object_get(columns->study->member[member].values, pointer);
  return value ? value : value_at(columns->base, pointer);
}

/* The unit as it is written in a value: what follows its number. */
static void unit_given(const json_t *value, char unit[QUANTITY_UNIT]) {
  char *end = NULL;
  const char *text = json_string_value(value);
  unit[0] = '\0';
  if (text) {
    strtod(text, &end);
    end += strspn(end, " ");
    snprintf(unit, QUANTITY_UNIT, "%s", end);
  }
}

/* The number of a value in the unit of its column; NaN when it is none. */
static double number_of(const struct columns *columns, const struct column *column,
                        const json_t *value) {
  char unit[QUANTITY_UNIT];
  double number, si;
  if (!quantity_read(value, &number, unit)) {
    return NAN;
  }
  if (column->per_si == 0 || !json_is_string(value)) {
    return column->per_si == 0 && !json_is_string(value) ? number : NAN;
  }
  if (strcmp(unit, column->unit) == 0) {
    return number;
  }
  return units_read(columns->units, json_string_value(value), column->given, &si, NULL) == STATUS_OK
             ? si * column->per_si
             : NAN;
}

/* ---- columns ------------------------------------------------------------------------------ */

static enum status column_add(struct columns *columns, const char *pointer, const char *name,
                              struct error *error) {
  const char *slash = strrchr(pointer, '/');
  for (size_t k = 0; k < columns->count; k++) {
    if (strcmp(columns->column[k].pointer, pointer) == 0) {
      return STATUS_OK;
    }
  }
  if (columns->count == COLUMNS_MAX) { /* more than a member can have of parameters */
    return STATUS_OK;
  }
  columns->column[columns->count++] = (struct column){.pointer = pointer,
                                                      .name = name    ? name
                                                              : slash ? slash + 1
                                                                      : pointer,
                                                      .low = NAN,
                                                      .high = NAN};
  return columns->base ? STATUS_OK : no_memory(error);
}

static enum status columns_list(struct columns *columns, const json_t *document,
                                struct error *error) {
  const json_t *parameters = json_object_get(document, "parameters");
  enum status status = STATUS_OK;
  json_t *parameter, *value;
  const char *pointer;
  size_t i;
  json_array_foreach(parameters, i, parameter) {
    if (status == STATUS_OK) {
      status = column_add(columns, json_string_value(json_object_get(parameter, "pointer")),
                          json_string_value(json_object_get(parameter, "name")), error);
    }
  }
  for (i = 0; !parameters && i < columns->study->count; i++) {
    json_object_foreach(columns->study->member[i].values, pointer, value) {
      if (status == STATUS_OK) {
        status = column_add(columns, pointer, NULL, error);
      }
    }
  }
  return status;
}

/* Takes the unit from the first value that is there. */
static void column_unit(struct columns *columns, size_t k) {
  struct column *column = &columns->column[k];
  char sentence[QUANTITY_UNIT + 4];
  double number, si;
  column->categorical = true;
  for (size_t i = 0; i < columns->study->count; i++) {
    const json_t *value = member_value(columns, i, k);
    if (!value || json_is_null(value)) {
      continue;
    }
    column->categorical = !quantity_read(value, &number, column->unit);
    if (!column->categorical && json_is_string(value)) {
      unit_given(value, column->given);
      snprintf(sentence, sizeof sentence, "1 %s", column->given);
      column->categorical =
          units_read(columns->units, sentence, column->given, &si, NULL) != STATUS_OK || si <= 0;
      column->per_si = column->categorical ? 0 : 1 / si;
    }
    break;
  }
}

/* Finds whether all values are numbers, and their range. */
static void column_read(struct columns *columns, size_t k) {
  struct column *column = &columns->column[k];
  column_unit(columns, k);
  for (size_t i = 0; i < columns->study->count && !column->categorical; i++) {
    const json_t *value = member_value(columns, i, k);
    double number = number_of(columns, column, value);
    column->categorical = value && !json_is_null(value) && isnan(number);
    column->low = fmin(column->low, number);
    column->high = fmax(column->high, number);
  }
  if (column->categorical) {
    column->low = column->high = NAN;
    column->unit[0] = '\0';
  }
}

/* Ranges that the document gives are wider than the values in them. */
static void column_range(struct columns *columns, size_t k, const json_t *parameter) {
  struct column *column = &columns->column[k];
  const json_t *from = json_object_get(parameter, "from"), *to = json_object_get(parameter, "to");
  const char *scale = json_string_value(json_object_get(parameter, "scale"));
  column->logarithmic = scale && strcmp(scale, "log") == 0;
  if (from && to && !column->categorical) {
    double low = number_of(columns, column, from), high = number_of(columns, column, to);
    column->low = isnan(low) ? column->low : low;
    column->high = isnan(high) ? column->high : high;
  }
}

enum status columns_create(const struct units *units, const json_t *document,
                           const struct study *study, struct columns **columns,
                           struct error *error) {
  struct columns *made = calloc(1, sizeof *made);
  const json_t *parameters = json_object_get(document, "parameters");
  const char *pointer;
  json_t *value;
  *columns = NULL;
  if (!made) {
    return no_memory(error);
  }
  *made = (struct columns){
      .units = units, .study = study, .base = json_deep_copy(json_object_get(document, "base"))};
  enum status status = made->base ? STATUS_OK : no_memory(error);
  json_object_foreach(json_object_get(document, "set"), pointer, value) {
    if (status == STATUS_OK) {
      status = study_set(made->base, pointer, value, error);
    }
  }
  if (status == STATUS_OK) {
    status = columns_list(made, document, error);
  }
  for (size_t k = 0; k < made->count && status == STATUS_OK; k++) {
    column_read(made, k);
    column_range(made, k, json_array_get(parameters, k));
  }
  if (status != STATUS_OK) {
    columns_destroy(made);
    return status;
  }
  *columns = made;
  return STATUS_OK;
}

size_t columns_count(const struct columns *columns) {
  return columns->count;
}

void columns_parameter(const struct columns *columns, size_t index,
                       struct study_parameter_row *parameter) {
  const struct column *column = &columns->column[index];
  *parameter = (struct study_parameter_row){.pointer = column->pointer,
                                            .name = column->name,
                                            .unit = column->unit,
                                            .categorical = column->categorical,
                                            .logarithmic = column->logarithmic,
                                            .low = column->low,
                                            .high = column->high};
}

bool columns_row(struct columns *columns, size_t row, size_t member,
                 struct study_value_row *values) {
  for (size_t k = 0; k < columns->count; k++) {
    json_t *value = member_value(columns, member, k);
    char **text = &columns->text[row][k];
    free(*text);
    *text = NULL;
    values[k] = (struct study_value_row){.number = NAN};
    if (value && !json_is_null(value)) {
      *text = json_is_string(value)
                  ? strdup(json_string_value(value))
                  : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(12));
      if (!*text) {
        return false;
      }
      values[k].text = *text;
      values[k].number =
          columns->column[k].categorical ? NAN : number_of(columns, &columns->column[k], value);
    }
  }
  return true;
}
