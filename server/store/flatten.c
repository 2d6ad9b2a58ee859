#include "server/store/flatten.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/store/sql.h"
#include "solver/base/units.h"
#include "solver/job/json.h"

/* A dimension met in jobs: a unit of it, and the SI unit in which its values are stored. */
static const struct {
  const char *unit, *si;
} dimensions[] = {
    {"mm", "m"},       {"kPa", "Pa"},    {"deg", "rad"},   {"kg/m3", "kg m-3"},
    {"m/s2", "m s-2"}, {"s", "s"},       {"Hz", "s-1"},    {"N", "N"},
    {"kg", "kg"},      {"m/s", "m s-1"}, {"N/m", "N m-1"}, {"N s/m", "N s m-1"},
    {"N/Pa", "m2"},    {"m3", "m3"},     {"J", "J"},       {"K", "K"},
};

struct flattening {
  const struct units *units;
  parameter_take *take;
  void *context;
  struct error *error;
  char pointer[512];
};

/* Whether text is a quantity; its value and the name of its SI unit. */
static bool quantity_read(const struct units *units, const char *text, double *value,
                          const char **si) {
  if (strspn(text, "+-.0123456789") == 0) {
    return false;
  }
  for (size_t i = 0; i < sizeof dimensions / sizeof *dimensions; i++) {
    if (units_read(units, text, dimensions[i].unit, value, NULL) == STATUS_OK) {
      *si = dimensions[i].si;
      return true;
    }
  }
  return false;
}

/* 0.9 as it was written, not 0.90000000000000002; what reads back as another number gets all its
 * digits. */
static void write_shortest(double value, char *text, size_t size) {
  snprintf(text, size, "%.15g", value);
  if (strtod(text, NULL) != value) {
    snprintf(text, size, "%.17g", value);
  }
}

static enum status flatten_leaf(struct flattening *to, const json_t *leaf) {
  char number[32];
  struct parameter parameter = {
      .pointer = to->pointer, .text = number, .unit = "", .has_value = true};
  if (json_is_string(leaf)) {
    parameter.text = json_string_value(leaf);
    parameter.has_value =
        quantity_read(to->units, parameter.text, &parameter.value, &parameter.unit);
  } else if (json_is_integer(leaf)) {
    parameter.value = (double)json_integer_value(leaf);
    snprintf(number, sizeof number, "%lld", (long long)json_integer_value(leaf));
  } else if (json_is_real(leaf)) {
    parameter.value = json_real_value(leaf);
    write_shortest(parameter.value, number, sizeof number);
  } else {
    parameter.value = json_is_true(leaf);
    parameter.has_value = json_is_boolean(leaf);
    parameter.text = json_is_true(leaf) ? "true" : json_is_false(leaf) ? "false" : "null";
  }
  return to->take(to->context, &parameter, to->error);
}

/* Appends "/key" with ~ and / escaped (RFC 6901); false when the pointer gets too long. */
static bool pointer_push(struct flattening *to, const char *key) {
  size_t used = strlen(to->pointer), room = sizeof to->pointer - 3;
  if (used >= room) {
    return false;
  }
  to->pointer[used++] = '/';
  for (; *key; key++) {
    if (used >= room) {
      return false;
    }
    if (*key == '~' || *key == '/') {
      to->pointer[used++] = '~';
      to->pointer[used++] = *key == '~' ? '0' : '1';
    } else {
      to->pointer[used++] = *key;
    }
  }
  to->pointer[used] = '\0';
  return true;
}

static enum status flatten_value(struct flattening *to, const json_t *value);

static enum status flatten_child(struct flattening *to, const char *key, const json_t *child) {
  size_t used = strlen(to->pointer);
  enum status status = STATUS_OK;
  if (pointer_push(to, key)) {
    status = flatten_value(to, child);
  }
  to->pointer[used] = '\0';
  return status;
}

/* Whether a member of the document is no parameter: what is about people, and about the queue. */
static bool key_is_remark(const char *key) {
  static const char *const remarks[] = {"name", "labels", "memory", "priority", "reuse"};
  bool remark = false;
  for (size_t i = 0; i < sizeof remarks / sizeof *remarks; i++) {
    remark = remark || strcmp(key, remarks[i]) == 0;
  }
  return remark;
}

/* The parser has bounded the depth of the document, and with it this recursion. */
static enum status flatten_value(struct flattening *to, const json_t *value) {
  enum status status = STATUS_OK;
  if (json_is_object(value)) {
    const char *key;
    json_t *child;
    json_object_foreach((json_t *)value, key, child) {
      bool remark = to->pointer[0] == '\0' && key_is_remark(key);
      bool table = strcmp(key, "csv") == 0; /* data, no parameter: the job's document has it */
      if (!remark && !table && status == STATUS_OK) {
        status = flatten_child(to, key, child);
      }
    }
  } else if (json_is_array(value)) {
    for (size_t i = 0; i < json_array_size(value) && status == STATUS_OK; i++) {
      char index[24];
      snprintf(index, sizeof index, "%zu", i);
      status = flatten_child(to, index, json_array_get(value, i));
    }
  } else {
    status = flatten_leaf(to, value);
  }
  return status;
}

enum status flatten_each(const char *document, const struct units *units, parameter_take *take,
                         void *context, struct error *error) {
  struct flattening to = {.units = units, .take = take, .context = context, .error = error};
  json_t *root = json_read(document, strlen(document), 0, NULL);
  if (!root) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a job document.");
  }
  enum status status = flatten_value(&to, root);
  json_decref(root);
  return status;
}

/* ---- into the database ------------------------------------------------------------------- */

struct insertion {
  sqlite3_stmt *insert;
  int64_t job_id;
};

static enum status parameter_insert(void *context, const struct parameter *parameter,
                                    struct error *error) {
  const struct insertion *insertion = context;
  sqlite3_stmt *insert = insertion->insert;
  sqlite3_reset(insert);
  sqlite3_bind_int64(insert, 1, insertion->job_id);
  sqlite3_bind_text(insert, 2, parameter->pointer, -1, SQLITE_STATIC);
  if (parameter->has_value) {
    sqlite3_bind_double(insert, 3, parameter->value);
  } else {
    sqlite3_bind_null(insert, 3);
  }
  sqlite3_bind_text(insert, 4, parameter->text, -1, SQLITE_STATIC);
  sqlite3_bind_text(insert, 5, parameter->unit, -1, SQLITE_STATIC);
  int row;
  return sql_step(insert, &row, error);
}

enum status flatten_store(sqlite3 *db, int64_t job_id, const struct units *units,
                          struct error *error) {
  struct insertion insertion = {.job_id = job_id};
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(db, &statement, error, "SELECT document FROM job WHERE id = ?", "i", job_id);
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    status =
        sql_prepare(db, &insertion.insert, error,
                    "INSERT OR REPLACE INTO design_parameter (job_id, pointer, value, text, unit) "
                    "VALUES (?, ?, ?, ?, ?)",
                    "");
    if (status == STATUS_OK) {
      status = flatten_each(sql_text(statement, 0), units, parameter_insert, &insertion, error);
      sql_done(insertion.insert);
    }
  }
  sql_done(statement);
  return status;
}
