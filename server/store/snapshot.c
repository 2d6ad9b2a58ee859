#include "server/store/snapshot.h"

#include <stdio.h>
#include <time.h>

#include "server/base/file.h"
#include "server/store/sql.h"

enum {
  STEP_PAGES = 256, /* one step: about 1 MiB */
  PAUSE_NS = 200000 /* between steps, so that others get their share of the disk */
};

static enum status copy_fail(sqlite3 *copy, int code, struct error *error) {
  return error_set(error, sql_status(code, sqlite3_system_errno(copy)), NULL,
                   "Cannot copy the database: %s.", sqlite3_errstr(code));
}

static enum status copy_pages(sqlite3 *db, sqlite3 *copy, snapshot_stop *stop, void *context,
                              struct error *error) {
  struct timespec pause = {.tv_nsec = PAUSE_NS};
  sqlite3_backup *backup = sqlite3_backup_init(copy, "main", db, "main");
  if (!backup) {
    return copy_fail(copy, sqlite3_errcode(copy), error);
  }
  int code = SQLITE_OK;
  bool stopped = false;
  while (code == SQLITE_OK && !stopped) {
    code = sqlite3_backup_step(backup, STEP_PAGES);
    stopped = stop && stop(context);
    if (code == SQLITE_OK) {
      nanosleep(&pause, NULL);
    }
  }
  sqlite3_backup_finish(backup);
  if (code == SQLITE_OK) {
    return error_set(error, STATUS_CANCELLED, NULL, "The copy was stopped.");
  }
  return code == SQLITE_DONE ? STATUS_OK : copy_fail(copy, code, error);
}

enum status snapshot_copy(sqlite3 *db, const char *path, snapshot_stop *stop, void *context,
                          struct error *error) {
  sqlite3 *copy = NULL;
  enum status status = STATUS_OK;
  if (sqlite3_open(path, &copy) != SQLITE_OK ||
      sqlite3_exec(copy, "PRAGMA synchronous = OFF", NULL, NULL, NULL) != SQLITE_OK) {
    status = copy ? sql_fail(copy, error)
                  : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a copy.");
  }
  if (status == STATUS_OK) {
    status = copy_pages(db, copy, stop, context, error);
  }
  /* A file that needs no log beside it can be copied and read anywhere. */
  if (status == STATUS_OK &&
      sqlite3_exec(copy, "PRAGMA journal_mode = DELETE", NULL, NULL, NULL) != SQLITE_OK) {
    status = sql_fail(copy, error);
  }
  if (sqlite3_close(copy) != SQLITE_OK && status == STATUS_OK) {
    status = error_set(error, STATUS_IO, NULL, "Cannot close the copy %s.", path);
  }
  return status == STATUS_OK ? file_sync(path, error) : status;
}

enum status store_snapshot(struct store *store, const char *path, snapshot_stop *stop,
                           void *context, struct error *error) {
  struct error reason = {.status = STATUS_IO};
  sqlite3 *db = store_read_begin(store, &reason);
  if (!db) {
    return error_set(error, reason.status, NULL, "%s", reason.message);
  }
  enum status status = snapshot_copy(db, path, stop, context, error);
  store_read_end(store, db);
  return status;
}
