/* The result document of a study, from the results of its members. */
#ifndef PNEULAB_EXPLORE_STUDY_DOCUMENT_H
#define PNEULAB_EXPLORE_STUDY_DOCUMENT_H

#include <jansson.h>
#include "solver/job/study.h"

/* Where the results of the members come from. */
struct study_results {
  void *context;
  /* The result document of a member, a new reference; else NULL with *reason and *message, which
   * are texts that live until the next call. */
  json_t *(*result)(void *context, size_t index, const char **reason, const char **message);
  bool each; /* of every member; else repetitions and mirror images have those of the first */
};

/* How the run went. */
struct study_figures {
  size_t computed, resumed; /* members that were solved, and that were there already */
  double wall_s, cpu_s;
};

/* The result document of a study, a new reference, for the study's job `spec`; ending: STATUS_OK,
 * or why the study has none but a part, STATUS_DIVERGED when not a single member could be solved.
 * NULL when memory runs out. */
json_t *study_document(const struct job_spec *spec, const struct study *study,
                       const struct study_results *results, const struct study_figures *figures,
                       enum status ending);

/* For each metric that a member of the result has: its extremes with the members that have them,
 * its mean and its standard deviation. A new reference. */
json_t *study_summary(const json_t *members);

/* Adds to `warnings` that members have some, and drops theirs when they are much text. */
void study_thin_warnings(json_t *members, json_t *warnings);

#endif
