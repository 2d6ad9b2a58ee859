/* Studies in the database: jobs of the kind "study", which no worker takes, and their members,
 * which are jobs like any others. Writers are fenced by the attempt of the study. */
#ifndef PNEULAB_STORE_STUDY_H
#define PNEULAB_STORE_STUDY_H

#include "server/store/retention.h"
#include "server/store/store.h"

/* A study that has not ended. */
struct study_job {
  int64_t id, attempt;
  enum job_state state;
  int priority;
  bool stored; /* all its members are jobs */
};

enum { STUDIES_LIVE_MAX = 1000 };

/* The studies that run, are held or are being cancelled, oldest first and at most
 * STUDIES_LIVE_MAX. *list: malloc'd. */
enum status store_studies_live(struct store *store, struct study_job **list, size_t *count,
                               struct error *error);

/* A study that was taken. */
struct study_claim {
  int64_t id, attempt;
  char *document;  /* malloc'd, owned by the holder of the claim */
  char *submitter; /* likewise */
  int priority;
  uint64_t memory_bytes; /* of each member that has no limit of its own; 0: none */
  double elapsed_s;      /* for which earlier attempts have run */
};

void study_claim_clear(struct study_claim *claim);

/* Takes the study that waits longest of those with the highest priority, and makes it run under a
 * new attempt; *claimed is false when none waits. Of one submitter at most `most` run at a time,
 * not counting those of lower priority. */
enum status store_study_claim(struct store *store, int most, struct study_claim *claim,
                              bool *claimed, struct error *error);

/* A parameter as in the table study_parameter. */
struct study_parameter_row {
  const char *pointer, *name, *unit;
  bool categorical, logarithmic;
  double low, high; /* NaN: none */
};

/* Notes what a study consists of, unless that is known already. STATUS_CONFLICT, with nothing
 * written, when the attempt is not the study's current one or the study does not run. */
enum status store_study_begin(struct store *store, int64_t id, int64_t attempt,
                              const char *sampling, size_t members, bool light,
                              const struct study_parameter_row *parameters, size_t count,
                              struct error *error);

/* A value as in the table study_value. */
struct study_value_row {
  double number;    /* NaN: none */
  const char *text; /* NULL: the member has no value, and gets no row */
};

/* A member to be stored. */
struct study_member_row {
  struct submission submission;        /* with study_id and member */
  const struct study_value_row *value; /* one for each parameter of the study */
};

/* Stores members, as many as there is time for in one short transaction but at least one. *stored:
 * how many, from the first on, chains as a whole. Members that are there are passed over.
 * STATUS_CONFLICT as above. */
enum status store_study_add(struct store *store, int64_t id, int64_t attempt,
                            const struct study_member_row *members, size_t count, size_t parameters,
                            size_t *stored, struct error *error);

/* Notes that all members are stored. STATUS_CONFLICT as above. */
enum status store_study_stored(struct store *store, int64_t id, int64_t attempt, size_t members,
                               struct error *error);

/* A member as it stands. */
struct study_member_job {
  int member;
  int64_t job_id;
  enum job_state state;
  bool reused;
  char reason[64];
  char message[400];
};

/* The members that are stored, in their order. *list: malloc'd. */
enum status store_study_members(struct store *store, int64_t id, struct study_member_job **list,
                                size_t *count, struct error *error);

/* Number of members in each state. */
enum status store_study_counts(struct store *store, int64_t id, int64_t counts[JOB_STATE_COUNT],
                               struct error *error);

/* What tells whether a study is still what it was. */
struct study_stamp {
  bool terminal;
  int64_t finished_ms, members;
};

/* STATUS_NOT_FOUND when there is no such study. */
enum status store_study_stamp(struct store *store, int64_t id, struct study_stamp *stamp,
                              struct error *error);

/* Seconds of processor time that the members' workers have used. */
enum status store_study_cpu(struct store *store, int64_t id, double *cpu_s, struct error *error);

/* What the members of a study have to follow. */
enum study_order { STUDY_HOLD, STUDY_RELEASE, STUDY_CANCEL, STUDY_PRIORITY };

/* Lets up to `most` members that wait follow the study: they are held, put back into the queue,
 * cancelled, or get its priority. *changed: how many. */
enum status store_study_follow(struct store *store, int64_t id, enum study_order order, int most,
                               int *changed, struct error *error);

/* The members that a worker has. *ids: up to `room` jobs. */
enum status store_study_running(struct store *store, int64_t id, int64_t *ids, size_t room,
                                size_t *count, struct error *error);

/* Ends a study that is being cancelled and has no member left that waits or runs. STATUS_CONFLICT,
 * with nothing written, otherwise. */
enum status store_study_cancelled(struct store *store, int64_t id, struct error *error);

/* Deletes up to `room` members of studies that were deleted, and lists their files, which are the
 * caller's to remove. *count is 0 when there are none left. */
enum status store_study_delete(struct store *store, struct job_files *files, size_t room,
                               size_t *count, struct error *error);

/* Makes, or makes anew, the view study_ID: a row a member with its parameters and metrics as
 * columns. Of the oldest studies the views go when there are more than STUDY_VIEWS_MAX. */
enum { STUDY_VIEWS_MAX = 100 };
enum status store_study_view(struct store *store, int64_t id, struct error *error);

#endif
