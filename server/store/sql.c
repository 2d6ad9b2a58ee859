#include "server/store/sql.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>

enum status sql_status(int code, int system_code) {
  switch (code & 0xff) {
  case SQLITE_CONSTRAINT:
    return STATUS_CONFLICT;
  case SQLITE_NOMEM:
    return STATUS_NO_MEMORY;
  case SQLITE_TOOBIG:
    return STATUS_TOO_LARGE;
  case SQLITE_FULL:
    return STATUS_NO_SPACE;
  case SQLITE_BUSY:
  case SQLITE_LOCKED:
    return STATUS_BUSY;
  case SQLITE_CORRUPT:
  case SQLITE_NOTADB:
    return STATUS_DAMAGED;
  default: /* growing the index of the log fails as an I/O error: only errno tells why */
    return system_code == ENOSPC || system_code == EDQUOT ? STATUS_NO_SPACE : STATUS_IO;
  }
}

enum status sql_fail(sqlite3 *db, struct error *error) {
  int code = sqlite3_errcode(db), system_code = sqlite3_system_errno(db);
  enum status status = sql_status(code, system_code);
  if (code == SQLITE_IOERR && system_code != 0) {
    return error_set(error, status, NULL, "Database: %s (%s).", sqlite3_errmsg(db),
                     strerrordesc_np(system_code));
  }
  return error_set(error, status, NULL, "Database: %s.", sqlite3_errmsg(db));
}

static int sql_bind(sqlite3_stmt *statement, const char *types, va_list arguments) {
  int code = SQLITE_OK;
  for (int i = 1; *types && code == SQLITE_OK; types++, i++) {
    switch (*types) {
    case 'i':
      code = sqlite3_bind_int64(statement, i, va_arg(arguments, int64_t));
      break;
    case 'd':
      code = sqlite3_bind_double(statement, i, va_arg(arguments, double));
      break;
    case 't':
      code = sqlite3_bind_text(statement, i, va_arg(arguments, const char *), -1, SQLITE_STATIC);
      break;
    default:
      assert(*types == 'n');
    }
  }
  return code;
}

/* A statement of this text that sql_done has kept, NULL when there is none. */
static sqlite3_stmt *statement_kept(sqlite3 *db, const char *text) {
  sqlite3_stmt *at = NULL;
  while ((at = sqlite3_next_stmt(db, at)) &&
         (sqlite3_stmt_busy(at) || strcmp(sqlite3_sql(at), text) != 0)) {
  }
  return at;
}

static enum status sql_prepare_list(sqlite3 *db, sqlite3_stmt **statement, struct error *error,
                                    const char *text, const char *types, va_list arguments) {
  *statement = statement_kept(db, text);
  if (!*statement &&
      sqlite3_prepare_v3(db, text, -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) != SQLITE_OK) {
    return sql_fail(db, error);
  }
  if (sql_bind(*statement, types, arguments) != SQLITE_OK) {
    enum status status = sql_fail(db, error);
    sqlite3_finalize(*statement);
    *statement = NULL;
    return status;
  }
  return STATUS_OK;
}

enum status sql_prepare(sqlite3 *db, sqlite3_stmt **statement, struct error *error,
                        const char *text, const char *types, ...) {
  va_list arguments;
  va_start(arguments, types);
  enum status status = sql_prepare_list(db, statement, error, text, types, arguments);
  va_end(arguments);
  return status;
}

enum status sql_run(sqlite3 *db, struct error *error, const char *text, const char *types, ...) {
  sqlite3_stmt *statement;
  va_list arguments;
  va_start(arguments, types);
  enum status status = sql_prepare_list(db, &statement, error, text, types, arguments);
  va_end(arguments);
  if (status == STATUS_OK) {
    int row;
    status = sql_step(statement, &row, error);
    sql_done(statement);
  }
  return status;
}

enum status sql_each_list(sqlite3 *db, struct error *error, sql_taker *take, void *context,
                          const char *text, const char *types, va_list arguments) {
  sqlite3_stmt *statement;
  int row = 1;
  enum status status = sql_prepare_list(db, &statement, error, text, types, arguments);
  while (status == STATUS_OK && (status = sql_step(statement, &row, error)) == STATUS_OK && row) {
    status = take(statement, context, error);
  }
  sql_done(statement);
  return status;
}

enum status sql_each(sqlite3 *db, struct error *error, sql_taker *take, void *context,
                     const char *text, const char *types, ...) {
  va_list arguments;
  va_start(arguments, types);
  enum status status = sql_each_list(db, error, take, context, text, types, arguments);
  va_end(arguments);
  return status;
}

enum status sql_take_integer(sqlite3_stmt *row, void *integer, struct error *error) {
  (void)error;
  *(int64_t *)integer = sqlite3_column_int64(row, 0);
  return STATUS_OK;
}

enum status sql_take_number(sqlite3_stmt *row, void *number, struct error *error) {
  (void)error;
  *(double *)number = sqlite3_column_double(row, 0);
  return STATUS_OK;
}

void sql_done(sqlite3_stmt *statement) {
  if (statement) {
    sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
  }
}

void sql_close(sqlite3 *db) {
  sqlite3_stmt *statement;
  while (db && (statement = sqlite3_next_stmt(db, NULL))) {
    sqlite3_finalize(statement);
  }
  sqlite3_close(db);
}

enum status sql_step(sqlite3_stmt *statement, int *row, struct error *error) {
  int code = sqlite3_step(statement);
  *row = code == SQLITE_ROW;
  if (code == SQLITE_ROW || code == SQLITE_DONE) {
    return STATUS_OK;
  }
  return sql_fail(sqlite3_db_handle(statement), error);
}

const char *sql_text(sqlite3_stmt *statement, int column) {
  const unsigned char *text = sqlite3_column_text(statement, column);
  return text ? (const char *)text : "";
}

char *sql_text_copy(sqlite3_stmt *statement, int column) {
  return strdup(sql_text(statement, column));
}
