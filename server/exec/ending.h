/* How attempts end, whoever ran them: their outcome is stored, counted and written to the log. */
#ifndef PNEULAB_EXEC_ENDING_H
#define PNEULAB_EXEC_ENDING_H

#include "server/exec/executor.h"
#include "server/exec/outcome.h"
#include "server/exec/run.h"

/* Who ends attempts; what it points to outlives it. */
struct ending {
  const struct engine_settings *settings;
  /* Waits for a while before the database is asked again; false once the daemon ends. */
  bool (*pause)(void *context);
  void *context;
};

/* What is known of a job when its attempt starts, for the counts. */
struct ending_job {
  char kind[40];
  int64_t start_ms; /* monotonic */
};

/* Room for the name of an attempt's folder. */
enum { ENDING_DIRECTORY_SIZE = RUN_DIRECTORY_SIZE + 8 };

/* Reads what the counts need to know of a job whose attempt starts. */
struct ending_job ending_job_read(const struct ending *ending, int64_t job_id, int64_t attempt);

/* Completes an outcome for the store; `troubles` are those of the disk when the attempt began.
 * `directory` gets the name of its folder, and lives as long as the outcome. */
void ending_fill(const struct ending *ending, int64_t job_id, int64_t attempt, unsigned troubles,
                 char directory[ENDING_DIRECTORY_SIZE], struct outcome *outcome);

/* Stores complete outcomes and counts them: in one transaction or, when that fails for one of them,
 * one after the other. While the database fails (a full disk) it is asked again; if the daemon ends
 * before that helps, the attempts stay open. A result that the database refuses fails its job; an
 * attempt that is no longer its job's current one is passed over. */
void ending_store(const struct ending *ending, const struct ending_job *const *jobs,
                  struct outcome *const *outcomes, size_t count);

#endif
