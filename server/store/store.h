/* The results database: one SQLite file, of which the daemon is the only writer.
 *
 * All writes go through one connection behind a mutex; each function that writes is one durable
 * transaction (WAL, synchronous=FULL). Reads use a small set of query_only connections. Every
 * function may be called from any thread. Failures of the database are STATUS_IO, STATUS_NO_SPACE
 * (full disk), STATUS_BUSY (another program holds it), STATUS_DAMAGED or STATUS_NO_MEMORY; they
 * leave it unchanged, and what failed may be tried again. */
#ifndef PNEULAB_STORE_STORE_H
#define PNEULAB_STORE_STORE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "server/store/state.h"
#include "solver/base/error.h"

struct store;

enum {
  STORE_DIRECTORY_SIZE = 64, /* of the name of an attempt's folder */
  STORE_FAILURES_MAX = 2,    /* lost workers after which one more failure is final */
  STORE_ATTEMPTS_MAX = 10,   /* attempts of one job that may be lost with the daemon */
  STORE_LABELS_OWN_MAX = 32, /* labels of one job */
  STORE_LABELS_MAX = 8       /* label filters of one list query */
};

/* Opens or creates DIR/pneulab.db and brings its schema up to date. Refused, with nothing changed
 * and advice in *error: STATUS_CONFLICT for a database of a newer program or of another one,
 * STATUS_DAMAGED for one that is no longer sound, or is missing beside files of jobs. The caller
 * owns *store. */
enum status store_open(const char *directory, struct store **store, struct error *error);
void store_close(struct store *store);

/* Gives an attempt of a job files of its own that are those of the result in the folder `from`:
 * `names` is an array of file names. Writes the folder that they are in to `directory`; both are
 * relative to the data directory. Called inside of a transaction: it must not ask the store.
 * STATUS_NOT_FOUND when they cannot be had (any more); then the job is solved like any other. */
typedef enum status store_share_files(void *context, const char *from, const json_t *names,
                                      int64_t job_id, int64_t attempt,
                                      char directory[STORE_DIRECTORY_SIZE], struct error *error);

/* Lets jobs that ask for it be answered with the result of an equal one. Without it none is. To be
 * called before any other thread uses the store. */
void store_set_sharing(struct store *store, store_share_files *share, void *context);

/* ---- submitting -------------------------------------------------------------------------- */

struct submission {
  const char *document;          /* the job as text */
  const json_t *root;            /* the same, parsed: an object */
  const char *spec_hash;         /* 64 hex digits */
  double timeout_s;              /* 0: none */
  const char *idempotency_key;   /* or NULL */
  int64_t retry_of;              /* or 0 */
  const char *retry_reason;      /* or NULL */
  const char *submitter;         /* whose share of the workers it uses; NULL: the label "user" */
  int priority;                  /* -100 .. 100 */
  uint64_t memory_bytes;         /* limit of a worker process; 0: none of its own */
  bool reuse;                    /* the result of an equal job will do */
  int64_t extends;               /* of a study: the shorter one that it continues, or 0 */
  int64_t study_id, member;      /* of a member of a study: see server/store/study.h; else 0 */
  int64_t chain, chain_position; /* of a member that is solved after others; chain -1: of none */
};

/* Makes the job durable in state queued and stores its id; with `reuse` and an equal job that
 * succeeded with this version of the solver it is succeeded at once, with that one's result. When
 * the idempotency key is known, nothing is written and *replayed is set: *id is then the earlier
 * job, or the answer is STATUS_CONFLICT if that one had another document. */
enum status store_submit(struct store *store, const struct submission *submission, int64_t *id,
                         bool *replayed, struct error *error);

/* Removes a terminal job with its attempts and results. STATUS_NOT_FOUND, or STATUS_CONFLICT
 * while the job, or the study that it is a member of, is not terminal. The members of a study are
 * deleted after it (store_study_delete). Its files are the caller's to remove. */
enum status store_delete(struct store *store, int64_t id, struct error *error);

/* Asks for the end of a job: one that waits becomes cancelled, one that runs, and a study with
 * members that have not ended, cancelling. *state: the state reached. STATUS_NOT_FOUND, or
 * STATUS_CONFLICT for a terminal job. */
enum status store_cancel(struct store *store, int64_t id, enum job_state *state,
                         struct error *error);

/* Takes a waiting job out of the queue (hold) or puts it back; a study may be held while it runs,
 * too. STATUS_NOT_FOUND, or STATUS_CONFLICT when the job is not queued (not held) or is a member
 * of a study that has not ended, which is held as a whole. */
enum status store_hold(struct store *store, int64_t id, bool hold, struct error *error);

/* Changes what people may change of a job: the members "name" (text or null), "labels" (object of
 * texts or nulls, or null) and "priority" (number or null) of a JSON merge patch (RFC 7396), of
 * which the values have been checked. STATUS_NOT_FOUND; STATUS_CONFLICT for a terminal job, and for
 * the priority of one that no longer waits, unless it is a study, and of a member of a study that
 * has not ended; STATUS_INVALID at /labels for more than
 * STORE_LABELS_OWN_MAX of them. */
enum status store_patch(struct store *store, int64_t id, const json_t *patch, struct error *error);

/* ---- attempts ---------------------------------------------------------------------------- */

struct claim {
  int64_t job_id;
  int64_t attempt;
  double timeout_s;
  uint64_t memory_bytes; /* 0: no limit of its own */
  char *document;        /* malloc'd, owned by the holder of the claim */
  struct claim *next;    /* others of its chain, claimed with it or (job_id is 0) answered */
  int64_t before_id;     /* the one before in its chain, when it has succeeded, or 0 */
  int64_t before_attempt;
  int64_t answered_id; /* when nothing was claimed, or 0: see store_claim */
};

/* Takes the next job that may start, makes it `starting` under a new attempt number and fills
 * *claim; *claimed is false when none waits. Next is, of the jobs with the highest priority, one of
 * the submitter with the fewest running jobs; of equals, of the one who used least worker time of
 * late (half counts after ten minutes); of his the oldest. A job that may be answered with an equal
 * one's result is: then *claimed is false, claim->answered_id names it, and there may be more. One
 * that is equal to a running job waits for its end. With a member of a chain those behind it are
 * taken, too, up to the first that may not start now or has another limit of memory; those that an
 * equal job answers are passed over. */
enum status store_claim(struct store *store, struct claim *claim, bool *claimed,
                        struct error *error);

/* Whose jobs are taken: those that ask for the engine (the labels "executor": "local" and "slurm"),
 * and with `others` those that ask for none. */
enum store_engine { ENGINE_NONE, ENGINE_LOCAL, ENGINE_SLURM };
struct store_taste {
  enum store_engine engine; /* ENGINE_NONE: all jobs */
  bool others;
};

/* The same for the jobs of one engine. */
enum status store_claim_for(struct store *store, struct store_taste taste, struct claim *claim,
                            bool *claimed, struct error *error);

/* Number of jobs that may start now. */
enum status store_ready(struct store *store, int64_t *count, struct error *error);

/* Frees what a claim and those behind it own. */
void claim_clear(struct claim *claim);

/* The worker of an attempt runs (pid 0: not on this machine): starting -> running. STATUS_CONFLICT when the attempt is no
 * longer the job's latest or the job is being cancelled. */
enum status store_attempt_running(struct store *store, int64_t job_id, int64_t attempt, int64_t pid,
                                  struct error *error);

/* How an attempt ended. */
enum attempt_end {
  ATTEMPT_SUCCEEDED,   /* with a result */
  ATTEMPT_FAILED,      /* for good, with or without a result */
  ATTEMPT_TIMED_OUT,   /* with or without a result */
  ATTEMPT_CANCELLED,   /* on request */
  ATTEMPT_WORKER_LOST, /* killed or broke the contract: again, or failed when too often */
  ATTEMPT_REQUEUED     /* the daemon shuts down: back into the queue */
};

struct attempt_outcome {
  int64_t job_id, attempt;
  enum attempt_end end;
  const char *reason_code; /* "" for success */
  const char *message;
  int exit_code; /* -1: a signal ended the worker, or it never ran */
  int signal;    /* 0: none */
  double cpu_s;
  double peak_memory_MB;
  int64_t retry_delay_ms;  /* for ATTEMPT_WORKER_LOST; doubled with every failure */
  const char *result_text; /* the result document, or NULL */
  const json_t *result;    /* the same, parsed and checked */
  const char *directory;   /* of its artifacts, relative to the data directory */
  const json_t *artifacts; /* object: file name -> size in bytes */
};

/* Ends an attempt: result, metrics, samples, artifacts and the change of state in one
 * transaction. A job that is being cancelled becomes cancelled whatever the outcome says. *state:
 * the state reached. STATUS_CONFLICT, with nothing written, when the attempt is not the job's
 * latest or has ended before. */
enum status store_attempt_finish(struct store *store, const struct attempt_outcome *outcome,
                                 enum job_state *state, struct error *error);

/* The same for several attempts in one transaction; states[count]. After a failure nothing is
 * written, for whichever of them it was. */
enum status store_attempts_finish(struct store *store,
                                  const struct attempt_outcome *const *outcomes, size_t count,
                                  enum job_state *states, struct error *error);

/* After a start: attempts that an earlier daemon left open are marked lost; their jobs are queued
 * again, those being cancelled become cancelled, those out of attempts failed. A study runs again
 * however often its attempts were lost, and goes on being cancelled. With `cluster` those that a
 * cluster solves stay open, to be adopted. *count: such jobs. */
enum status store_recover(struct store *store, bool cluster, int64_t *count, struct error *error);

/* ---- reading ----------------------------------------------------------------------------- */

/* One job as read. Strings and JSON values are owned by the record. */
struct job_record {
  int64_t id;
  enum job_state state;
  char *reason_code, *message, *kind, *name, *spec_hash;
  int64_t attempt;
  int64_t retry_of; /* 0: none */
  char *retry_reason, *submitter;
  int priority;
  int64_t reused_from, waits_for;              /* 0: none */
  int64_t study_id, member;                    /* of a member of a study; study_id 0: of none */
  int64_t extends;                             /* of a study: the one that it continues, or 0 */
  enum store_engine engine;                    /* that its label asks for */
  int64_t created_ms, started_ms, finished_ms; /* 0: not yet */
  bool has_result;
  json_t *labels;    /* object of strings */
  json_t *metrics;   /* object of numbers, empty before there is a result */
  json_t *artifacts; /* array of file names */
};

void job_record_clear(struct job_record *record);

/* Reads one job. STATUS_NOT_FOUND. On success the caller clears *record. */
enum status store_job(struct store *store, int64_t id, struct job_record *record,
                      struct error *error);

/* Instead of a study in a list query. */
enum { LIST_STUDY_ANY = 0, LIST_STUDY_NONE = -1 };

struct list_query {
  bool states[JOB_STATE_COUNT]; /* wanted states; none set: all */
  const char *kind;             /* or NULL */
  int64_t study;                /* its members; LIST_STUDY_NONE: members of no study; or any jobs */
  struct {
    const char *name, *value;
  } labels[STORE_LABELS_MAX];
  size_t label_count;
  enum { LIST_BY_ID, LIST_BY_CREATED, LIST_BY_FINISHED, LIST_BY_NAME, LIST_BY_STATE } sort;
  bool descending;
  const char *cursor; /* as the page before gave it, NULL: first page */
  int limit;          /* jobs a page, at least 1 */
};

/* One page, in a time that depends neither on the number of jobs nor on the page. (With several
 * labels the jobs are looked through that have the rarest of them, a bounded number for each page:
 * then a page may have fewer jobs than wanted, or none, though there is a next one.) *records: malloc'd array of
 * *count, each to be cleared, then freed. *next: the cursor of the next page, malloc'd, NULL when
 * this is the last: it stands for a place in the order, whatever becomes of the job there.
 * STATUS_INVALID for a cursor that is none of this order. */
enum status store_list(struct store *store, const struct list_query *query,
                       struct job_record **records, size_t *count, char **next,
                       struct error *error);

/* The job document as submitted, malloc'd. STATUS_NOT_FOUND. */
enum status store_document(struct store *store, int64_t id, char **text, struct error *error);

/* The result document and (unless NULL) the folder of its artifacts relative to the data
 * directory, malloc'd. STATUS_NOT_FOUND when there is no result. */
enum status store_result(struct store *store, int64_t id, char **text, char **directory,
                         struct error *error);

/* STATUS_OK when the job has an artifact of that name; else STATUS_NOT_FOUND. */
enum status store_artifact(struct store *store, int64_t id, const char *name, struct error *error);

/* The attempts of a job: array of objects. The caller owns *attempts. */
enum status store_attempts(struct store *store, int64_t id, json_t **attempts, struct error *error);

/* The newest job of that spec hash that succeeded, else the newest one; *id is 0 when there is none.
 */
enum status store_equal_job(struct store *store, const char *spec_hash, int64_t *id,
                            struct error *error);

/* The design parameters of a job: object pointer -> { value, text, unit }. */
enum status store_parameters(struct store *store, int64_t id, json_t **parameters,
                             struct error *error);

/* A number that is another one after every transaction that was committed. Whatever is read after
 * it is at least as new. */
uint64_t store_version(const struct store *store);

/* ---- events ------------------------------------------------------------------------------ */

/* A row of the history: a job has reached a state, or 'deleted'. Texts live as long as the call
 * that hands it over. */
struct job_event {
  int64_t id;
  int64_t at_ms;
  int64_t job_id;
  int64_t attempt;
  const char *state, *reason_code;
  const char *labels; /* of the job now, as a JSON object of strings */
};

/* From now on committed(context) is called after every transaction that wrote an event, on the
 * thread that wrote it, with nothing locked. NULL ends that. */
void store_watch_events(struct store *store, void (*committed)(void *context), void *context);

/* The id of the newest event, 0 when there is none. */
enum status store_event_last(struct store *store, int64_t *id, struct error *error);

/* Hands up to `limit` events with ids above `after` to take(), in order, until it returns false.
 * *count: how many it took. */
enum status store_events(struct store *store, int64_t after, int limit,
                         bool (*take)(void *context, const struct job_event *event), void *context,
                         int *count, struct error *error);

/* The labels of a job: an object of strings, empty when there is no such job. The caller owns
 * *labels. */
enum status store_labels(struct store *store, int64_t id, json_t **labels, struct error *error);

/* ------------------------------------------------------------------------------------------ */

/* Whether a copy under way is to be given up. */
typedef bool snapshot_stop(void *context);

/* Writes a consistent copy of the database, of one moment, to an empty or absent file; writers go
 * on meanwhile. stop (or NULL) is asked every MiB: STATUS_CANCELLED when it says so. After a
 * failure the file is the caller's to remove. */
enum status store_snapshot(struct store *store, const char *path, snapshot_stop *stop,
                           void *context, struct error *error);

/* ---- with or without a daemon ------------------------------------------------------------ */

/* Writes a consistent copy of DIR/pneulab.db to a file, beside a running daemon or without one. The
 * file appears whole or not at all, checked and durable. Without `replace` an existing file is
 * refused with STATUS_CONFLICT. */
enum status store_backup(const char *directory, const char *path, bool replace,
                         struct error *error);

/* Puts a backup in the place of DIR/pneulab.db, after checking it; the caller holds the lock of the
 * directory. The files that were there are kept: renamed to pneulab.db.replaced and so on. Without
 * `replace` a database that is there is refused with STATUS_CONFLICT. */
enum status store_restore(const char *directory, const char *path, bool replace,
                          struct error *error);

/* Checks all of DIR/pneulab.db, however long that takes. STATUS_DAMAGED or STATUS_CONFLICT with
 * what was found. */
enum status store_verify(const char *directory, struct error *error);

/* Whether a status is a failure of the database that may pass: what failed is worth another try. */
bool store_failed(enum status status);

/* STATUS_OK while transactions can be written, else the status and reason of the last failure
 * (STATUS_NO_SPACE, STATUS_IO, STATUS_DAMAGED). Waits for nobody. */
enum status store_health(struct store *store, struct error *error);

/* Writes one small durable transaction to see whether that works, and returns its status. */
enum status store_probe(struct store *store, struct error *error);

/* Writes the store's metrics in the text form of Prometheus. */
void store_metrics(struct store *store, FILE *out);

/* Number of jobs in each state. */
enum status store_counts(struct store *store, int64_t counts[JOB_STATE_COUNT], struct error *error);

#endif
