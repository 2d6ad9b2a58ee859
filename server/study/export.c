#include "server/study/export.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/csv.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

/* ---- fields ------------------------------------------------------------------------------- */

static void put_separator(FILE *out, bool *first) {
  if (!*first) {
    fputc(',', out);
  }
  *first = false;
}

static void put_text(FILE *out, bool *first, const char *text) {
  put_separator(out, first);
  csv_text(out, text);
}

static void put_number(FILE *out, bool *first, double value) {
  put_separator(out, first);
  if (isfinite(value)) {
    fprintf(out, "%.15g", value);
  }
}

static void put_integer(FILE *out, bool *first, int64_t value) {
  put_separator(out, first);
  fprintf(out, "%" PRId64, value);
}

static void end_row(FILE *out, bool *first) {
  fputs("\r\n", out);
  *first = true;
}

/* Number or word of a parameter. */
static void put_parameter(FILE *out, bool *first, const struct study_table *table, size_t row,
                          size_t k) {
  double value = table->value[row * table->parameters + k];
  const struct study_column *column = &table->parameter[k];
  if (column->categorical) {
    size_t word = value >= 0.0 ? (size_t)value : column->word_count;
    put_text(out, first, word < column->word_count ? column->words[word] : "");
  } else {
    put_number(out, first, value);
  }
}

static void put_joined(FILE *out, bool *first, const char *format, const char *a, const char *b) {
  char text[400];
  snprintf(text, sizeof text, format, a, b);
  put_text(out, first, text);
}

/* Ends the text in memory. */
static enum status finish(FILE *out, char **text, struct error *error) {
  bool failed = ferror(out) != 0;
  failed = fclose(out) == EOF || failed;
  if (failed) {
    free(*text);
    *text = NULL;
  }
  return failed ? error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the table.") : STATUS_OK;
}

static FILE *begin(char **text, size_t *size, struct error *error) {
  *text = NULL;
  FILE *out = open_memstream(text, size);
  if (!out) {
    error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the table.");
  }
  return out;
}

/* ---- the table ---------------------------------------------------------------------------- */

enum status export_csv(const struct study_table *table, char **text, size_t *size,
                       struct error *error) {
  static const char *const names[] = {"member", "job", "state", "reason", "name"};
  FILE *out = begin(text, size, error);
  bool first = true;
  if (!out) {
    return STATUS_NO_MEMORY;
  }
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    put_text(out, &first, names[i]);
  }
  for (size_t k = 0; k < table->parameters; k++) {
    const char *unit = table->parameter[k].unit;
    put_joined(out, &first, unit[0] ? "%s [%s]" : "%s%s", table->parameter[k].key, unit);
  }
  for (size_t k = 0; k < table->metrics; k++) {
    put_text(out, &first, table->metric[k].key);
  }
  end_row(out, &first);
  for (size_t i = 0; i < table->members; i++) {
    put_integer(out, &first, table->member[i]);
    put_integer(out, &first, table->job_id[i]);
    put_text(out, &first, job_state_word((enum job_state)table->state[i]));
    put_text(out, &first, table->reason[i]);
    put_text(out, &first, table->member_name[i]);
    for (size_t k = 0; k < table->parameters; k++) {
      put_parameter(out, &first, table, i, k);
    }
    for (size_t k = 0; k < table->metrics; k++) {
      put_number(out, &first, table->result[i * table->metrics + k]);
    }
    end_row(out, &first);
  }
  return finish(out, text, error);
}

/* ---- Optuna ------------------------------------------------------------------------------- */

/* When a member was solved, ms since 1970; 0: not yet. */
struct span {
  int64_t started, finished;
};

static enum status read_spans(struct store *store, const struct study_table *table,
                              struct span *spans, struct error *error) {
  sqlite3 *db = store_read_begin(store, error);
  sqlite3_stmt *statement;
  size_t at = 0;
  int row = 0;
  if (!db) {
    return error->status;
  }
  enum status status = sql_prepare(db, &statement, error,
                                   "SELECT member, coalesce(started_ms, created_ms), "
                                   "coalesce(finished_ms, 0), started_ms IS NULL AND "
                                   "finished_ms IS NULL FROM job WHERE study_id = ? "
                                   "ORDER BY member",
                                   "i", table->study_id);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    int64_t member = sqlite3_column_int64(statement, 0);
    while (at < table->members && table->member[at] < member) {
      at++;
    }
    if (at < table->members && table->member[at] == member && !sqlite3_column_int(statement, 3)) {
      spans[at].started = sqlite3_column_int64(statement, 1);
      spans[at].finished = sqlite3_column_int64(statement, 2);
    }
  }
  sql_done(statement);
  store_read_end(store, db);
  return status;
}

/* "2026-01-31 12:00:00.123000", as pandas writes a datetime. */
static void put_time(FILE *out, bool *first, int64_t ms) {
  time_t seconds = (time_t)(ms / 1000);
  struct tm tm;
  char text[40];
  put_separator(out, first);
  if (ms > 0 && gmtime_r(&seconds, &tm) &&
      strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &tm) > 0) {
    fprintf(out, "%s.%06d", text, (int)(ms % 1000) * 1000);
  }
}

/* "0 days 00:00:01.234000", as pandas writes a timedelta. */
static void put_duration(FILE *out, bool *first, const struct span *span) {
  put_separator(out, first);
  if (span->started > 0 && span->finished >= span->started) {
    int64_t ms = span->finished - span->started, s = ms / 1000;
    fprintf(out, "%d days %02d:%02d:%02d.%06d", (int)(s / 86400), (int)(s / 3600 % 24),
            (int)(s / 60 % 60), (int)(s % 60), (int)(ms % 1000) * 1000);
  }
}

static const char *trial_state(int state) {
  switch ((enum job_state)state) {
  case JOB_STATE_SUCCEEDED:
    return "COMPLETE";
  case JOB_STATE_FAILED:
  case JOB_STATE_TIMED_OUT:
  case JOB_STATE_CANCELLED:
    return "FAIL";
  case JOB_STATE_STARTING:
  case JOB_STATE_RUNNING:
  case JOB_STATE_CANCELLING:
    return "RUNNING";
  default:
    return "WAITING";
  }
}

static bool is_objective(const struct criterion *objectives, size_t count, size_t metric) {
  bool found = false;
  for (size_t i = 0; i < count; i++) {
    found = found || objectives[i].metric == metric;
  }
  return found;
}

static void put_trial_names(FILE *out, const struct study_table *table,
                            const struct criterion *objectives, size_t count) {
  bool first = true;
  put_text(out, &first, "number");
  for (size_t i = 0; i < count; i++) {
    char text[40];
    snprintf(text, sizeof text, "values_%zu", i);
    put_text(out, &first, count > 1 ? text : "value");
  }
  put_text(out, &first, "datetime_start");
  put_text(out, &first, "datetime_complete");
  put_text(out, &first, "duration");
  for (size_t k = 0; k < table->parameters; k++) {
    put_joined(out, &first, "params_%s%s", table->parameter[k].key, "");
  }
  for (size_t k = 0; k < table->metrics; k++) {
    if (!is_objective(objectives, count, k)) {
      put_joined(out, &first, "user_attrs_%s%s", table->metric[k].key, "");
    }
  }
  put_text(out, &first, "user_attrs_job");
  put_text(out, &first, "user_attrs_name");
  put_text(out, &first, "user_attrs_reason");
  put_text(out, &first, "state");
  end_row(out, &first);
}

static void put_trial(FILE *out, const struct study_table *table, size_t row,
                      const struct span *span, const struct criterion *objectives, size_t count) {
  const double *result = table->result + row * table->metrics;
  bool first = true, complete = row_counts(table, row);
  put_integer(out, &first, table->member[row]);
  for (size_t i = 0; i < count; i++) {
    put_number(out, &first, complete ? result[objectives[i].metric] : NAN);
  }
  put_time(out, &first, span->started);
  put_time(out, &first, span->finished);
  put_duration(out, &first, span);
  for (size_t k = 0; k < table->parameters; k++) {
    put_parameter(out, &first, table, row, k);
  }
  for (size_t k = 0; k < table->metrics; k++) {
    if (!is_objective(objectives, count, k)) {
      put_number(out, &first, result[k]);
    }
  }
  put_integer(out, &first, table->job_id[row]);
  put_text(out, &first, table->member_name[row]);
  put_text(out, &first, table->reason[row]);
  put_text(out, &first, trial_state(table->state[row]));
  end_row(out, &first);
}

enum status export_optuna(struct store *store, const struct study_table *table,
                          const struct criterion *objectives, size_t count, char **text,
                          size_t *size, struct error *error) {
  struct span *spans = calloc(table->members + 1, sizeof *spans);
  *text = NULL;
  if (!spans) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the table.");
  }
  enum status status = read_spans(store, table, spans, error);
  FILE *out = status == STATUS_OK ? begin(text, size, error) : NULL;
  if (out) {
    put_trial_names(out, table, objectives, count);
    for (size_t i = 0; i < table->members; i++) {
      put_trial(out, table, i, &spans[i], objectives, count);
    }
    status = finish(out, text, error);
  } else if (status == STATUS_OK) {
    status = STATUS_NO_MEMORY;
  }
  free(spans);
  return status;
}
