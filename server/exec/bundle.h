/* Several attempts in one process: the members of a chain that were claimed together. */
#ifndef PNEULAB_EXEC_BUNDLE_H
#define PNEULAB_EXEC_BUNDLE_H

#include "server/exec/run.h"

enum { BUNDLE_MEMBERS_MAX = 64 };

/* An attempt that has ended; the outcome is owned by the one who tells it. */
struct bundle_end {
  size_t member;
  struct outcome outcome;
};

/* What the bundle asks of and tells its owner; called on the thread of bundle_run. */
struct bundle_hooks {
  void *context;
  /* The process has come to this member. STATUS_CONFLICT when its attempt should not go on. */
  enum status (*begun)(void *context, size_t member, int64_t pid);
  void (*progressed)(void *context, size_t member, const struct progress *progress);
  /* Some have ended; every member does, once. The outcomes lack what outcome_judge leaves open. */
  void (*ended)(void *context, struct bundle_end *ends, size_t count);
  /* STOP_SHUTDOWN or STOP_ABORT once the process is to end. */
  enum stop_cause (*stop_wanted)(void *context);
  /* Whether a member is to be cancelled. */
  bool (*cancel_wanted)(void *context, size_t member);
};

/* Folder below the data directory for the files of bundles that run; the pool empties it when it
 * starts. */
#define BUNDLE_FOLDER "bundles"

/* Runs claimed attempts (at most BUNDLE_MEMBERS_MAX, in their order) by one process with a folder
 * for each as run_attempt has, and judges each as soon as it is complete. The limits of time and
 * files hold for each member, that of memory for the process. Whatever ends the process early -
 * a crash, a limit, the cancellation of the member that is being solved - counts for that member
 * alone: those behind it are put back into the queue. One that is cancelled before its turn is left
 * out. */
void bundle_run(const struct run_settings *settings, const struct claim *const *members,
                size_t count, const struct bundle_hooks *hooks);

#endif
