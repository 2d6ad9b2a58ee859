/* Files of jobs as the database knows them: whose they are, how many bytes they take, and when
 * they are to go. The files themselves are the caller's. */
#ifndef PNEULAB_STORE_RETENTION_H
#define PNEULAB_STORE_RETENTION_H

#include "server/store/store.h"

/* The files of one job: those of its attempts 1 to `attempts`. */
struct job_files {
  int64_t job_id, attempts;
  int64_t bytes; /* on the disk */
};

struct retention {
  int64_t keep_ms;    /* after the end of a job; 0: for ever */
  int64_t keep_bytes; /* of all finished jobs; 0: no limit */
};

/* Finished jobs whose files have not been measured, at most `room` of them. */
enum status store_files_unmeasured(struct store *store, struct job_files *list, size_t room,
                                   size_t *count, struct error *error);

/* Notes the measured bytes of `count` jobs in one transaction. */
enum status store_files_measured(struct store *store, const struct job_files *list, size_t count,
                                 struct error *error);

/* Marks the files of finished jobs that are beyond the limits as removed, the oldest first and at
 * most `room` jobs, and lists those jobs: their files may be removed from now on. */
enum status store_files_expire(struct store *store, const struct retention *limits,
                               struct job_files *list, size_t room, size_t *count,
                               struct error *error);

/* Whether files of this attempt are to be there: *kept is false when the job or the attempt does
 * not exist, or its files were marked as removed. Files of a deleted job stay for the jobs that
 * were answered with its result. */
enum status store_files_kept(struct store *store, int64_t job_id, int64_t attempt, bool *kept,
                             struct error *error);

/* When and why ("age", "size") the files that a job's result refers to were removed; *removed_ms is
 * 0 when they were not. A job that was answered with another one's result has files of its own.
 * why: room for 8 bytes. STATUS_NOT_FOUND. */
enum status store_files_removed(struct store *store, int64_t job_id, int64_t *removed_ms,
                                char why[8], struct error *error);

#endif
