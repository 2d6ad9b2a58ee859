#include "server/study/criteria.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"

enum { KEY_MAX = 200 };

/* ---- columns ------------------------------------------------------------------------------ */

static size_t column_find(const struct study_column *columns, size_t count, const char *key) {
  size_t at = 0;
  while (at < count && strcmp(columns[at].key, key) != 0) {
    at++;
  }
  return at;
}

/* The refusal of a key that none of the columns has. */
static enum status unknown(const struct study_column *columns, size_t count, const char *what,
                           const char *key, struct error *error) {
  char quoted[80], list[300] = "";
  const char *words[64];
  size_t known = count < 64 ? count : 64, used = 0;
  for (size_t i = 0; i < known; i++) {
    words[i] = columns[i].key;
    int wrote = snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", columns[i].key);
    used += wrote > 0 && used + (size_t)wrote < sizeof list ? (size_t)wrote : 0;
    list[used] = '\0';
  }
  if (!key) {
    return error_set(error, STATUS_INVALID, NULL, "no %s is given\none of %s", what,
                     count ? list : "none: no member has ended yet");
  }
  text_quote(quoted, sizeof quoted, key);
  enum status status = error_set(error, STATUS_INVALID, NULL, "the study has no %s %s\none of %s",
                                 what, quoted, count ? list : "none: no member has ended yet");
  return error_nearest(error, status, text_nearest(key, words, known));
}

enum status criteria_metric(const struct study_table *table, const char *key, size_t *column,
                            struct error *error) {
  *column = key ? column_find(table->metric, table->metrics, key) : table->metrics;
  return *column < table->metrics ? STATUS_OK
                                  : unknown(table->metric, table->metrics, "metric", key, error);
}

enum status criteria_parameter(const struct study_table *table, const char *key, size_t *column,
                               struct error *error) {
  *column = key ? column_find(table->parameter, table->parameters, key) : table->parameters;
  return *column < table->parameters
             ? STATUS_OK
             : unknown(table->parameter, table->parameters, "parameter", key, error);
}

enum status criteria_quantity(const struct study_table *table, const char *key,
                              struct quantity_of *of, struct error *error) {
  of->parameter = key && key[0] == '/';
  enum status status = of->parameter ? criteria_parameter(table, key, &of->column, error)
                                     : criteria_metric(table, key, &of->column, error);
  if (status == STATUS_OK && of->parameter && table->parameter[of->column].categorical) {
    status = error_set(error, STATUS_INVALID, NULL,
                       "the parameter %.100s has words as values\na parameter with numbers", key);
  }
  return status;
}

double quantity_value(const struct study_table *table, struct quantity_of of, size_t row) {
  if (of.parameter) {
    return table->value[row * table->parameters + of.column];
  }
  return row_counts(table, row) ? table->result[row * table->metrics + of.column] : NAN;
}

const struct study_column *quantity_column(const struct study_table *table, struct quantity_of of) {
  return of.parameter ? &table->parameter[of.column] : &table->metric[of.column];
}

bool row_counts(const struct study_table *table, size_t row) {
  return table->state[row] == JOB_STATE_SUCCEEDED;
}

/* ---- texts -------------------------------------------------------------------------------- */

/* Copies what stands before the next `stop` into `part` and moves *rest behind it. False when it is
 * empty or too long. */
static bool take_part(const char **rest, const char *stop, char part[KEY_MAX]) {
  size_t length = strcspn(*rest, stop);
  if (length == 0 || length >= KEY_MAX) {
    return false;
  }
  memcpy(part, *rest, length);
  part[length] = '\0';
  *rest += length;
  return true;
}

/* A finite number that ends at a comma or the end. */
static bool take_number(const char **rest, double *number) {
  char *end;
  if (strchr(" \t\n,", **rest)) {
    return false;
  }
  *number = strtod(*rest, &end);
  bool good = end != *rest && (*end == ',' || *end == '\0') && isfinite(*number);
  *rest = end;
  return good;
}

static enum status malformed(const char *text, const char *allowed, struct error *error) {
  char quoted[120];
  return error_set(error, STATUS_INVALID, NULL, "%s cannot be read\n%s",
                   text_quote(quoted, sizeof quoted, text), allowed);
}

enum status criteria_read(const struct study_table *table, const char *text,
                          struct criterion criteria[CRITERIA_MAX], size_t *count,
                          struct error *error) {
  static const char allowed[] =
      "1 to 10 different metrics as max:KEY or min:KEY, each with a number behind another colon if "
      "wanted, separated by commas, as in max:bending_angle_deg:0.4,min:mass_g:0.6";
  const char *rest = text ? text : "";
  char key[KEY_MAX];
  *count = 0;
  for (;; rest++) {
    bool maximise = strncmp(rest, "max:", 4) == 0;
    if (*count == CRITERIA_MAX || (!maximise && strncmp(rest, "min:", 4) != 0)) {
      return malformed(text ? text : "", allowed, error);
    }
    struct criterion *criterion = &criteria[*count];
    *criterion = (struct criterion){.maximise = maximise, .number = NAN};
    rest += 4;
    if (!take_part(&rest, ":,", key) ||
        (*rest == ':' && (rest++, !take_number(&rest, &criterion->number)))) {
      return malformed(text, allowed, error);
    }
    enum status status = criteria_metric(table, key, &criterion->metric, error);
    if (status != STATUS_OK) {
      return status;
    }
    for (size_t i = 0; i < *count; i++) {
      if (criteria[i].metric == criterion->metric) {
        return malformed(text, allowed, error);
      }
    }
    ++*count;
    if (*rest == '\0') {
      return STATUS_OK;
    }
  }
}

enum status conditions_read(const struct study_table *table, const char *text,
                            struct condition conditions[CONDITIONS_MAX], size_t *count,
                            struct error *error) {
  static const char allowed[] =
      "up to 8 limits on metrics, or on parameters by their pointers, in the units in which they "
      "are shown, as in bending_angle_deg>=60,/actuator/side_wall<=2";
  const char *rest = text ? text : "";
  char key[KEY_MAX];
  *count = 0;
  for (; *rest; rest += *rest == ',') {
    struct condition *condition = &conditions[*count];
    if (*count == CONDITIONS_MAX || !take_part(&rest, "<>,", key) || *rest == '\0' ||
        rest[1] != '=') {
      return malformed(text, allowed, error);
    }
    condition->at_least = *rest == '>';
    rest += 2;
    if (!take_number(&rest, &condition->limit)) {
      return malformed(text, allowed, error);
    }
    enum status status = criteria_quantity(table, key, &condition->of, error);
    if (status != STATUS_OK) {
      return status;
    }
    ++*count;
  }
  return STATUS_OK;
}
