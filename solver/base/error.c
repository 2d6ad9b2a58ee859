#include "solver/base/error.h"

#include <stdarg.h>
#include <stdio.h>

#include "solver/base/text.h"

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
  /* Cutting at the field's size, or a library's own message, may break a character; no JSON writer
   * would take it then. */
  text_repair(error->pointer);
  text_repair(error->message);
  return status;
}
