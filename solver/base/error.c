#include "solver/base/error.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"

bool status_is_final(enum status status) {
  return status == STATUS_TIMEOUT || status == STATUS_CANCELLED || status == STATUS_NO_MEMORY;
}

const char *status_word(enum status status) {
  static const char *const words[] = {
#define STATUS_WORD(name, word, sentence) word,
      STATUS_LIST(STATUS_WORD)
#undef STATUS_WORD
  };
  return (unsigned)status < STATUS_COUNT ? words[status] : "unknown";
}

const char *status_sentence(enum status status) {
  static const char *const sentences[] = {
#define STATUS_SENTENCE(name, word, sentence) sentence,
      STATUS_LIST(STATUS_SENTENCE)
#undef STATUS_SENTENCE
  };
  return (unsigned)status < STATUS_COUNT ? sentences[status] : "unknown status";
}

/* Copies a part; cutting at the field's size, or a library's own message, may break a character,
 * and no JSON writer would take it then. */
static void copy(char *field, size_t size, const char *text) {
  size_t length = text_prefix(text, size - 1);
  memcpy(field, text, length);
  field[length] = '\0';
  text_repair(field);
}

enum status error_set(struct error *error, enum status status, const char *pointer,
                      const char *format, ...) {
  if (!error) {
    return status;
  }
  *error = (struct error){.status = status};
  copy(error->pointer, sizeof error->pointer, pointer ? pointer : "");
  char text[sizeof error->message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  char *rest = text;
  const char *found = strsep(&rest, "\n");
  const char *allowed = strsep(&rest, "\n");
  if (allowed) {
    copy(error->found, sizeof error->found, found);
    copy(error->allowed, sizeof error->allowed, allowed);
    copy(error->example, sizeof error->example, rest ? rest : "");
  }
  snprintf(error->message, sizeof error->message, "%s%s%s%s%s", found, allowed ? ": " : "",
           allowed ? allowed : "", rest ? "; for example " : "", rest ? rest : "");
  text_repair(error->message);
  return status;
}

enum status error_nearest(struct error *error, enum status status, const char *nearest) {
  if (error) {
    copy(error->nearest, sizeof error->nearest, nearest ? nearest : "");
  }
  return status;
}

void error_carry(struct error *error, const char *pointer, const char *format, ...) {
  char words[300], whole[sizeof words + sizeof error->message];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(words, sizeof words, format, arguments);
  va_end(arguments);
  snprintf(whole, sizeof whole, "%s%s", words, error->message);
  copy(error->message, sizeof error->message, whole);
  copy(error->pointer, sizeof error->pointer, pointer);
}

const char *error_describe(const struct error *error, char *out, size_t size) {
  char place[60] = "";
  bool pointer = error->pointer[0] != '\0';
  if (error->line > 0) {
    snprintf(place, sizeof place, "%sline %d, column %d%s", pointer ? " (" : "", error->line,
             error->column, pointer ? ")" : "");
  }
  snprintf(out, size, "%s%s%s%s", error->pointer, place, pointer || place[0] ? ": " : "",
           error->message);
  text_repair(out);
  return out;
}
