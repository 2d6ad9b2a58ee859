#include <stdio.h>
#include <string.h>

#include "server/http/cache.h"
#include "server/http/encoding.h"
#include "server/http/handlers.h"
#include "server/http/static_files.h"

static const struct static_file *page_find(const char *path) {
  for (size_t i = 0; i < static_file_count; i++) {
    if (strcmp(static_files[i].path, path) == 0) {
      return &static_files[i];
    }
  }
  return NULL;
}

/* The file of a request's path: the path itself, or with ".html" added. */
static const struct static_file *page_of(const struct request *request) {
  char path[256] = "";
  size_t used = 0;
  for (size_t i = 0; i < request->url.segment_count; i++) {
    int length = snprintf(path + used, sizeof path - used, "/%s", request->url.segments[i]);
    used += (size_t)length;
    if (used >= sizeof path - sizeof ".html") {
      return NULL;
    }
  }
  const struct static_file *file = page_find(path);
  if (!file) {
    strcpy(path + used, ".html");
    file = page_find(path);
  }
  return file;
}

struct representation {
  const struct static_content *content;
  const char *coding; /* NULL: as it is */
  const char *suffix; /* of its tag, as it differs from the others byte by byte */
};

/* The smallest representation of the file that the client takes. */
static struct representation page_choose(const struct request *request,
                                         const struct static_file *file) {
  const char *accept = request_header(request, "Accept-Encoding");
  if (file->brotli.data && encoding_accepted(accept, "br")) {
    return (struct representation){&file->brotli, "br", "-br"};
  }
  if (file->gzip.data && encoding_accepted(accept, "gzip")) {
    return (struct representation){&file->gzip, "gzip", "-gz"};
  }
  return (struct representation){&file->plain, NULL, ""};
}

static void file_reply(const struct request *request, struct reply *reply,
                       const struct static_file *file) {
  struct representation chosen = page_choose(request, file);
  char etag[40];
  snprintf(etag, sizeof etag, "\"%s%s\"", file->hash, chosen.suffix);
  reply->content_type = file->content_type; /* the policy that goes with it, for a 304 too */
  bool fresh = cache_fresh_text(request, reply, etag);
  if (file->forever) {
    reply_header(reply, "Cache-Control", "public, max-age=31536000, immutable");
  }
  reply_header(reply, "Vary", "Accept-Encoding");
  if (!fresh) {
    if (chosen.coding) {
      reply_header(reply, "Content-Encoding", "%s", chosen.coding);
    }
    reply_static(reply, file->content_type, chosen.content->data, chosen.content->size);
  }
}

bool page_exists(const struct request *request) {
  return page_of(request) != NULL;
}

void page_show(struct request *request, struct reply *reply) {
  file_reply(request, reply, page_of(request));
}
