#include "server/base/follow.h"

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

enum { PIECE_BYTES = 65536 };

bool follow_lines(const char *path, off_t *offset, follow_taker *take, void *context) {
  char piece[PIECE_BYTES];
  int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  ssize_t got = fd >= 0 ? pread(fd, piece, sizeof piece, *offset) : -1;
  if (fd >= 0) {
    close(fd);
  }
  const char *start = piece, *newline;
  while (got > 0 && (newline = memchr(start, '\n', (size_t)(piece + got - start)))) {
    take(context, start, (size_t)(newline - start));
    start = newline + 1;
  }
  bool endless = start == piece && got == (ssize_t)sizeof piece;
  off_t taken = endless ? got : start - piece;
  *offset += taken;
  return taken > 0;
}
