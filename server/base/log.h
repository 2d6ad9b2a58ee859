/* The daemon's own log: one line an event on standard error, as text or JSON.
 *
 * text: 2026-11-22T07:33:26.123Z info attempt ended job=7 attempt=1 state=failed reason=diverged
 * json: {"time":"2026-11-22T07:33:26.123Z","level":"info","message":"attempt ended","job":7,...}
 *
 * Control characters, quotes and bytes that are not ASCII are escaped, so no input can forge a line
 * or a field. Under systemd each line starts with its priority (<6>). */
#ifndef PNEULAB_SERVER_LOG_H
#define PNEULAB_SERVER_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From rare to many; a level includes those before it. */
enum log_level { LOG_LEVEL_ERROR, LOG_LEVEL_WARNING, LOG_LEVEL_INFO, LOG_LEVEL_REQUEST };

enum log_format { LOG_FORMAT_TEXT, LOG_FORMAT_JSON };

/* One named value of an event; the name is a word of the program. */
struct log_field {
  const char *name;
  const char *text; /* NULL: the number counts */
  double number;
};

#define LOG_TEXT(NAME, VALUE) ((struct log_field){.name = (NAME), .text = (VALUE)})
#define LOG_NUMBER(NAME, VALUE) ((struct log_field){.name = (NAME), .number = (double)(VALUE)})

/* Sets what is written and how, before there is a second thread; otherwise text up to
 * LOG_LEVEL_INFO. */
void log_configure(enum log_level level, enum log_format format);

/* Whether events of the level are written: lets callers save the making of their fields. */
bool log_wants(enum log_level level);

/* Writes one event, cut at 2 KiB, in one write; safe from any thread. */
void log_write(enum log_level level, const char *message, const struct log_field *fields,
               size_t count);

/* log_event(LOG_LEVEL_INFO, "attempt ended", LOG_NUMBER("job", 7), LOG_TEXT("state", word)) */
#define log_event(LEVEL, MESSAGE, ...)                                                             \
  log_write(LEVEL, MESSAGE, (const struct log_field[]){__VA_ARGS__},                               \
            sizeof((const struct log_field[]){__VA_ARGS__}) / sizeof(struct log_field))

/* Writes a sentence without fields at LOG_LEVEL_INFO. */
void log_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
