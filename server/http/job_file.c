#include "server/base/clock.h"
#include "server/http/service.h"
#include "server/store/retention.h"

void reply_job_file(const struct request *request, struct reply *reply, const char *content_type,
                    int64_t job_id, const char *path) {
  struct error error;
  char why[8], when[CLOCK_TEXT_SIZE];
  int64_t removed_ms;
  reply_file(reply, content_type, request->service->data, path);
  if (reply->fd >= 0) {
    return;
  }
  if (store_files_removed(request->service->store, job_id, &removed_ms, why, &error) != STATUS_OK) {
    reply_error(reply, &error);
  } else if (removed_ms != 0) {
    clock_format(removed_ms, when);
    reply_problem(reply, 410, "files_removed",
                  "The files of job %lld were removed at %s: %s. Its result, metrics and samples "
                  "are kept.",
                  (long long)job_id, when,
                  why[0] == 'a' ? "they were older than this server keeps files (--keep-files-days)"
                                : "newer files needed the room (--keep-files-size)");
  }
}
