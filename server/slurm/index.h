/* Members by their jobs. */
#ifndef PNEULAB_SLURM_INDEX_H
#define PNEULAB_SLURM_INDEX_H

#include <stdint.h>

#include "solver/base/error.h"

struct slurm_member;

/* Adds a member to the tree (NULL: an empty one), which does not own it. STATUS_NO_MEMORY. */
enum status index_add(void **index, struct slurm_member *member, struct error *error);
void index_remove(void **index, const struct slurm_member *member);

/* A member of the job, NULL for none. */
struct slurm_member *index_find(void *const *index, int64_t job_id);

#endif
