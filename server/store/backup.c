/* Backup, restoring and checking of a database by a program that need not be the daemon. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/file.h"
#include "server/store/check.h"
#include "server/store/snapshot.h"
#include "server/store/sql.h"

/* The database itself comes last: until it is moved, nothing has been taken away. */
static const char *const database_files[] = {"pneulab.db-wal", "pneulab.db-shm", "pneulab.db"};

static enum status path_join(char path[PATH_MAX], const char *directory, const char *name,
                             const char *suffix, struct error *error) {
  int length = snprintf(path, PATH_MAX, "%s/%s%s", directory, name, suffix);
  return length > 0 && length < PATH_MAX
             ? STATUS_OK
             : error_set(error, STATUS_TOO_LARGE, NULL, "The path %.200s is too long.", directory);
}

/* Opens an existing database for reading only and checks whose it is. *db is the caller's to
 * close, also after a failure. */
static enum status existing_open(const char *path, int newest, sqlite3 **db, struct error *error) {
  enum status status = store_connect(path, SQLITE_OPEN_READWRITE, "", db, error);
  if (status == STATUS_OK) {
    sqlite3_db_config(*db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    status = check_owner(*db, path, newest, error);
  }
  if (status == STATUS_OK &&
      sqlite3_exec(*db, "PRAGMA query_only = ON", NULL, NULL, NULL) != SQLITE_OK) {
    status = sql_fail(*db, error);
  }
  return status;
}

static enum status database_open(const char *directory, char path[PATH_MAX], sqlite3 **db,
                                 struct error *error) {
  enum status status = path_join(path, directory, "pneulab.db", "", error);
  *db = NULL;
  if (status == STATUS_OK) {
    status = check_file(directory, path, error);
  }
  if (status == STATUS_OK && access(path, F_OK) != 0) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "There is no database %s.", path);
  }
  return status == STATUS_OK ? existing_open(path, INT_MAX, db, error) : status;
}

/* Gives the finished copy its name. */
static enum status copy_publish(const char *part, const char *path, bool replace,
                                struct error *error) {
  if ((replace ? rename(part, path) : link(part, path)) != 0) {
    return errno == EEXIST ? error_set(error, STATUS_CONFLICT, NULL,
                                       "%s exists; choose another name, or add --force.", path)
                           : error_set(error, STATUS_IO, NULL, "Cannot create %s: %s.", path,
                                       strerrordesc_np(errno));
  }
  return file_sync_parent(path, error);
}

/* A temporary file beside `path`, which must not exist unless it may be replaced. */
static enum status part_create(const char *path, bool replace, char part[PATH_MAX],
                               struct error *error) {
  int length = snprintf(part, PATH_MAX, "%s.part-XXXXXX", path);
  part[0] = length > 0 && length < PATH_MAX ? part[0] : '\0';
  if (!replace && access(path, F_OK) == 0) {
    part[0] = '\0';
    return error_set(error, STATUS_CONFLICT, NULL,
                     "%s exists; choose another name, or add --force.", path);
  }
  int fd = part[0] ? mkstemp(part) : -1;
  if (fd < 0) {
    part[0] = '\0';
    return error_set(error, STATUS_IO, NULL, "Cannot create a file beside %s: %s.", path,
                     strerrordesc_np(errno));
  }
  close(fd);
  return STATUS_OK;
}

/* Copies the database to a new file beside `path` and checks the copy. On failure nothing is left,
 * and part is "". */
static enum status copy_make(sqlite3 *db, const char *path, bool replace, char part[PATH_MAX],
                             struct error *error) {
  sqlite3 *copy = NULL;
  bool complete;
  enum status status = part_create(path, replace, part, error);
  if (status == STATUS_OK) {
    status = snapshot_copy(db, part, NULL, NULL, error);
  }
  if (status == STATUS_OK) {
    status = store_connect(part, SQLITE_OPEN_READONLY, "", &copy, error);
  }
  if (status == STATUS_OK) {
    status = check_content(copy, path, 0, &complete, error);
  }
  sqlite3_close(copy);
  if (status != STATUS_OK && part[0]) {
    unlink(part);
    part[0] = '\0';
  }
  return status;
}

enum status store_backup(const char *directory, const char *path, bool replace,
                         struct error *error) {
  char database[PATH_MAX], part[PATH_MAX] = "";
  sqlite3 *db = NULL;
  enum status status = database_open(directory, database, &db, error);
  /* All is read in one transaction, so that a daemon at work cannot make the copy start anew. */
  if (status == STATUS_OK && sqlite3_exec(db, "BEGIN; SELECT count(*) FROM sqlite_schema", NULL,
                                          NULL, NULL) != SQLITE_OK) {
    status = sql_fail(db, error);
  }
  if (status == STATUS_OK) {
    status = copy_make(db, path, replace, part, error);
  }
  if (status == STATUS_OK) {
    status = copy_publish(part, path, replace, error);
  }
  if (part[0]) {
    unlink(part);
  }
  sqlite3_close(db);
  return status;
}

/* Moves the files of the present database aside. */
static enum status database_move_aside(const char *directory, struct error *error) {
  char from[PATH_MAX], to[PATH_MAX];
  enum status status = STATUS_OK;
  for (size_t i = 0; i < sizeof database_files / sizeof *database_files && status == STATUS_OK;
       i++) {
    status = path_join(from, directory, database_files[i], "", error);
    if (status == STATUS_OK) {
      status = path_join(to, directory, "replaced-", database_files[i], error);
    }
    if (status == STATUS_OK && rename(from, to) != 0 && errno != ENOENT) {
      status = error_set(error, STATUS_IO, NULL, "Cannot rename %s: %s.", from,
                         strerrordesc_np(errno));
    }
  }
  return status;
}

enum status store_restore(const char *directory, const char *path, bool replace,
                          struct error *error) {
  char target[PATH_MAX], part[PATH_MAX] = "";
  sqlite3 *db = NULL;
  enum status status = path_join(target, directory, "pneulab.db", "", error);
  if (status == STATUS_OK && !replace && access(target, F_OK) == 0) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "%s is there; add --force to put it aside (as replaced-pneulab.db) and "
                       "restore the backup.",
                       target);
  }
  if (status == STATUS_OK) {
    status = existing_open(path, store_migrate_newest(), &db, error);
  }
  if (status == STATUS_OK) {
    status = copy_make(db, target, true, part, error);
  }
  if (status == STATUS_OK) {
    status = database_move_aside(directory, error);
  }
  if (status == STATUS_OK) {
    status = copy_publish(part, target, false, error);
  }
  if (part[0]) {
    unlink(part);
  }
  sqlite3_close(db);
  return status;
}

enum status store_verify(const char *directory, struct error *error) {
  char path[PATH_MAX];
  sqlite3 *db = NULL;
  bool complete;
  enum status status = database_open(directory, path, &db, error);
  if (status == STATUS_OK) {
    status = check_content(db, path, 0, &complete, error);
  }
  sqlite3_stmt *statement = NULL;
  int row = 0;
  if (status == STATUS_OK) {
    status = sql_prepare(db, &statement, error, "SELECT \"table\" FROM pragma_foreign_key_check",
                         "");
  }
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
  }
  if (status == STATUS_OK && row) {
    char finding[100];
    snprintf(finding, sizeof finding, "a row of table %.60s refers to nothing",
             sql_text(statement, 0));
    status = check_damaged(path, finding, error);
  }
  sqlite3_finalize(statement);
  sqlite3_close(db);
  return status;
}
