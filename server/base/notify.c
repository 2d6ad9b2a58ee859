#include "server/base/notify.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

void notify_send(const char *state) {
  const char *path = getenv("NOTIFY_SOCKET");
  struct sockaddr_un to = {.sun_family = AF_UNIX};
  size_t length = path ? strlen(path) : 0;
  if (length < 2 || length >= sizeof to.sun_path || (path[0] != '/' && path[0] != '@')) {
    return;
  }
  memcpy(to.sun_path, path, length);
  to.sun_path[0] = '/';
  if (path[0] == '@') {
    to.sun_path[0] = '\0'; /* an abstract name */
  }
  int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd >= 0) {
    sendto(fd, state, strlen(state), MSG_NOSIGNAL | MSG_DONTWAIT, (const struct sockaddr *)&to,
           (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length));
    close(fd);
  }
}

int64_t notify_watchdog_ms(void) {
  const char *micro = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");
  if (!micro || (pid && atol(pid) != (long)getpid())) {
    return 0;
  }
  return atoll(micro) / 2000;
}
