#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "server/http/handlers.h"

void database_show(struct request *request, struct reply *reply) {
  char path[PATH_MAX];
  struct error error;
  int length = snprintf(path, sizeof path, "%s/snapshot-XXXXXX", request->service->data);
  int fd = length > 0 && (size_t)length < sizeof path ? mkstemp(path) : -1;
  if (fd < 0) {
    reply_problem(reply, 500, "io_error", "Cannot create a file for the snapshot.");
    return;
  }
  close(fd);
  if (store_snapshot(request->service->store, path, &error) == STATUS_OK) {
    reply_file(reply, "application/vnd.sqlite3", path);
    reply_header(reply, "Content-Disposition", "attachment; filename=\"pneulab.db\"");
  } else {
    reply_error(reply, &error);
  }
  unlink(path); /* an open file stays readable until it has been sent */
}
