/* A study that searches: its members come round by round. */
#include <stdlib.h>
#include <string.h>

#include "solver/study/study_internal.h"

/* Tells the search what the members of the last round have come to. */
static enum status tell(struct study_run *run, struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = run->told; i < run->study.count && status == STATUS_OK; i++) {
    int same = run->study.member[i].same_as;
    size_t from = same >= 0 ? (size_t)same : i;
    json_t *result = run->state[from].settled && !run->state[from].reason[0]
                         ? member_store_result(&run->store, &run->study.member[from])
                         : NULL;
    status = study_search_tell(run->search, i, result, error);
    json_decref(result);
    run->told = i + 1;
  }
  return status;
}

/* The members, with those of the next round. */
static enum status expand_again(struct study_run *run, struct error *error) {
  size_t before = run->study.count;
  bool keep = !run->study.light;
  study_release(&run->study);
  enum status status = study_expand(run->reader, run->document, keep, &run->study, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct member_state *state = realloc(run->state, run->study.count * sizeof *state);
  if (!state) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the study");
  }
  memset(state + before, 0, (run->study.count - before) * sizeof *state);
  run->state = state;
  run->next = before;
  return STATUS_OK;
}

enum status study_next_round(struct study_run *run, bool *more, struct error *error) {
  *more = false;
  if (!run->search) {
    return STATUS_OK;
  }
  enum status status = tell(run, error);
  if (status == STATUS_OK) {
    status = study_search_next(run->search, more, error);
  }
  return status == STATUS_OK && *more ? expand_again(run, error) : status;
}
