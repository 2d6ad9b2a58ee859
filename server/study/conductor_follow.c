/* What a study asks of its members: they are held, released, cancelled and deleted with it. */
#include <stdlib.h>

#include "server/base/log.h"
#include "server/exec/janitor.h"
#include "server/study/conductor_internal.h"

/* Members that follow, and that are deleted, in one transaction; members that may be with
 * workers. */
enum { FOLLOW_MAX = 200, DELETE_MAX = 50, RUNNING_MAX = 1024 };

void conductor_complain(int64_t id, const struct error *error) {
  log_event(LOG_LEVEL_ERROR, error->message, LOG_NUMBER("study", id));
}

void conductor_changed(struct conductor *conductor, int64_t id) {
  conductor->settings.changed(conductor->settings.context, id);
}

bool conductor_follow(struct conductor *conductor, int64_t id, enum study_order order) {
  struct error error;
  int count = 0;
  enum status status =
      store_study_follow(conductor->settings.store, id, order, FOLLOW_MAX, &count, &error);
  if (status != STATUS_OK) {
    conductor_complain(id, &error);
  }
  if (count > 0 && order == STUDY_RELEASE) {
    executor_wake(conductor->executor);
  } else if (count > 0 && order != STUDY_CANCEL) {
    executor_recall(conductor->executor);
  }
  return count == FOLLOW_MAX;
}

void conductor_cancel_running(struct conductor *conductor, int64_t id) {
  static const size_t room = RUNNING_MAX;
  int64_t *ids = malloc(room * sizeof *ids);
  enum job_state state;
  size_t count = 0;
  if (ids) {
    store_study_running(conductor->settings.store, id, ids, room, &count, NULL);
  }
  for (size_t i = 0; i < count; i++) {
    if (store_cancel(conductor->settings.store, ids[i], &state, NULL) == STATUS_OK) {
      executor_cancel(conductor->executor, ids[i]);
    }
  }
  free(ids);
}

void conductor_changed_members(struct conductor *conductor, int64_t id) {
  struct study_member_job *list;
  size_t count;
  if (store_study_members(conductor->settings.store, id, &list, &count, NULL) == STATUS_OK) {
    for (size_t i = 0; i < count; i++) {
      conductor_changed(conductor, list[i].job_id);
    }
    free(list);
  }
}

bool conductor_delete(struct conductor *conductor) {
  const struct conductor_settings *settings = &conductor->settings;
  struct job_files files[DELETE_MAX];
  struct error error;
  size_t count = 0;
  bool kept = true;
  if (store_study_delete(settings->store, files, DELETE_MAX, &count, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, "cannot delete members", LOG_TEXT("error", error.message));
    return false;
  }
  for (size_t i = 0; i < count; i++) {
    if (store_files_kept(settings->store, files[i].job_id, files[i].attempts, &kept, NULL) ==
            STATUS_OK &&
        !kept) {
      janitor_remove_files(settings->data, files[i].job_id, files[i].attempts);
    }
  }
  return count > 0;
}
