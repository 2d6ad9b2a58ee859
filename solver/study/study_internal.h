/* Inside of a running study, shared by its files. */
#ifndef PNEULAB_STUDY_STUDY_INTERNAL_H
#define PNEULAB_STUDY_STUDY_INTERNAL_H

#include "solver/job/study.h"
#include "solver/study/store.h"

/* What has become of a member that is solved itself. */
struct member_state {
  bool settled;      /* solved, resumed or failed */
  bool resumed;      /* its result was there */
  char reason[40];   /* why there is no result, "" when there is one */
  char message[400]; /* the same in a sentence */
};

/* How the run went, for the document. */
struct study_run_figures {
  size_t computed, resumed;
  double wall_s, cpu_s;
};

/* The result document of the study, a new reference; `state` has one entry a member. NULL when
 * memory runs out. */
json_t *study_document(const struct job_spec *spec, const struct study *study,
                       const struct member_state *state, const struct member_store *store,
                       const struct study_run_figures *figures, enum status ending);

/* Turns a member's result into that of its mirror image about y = 0, in place. */
void study_mirror_result(json_t *result);

#endif
