#include "server/http/cache.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/service.h"

enum { ETAG_SIZE = 20 };

uint64_t cache_tag(void) {
  return cache_tag_add(UINT64_C(0xcbf29ce484222325), PNEULAB_VERSION, sizeof PNEULAB_VERSION);
}

uint64_t cache_tag_add(uint64_t tag, const void *data, size_t size) {
  const unsigned char *bytes = data;
  for (size_t i = 0; i < size; i++) {
    tag = (tag ^ bytes[i]) * UINT64_C(0x100000001b3);
  }
  return tag;
}

static void etag_write(uint64_t tag, char etag[ETAG_SIZE]) {
  snprintf(etag, ETAG_SIZE, "\"%016" PRIx64 "\"", tag);
}

/* "private": a cache that serves several people has no business with jobs. */
static void etag_mark(struct reply *reply, const char *etag, const char *control) {
  reply_header(reply, "ETag", "%s", etag);
  reply_header(reply, "Cache-Control", "%s", control);
}

void cache_mark(struct reply *reply, uint64_t tag) {
  char etag[ETAG_SIZE];
  etag_write(tag, etag);
  etag_mark(reply, etag, "private, no-cache");
}

/* Whether a list of tags, strong or weak, or the word for all, names this one. */
static bool list_names(const char *list, const char *etag) {
  size_t size = strlen(etag);
  while (*list) {
    list += strspn(list, " \t,");
    list += strncmp(list, "W/", 2) == 0 ? 2 : 0;
    size_t length = strcspn(list, " \t,");
    if ((length == 1 && *list == '*') || (length == size && memcmp(list, etag, size) == 0)) {
      return true;
    }
    list += length;
  }
  return false;
}

static bool request_knows(const struct request *request, const char *etag) {
  const char *known = request_header(request, "If-None-Match");
  return known && list_names(known, etag);
}

bool cache_fresh(const struct request *request, struct reply *reply, uint64_t tag) {
  char etag[ETAG_SIZE];
  etag_write(tag, etag);
  if (!request_knows(request, etag)) {
    return false;
  }
  reply->status = 304;
  etag_mark(reply, etag, "private, no-cache");
  return true;
}

bool cache_fresh_text(const struct request *request, struct reply *reply, const char *etag) {
  bool fresh = request_knows(request, etag);
  if (fresh) {
    reply->status = 304;
  }
  etag_mark(reply, etag, "no-cache");
  return fresh;
}

void cache_reply_text(const struct request *request, struct reply *reply, const char *content_type,
                      char *text) {
  size_t size = strlen(text);
  uint64_t tag = cache_tag_add(cache_tag(), text, size);
  if (cache_fresh(request, reply, tag)) {
    free(text);
    return;
  }
  reply_text(reply, content_type, text, size);
  cache_mark(reply, tag);
}
