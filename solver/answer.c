#include "solver/answer.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include "solver/job/json.h"

char *answer_read_job(const char *path, size_t *size, struct error *error) {
  FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "r");
  char *text = malloc(JSON_TEXT_MAX + 1);
  if (!file || !text) {
    error_set(error, STATUS_IO, NULL, "cannot read %s: %s", path, strerror(errno));
    free(text);
    text = NULL;
  } else {
    *size = fread(text, 1, JSON_TEXT_MAX + 1, file);
    if (ferror(file)) {
      error_set(error, STATUS_IO, NULL, "reading %s failed: %s", path, strerror(errno));
      free(text);
      text = NULL;
    }
  }
  if (file && file != stdin) {
    fclose(file);
  }
  return text;
}

void answer_write(const json_t *document, FILE *file) {
  size_t layout = json_object_get(document, "members") ? JSON_COMPACT : JSON_INDENT(1);
  json_dumpf(document, file, layout | JSON_REAL_PRECISION(12));
  putc('\n', file);
}

static bool is_invalid(const struct error *error) {
  return error->status == STATUS_INVALID || error->status == STATUS_SYNTAX ||
         error->status == STATUS_GEOMETRY || error->status == STATUS_TOO_LARGE;
}

json_t *answer_of_error(const struct error *error) {
  json_t *problem = json_pack("{s:s, s:s, s:s}", "code", status_word(error->status), "message",
                              error->message, "pointer", error->pointer);
  json_set_error(problem, error);
  return json_pack("{s:s, s:o}", "status", is_invalid(error) ? "invalid" : "error", "error",
                   problem);
}

enum exit_code answer_exit_of_error(const struct error *error) {
  return is_invalid(error) ? EXIT_INVALID_JOB : EXIT_INTERNAL;
}

enum exit_code answer_exit_of_ending(enum status ending) {
  return ending == STATUS_OK          ? EXIT_SUCCEEDED
         : ending == STATUS_CANCELLED ? EXIT_CANCELLED
                                      : EXIT_STOPPED_EARLY;
}
