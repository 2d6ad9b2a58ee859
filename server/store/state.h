/* The states of a job. The legal changes between them are rows of job_transition, enforced by a
 * trigger of the database. */
#ifndef PNEULAB_STORE_STATE_H
#define PNEULAB_STORE_STATE_H

#include <stdbool.h>

/* X(name, word, terminal) */
#define JOB_STATE_LIST(X)                                                                          \
  X(QUEUED, "queued", false)                                                                       \
  X(HELD, "held", false)                                                                           \
  X(STARTING, "starting", false)                                                                   \
  X(RUNNING, "running", false)                                                                     \
  X(CANCELLING, "cancelling", false)                                                               \
  X(RETRY_WAIT, "retry_wait", false)                                                               \
  X(SUCCEEDED, "succeeded", true)                                                                  \
  X(FAILED, "failed", true)                                                                        \
  X(TIMED_OUT, "timed_out", true)                                                                  \
  X(CANCELLED, "cancelled", true)

enum job_state {
#define JOB_STATE_ENUM(name, word, terminal) JOB_STATE_##name,
  JOB_STATE_LIST(JOB_STATE_ENUM)
#undef JOB_STATE_ENUM
      JOB_STATE_COUNT
};

/* The word of a state ("retry_wait"). Static storage. */
const char *job_state_word(enum job_state state);

/* Whether a job in this state never changes again. */
bool job_state_terminal(enum job_state state);

/* Finds the state of a word; false when there is none. */
bool job_state_parse(const char *word, enum job_state *state);

#endif
