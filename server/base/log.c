#include "server/base/log.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/clock.h"

enum {
  LINE_MAX_BYTES = 2048,
  NAME_ROOM = 4, /* what stands around a field's name */
  TAIL = 4       /* closing quote, brace, newline */
};

static const char *const words[] = {[LOG_LEVEL_ERROR] = "error",
                                    [LOG_LEVEL_WARNING] = "warning",
                                    [LOG_LEVEL_INFO] = "info",
                                    [LOG_LEVEL_REQUEST] = "request"};
static const char *const priorities[] = {[LOG_LEVEL_ERROR] = "<3>",
                                         [LOG_LEVEL_WARNING] = "<4>",
                                         [LOG_LEVEL_INFO] = "<6>",
                                         [LOG_LEVEL_REQUEST] = "<6>"};

/* The process has one log, as it has one standard error. Written once, before other threads. */
static struct {
  enum log_level level;
  enum log_format format;
  bool journal;
} settings = {.level = LOG_LEVEL_INFO};

/* A line in the making. What does not fit is left out, with room kept for what closes it. */
struct line {
  char text[LINE_MAX_BYTES];
  size_t used;
};

static void line_add(struct line *line, const char *text) {
  size_t length = strlen(text);
  if (line->used + length + TAIL <= sizeof line->text) {
    memcpy(line->text + line->used, text, length);
    line->used += length;
  }
}

/* Escapes as JSON does, which serves the text form, too. */
static void line_escape(struct line *line, const char *text) {
  for (const unsigned char *at = (const unsigned char *)text; *at; at++) {
    char piece[8];
    if (*at == '"' || *at == '\\') {
      snprintf(piece, sizeof piece, "\\%c", *at);
    } else if (*at < 0x20 || *at >= 0x7f) {
      snprintf(piece, sizeof piece, "\\u%04x", *at);
    } else {
      snprintf(piece, sizeof piece, "%c", *at);
    }
    line_add(line, piece);
  }
}

static void line_quote(struct line *line, const char *text) {
  size_t before = line->used;
  line_add(line, "\"");
  if (line->used > before) {
    line_escape(line, text);
    line->text[line->used++] = '"'; /* line_add keeps room for it */
  }
}

/* A word stands for itself in the text form: letters, digits and what paths have. */
static bool is_word(const char *text) {
  static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_-./:,@+%?&~*";
  return text[0] != '\0' && text[strspn(text, plain)] == '\0';
}

static void line_number(struct line *line, double number) {
  char text[40];
  if (!isfinite(number)) {
    snprintf(text, sizeof text, "null");
  } else if (floor(number) == number && fabs(number) < 1e15) {
    snprintf(text, sizeof text, "%.0f", number);
  } else {
    snprintf(text, sizeof text, "%.6g", number);
  }
  line_add(line, text);
}

static void line_field(struct line *line, const struct log_field *field) {
  bool json = settings.format == LOG_FORMAT_JSON;
  size_t before = line->used;
  if (before + strlen(field->name) + NAME_ROOM + TAIL > sizeof line->text) {
    return;
  }
  line_add(line, json ? ",\"" : " ");
  line_add(line, field->name);
  line_add(line, json ? "\":" : "=");
  size_t start = line->used;
  if (!field->text) {
    line_number(line, field->number);
  } else if (!json && is_word(field->text)) {
    line_add(line, field->text);
  } else {
    line_quote(line, field->text);
  }
  if (line->used == start) {
    line->used = before; /* no room: better no field than a name alone */
  }
}

void log_configure(enum log_level level, enum log_format format) {
  struct stat info;
  unsigned long long device = 0, inode = 0;
  const char *stream = getenv("JOURNAL_STREAM"); /* "device:inode" of what systemd gave us */
  settings.level = level;
  settings.format = format;
  settings.journal = stream && sscanf(stream, "%llu:%llu", &device, &inode) == 2 &&
                     fstat(STDERR_FILENO, &info) == 0 && info.st_dev == device &&
                     info.st_ino == inode;
}

bool log_wants(enum log_level level) {
  return level <= settings.level;
}

void log_write(enum log_level level, const char *message, const struct log_field *fields,
               size_t count) {
  struct line line = {.used = 0};
  char now[CLOCK_TEXT_SIZE];
  bool json = settings.format == LOG_FORMAT_JSON;
  if (!log_wants(level)) {
    return;
  }
  clock_format(clock_unix_ms(), now);
  line_add(&line, settings.journal ? priorities[level] : "");
  line_add(&line, json ? "{\"time\":\"" : "");
  line_add(&line, now);
  line_add(&line, json ? "\",\"level\":\"" : " ");
  line_add(&line, words[level]);
  if (json) {
    line_add(&line, "\",\"message\":");
    line_quote(&line, message);
  } else {
    line_add(&line, " ");
    line_escape(&line, message);
  }
  for (size_t i = 0; i < count; i++) {
    line_field(&line, &fields[i]);
  }
  if (json) {
    line.text[line.used++] = '}';
  }
  line.text[line.used++] = '\n';
  ssize_t ignored = write(STDERR_FILENO, line.text, line.used);
  (void)ignored; /* a lost log line is no reason to stop */
}

void log_line(const char *format, ...) {
  char message[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  log_write(LOG_LEVEL_INFO, message, NULL, 0);
}
