/* Inside of a running study, shared by its files. */
#ifndef PNEULAB_STUDY_STUDY_INTERNAL_H
#define PNEULAB_STUDY_STUDY_INTERNAL_H

#include "solver/explore/study_document.h"
#include "solver/job/study.h"
#include "solver/job/study_optimise.h"
#include "solver/study/child.h"
#include "solver/study/store.h"
#include "solver/study/study_run.h"

/* A member gets this much longer than its own time limit, in s. */
#define STUDY_MARGIN_S 30.0

/* What has become of a member that is solved itself. */
struct member_state {
  bool settled;      /* solved, resumed or failed */
  bool resumed;      /* its result was there */
  char reason[40];   /* why there is no result, "" when there is one */
  char message[400]; /* the same in a sentence */
};

/* One process and the member it solves; of light members, the process alone. */
struct slot {
  struct child child;
  size_t member;
  double deadline_s;
  bool overdue; /* was asked to end because of the deadline */
};

struct study_run {
  const struct study_options *options;
  const json_t *document;
  struct job_reader *reader;
  struct study study;
  struct member_store store;
  struct member_state *state; /* of every member */
  struct slot slot[STUDY_JOBS_MAX];
  int slots;
  size_t next; /* first member that has not been looked at */
  size_t settled;
  struct study_search *search; /* of a study that searches, else NULL */
  size_t told;                 /* members that the search knows the results of */
  double deadline_s;           /* clock_wall_s, infinite without a limit */
  struct study_figures figures;
};

/* Why the study has to end now, or STATUS_OK. */
enum status study_ending(const struct study_run *run);

/* The next member to be computed, settling on the way those whose result is there; the number of
 * members when there is none. */
size_t study_next_member(struct study_run *run);

/* Notes why a member has no result. */
void study_fail(struct member_state *state, const char *reason, const char *message);

/* Notes that a member has its result or never will. */
void study_settle(struct study_run *run, size_t index);

/* Ends the processes that still run, and waits for that. */
void study_stop(struct study_run *run);

/* Takes the members of the next round of a search into the study, when all that there are have been
 * settled. *more: whether there are some; never in a study that does not search. The failures of
 * study_search_next and study_expand. */
enum status study_next_round(struct study_run *run, bool *more, struct error *error);

/* Solves light members until all are settled or the study has to end.
 * STATUS_OK, STATUS_IO or STATUS_NO_MEMORY. */
enum status study_work_light(struct study_run *run, enum status *ending, struct error *error);

#endif
