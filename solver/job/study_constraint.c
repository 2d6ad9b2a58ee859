#include "solver/job/study_constraint.h"
#include "solver/job/study_optimise.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What follows the number of a quantity. */
static void copy_unit(const char *text, char *unit, size_t size) {
  char *end;
  strtod(text, &end);
  snprintf(unit, size, "%s", end + strspn(end, " "));
}

/* Numbers count as they are. */
static enum status value_of(const struct reader *reader, const json_t *value, const char *unit,
                            double *number) {
  if (json_is_number(value) && !unit[0]) {
    *number = json_number_value(value);
    return STATUS_OK;
  }
  if (!json_is_string(value) || !unit[0]) {
    return error_set(
        reader->error, STATUS_INVALID, "",
        "quantities with units stand beside plain numbers\nlimits and parameters of a constraint "
        "are all quantities with units, or all numbers");
  }
  return units_read(reader->units, json_string_value(value), unit, number, reader->error);
}

static enum status read_limits(const struct reader *reader, const json_t *value,
                               struct study_constraint *constraint) {
  const json_t *low = json_object_get(value, "at_least"), *high = json_object_get(value, "at_most");
  const json_t *any = low ? low : high;
  enum status status = STATUS_OK;
  *constraint = (struct study_constraint){.low = -INFINITY, .high = INFINITY};
  if (!any) {
    return error_set(reader->error, STATUS_INVALID, "",
                     "a constraint without a limit\n\"at_least\" or \"at_most\"\n{\"sum\": "
                     "{\"/actuator/top_wall\": 1}, \"at_most\": \"3 mm\"}");
  }
  if (json_is_string(any)) {
    copy_unit(json_string_value(any), constraint->unit, sizeof constraint->unit);
  }
  if (low) {
    status = value_of(reader, low, constraint->unit, &constraint->low);
  }
  if (status == STATUS_OK && high) {
    status = value_of(reader, high, constraint->unit, &constraint->high);
  }
  return status;
}

/* The place of a pointer among the parameters, their number for none. */
static size_t find_parameter(const json_t *parameters, const char *pointer) {
  size_t k = 0;
  while (k < json_array_size(parameters) &&
         strcmp(json_string_value(json_object_get(json_array_get(parameters, k), "pointer")),
                pointer) != 0) {
    k++;
  }
  return k;
}

static enum status read_one(const struct reader *reader, const json_t *parameters,
                            const json_t *value, struct study_constraint *constraint) {
  const char *pointer;
  json_t *factor;
  enum status status = read_limits(reader, value, constraint);
  if (status == STATUS_OK && json_object_get(value, "metric")) { /* see study_objective.h */
    *constraint = (struct study_constraint){.low = -INFINITY, .high = INFINITY};
    return STATUS_OK;
  }
  json_object_foreach(json_object_get(value, "sum"), pointer, factor) {
    size_t k = find_parameter(parameters, pointer);
    if (status == STATUS_OK && k == json_array_size(parameters)) {
      status = error_set(reader->error, STATUS_INVALID, "",
                         "%s is no parameter of this study\na sum takes the pointers under "
                         "\"parameters\"",
                         pointer);
    } else if (status == STATUS_OK) {
      constraint->factor[k] = json_number_value(factor);
    }
  }
  return status;
}

/* What is limited: a sum, or of a search a metric. */
static enum status check_form(const struct reader *reader, const json_t *document,
                              const json_t *value) {
  bool sum = json_object_get(value, "sum"), metric = json_object_get(value, "metric");
  if (metric && !study_is_search(document)) {
    return error_set(reader->error, STATUS_INVALID, "",
                     "metrics are not known before the members are solved\nlimits on metrics go "
                     "with the sampling \"optimise\"");
  }
  if (sum == metric || (!metric && json_object_get(value, "at_pressure"))) {
    return error_set(
        reader->error, STATUS_INVALID, "",
        "what is limited is not said, or said twice\neither a sum of parameters, or a "
        "metric with its pressure\n{\"metric\": \"bending_angle_deg\", \"at_least\": 60}");
  }
  return STATUS_OK;
}

/* The error belongs to the constraint. */
static enum status at_constraint(const struct reader *reader, size_t index, enum status status) {
  snprintf(reader->error->pointer, sizeof reader->error->pointer, "/constraints/%zu", index);
  return status;
}

enum status study_constraints_read(const struct reader *reader, const json_t *document,
                                   struct study_constraints *constraints) {
  const json_t *parameters = json_object_get(document, "parameters");
  const json_t *given = json_object_get(document, "constraints");
  *constraints = (struct study_constraints){.count = json_array_size(given),
                                            .parameters = json_array_size(parameters)};
  for (size_t i = 0; i < constraints->count; i++) {
    enum status status = check_form(reader, document, json_array_get(given, i));
    if (status == STATUS_OK) {
      status = read_one(reader, parameters, json_array_get(given, i), &constraints->constraint[i]);
    }
    if (status != STATUS_OK) {
      return at_constraint(reader, i, status);
    }
  }
  return STATUS_OK;
}

enum status study_constraints_check(const struct study_constraints *constraints,
                                    const struct reader *reader, json_t *const *lists, bool *met) {
  *met = true;
  for (size_t i = 0; i < constraints->count && *met; i++) {
    const struct study_constraint *constraint = &constraints->constraint[i];
    double sum = 0.0, number = 0.0;
    for (size_t k = 0; k < constraints->parameters; k++) {
      if (constraint->factor[k] == 0.0) {
        continue;
      }
      const json_t *last = json_array_get(lists[k], json_array_size(lists[k]) - 1);
      enum status status = value_of(reader, last, constraint->unit, &number);
      if (status != STATUS_OK) {
        return at_constraint(reader, i, status);
      }
      sum += constraint->factor[k] * number;
    }
    *met = constraint->low <= sum && sum <= constraint->high;
  }
  return STATUS_OK;
}
