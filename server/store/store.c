#include "server/store/store.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "server/base/clock.h"
#include "server/base/file.h"
#include "server/base/log.h"
#include "server/store/check.h"
#include "server/store/connection.h"
#include "server/store/group.h"
#include "server/store/sql.h"
#include "solver/base/units.h"

/* What a start may spend on looking at all pages. SQLite looks through a whole table at once, so
 * that the time alone does not bound it. */
enum { CHECK_BUDGET_MS = 500, CHECK_BYTES_MAX = 512 << 20 };

#define LOG_KEPT_BYTES "67108864" /* of the write-ahead log once it has been taken in */

enum status store_connect(const char *path, int flags, const char *settings, sqlite3 **db,
                          struct error *error) {
  int code = sqlite3_open_v2(path, db, flags | SQLITE_OPEN_NOMUTEX, NULL);
  if (!*db) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a database connection.");
  }
  if (code != SQLITE_OK || sqlite3_busy_timeout(*db, 5000) != SQLITE_OK ||
      sqlite3_db_config(*db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL) != SQLITE_OK ||
      sqlite3_db_config(*db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL) != SQLITE_OK ||
      sqlite3_exec(*db, settings, NULL, NULL, NULL) != SQLITE_OK) {
    return error_set(error, sql_status(sqlite3_errcode(*db), sqlite3_system_errno(*db)), NULL,
                     "Cannot open the database %s: %s.", path, sqlite3_errmsg(*db));
  }
  return STATUS_OK;
}

/* Opens the connection for writing. Until the file is known to be a sound database of ours nothing
 * in it is changed: not even its log is taken in. */
static enum status writer_open(const char *path, sqlite3 **writer, struct error *error) {
  bool complete = false;
  enum status status =
      store_connect(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, "", writer, error);
  if (status == STATUS_OK) {
    sqlite3_db_config(*writer, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    status = check_owner(*writer, path, store_migrate_newest(), error);
  }
  struct stat info;
  bool small = stat(path, &info) == 0 && info.st_size <= CHECK_BYTES_MAX;
  if (status == STATUS_OK && small) {
    status = check_content(*writer, path, CHECK_BUDGET_MS, &complete, error);
  }
  if (status == STATUS_OK && !complete) {
    log_line("the database is large: not all of it was checked; pneulabd --check does that");
  }
  if (status == STATUS_OK) {
    sqlite3_db_config(*writer, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0, NULL);
    if (sqlite3_exec(*writer,
                     "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                     "PRAGMA foreign_keys = ON; PRAGMA mmap_size = 0;"
                     "PRAGMA journal_size_limit = " LOG_KEPT_BYTES,
                     NULL, NULL, NULL) != SQLITE_OK) {
      status = sql_fail(*writer, error);
    }
  }
  if (status == STATUS_OK) {
    status = store_migrate(*writer, error);
  }
  /* From now on transactions are small: what undoes a part of one needs no file of its own. */
  if (status == STATUS_OK &&
      sqlite3_exec(*writer, "PRAGMA temp_store = MEMORY", NULL, NULL, NULL) != SQLITE_OK) {
    status = sql_fail(*writer, error);
  }
  return status;
}

enum status store_open(const char *directory, struct store **store, struct error *error) {
  char path[PATH_MAX];
  *store = NULL;
  struct store *opened = calloc(1, sizeof *opened);
  if (!opened) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the store.");
  }
  pthread_mutex_init(&opened->writer_mutex, NULL);
  pthread_mutex_init(&opened->reader_mutex, NULL);
  pthread_mutex_init(&opened->health_mutex, NULL);
  pthread_cond_init(&opened->reader_free, NULL);
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  enum status status = file_make_directory(directory, error);
  if (status == STATUS_OK) {
    status = units_create(&opened->units, error);
  }
  if (status == STATUS_OK && !(opened->group = group_create())) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the store.");
  }
  if (status == STATUS_OK) {
    status = check_file(directory, path, error);
  }
  if (status == STATUS_OK) {
    status = writer_open(path, &opened->writer, error);
  }
  for (int i = 0; i < STORE_READERS && status == STATUS_OK; i++) {
    status =
        store_connect(path, SQLITE_OPEN_READWRITE, "PRAGMA query_only = ON; PRAGMA mmap_size = 0;",
                      &opened->readers[i], error);
  }
  if (status != STATUS_OK) {
    store_close(opened);
    return status;
  }
  *store = opened;
  return STATUS_OK;
}

void store_close(struct store *store) {
  if (!store) {
    return;
  }
  for (int i = 0; i < STORE_READERS; i++) {
    sql_close(store->readers[i]);
  }
  sql_close(store->writer);
  group_destroy(store->group);
  units_destroy(store->units);
  pthread_cond_destroy(&store->reader_free);
  pthread_mutex_destroy(&store->health_mutex);
  pthread_mutex_destroy(&store->reader_mutex);
  pthread_mutex_destroy(&store->writer_mutex);
  free(store);
}

void store_set_sharing(struct store *store, store_share_files *share, void *context) {
  store->share = share;
  store->share_context = context;
}

static int reader_find_free(const struct store *store) {
  for (int i = 0; i < STORE_READERS; i++) {
    if (!store->reader_busy[i]) {
      return i;
    }
  }
  return -1;
}

static void reader_release(struct store *store, const sqlite3 *reader) {
  pthread_mutex_lock(&store->reader_mutex);
  for (int i = 0; i < STORE_READERS; i++) {
    if (store->readers[i] == reader) {
      store->reader_busy[i] = false;
    }
  }
  pthread_cond_signal(&store->reader_free);
  pthread_mutex_unlock(&store->reader_mutex);
}

sqlite3 *store_read_begin(struct store *store, struct error *error) {
  pthread_mutex_lock(&store->reader_mutex);
  int found;
  while ((found = reader_find_free(store)) < 0) {
    pthread_cond_wait(&store->reader_free, &store->reader_mutex);
  }
  store->reader_busy[found] = true;
  sqlite3 *reader = store->readers[found];
  pthread_mutex_unlock(&store->reader_mutex);
  if (sql_run(reader, error, "BEGIN", "") != STATUS_OK) {
    reader_release(store, reader);
    return NULL;
  }
  return reader;
}

void store_read_end(struct store *store, sqlite3 *reader) {
  sql_run(reader, NULL, "ROLLBACK", "");
  reader_release(store, reader);
}

enum status store_each(struct store *store, struct error *error, sql_taker *take, void *context,
                       const char *text, const char *types, ...) {
  struct error reason = {.status = STATUS_IO};
  sqlite3 *db = store_read_begin(store, &reason);
  if (!db) {
    return error_set(error, reason.status, NULL, "%s", reason.message);
  }
  va_list arguments;
  va_start(arguments, types);
  enum status status = sql_each_list(db, error, take, context, text, types, arguments);
  va_end(arguments);
  store_read_end(store, db);
  return status;
}

enum status store_write_begin(struct store *store, struct error *error) {
  int64_t since_us = clock_monotonic_us();
  pthread_mutex_lock(&store->writer_mutex);
  store->changes_before = sqlite3_total_changes64(store->writer);
  enum status status = sql_run(store->writer, error, "BEGIN IMMEDIATE", "");
  store_meter_wait(store, since_us, status == STATUS_OK);
  if (status != STATUS_OK) {
    store_health_note(store, status, false, sqlite3_errmsg(store->writer));
    pthread_mutex_unlock(&store->writer_mutex);
  }
  return status;
}

enum status store_write_end(struct store *store, enum status status, struct error *error) {
  if (status == STATUS_OK) {
    status = sql_run(store->writer, error, "COMMIT", "");
  }
  bool wrote = sqlite3_total_changes64(store->writer) != store->changes_before;
  store_health_note(store, status, wrote, sqlite3_errmsg(store->writer));
  if (status != STATUS_OK) {
    sql_run(store->writer, NULL, "ROLLBACK", "");
  }
  store_meter_write(store, status);
  if (status == STATUS_OK) {
    atomic_fetch_add(&store->version, 1);
  }
  void (*committed)(void *) =
      store->event_written && status == STATUS_OK ? store->event_committed : NULL;
  void *context = store->event_context;
  store->event_written = false;
  pthread_mutex_unlock(&store->writer_mutex);
  if (committed) {
    committed(context);
  }
  return status;
}

uint64_t store_version(const struct store *store) {
  return atomic_load(&store->version);
}

enum status store_no_job(int64_t id, struct error *error) {
  return error_set(error, STATUS_NOT_FOUND, NULL, "There is no job %lld.", (long long)id);
}

enum status store_state_of(sqlite3 *db, int64_t id, enum job_state *state, struct error *error) {
  sqlite3_stmt *statement;
  enum status status =
      sql_prepare(db, &statement, error, "SELECT state FROM job WHERE id = ?", "i", id);
  if (status != STATUS_OK) {
    return status;
  }
  int row = 0;
  status = sql_step(statement, &row, error);
  if (status == STATUS_OK && (!row || !job_state_parse(sql_text(statement, 0), state))) {
    status = store_no_job(id, error);
  }
  sql_done(statement);
  return status;
}
