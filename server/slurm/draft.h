/* Tasks on their way to the cluster: jobs that have been claimed, bundled. */
#ifndef PNEULAB_SLURM_DRAFT_H
#define PNEULAB_SLURM_DRAFT_H

#include "server/store/cluster.h"

enum { DRAFT_MEMBERS_MAX = 512 };

/* An attempt of a draft. */
struct draft_member {
  int64_t job_id, attempt;
  double time_limit_s; /* with the margin */
  char *document;      /* malloc'd */
  bool start;          /* begins a chain */
  char kind[40];
};

struct draft {
  struct draft *next;
  struct draft_member *member; /* malloc'd, `count` of `room` */
  size_t count, room;
  int64_t before_id, before_attempt; /* whose states the first one starts from, or 0 */
  uint64_t memory_bytes;             /* limit of its processes, 0: none */
  bool memory_own;                   /* a job has asked for it */
  char partition[CLUSTER_WORD_SIZE]; /* of a label, or "" */
  int priority;
  double mean_s; /* what it is believed to take */
  double time_s; /* limits of those of its jobs that have one of their own, together */
  double rest_s; /* limit of those that have none: it counts once; 0 without such */
};

void draft_destroy(struct draft *draft);

/* Whether two can be tasks of one array, or one task. */
bool draft_alike(const struct draft *a, const struct draft *b);

/* Appends the members of `from`, which is destroyed. STATUS_NO_MEMORY, with nothing changed. */
enum status draft_append(struct draft *draft, struct draft *from, struct error *error);

#endif
