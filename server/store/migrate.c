#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "schema/embedded.h"
#include "server/store/connection.h"
#include "server/store/sql.h"

/* The number of a migration file "0001-jobs.sql", 0 for other files. */
static int migration_number(const char *name) {
  size_t length = strlen(name);
  if (length < 9 || strspn(name, "0123456789") != 4 || name[4] != '-' ||
      strcmp(name + length - 4, ".sql") != 0) {
    return 0;
  }
  return (int)strtol(name, NULL, 10);
}

static enum status migration_run(sqlite3 *db, const struct embedded_file *file, int number,
                                 struct error *error) {
  char version[64];
  snprintf(version, sizeof version, "PRAGMA user_version = %d", number);
  if (sqlite3_exec(db, "BEGIN IMMEDIATE", NULL, NULL, NULL) != SQLITE_OK) {
    return sql_fail(db, error);
  }
  if (sqlite3_exec(db, (const char *)file->data, NULL, NULL, NULL) != SQLITE_OK ||
      sqlite3_exec(db, version, NULL, NULL, NULL) != SQLITE_OK ||
      sqlite3_exec(db, "COMMIT", NULL, NULL, NULL) != SQLITE_OK) {
    enum status status = sql_fail(db, error);
    sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL);
    return status;
  }
  return STATUS_OK;
}

static enum status migration_version(sqlite3 *db, int *version, struct error *error) {
  sqlite3_stmt *statement;
  enum status status = sql_prepare(db, &statement, error, "PRAGMA user_version", "");
  if (status == STATUS_OK) {
    int row;
    status = sql_step(statement, &row, error);
    *version = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
  }
  return status;
}

int store_migrate_newest(void) {
  int newest = 0;
  for (size_t i = 0; i < embedded_file_count; i++) {
    int number = migration_number(embedded_files[i].name);
    newest = number > newest ? number : newest;
  }
  return newest;
}

enum status store_migrate(sqlite3 *writer, struct error *error) {
  int version = 0;
  enum status status = migration_version(writer, &version, error);
  /* The table of embedded files is in the order of the build's list: ascending numbers. */
  for (size_t i = 0; i < embedded_file_count && status == STATUS_OK; i++) {
    int number = migration_number(embedded_files[i].name);
    if (number > version) {
      status = migration_run(writer, &embedded_files[i], number, error);
    }
  }
  return status;
}
