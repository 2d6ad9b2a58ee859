/* Inside the conductor: one study that runs. */
#ifndef PNEULAB_STUDY_WORK_H
#define PNEULAB_STUDY_WORK_H

#include "server/exec/pace.h"
#include "server/store/study.h"
#include "server/study/columns.h"
#include "server/study/conductor.h"
#include "server/study/order.h"
#include "solver/job/study_optimise.h"

struct work {
  int64_t id, attempt;
  struct work *next;
  struct job_spec spec; /* of the study */
  struct study study;
  struct columns *columns;
  struct study_search *search; /* of a study that searches, else NULL */
  size_t told;                 /* members that the search knows the results of */
  char *submitter;
  int priority;
  bool followed; /* the members that wait have this priority */
  uint64_t memory_bytes;
  struct chain_place *place; /* of each member; NULL for a search, whose members come singly */
  size_t *order;            /* the members in the order of their chains, in which they are stored */
  size_t added;             /* members that are stored, or that have been looked at */
  bool stored;              /* all of them */
  bool viewed;              /* the view of the study has its metrics */
  double elapsed_s;         /* of earlier attempts */
  int64_t start_ms;         /* of this one, on the monotonic clock */
  double limit_s;           /* of all of them, 0: none */
  bool out_of_time;         /* members are being cancelled for that */
  struct progress progress; /* under the conductor's mutex */
  struct pace pace;
};

/* Reads and expands a study that was claimed; the claim's texts are taken over. *work is the
 * caller's also after a failure: it then names the attempt that has to be ended. The failures of
 * job_reader_read; STATUS_CONFLICT when the study has changed meanwhile; those of the store. */
enum status work_begin(const struct conductor_settings *settings, struct study_claim *claim,
                       struct work **work, struct error *error);

/* NULL is fine. */
void work_destroy(struct work *work);

/* Stores the next members; *more: whether there are others left. Failures of the store. */
enum status work_add(const struct conductor_settings *settings, struct work *work, bool *more,
                     struct error *error);

/* Starts the search of a study that has one; its members are those of the first round. */
enum status work_search_begin(const struct conductor_settings *settings, struct work *work,
                              struct error *error);

/* Goes on with a search whose members so far have all ended. *more: whether it has asked for
 * others; without, all members are stored. The failures of study_search_next, study_expand and the
 * store. */
enum status work_search(const struct conductor_settings *settings, struct work *work, bool *more,
                        struct error *error);

/* Makes the result of a study whose members have all ended, and ends it. */
enum status work_finish(const struct conductor_settings *settings, struct work *work,
                        enum job_state *state, struct error *error);

/* Ends the attempt otherwise: in the queue again, or failed for the reason in *why. */
enum status work_requeue(const struct conductor_settings *settings, const struct work *work,
                         struct error *error);
enum status work_fail(const struct conductor_settings *settings, const struct work *work,
                      const struct error *why, struct error *error);

#endif
