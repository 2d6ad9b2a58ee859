#include "server/slurm/index.h"

#include <search.h>

#include "server/slurm/slurm_internal.h"

/* By job, then by attempt: one that was taken back may be here again before it is settled. */
static int compare(const void *first, const void *second) {
  const struct slurm_member *a = first, *b = second;
  int by_job = (a->job_id > b->job_id) - (a->job_id < b->job_id);
  return by_job ? by_job : (a->attempt > b->attempt) - (a->attempt < b->attempt);
}

static int compare_job(const void *first, const void *second) {
  const struct slurm_member *a = first, *b = second;
  return (a->job_id > b->job_id) - (a->job_id < b->job_id);
}

enum status index_add(void **index, struct slurm_member *member, struct error *error) {
  return tsearch(member, index, compare)
             ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the jobs of a cluster.");
}

void index_remove(void **index, const struct slurm_member *member) {
  tdelete(member, index, compare);
}

struct slurm_member *index_find(void *const *index, int64_t job_id) {
  const struct slurm_member wanted = {.job_id = job_id};
  struct slurm_member *const *found = tfind(&wanted, index, compare_job);
  return found ? *found : NULL;
}
