#include "server/study/designs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- columns ------------------------------------------------------------------------------ */

static json_t *number_or_null(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

json_t *designs_column(const struct study_column *column, const char *role) {
  json_t *words = json_array();
  for (size_t i = 0; i < column->word_count; i++) {
    json_array_append_new(words, json_string(column->words[i]));
  }
  return json_pack("{s:s, s:s, s:s, s:s, s:b, s:b, s:o, s:o, s:o}", "key", column->key, "title",
                   column->title, "unit", column->unit, "role", role, "categorical",
                   column->categorical, "logarithmic", column->logarithmic, "low",
                   number_or_null(column->low), "high", number_or_null(column->high), "words",
                   words);
}

static json_t *columns_of(const struct study_table *table) {
  json_t *columns = json_array();
  for (size_t k = 0; k < table->parameters; k++) {
    json_array_append_new(columns, designs_column(&table->parameter[k], "parameter"));
  }
  for (size_t k = 0; k < table->metrics; k++) {
    json_array_append_new(columns, designs_column(&table->metric[k], "metric"));
  }
  return columns;
}

static void put_text(FILE *out, const char *text) {
  putc_unlocked('"', out);
  for (const char *c = text; *c; c++) {
    if (*c == '"' || *c == '\\') {
      putc_unlocked('\\', out);
    }
    if ((unsigned char)*c < 0x20) {
      fprintf(out, "\\u%04x", (unsigned)*c);
    } else {
      putc_unlocked(*c, out);
    }
  }
  putc_unlocked('"', out);
}

/* Whole numbers below a million are the most frequent, and take a tenth of the time. */
static void put_number(FILE *out, double value) {
  char text[32];
  if (!isfinite(value)) {
    fputs("null", out);
  } else if (value == trunc(value) && fabs(value) < 1e6) {
    char *at = text + sizeof text - 1;
    unsigned rest = (unsigned)fabs(value);
    *at = '\0';
    do {
      *--at = (char)('0' + rest % 10);
    } while ((rest /= 10) > 0);
    fputs(value < 0 ? "-" : "", out);
    fputs(at, out);
  } else {
    snprintf(text, sizeof text, "%.10g", value);
    fputs(text, out);
  }
}

/* One array with `put` for each row. */
#define PUT_ROWS(out, key, put)                                                                    \
  do {                                                                                             \
    fputs(",\n\"" key "\":[", out);                                                                \
    for (size_t i = 0; i < table->members; i++) {                                                  \
      if (i > 0) {                                                                                 \
        putc_unlocked(',', out);                                                                   \
      }                                                                                            \
      put;                                                                                         \
    }                                                                                              \
    putc_unlocked(']', out);                                                                       \
  } while (0)

static void put_column(FILE *out, const struct study_table *table, const double *values,
                       size_t step, bool first) {
  fputs(first ? "\n[" : ",\n[", out);
  for (size_t i = 0; i < table->members; i++) {
    if (i > 0) {
      putc_unlocked(',', out);
    }
    put_number(out, values[i * step]);
  }
  putc_unlocked(']', out);
}

char *designs_columns(const struct study_table *table, size_t *size) {
  char *text = NULL;
  json_t *columns = columns_of(table);
  FILE *out = columns ? open_memstream(&text, size) : NULL;
  if (!out) {
    json_decref(columns);
    return NULL;
  }
  fprintf(out, "{\"study\":%lld,\"state\":\"%s\",\"columns\":", (long long)table->study_id,
          job_state_word(table->own_state));
  json_dumpf(columns, out, JSON_COMPACT | JSON_REAL_PRECISION(12));
  PUT_ROWS(out, "members", fprintf(out, "%d", table->member[i]));
  PUT_ROWS(out, "jobs", fprintf(out, "%lld", (long long)table->job_id[i]));
  PUT_ROWS(out, "states", put_text(out, job_state_word((enum job_state)table->state[i])));
  PUT_ROWS(out, "reasons", put_text(out, table->reason[i]));
  PUT_ROWS(out, "names", put_text(out, table->member_name[i]));
  fputs(",\n\"values\":[", out);
  for (size_t k = 0; k < table->parameters; k++) {
    put_column(out, table, table->value + k, table->parameters, k == 0);
  }
  for (size_t k = 0; k < table->metrics; k++) {
    put_column(out, table, table->result + k, table->metrics, k + table->parameters == 0);
  }
  fputs("]}\n", out);
  json_decref(columns);
  bool failed = ferror(out);
  if (fclose(out) != 0 || failed) {
    free(text);
    return NULL;
  }
  return text;
}

/* ---- rows --------------------------------------------------------------------------------- */

bool designs_order(const struct study_table *table, const char *key, struct designs_order *order) {
  *order = (struct designs_order){.by = ORDER_MEMBER, .descending = key[0] == '-'};
  key += order->descending;
  if (strcmp(key, "member") == 0) {
    return true;
  }
  if (strcmp(key, "name") == 0 || strcmp(key, "state") == 0) {
    order->by = key[0] == 'n' ? ORDER_NAME : ORDER_STATE;
    return true;
  }
  for (size_t k = 0; k < table->parameters; k++) {
    if (strcmp(table->parameter[k].key, key) == 0) {
      order->by = ORDER_PARAMETER;
      order->column = k;
      return true;
    }
  }
  for (size_t k = 0; k < table->metrics; k++) {
    if (strcmp(table->metric[k].key, key) == 0) {
      order->by = ORDER_METRIC;
      order->column = k;
      return true;
    }
  }
  return false;
}

/* A row and what it is sorted by. */
struct place {
  size_t row;
  double number;
  const char *text;
};

static struct place place_of(const struct study_table *table, const struct designs_order *order,
                             size_t row) {
  struct place place = {.row = row, .number = 0, .text = ""};
  switch (order->by) {
  case ORDER_MEMBER:
    place.number = (double)row;
    break;
  case ORDER_NAME:
    place.text = table->member_name[row];
    break;
  case ORDER_STATE:
    place.text = job_state_word((enum job_state)table->state[row]);
    break;
  case ORDER_PARAMETER:
    place.number = table->value[row * table->parameters + order->column];
    break;
  case ORDER_METRIC:
    place.number = table->result[row * table->metrics + order->column];
    break;
  }
  if (order->descending) {
    place.number = -place.number;
  }
  return place;
}

static int by_row(const struct place *a, const struct place *b) {
  return (a->row > b->row) - (a->row < b->row);
}

static int compare(const void *first, const void *second) {
  const struct place *a = first, *b = second;
  if (isnan(a->number) || isnan(b->number)) {
    int missing = isnan(a->number) - isnan(b->number);
    return missing ? missing : by_row(a, b);
  }
  int order = (a->number > b->number) - (a->number < b->number);
  order = order ? order : strcmp(a->text, b->text);
  return order ? order : by_row(a, b);
}

static int compare_descending(const void *first, const void *second) {
  const struct place *a = first, *b = second;
  int order = strcmp(b->text, a->text);
  return order ? order : compare(first, second);
}

static json_t *cell(const struct study_column *column, double value) {
  if (isfinite(value) && column->categorical) {
    return json_string(column->words[(size_t)value]);
  }
  return number_or_null(value);
}

static json_t *row_view(const struct study_table *table, size_t row) {
  json_t *values = json_object(), *metrics = json_object();
  for (size_t k = 0; k < table->parameters; k++) {
    json_object_set_new(values, table->parameter[k].key,
                        cell(&table->parameter[k], table->value[row * table->parameters + k]));
  }
  for (size_t k = 0; k < table->metrics; k++) {
    double value = table->result[row * table->metrics + k];
    if (isfinite(value)) {
      json_object_set_new(metrics, table->metric[k].key, json_real(value));
    }
  }
  return json_pack("{s:i, s:I, s:s, s:s, s:s, s:o, s:o}", "member", table->member[row], "job",
                   (json_int_t)table->job_id[row], "name", table->member_name[row], "state",
                   job_state_word((enum job_state)table->state[row]), "reason_code",
                   table->reason[row], "values", values, "metrics", metrics);
}

json_t *designs_rows(const struct study_table *table, const struct designs_order *order,
                     size_t from, size_t count) {
  struct place *places = calloc(table->members + 1, sizeof *places);
  json_t *rows = places ? json_array() : NULL;
  for (size_t i = 0; rows && i < table->members; i++) {
    places[i] = place_of(table, order, i);
  }
  if (rows) {
    bool texts = order->by == ORDER_NAME || order->by == ORDER_STATE;
    qsort(places, table->members, sizeof *places,
          texts && order->descending ? compare_descending : compare);
  }
  for (size_t i = from; rows && i < table->members && i - from < count; i++) {
    json_array_append_new(rows, row_view(table, places[i].row));
  }
  free(places);
  return rows;
}
