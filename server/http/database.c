#include "server/http/handlers.h"
#include "server/http/snapshots.h"

enum { COPY_WAIT_MS = 600000 };

/* Sends the copy that the request has waited for. */
static void database_send(struct request *request, struct reply *reply) {
  struct error error;
  int64_t size;
  int fd;
  if (snapshots_take(request->service->snapshots, -request->job_id, &fd, &size, &error) !=
      STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  reply->fd = fd;
  reply->size = (size_t)size;
  reply->content_type = "application/vnd.sqlite3";
  reply_header(reply, "Content-Disposition", "attachment; filename=\"pneulab.db\"");
}

void database_show(struct request *request, struct reply *reply) {
  request->job_id = -snapshots_ask(request->service->snapshots);
  reply->wait_job_id = request->job_id; /* waiters know copies by negative numbers */
  reply->wait_ms = COPY_WAIT_MS;
  reply->then = database_send;
}
