#include "server/study/table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/quantity.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

enum { METRICS_MAX = 1000, TITLE_SIZE = 120 };

/* A table in the making. */
struct making {
  sqlite3 *db;
  struct study_table *table;
  size_t room;  /* of rows */
  int *row_of;  /* by member: its row, or -1 */
  size_t count; /* of row_of */
};

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the table of a study.");
}

static void column_clear(struct study_column *column) {
  for (size_t i = 0; i < column->word_count; i++) {
    free(column->words[i]);
  }
  free(column->words);
  free(column->key);
  free(column->title);
  free(column->unit);
}

void study_table_destroy(struct study_table *table) {
  if (!table) {
    return;
  }
  for (size_t k = 0; k < table->parameters; k++) {
    column_clear(&table->parameter[k]);
  }
  for (size_t k = 0; k < table->metrics; k++) {
    column_clear(&table->metric[k]);
  }
  for (size_t i = 0; i < table->members; i++) {
    free(table->reason[i]);
    free(table->member_name[i]);
  }
  free(table->parameter);
  free(table->metric);
  free(table->member);
  free(table->job_id);
  free(table->state);
  free(table->reason);
  free(table->member_name);
  free(table->value);
  free(table->result);
  free(table->name);
  free(table->sampling);
  free(table);
}

/* Runs a query whose only parameter is the study and hands each row to take(). */
static enum status rows(struct making *making, const char *sql,
                        enum status (*take)(struct making *, sqlite3_stmt *, struct error *),
                        struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status =
      sql_prepare(making->db, &statement, error, sql, "i", making->table->study_id);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    status = take(making, statement, error);
  }
  sql_done(statement);
  return status;
}

/* ---- the study ---------------------------------------------------------------------------- */

static enum status take_study(struct making *making, sqlite3_stmt *row, struct error *error) {
  struct study_table *table = making->table;
  if (strcmp(sql_text(row, 0), "study") != 0 ||
      !job_state_parse(sql_text(row, 2), &table->own_state)) {
    return STATUS_OK;
  }
  table->name = sql_text_copy(row, 1);
  table->sampling = sql_text_copy(row, 3);
  table->wanted = (size_t)sqlite3_column_int64(row, 4);
  return table->name && table->sampling ? STATUS_OK : no_memory(error);
}

static enum status read_study(struct making *making, struct error *error) {
  int64_t id = making->table->study_id;
  enum status status =
      rows(making,
           "SELECT kind, name, state, coalesce(study.sampling, ''), coalesce(study.members, 0) "
           "FROM job LEFT JOIN study ON study.study_id = job.id WHERE job.id = ?",
           take_study, error);
  if (status == STATUS_OK && !making->table->name) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "There is no study %lld.", (long long)id);
  }
  return status;
}

/* ---- its members -------------------------------------------------------------------------- */

static bool grow(void *array, size_t room, size_t size) {
  void **place = array, *grown = realloc(*place, room * size);
  if (grown) {
    *place = grown;
  }
  return grown != NULL;
}

static bool make_room(struct making *making) {
  struct study_table *table = making->table;
  size_t room = 2 * making->room + 64;
  if (table->members < making->room) {
    return true;
  }
  making->room = room;
  return grow(&table->member, room, sizeof *table->member) &&
         grow(&table->job_id, room, sizeof *table->job_id) &&
         grow(&table->state, room, sizeof *table->state) &&
         grow(&table->reason, room, sizeof *table->reason) &&
         grow(&table->member_name, room, sizeof *table->member_name);
}

static enum status take_member(struct making *making, sqlite3_stmt *row, struct error *error) {
  struct study_table *table = making->table;
  enum job_state state = JOB_STATE_QUEUED;
  if (!make_room(making)) {
    return no_memory(error);
  }
  size_t at = table->members++;
  job_state_parse(sql_text(row, 2), &state);
  table->member[at] = sqlite3_column_int(row, 0);
  table->job_id[at] = sqlite3_column_int64(row, 1);
  table->state[at] = (int)state;
  table->reason[at] = sql_text_copy(row, 3);
  table->member_name[at] = sql_text_copy(row, 4);
  return table->reason[at] && table->member_name[at] ? STATUS_OK : no_memory(error);
}

static enum status read_members(struct making *making, struct error *error) {
  struct study_table *table = making->table;
  enum status status = rows(making,
                            "SELECT member, id, state, "
                            "iif(state = 'succeeded', '', reason_code), name FROM job "
                            "WHERE study_id = ? ORDER BY member",
                            take_member, error);
  if (status != STATUS_OK || table->members == 0) {
    return status;
  }
  making->count = (size_t)table->member[table->members - 1] + 1;
  making->row_of = malloc(making->count * sizeof *making->row_of);
  if (!making->row_of) {
    return no_memory(error);
  }
  for (size_t m = 0; m < making->count; m++) {
    making->row_of[m] = -1;
  }
  for (size_t i = 0; i < table->members; i++) {
    making->row_of[table->member[i]] = (int)i;
  }
  return STATUS_OK;
}

/* The row of a member, or -1. */
static int row_of(const struct making *making, int64_t member) {
  return member >= 0 && (size_t)member < making->count ? making->row_of[member] : -1;
}

static double *numbers(size_t count) {
  double *list = malloc((count ? count : 1) * sizeof *list);
  for (size_t i = 0; list && i < count; i++) {
    list[i] = NAN;
  }
  return list;
}

/* ---- parameters --------------------------------------------------------------------------- */

static double optional_number(sqlite3_stmt *row, int column) {
  return sqlite3_column_type(row, column) == SQLITE_NULL ? NAN : sqlite3_column_double(row, column);
}

static enum status take_parameter(struct making *making, sqlite3_stmt *row, struct error *error) {
  struct study_table *table = making->table;
  if (!grow(&table->parameter, table->parameters + 1, sizeof *table->parameter)) {
    return no_memory(error);
  }
  struct study_column *column = &table->parameter[table->parameters++];
  *column = (struct study_column){.key = sql_text_copy(row, 0),
                                  .title = sql_text_copy(row, 1),
                                  .unit = sql_text_copy(row, 2),
                                  .categorical = sqlite3_column_int(row, 3) != 0,
                                  .logarithmic = sqlite3_column_int(row, 4) != 0,
                                  .low = optional_number(row, 5),
                                  .high = optional_number(row, 6)};
  return column->key && column->title && column->unit ? STATUS_OK : no_memory(error);
}

/* The index of a word, which is added when it is new; -1 without memory. */
static int word_index(struct study_column *column, const char *text) {
  for (size_t i = 0; i < column->word_count; i++) {
    if (strcmp(column->words[i], text) == 0) {
      return (int)i;
    }
  }
  char *copy = strdup(text);
  if (!copy || !grow(&column->words, column->word_count + 1, sizeof *column->words)) {
    free(copy);
    return -1;
  }
  column->words[column->word_count] = copy;
  return (int)column->word_count++;
}

static enum status take_value(struct making *making, sqlite3_stmt *row, struct error *error) {
  struct study_table *table = making->table;
  int at = row_of(making, sqlite3_column_int64(row, 0));
  int64_t position = sqlite3_column_int64(row, 1);
  if (at < 0 || position < 0 || (size_t)position >= table->parameters) {
    return STATUS_OK;
  }
  struct study_column *column = &table->parameter[position];
  double value = optional_number(row, 2);
  if (column->categorical) {
    int word = word_index(column, sql_text(row, 3));
    if (word < 0) {
      return no_memory(error);
    }
    value = word;
  }
  table->value[(size_t)at * table->parameters + (size_t)position] = value;
  return STATUS_OK;
}

static enum status read_values(struct making *making, struct error *error) {
  struct study_table *table = making->table;
  enum status status =
      rows(making,
           "SELECT pointer, name, unit, categorical, logarithmic, low, high FROM study_parameter "
           "WHERE study_id = ? ORDER BY position",
           take_parameter, error);
  if (status == STATUS_OK && !(table->value = numbers(table->members * table->parameters))) {
    status = no_memory(error);
  }
  if (status == STATUS_OK) {
    status = rows(making,
                  "SELECT member, position, number, text FROM study_value WHERE study_id = ? "
                  "ORDER BY member, position",
                  take_value, error);
  }
  return status;
}

/* ---- metrics ------------------------------------------------------------------------------ */

/* A metric of a member on its way into the table. */
struct figure {
  int row, column;
  double value;
};

struct figures {
  struct figure *list;
  size_t count, room;
};

static enum status column_add(struct study_table *table, const char *key, struct error *error) {
  char title[TITLE_SIZE], unit[QUANTITY_UNIT];
  if (!grow(&table->metric, table->metrics + 1, sizeof *table->metric)) {
    return no_memory(error);
  }
  quantity_name(key, title, sizeof title);
  quantity_unit(key, unit, sizeof unit);
  struct study_column *column = &table->metric[table->metrics++];
  *column = (struct study_column){
      .key = strdup(key), .title = strdup(title), .unit = strdup(unit), .low = NAN, .high = NAN};
  return column->key && column->title && column->unit ? STATUS_OK : no_memory(error);
}

/* The column of a metric: from `from` on, where it is unless members differ in what they have; the
 * number of columns when there is none. */
static size_t column_find(const struct study_table *table, size_t from, const char *key) {
  for (size_t i = 0; i < table->metrics; i++) {
    size_t k = (from + i) % table->metrics;
    if (strcmp(table->metric[k].key, key) == 0) {
      return k;
    }
  }
  return table->metrics;
}

/* Adds one figure; *next: the column that is probably the next one's. */
static enum status figure_add(struct making *making, struct figures *figures, sqlite3_stmt *row,
                              size_t *next, struct error *error) {
  struct study_table *table = making->table;
  int at = row_of(making, sqlite3_column_int64(row, 0));
  const char *key = sql_text(row, 1);
  size_t k = column_find(table, *next, key);
  if (at < 0 || (k == table->metrics && table->metrics == METRICS_MAX)) {
    return STATUS_OK;
  }
  if (k == table->metrics && column_add(table, key, error) != STATUS_OK) {
    return error->status;
  }
  if (figures->count == figures->room) {
    figures->room = 2 * figures->room + 1024;
    if (!grow(&figures->list, figures->room, sizeof *figures->list)) {
      return no_memory(error);
    }
  }
  *next = k + 1;
  figures->list[figures->count++] =
      (struct figure){.row = at, .column = (int)k, .value = sqlite3_column_double(row, 2)};
  return STATUS_OK;
}

static int by_key(const void *a, const void *b) {
  return strcmp(((const struct study_column *)a)->key, ((const struct study_column *)b)->key);
}

/* Puts the columns in the order of their names and the figures into the table. */
static enum status figures_place(struct study_table *table, const struct figures *figures,
                                 struct error *error) {
  size_t count = table->metrics;
  char **found = calloc(count + 1, sizeof *found);
  size_t *place = calloc(count + 1, sizeof *place);
  table->result = numbers(table->members * count);
  bool good = found && place && table->result;
  for (size_t k = 0; good && k < count; k++) {
    found[k] = table->metric[k].key;
  }
  if (good && count > 1) {
    qsort(table->metric, count, sizeof *table->metric, by_key);
  }
  for (size_t k = 0; good && k < count; k++) {
    place[k] = column_find(table, 0, found[k]);
  }
  for (size_t i = 0; good && i < figures->count; i++) {
    const struct figure *figure = &figures->list[i];
    size_t k = place[figure->column];
    table->result[(size_t)figure->row * count + k] = figure->value;
    table->metric[k].low = fmin(table->metric[k].low, figure->value);
    table->metric[k].high = fmax(table->metric[k].high, figure->value);
  }
  free(found);
  free(place);
  return good ? STATUS_OK : no_memory(error);
}

static enum status read_metrics(struct making *making, struct error *error) {
  struct figures figures = {0};
  sqlite3_stmt *statement;
  int row = 0;
  size_t next = 0;
  enum status status =
      sql_prepare(making->db, &statement, error,
                  "SELECT job.member, metric.name, metric.value FROM job "
                  "CROSS JOIN metric ON metric.job_id = job.id WHERE job.study_id = ?",
                  "i", making->table->study_id);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    status = figure_add(making, &figures, statement, &next, error);
  }
  sql_done(statement);
  if (status == STATUS_OK) {
    status = figures_place(making->table, &figures, error);
  }
  free(figures.list);
  return status;
}

enum status study_table_read(struct store *store, int64_t study_id, struct study_table **table,
                             struct error *error) {
  struct making making = {.table = calloc(1, sizeof *making.table)};
  *table = NULL;
  if (!making.table) {
    return no_memory(error);
  }
  making.table->study_id = study_id;
  making.db = store_read_begin(store, error);
  enum status status = making.db ? read_study(&making, error) : STATUS_IO;
  if (status == STATUS_OK) {
    status = read_members(&making, error);
  }
  if (status == STATUS_OK) {
    status = read_values(&making, error);
  }
  if (status == STATUS_OK) {
    status = read_metrics(&making, error);
  }
  if (making.db) {
    store_read_end(store, making.db);
  }
  free(making.row_of);
  if (status == STATUS_OK) {
    *table = making.table;
  } else {
    study_table_destroy(making.table);
  }
  return status;
}
