#include "server/slurm/draft.h"

#include <stdlib.h>
#include <string.h>

void draft_destroy(struct draft *draft) {
  if (!draft) {
    return;
  }
  for (size_t i = 0; i < draft->count; i++) {
    free(draft->member[i].document);
  }
  free(draft->member);
  free(draft);
}

bool draft_alike(const struct draft *a, const struct draft *b) {
  return a->memory_bytes == b->memory_bytes && a->memory_own == b->memory_own &&
         a->priority == b->priority && strcmp(a->partition, b->partition) == 0;
}

enum status draft_append(struct draft *draft, struct draft *from, struct error *error) {
  size_t count = draft->count + from->count;
  if (count > draft->room) {
    struct draft_member *member = realloc(draft->member, 2 * count * sizeof *member);
    if (!member) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a bundle of jobs.");
    }
    draft->member = member;
    draft->room = 2 * count;
  }
  memcpy(draft->member + draft->count, from->member, from->count * sizeof *from->member);
  draft->count = count;
  draft->mean_s += from->mean_s;
  draft->time_s += from->time_s;
  draft->rest_s = draft->rest_s > from->rest_s ? draft->rest_s : from->rest_s;
  from->count = 0;
  draft_destroy(from);
  return STATUS_OK;
}
