#include "server/study/order.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* A number that other words hardly have (FNV-1a: Fowler, Noll and Vo). */
static double word_number(const char *text) {
  uint64_t hash = 14695981039346656037u;
  for (; *text; text++) {
    hash = (hash ^ (unsigned char)*text) * 1099511628211u;
  }
  return (double)(hash >> 11);
}

/* value[members x columns], and what kind of dimension each column is. */
static enum status read_values(struct columns *columns, const struct study *study, double *value,
                               struct chain_dimension *dimension, struct error *error) {
  size_t count = columns_count(columns);
  struct study_value_row *row = calloc(count + 1, sizeof *row);
  bool good = row != NULL;
  for (size_t k = 0; k < count; k++) {
    struct study_parameter_row parameter;
    columns_parameter(columns, k, &parameter);
    dimension[k] = (struct chain_dimension){.categorical = parameter.categorical,
                                            .logarithmic = parameter.logarithmic};
    dimension[k].categorical = parameter.categorical || !parameter.unit[0];
  }
  for (size_t m = 0; m < study->count && good; m++) {
    good = columns_row(columns, 0, m, row);
    for (size_t k = 0; k < count && good; k++) {
      double *at = &value[m * count + k];
      *at = row[k].text && isnan(row[k].number) ? word_number(row[k].text) : row[k].number;
    }
  }
  free(row);
  return good ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the order of a study.");
}

/* Columns without a unit are those of counts unless some value is no whole number. */
static void find_counts(struct columns *columns, const double *value, size_t members,
                        struct chain_dimension *dimension) {
  size_t count = columns_count(columns);
  for (size_t k = 0; k < count; k++) {
    struct study_parameter_row parameter;
    columns_parameter(columns, k, &parameter);
    for (size_t m = 0; m < members && !parameter.categorical; m++) {
      double at = value[m * count + k];
      dimension[k].categorical = dimension[k].categorical && (isnan(at) || at == floor(at));
    }
  }
}

/* order[]: the members chain by chain. */
static enum status list_members(const struct chain_place *place, size_t members, size_t *order,
                                struct error *error) {
  size_t *start = calloc(members + 2, sizeof *start);
  if (!start) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the order of a study.");
  }
  for (size_t m = 0; m < members; m++) {
    start[place[m].chain + 1]++;
  }
  for (size_t c = 0; c < members; c++) {
    start[c + 1] += start[c];
  }
  for (size_t m = 0; m < members; m++) {
    order[start[place[m].chain] + place[m].position] = m;
  }
  free(start);
  return STATUS_OK;
}

enum status order_members(struct columns *columns, const struct study *study,
                          struct chain_place **place, size_t **order, struct error *error) {
  size_t members = study->count, count = columns_count(columns);
  size_t length = chain_length(members, study->light);
  double *value = malloc(sizeof *value * (members * count + 1));
  struct chain_dimension *dimension = calloc(count + 1, sizeof *dimension);
  *place = calloc(members + 1, sizeof **place);
  *order = calloc(members + 1, sizeof **order);
  enum status status = STATUS_OK;
  if (!value || !dimension || !*place || !*order) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the order of a study.");
  }
  if (status == STATUS_OK && !study->light) {
    status = read_values(columns, study, value, dimension, error);
  }
  if (status == STATUS_OK && !study->light) {
    find_counts(columns, value, members, dimension);
  }
  if (status == STATUS_OK) {
    status =
        chain_order(value, dimension, members, study->light ? 0 : count, length, *place, error);
  }
  if (status == STATUS_OK) {
    status = list_members(*place, members, *order, error);
  }
  free(value);
  free(dimension);
  return status;
}
