#include "server/exec/progress.h"

#include <fcntl.h>
#include <jansson.h>
#include <string.h>
#include <unistd.h>

void progress_take_line(const char *line, size_t size, struct progress *progress) {
  json_t *event = json_loadb(line, size, JSON_REJECT_DUPLICATES, NULL);
  const char *word = json_string_value(json_object_get(event, "event"));
  const json_t *fraction = json_object_get(event, "fraction");
  const json_t *pressure = json_object_get(event, "pressure_kPa");
  if (word && strcmp(word, "progress") == 0 && json_is_number(fraction)) {
    double value = json_number_value(fraction);
    if (value >= 0 && value <= 1) {
      progress->fraction = value;
      progress->pressure_kPa = json_is_number(pressure) ? json_number_value(pressure) : -1;
    }
  }
  json_decref(event);
}

bool progress_poll(struct progress_reader *reader, struct progress *progress) {
  char buffer[65536];
  int fd = open(reader->path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (fd < 0) {
    return false;
  }
  ssize_t got = pread(fd, buffer, sizeof buffer, reader->offset);
  close(fd);
  if (got <= 0) {
    return false;
  }
  const char *start = buffer, *end = buffer + got, *newline;
  struct progress before = *progress;
  while ((newline = memchr(start, '\n', (size_t)(end - start)))) {
    progress_take_line(start, (size_t)(newline - start), progress);
    start = newline + 1;
  }
  bool line_too_long = start == buffer && (size_t)got == sizeof buffer;
  reader->offset += line_too_long ? got : start - buffer;
  return before.fraction != progress->fraction || before.pressure_kPa != progress->pressure_kPa;
}
