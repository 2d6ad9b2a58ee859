/* Which design does what is wanted best: among those that were solved, and among all others by what
 * the surrogates expect of them. */
#ifndef PNEULAB_STUDY_SEARCH_H
#define PNEULAB_STUDY_SEARCH_H

#include "server/study/analysis.h"
#include "solver/job/spec.h"

struct search_query {
  struct condition condition[CONDITIONS_MAX];
  size_t conditions;
  struct quantity_of goal;
  bool most;     /* else the least of it */
  double chance; /* that a predicted design meets all limits, at least: 0 to 1 */
  size_t limit;  /* designs of either sort, up to ANALYSIS_FOUND_MAX */
};

/* What a search needs beside the table. */
struct search_means {
  struct models *models;
  struct store *store;
  const struct job_reader *reader;
  const json_t *document; /* of the study, defaults filled in or not */
};

/* Looks through the members, then through 2^11 points of the design space and around the best of
 * them. Answers as schema/openapi.yaml says (StudySearch): predicted designs meet the constraints
 * of the study, are valid jobs, and differ by more than 5 % of the range of a parameter. Failures
 * of models_get; STATUS_INVALID for more than 6 metrics. */
enum status search_run(const struct study_table *table, const struct search_means *means,
                       const struct search_query *query, json_t **answer, struct error *error);

/* ---- search_candidates.c ------------------------------------------------------------------ */

enum { SEARCH_METRICS_MAX = 6 };

/* A limit on a weighted sum of the parameters, which are numbers. */
struct search_sum {
  double factor[SURROGATE_PARAMETERS_MAX];
  double low, high;
};

/* What is known of the search while it runs. */
struct search {
  const struct study_table *table;
  const struct search_query *query;
  const struct space *space;
  size_t metric[SEARCH_METRICS_MAX]; /* columns */
  struct model *model[SEARCH_METRICS_MAX];
  double spread[SEARCH_METRICS_MAX]; /* standard deviation of each over the members */
  size_t metrics;
  struct search_sum *sum;
  size_t sums;
};

struct candidate {
  double design[SURROGATE_PARAMETERS_MAX];
  double mean[SEARCH_METRICS_MAX], deviation[SEARCH_METRICS_MAX];
  double chance; /* that all limits are met */
  double goal;   /* less is better */
};

/* Whether a is to be preferred: enough chance first, then the goal; without that the chance. */
bool candidate_better(const struct search *search, const struct candidate *a,
                      const struct candidate *b);

/* The best candidates of the whole space, best first, up to `room`, different ones. *count of
 * them. STATUS_NO_MEMORY. */
enum status search_candidates(const struct search *search, struct candidate *best, size_t room,
                              size_t *count, struct error *error);

#endif
