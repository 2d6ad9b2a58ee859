#include "server/base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"

void log_line(const char *format, ...) {
  char line[1024];
  clock_format(clock_unix_ms(), line);
  size_t used = strlen(line);
  line[used++] = ' ';
  va_list arguments;
  va_start(arguments, format);
  int written = vsnprintf(line + used, sizeof line - used - 1, format, arguments);
  va_end(arguments);
  if (written < 0) {
    return;
  }
  size_t end = used + (size_t)written;
  if (end > sizeof line - 2) {
    end = sizeof line - 2;
  }
  for (size_t i = used; i < end; i++) {
    if ((unsigned char)line[i] < 0x20 || line[i] == 0x7f) {
      line[i] = '?';
    }
  }
  line[end++] = '\n';
  ssize_t ignored = write(STDERR_FILENO, line, end);
  (void)ignored; /* a lost log line is no reason to stop */
}
