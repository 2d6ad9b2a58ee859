#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/file.h"
#include "server/http/answers.h"
#include "server/http/service.h"
#include "solver/job/json.h"

enum { RETRY_AFTER_S = 5 };

void reply_init(struct reply *reply) {
  *reply = (struct reply){.status = 200, .fd = -1};
}

void reply_clear(struct reply *reply) {
  free(reply->body);
  if (reply->kept) {
    answer_release(reply->kept->text);
  }
  if (reply->fd >= 0) {
    close(reply->fd);
  }
  if (reply->stream.done) {
    reply->stream.done(reply->stream.context);
  }
  reply_init(reply);
}

void reply_header(struct reply *reply, const char *name, const char *format, ...) {
  size_t at = 0;
  while (at < reply->header_count && strcmp(reply->headers[at].name, name) != 0) {
    at++;
  }
  if (at == REPLY_HEADERS_MAX) {
    return;
  }
  reply->header_count += at == reply->header_count;
  reply->headers[at].name = name;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(reply->headers[at].value, sizeof reply->headers[at].value, format, arguments);
  va_end(arguments);
}

static void reply_no_memory(struct reply *reply) {
  static const char text[] = "{\"type\":\"urn:pneulab:no_memory\",\"title\":\"memory ran out\","
                             "\"status\":503,\"code\":\"no_memory\"}\n";
  reply->status = 503;
  reply_static(reply, "application/problem+json", text, sizeof text - 1);
}

/* The value as indented text that ends in a newline; NULL without memory. */
static char *json_text(const json_t *value) {
  char *text = NULL;
  size_t size = 0;
  FILE *out = value ? open_memstream(&text, &size) : NULL;
  if (!out) {
    return NULL;
  }
  int failed = json_dumpf(value, out, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
  failed |= fputc('\n', out) == EOF;
  failed |= fclose(out);
  if (failed) {
    free(text);
    text = NULL;
  }
  return text;
}

static void reply_json_typed(struct reply *reply, unsigned status, const char *content_type,
                             json_t *value) {
  char *text = json_text(value);
  json_decref(value);
  reply->status = status;
  reply_text(reply, content_type, text, text ? strlen(text) : 0);
}

void reply_json(struct reply *reply, unsigned status, json_t *value) {
  reply_json_typed(reply, status, "application/json", value);
}

void reply_text(struct reply *reply, const char *content_type, char *text, size_t size) {
  if (!text) {
    reply_no_memory(reply);
    return;
  }
  free(reply->body);
  reply->body = text;
  reply->static_body = NULL;
  reply->size = size;
  reply->content_type = content_type;
}

void reply_static(struct reply *reply, const char *content_type, const void *data, size_t size) {
  free(reply->body);
  reply->body = NULL;
  reply->static_body = data;
  reply->size = size;
  reply->content_type = content_type;
}

void reply_kept(struct reply *reply, const char *content_type, struct answer *answer) {
  reply->kept = answer;
  reply->size = answer->size;
  reply->content_type = content_type;
}

void reply_file(struct reply *reply, const char *content_type, const char *directory,
                const char *path) {
  size_t size;
  int fd = file_open_below(directory, path, &size);
  if (fd < 0) {
    reply_problem(reply, 404, "not_found", "The file is not there.");
    return;
  }
  reply->fd = fd;
  reply->size = size;
  reply->content_type = content_type;
}

void reply_stream(struct reply *reply, const char *content_type,
                  const struct reply_stream *stream) {
  reply->stream = *stream;
  reply->content_type = content_type;
}

static json_t *problem_make(unsigned status, const char *code, const char *title,
                            const char *detail) {
  char type[100];
  snprintf(type, sizeof type, "urn:pneulab:%s", code);
  return json_pack("{s:s, s:s, s:i, s:s, s:s}", "type", type, "title", title, "status", (int)status,
                   "detail", detail, "code", code);
}

/* The general meaning of an HTTP status, as a problem's title. */
static const char *status_title(unsigned status) {
  static const struct {
    unsigned status;
    const char *title;
  } titles[] = {{400, "the request is malformed"},
                {401, "the request needs a valid token"},
                {403, "the request is not allowed"},
                {404, "the named thing does not exist"},
                {405, "the resource does not offer this method"},
                {409, "the request does not fit the present state"},
                {410, "the thing was here and is gone"},
                {413, "the request body is too large"},
                {421, "the request is meant for another server"},
                {422, "the content breaks a rule"},
                {429, "the client sends too many requests"},
                {501, "the request needs something that is not offered"},
                {503, "the service cannot do this now"},
                {507, "there is no space to store this"}};
  for (size_t i = 0; i < sizeof titles / sizeof *titles; i++) {
    if (titles[i].status == status) {
      return titles[i].title;
    }
  }
  return "the request failed";
}

/* Sends a problem. Those that pass by themselves say when it is worth asking again. */
static void reply_problem_send(struct reply *reply, unsigned status, json_t *problem) {
  reply_json_typed(reply, status, "application/problem+json", problem);
  if (status == 503 || status == 507) {
    reply_header(reply, "Retry-After", "%d", RETRY_AFTER_S);
  }
}

void reply_problem(struct reply *reply, unsigned status, const char *code, const char *format,
                   ...) {
  char detail[500];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(detail, sizeof detail, format, arguments);
  va_end(arguments);
  json_t *problem = problem_make(status, code, status_title(status), detail);
  if (!problem) { /* a detail cut inside a character of its input */
    problem = problem_make(status, code, status_title(status), status_title(status));
  }
  reply_problem_send(reply, status, problem);
}

static unsigned error_http_status(enum status status) {
  switch (status) {
  case STATUS_SYNTAX:
    return 400;
  case STATUS_INVALID:
  case STATUS_GEOMETRY:
    return 422;
  case STATUS_NOT_FOUND:
    return 404;
  case STATUS_CONFLICT:
    return 409;
  case STATUS_TOO_LARGE:
    return 413;
  case STATUS_NO_SPACE:
    return 507;
  case STATUS_NO_MEMORY:
  case STATUS_IO:
  case STATUS_BUSY:
  case STATUS_DAMAGED:
    return 503;
  default:
    return 500;
  }
}

void reply_shutting_down(struct reply *reply) {
  reply_problem(reply, 503, "shutting_down", "The server is shutting down; try again later.");
}

void reply_error(struct reply *reply, const struct error *error) {
  unsigned status = error_http_status(error->status);
  char detail[ERROR_TEXT_MAX];
  json_t *problem = problem_make(status, status_word(error->status), status_sentence(error->status),
                                 error_describe(error, detail, sizeof detail));
  if (problem && error->status <= STATUS_GEOMETRY) {
    json_object_set_new(problem, "pointer", json_string(error->pointer));
  }
  json_set_error(problem, error);
  reply_problem_send(reply, status, problem);
}
