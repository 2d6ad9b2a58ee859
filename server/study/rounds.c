/* A study that searches: its members come round by round, each when the last one has ended. */
#include <stdlib.h>
#include <string.h>

#include "server/study/work.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

enum status work_search_begin(const struct conductor_settings *settings, struct work *work,
                              struct error *error) {
  if (!study_is_search(work->spec.document)) {
    return STATUS_OK;
  }
  return study_search_create(settings->reader, work->spec.document, &work->search, error);
}

/* The result of a member, a new reference; NULL for one that has none. */
static json_t *result_of(struct store *store, const struct study_member_job *job) {
  char *text = NULL;
  if (job->state != JOB_STATE_SUCCEEDED ||
      store_result(store, job->job_id, &text, NULL, NULL) != STATUS_OK) {
    return NULL;
  }
  json_t *result = json_read(text, strlen(text), 0, NULL);
  free(text);
  return result;
}

/* Tells the search what the members of the last round have come to; one that was deleted has
 * failed. */
static enum status tell(const struct conductor_settings *settings, struct work *work,
                        struct error *error) {
  struct study_member_job *list = NULL;
  size_t count = 0, at = 0;
  enum status status = store_study_members(settings->store, work->id, &list, &count, error);
  for (size_t member = work->told; status == STATUS_OK && member < work->study.count; member++) {
    while (at < count && (size_t)list[at].member < member) {
      at++;
    }
    bool there = at < count && (size_t)list[at].member == member;
    json_t *result = there ? result_of(settings->store, &list[at]) : NULL;
    status = study_search_tell(work->search, member, result, error);
    json_decref(result);
    work->told = member + 1;
  }
  free(list);
  return status;
}

/* The members with those of the next round, and the columns, which know the members. */
static enum status expand_again(const struct conductor_settings *settings, struct work *work,
                                struct error *error) {
  struct study study;
  struct columns *columns = NULL;
  enum status status = study_expand(settings->reader, work->spec.document, false, &study, error);
  columns_destroy(work->columns);
  work->columns = NULL;
  study_release(&work->study);
  work->study = study;
  if (status == STATUS_OK) {
    status = columns_create(job_reader_units(settings->reader), work->spec.document, &work->study,
                            &columns, error);
    work->columns = columns;
  }
  return status;
}

enum status work_search(const struct conductor_settings *settings, struct work *work, bool *more,
                        struct error *error) {
  enum status status = tell(settings, work, error);
  *more = false;
  if (status == STATUS_OK) {
    status = study_search_next(work->search, more, error);
  }
  if (status == STATUS_OK && *more) {
    status = expand_again(settings, work, error);
  } else if (status == STATUS_OK) {
    status = store_study_stored(settings->store, work->id, work->attempt, work->study.count, error);
    work->stored = status == STATUS_OK;
  }
  return status;
}
