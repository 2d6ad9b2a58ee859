#include <errno.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/http/service.h"

const char *request_header(const struct request *request, const char *name) {
  return MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, name);
}

/* A whole number without sign or leading zeros, ended by `stop`. */
static bool integer_read(const char *text, char stop, int64_t *value, const char **rest) {
  char *end;
  if (*text < '0' || *text > '9' || (*text == '0' && text[1] >= '0' && text[1] <= '9')) {
    return false;
  }
  errno = 0;
  long long number = strtoll(text, &end, 10);
  if (errno != 0 || (*end != '\0' && *end != stop)) {
    return false;
  }
  *value = number;
  if (rest) {
    *rest = end;
  }
  return true;
}

bool request_id(const struct request *request, struct reply *reply, int64_t *id) {
  if (integer_read(request->parameters[0], '\0', id, NULL) && *id > 0) {
    return true;
  }
  reply_problem(reply, 404, "not_found", "There is no job %.40s; job ids are whole numbers.",
                request->parameters[0]);
  return false;
}

/* Whether a name is in a list of words; a word that ends in a dot stands for all that go on. */
static bool name_in(const char *list, const char *name) {
  while (*list) {
    size_t length = strcspn(list, " ");
    bool open = list[length - 1] == '.';
    if (strncmp(list, name, length) == 0 && (name[length] != '\0') == open) {
      return true;
    }
    list += length + (list[length] == ' ');
  }
  return false;
}

bool request_query_known(const struct request *request, struct reply *reply) {
  const char *known = request->known_query;
  for (size_t i = 0; known && i < request->url.query_count; i++) {
    const char *given = request->url.query[i].name;
    if (!name_in(known, given)) {
      reply_problem(reply, 400, "invalid_query",
                    "There is no query parameter %.60s here; known are: %s.", given,
                    known[0] ? known : "none");
      return false;
    }
  }
  return true;
}

bool request_query_integer(const struct request *request, struct reply *reply, const char *name,
                           int64_t low, int64_t high, int64_t otherwise, int64_t *value) {
  const char *text = url_query(&request->url, name);
  *value = otherwise;
  if (!text || (integer_read(text, '\0', value, NULL) && *value >= low && *value <= high)) {
    return true;
  }
  reply_problem(reply, 400, "invalid_query",
                "%s=%.40s: expected a whole number from %lld to %lld, for example %s=%lld.", name,
                text, (long long)low, (long long)high, name, (long long)otherwise);
  return false;
}

bool request_query_jobs(const struct request *request, struct reply *reply, const char *name,
                        size_t limit, int64_t *ids, size_t *count) {
  const char *rest = url_query(&request->url, name);
  bool fine = rest != NULL;
  *count = 0;
  while (fine && *count < limit && integer_read(rest, ',', &ids[*count], &rest)) {
    for (size_t i = 0; i < *count; i++) {
      fine = fine && ids[i] != ids[*count];
    }
    ++*count;
    if (*rest == '\0') {
      break;
    }
    rest++;
    fine = fine && *rest != '\0';
  }
  if (!fine || *count == 0 || *rest != '\0') {
    reply_problem(reply, 400, "invalid_query",
                  "%s: expected 1 to %zu different job ids, for example %s=1,2,3.", name, limit,
                  name);
    return false;
  }
  return true;
}

int64_t request_wait_s(const struct request *request) {
  const char *prefer = request_header(request, "Prefer");
  const char *wait = prefer ? strcasestr(prefer, "wait=") : NULL;
  if (!wait || (wait != prefer && !strchr(" ,;\t", wait[-1]))) {
    return 0;
  }
  char *end;
  long seconds = strtol(wait + 5, &end, 10);
  if (end == wait + 5 || (*end != '\0' && !strchr(" ,;\t", *end)) || seconds < 0) {
    return 0;
  }
  return seconds < HTTP_WAIT_MAX_S ? seconds : HTTP_WAIT_MAX_S;
}
