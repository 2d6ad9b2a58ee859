/* Inside the store: its connections. */
#ifndef PNEULAB_STORE_CONNECTION_H
#define PNEULAB_STORE_CONNECTION_H

#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "server/store/meter.h"
#include "server/store/sql.h"
#include "server/store/store.h"

struct group;
struct units;

enum { STORE_READERS = 8 };

struct store {
  sqlite3 *writer; /* the only connection that writes and checkpoints */
  pthread_mutex_t writer_mutex;
  atomic_ullong version; /* grows with every commit */
  bool event_written;    /* by the open transaction; under the writer's mutex, like the two below */
  void (*event_committed)(void *context);
  void *event_context;
  int64_t changes_before; /* of the writer, when its transaction began */
  sqlite3 *readers[STORE_READERS];
  bool reader_busy[STORE_READERS];
  pthread_mutex_t reader_mutex;
  pthread_cond_t reader_free;
  struct store_meter meter;
  struct units *units; /* for values in SI */
  struct group *group; /* of submissions that are committed together */
  pthread_mutex_t health_mutex;
  struct error health;      /* of writing: STATUS_OK, or how the last transaction failed */
  store_share_files *share; /* NULL: no result is used again */
  void *share_context;
};

/* Opens one connection and runs its settings, a list of pragmas. *db is the caller's to close, also
 * after a failure. */
enum status store_connect(const char *path, int flags, const char *settings, sqlite3 **db,
                          struct error *error);

/* Takes a connection for reading, waiting for a free one, with a read transaction open: all that
 * is read until store_read_end is one consistent state. NULL and *error on failure. */
sqlite3 *store_read_begin(struct store *store, struct error *error);
void store_read_end(struct store *store, sqlite3 *reader);

/* Reads a query, as sql_each does, by a connection for reading of its own. */
enum status store_each(struct store *store, struct error *error, sql_taker *take, void *context,
                       const char *text, const char *types, ...);

/* A sql_taker of rows (state, number of jobs) into int64_t counts[JOB_STATE_COUNT]. */
enum status store_take_count(sqlite3_stmt *row, void *counts, struct error *error);

/* Locks the writer and opens a transaction. On failure nothing is locked. */
enum status store_write_begin(struct store *store, struct error *error);

/* Commits when status is STATUS_OK, else rolls back; unlocks. Returns status, or the reason why
 * the commit failed. */
enum status store_write_end(struct store *store, enum status status, struct error *error);

/* Notes that a writer has waited since `since_us` for its turn, and whether its transaction has
 * begun; then the end of the transaction. Under the writer's mutex. */
void store_meter_wait(struct store *store, int64_t since_us, bool begun);
void store_meter_write(struct store *store, enum status status);

/* Writes a submission inside a write transaction; otherwise as store_submit. */
enum status submission_write(struct store *store, const struct submission *submission, int64_t *id,
                             bool *replayed, struct error *error);

/* Notes how a transaction ended; one that wrote nothing does not show that writing works. Reasons
 * other than those of the disk are passed over. */
void store_health_note(struct store *store, enum status status, bool wrote, const char *reason);

/* Runs the migrations that the database lacks, each in a transaction of its own. */
enum status store_migrate(sqlite3 *writer, struct error *error);

/* The number of the newest migration that this program knows. */
int store_migrate_newest(void);

/* Reads the state of a job inside a write transaction. STATUS_NOT_FOUND. */
enum status store_state_of(sqlite3 *db, int64_t id, enum job_state *state, struct error *error);

/* STATUS_NOT_FOUND with the sentence for a job that does not exist. */
enum status store_no_job(int64_t id, struct error *error);

/* Reads one job by a connection that is held already; otherwise as store_job. */
enum status store_record_read(sqlite3 *db, int64_t id, struct job_record *record,
                              struct error *error);

/* Charges the worker time of an attempt that ends at `now` (unix ms) to the job's submitter, and
 * forgets submitters whose use has faded. In a write transaction. */
enum status queue_charge(sqlite3 *db, int64_t job_id, int64_t attempt, int64_t now,
                         struct error *error);

/* Makes the job of a claim `starting` under its attempt. In a write transaction. */
enum status queue_take(struct store *store, const struct claim *claim, int64_t now,
                       struct error *error);

/* Takes the jobs that follow a claimed one in its chain, if it is of one: see store_claim. In a
 * write transaction; what has been appended to the claim is freed with it. */
enum status chain_claim(struct store *store, struct claim *claim, int64_t now, struct error *error);

/* Whose: one job, the members of a study, or those of them that have not its priority. */
enum withdrawal { WITHDRAW_JOB, WITHDRAW_STUDY, WITHDRAW_PRIORITY };

/* Takes up to `most` jobs that wait with a cluster back into the queue: `starting` -> `queued`;
 * their attempts end. *count: how many. In a write transaction. */
enum status cluster_withdraw(sqlite3 *db, int64_t id, enum withdrawal whose, int most, int *count,
                             struct error *error);

/* The engine that a value of the label "executor" (or NULL) asks for. */
enum store_engine engine_of_label(const char *value);

/* How a job that asks for it can be answered. */
enum reuse { REUSE_NONE, REUSE_ANSWERED, REUSE_WAITS };

/* Looks for a job equal to the queued job `id`: one that succeeded answers it (it is succeeded
 * then), one that runs makes it wait. In a write transaction. */
enum status reuse_try(struct store *store, int64_t id, enum reuse *reuse, struct error *error);

#endif
