#include <stdio.h>

#include "server/store/connection.h"
#include "server/store/sql.h"

enum status store_snapshot(struct store *store, const char *path, struct error *error) {
  sqlite3 *copy = NULL;
  sqlite3 *db = store_read_begin(store, error);
  if (!db) {
    return STATUS_IO;
  }
  enum status status = STATUS_OK;
  sqlite3_backup *backup = NULL;
  if (sqlite3_open(path, &copy) != SQLITE_OK ||
      !(backup = sqlite3_backup_init(copy, "main", db, "main"))) {
    status = error_set(error, STATUS_IO, NULL, "Cannot write a snapshot: %s.",
                       copy ? sqlite3_errmsg(copy) : "no memory");
  }
  if (backup) {
    int code = sqlite3_backup_step(backup, -1);
    sqlite3_backup_finish(backup);
    if (code != SQLITE_DONE) {
      status =
          error_set(error, STATUS_IO, NULL, "Cannot write a snapshot: %s.", sqlite3_errstr(code));
    }
  }
  sqlite3_close(copy);
  store_read_end(store, db);
  return status;
}
