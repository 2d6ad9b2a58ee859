#include "solver/base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

/* A field that was full may end inside a UTF-8 character, which no JSON writer would take. */
static void drop_partial_character(char *field, size_t size) {
  char *end = field + size - 1;
  size_t length = strnlen(field, size);
  if (field + length < end) {
    return;
  }
  size_t start = length;
  while (start > 0 && ((unsigned char)field[start - 1] & 0xC0) == 0x80) {
    start--;
  }
  if (start == 0) {
    return;
  }
  unsigned char lead = (unsigned char)field[start - 1];
  size_t wanted = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 1;
  if (length - (start - 1) < wanted) {
    field[start - 1] = '\0';
  }
}

enum status error_set(struct error *error, enum status status, const char *pointer,
                      const char *format, ...) {
  if (!error) {
    return status;
  }
  *error = (struct error){.status = status};
  snprintf(error->pointer, sizeof error->pointer, "%s", pointer ? pointer : "");
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->message, sizeof error->message, format, arguments);
  va_end(arguments);
  drop_partial_character(error->pointer, sizeof error->pointer);
  drop_partial_character(error->message, sizeof error->message);
  return status;
}
