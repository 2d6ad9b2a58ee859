#include "server/store/check.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/store/sql.h"

enum {
  HEADER_BYTES = 100, /* of an SQLite file */
  STEPS = 10000,      /* of SQLite's virtual machine between two looks at the clock */
  UNMARKED_MAX = 3    /* schemas up to this one carry no application id */
};

static uint32_t header_number(const unsigned char *header, size_t at, size_t bytes) {
  uint32_t number = 0;
  for (size_t i = 0; i < bytes; i++) {
    number = number << 8 | header[at + i];
  }
  return number;
}

/* Whether the folder beside the database has anything but links to itself. */
static bool folder_has_entries(const char *path) {
  DIR *folder = opendir(path);
  bool found = false;
  struct dirent *entry;
  while (folder && !found && (entry = readdir(folder))) {
    found = entry->d_name[0] != '.';
  }
  if (folder) {
    closedir(folder);
  }
  return found;
}

static bool file_has_bytes(const char *directory, const char *name) {
  char path[PATH_MAX];
  struct stat info;
  int length = snprintf(path, sizeof path, "%s/%s", directory, name);
  return length > 0 && (size_t)length < sizeof path && stat(path, &info) == 0 && info.st_size > 0;
}

/* A data directory in use whose database is gone is no place for a new one. */
static enum status check_missing(const char *directory, struct error *error) {
  char attempts[PATH_MAX];
  int length = snprintf(attempts, sizeof attempts, "%s/attempts", directory);
  bool used = length > 0 && (size_t)length < sizeof attempts && folder_has_entries(attempts);
  if (used || file_has_bytes(directory, "pneulab.db-wal")) {
    return error_set(error, STATUS_DAMAGED, NULL,
                     "%.120s has files of jobs, but its pneulab.db is missing or empty. Restore a "
                     "backup (pneulabd --data DIR --restore FILE), or choose a new directory with "
                     "--data. Nothing was changed.",
                     directory);
  }
  return STATUS_OK;
}

enum status check_damaged(const char *path, const char *finding, struct error *error) {
  return error_set(error, STATUS_DAMAGED, NULL,
                   "%.120s is damaged: %.80s. Nothing was changed. Restore a backup (pneulabd "
                   "--data DIR --restore FILE), or save what can be read: sqlite3 pneulab.db "
                   ".recover | sqlite3 saved.db; see docs/RELIABILITY.md.",
                   path, finding);
}

enum status check_file(const char *directory, const char *path, struct error *error) {
  unsigned char header[HEADER_BYTES];
  struct stat info;
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0 && errno == ENOENT) {
    return check_missing(directory, error);
  }
  if (fd < 0 || fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    int reason = errno;
    enum status status =
        fd < 0 ? error_set(error, STATUS_IO, NULL, "Cannot open the database %s: %s.", path,
                           strerrordesc_np(reason))
               : error_set(error, STATUS_CONFLICT, NULL, "%s is not a regular file.", path);
    if (fd >= 0) {
      close(fd);
    }
    return status;
  }
  ssize_t got = read(fd, header, sizeof header);
  close(fd);
  if (info.st_size == 0) {
    return check_missing(directory, error);
  }
  if (got < HEADER_BYTES || memcmp(header, "SQLite format 3", 16) != 0) {
    return check_damaged(path, "it does not begin like an SQLite database", error);
  }
  uint32_t page = header_number(header, 16, 2);
  uint64_t expected = (uint64_t)(page == 1 ? 65536 : page) * header_number(header, 28, 4);
  /* With a log beside it the file may be short: a crash in the midst of a checkpoint. */
  if (!file_has_bytes(directory, "pneulab.db-wal") &&
      header_number(header, 24, 4) == header_number(header, 92, 4) &&
      (uint64_t)info.st_size < expected) {
    return check_damaged(path, "it is cut off: shorter than its header says", error);
  }
  return STATUS_OK;
}

static enum status pragma_number(sqlite3 *db, const char *sql, int64_t *number,
                                 struct error *error) {
  sqlite3_stmt *statement;
  int row = 0;
  enum status status = sql_prepare(db, &statement, error, sql, "");
  if (status == STATUS_OK) {
    status = sql_step(statement, &row, error);
    *number = sqlite3_column_int64(statement, 0);
    sqlite3_finalize(statement);
  }
  return status;
}

enum status check_owner(sqlite3 *db, const char *path, int newest, struct error *error) {
  int64_t application = 0, version = 0, tables = 0, own = 0;
  enum status status = pragma_number(db, "PRAGMA application_id", &application, error);
  if (status == STATUS_OK) {
    status = pragma_number(db, "PRAGMA user_version", &version, error);
  }
  if (status == STATUS_OK) {
    status = pragma_number(db, "SELECT count(*) FROM sqlite_schema", &tables, error);
  }
  if (status == STATUS_OK) {
    status = pragma_number(
        db, "SELECT count(*) FROM sqlite_schema WHERE name IN ('job', 'job_transition', 'attempt')",
        &own, error);
  }
  if (status == STATUS_DAMAGED) {
    return check_damaged(path, sqlite3_errmsg(db), error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  bool fresh = application == 0 && version == 0 && tables == 0;
  bool unmarked = application == 0 && version >= 1 && version <= UNMARKED_MAX && own == 3;
  if (!fresh && !unmarked && application != CHECK_APPLICATION_ID) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "%.150s is a database of another program (application id %lld, version %lld, "
                     "%lld tables). Nothing was changed. Choose another directory with --data.",
                     path, (long long)application, (long long)version, (long long)tables);
  }
  if (version > newest) {
    return error_set(error, STATUS_CONFLICT, NULL,
                     "%.150s has schema %lld, this program knows up to %d: it was written by a "
                     "newer pneulabd. Nothing was changed. Install that version again, or restore "
                     "the backup made before the upgrade (pneulabd --restore FILE).",
                     path, (long long)version, newest);
  }
  return STATUS_OK;
}

/* Ends a statement whose time is over. */
static int check_over(void *context) {
  const int64_t *until_ms = context;
  return *until_ms != 0 && clock_monotonic_ms() >= *until_ms;
}

enum status check_content(sqlite3 *db, const char *path, int64_t budget_ms, bool *complete,
                          struct error *error) {
  int64_t until_ms = budget_ms > 0 ? clock_monotonic_ms() + budget_ms : 0;
  sqlite3_stmt *statement = NULL;
  char finding[200] = "";
  *complete = false;
  sqlite3_progress_handler(db, STEPS, check_over, &until_ms);
  int code = sqlite3_prepare_v2(db, "PRAGMA quick_check(1)", -1, &statement, NULL);
  if (code == SQLITE_OK) {
    code = sqlite3_step(statement);
  }
  if (code == SQLITE_ROW) {
    snprintf(finding, sizeof finding, "%s", sql_text(statement, 0));
    *complete = true;
  }
  enum status status = STATUS_OK;
  if (code != SQLITE_ROW && code != SQLITE_INTERRUPT) {
    status = sql_fail(db, error);
    snprintf(finding, sizeof finding, "%s", sqlite3_errmsg(db));
  }
  sqlite3_finalize(statement);
  sqlite3_progress_handler(db, 0, NULL, NULL);
  if (status == STATUS_DAMAGED || (*complete && strcmp(finding, "ok") != 0)) {
    finding[strcspn(finding, "\n")] = '\0';
    return check_damaged(path, finding, error);
  }
  return status;
}
