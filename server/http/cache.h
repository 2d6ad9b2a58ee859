/* Answers that a client may keep and ask for again (RFC 9110, sections 8.8.3 and 13.1.2). */
#ifndef PNEULAB_HTTP_CACHE_H
#define PNEULAB_HTTP_CACHE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct request;
struct reply;

/* The tag of a content is made of all that the content follows from: cache_tag starts one, with the
 * version of the program, and cache_tag_add returns it with `size` bytes added (FNV-1a, 64 bits).
 */
uint64_t cache_tag(void);
uint64_t cache_tag_add(uint64_t tag, const void *data, size_t size);

/* Adds the tag to a reply as its ETag, and says that it is to be asked for before every use. */
void cache_mark(struct reply *reply, uint64_t tag);

/* Whether the request's If-None-Match names the tag: then the reply is a complete 304. */
bool cache_fresh(const struct request *request, struct reply *reply, uint64_t tag);

/* The same for a tag made elsewhere, quoted; marks the reply in either case. For files of the
 * program itself, which any cache may keep. */
bool cache_fresh_text(const struct request *request, struct reply *reply, const char *etag);

/* Replies with a text from the heap, taken over, that never changes; when the request has it
 * already, with 304. */
void cache_reply_text(const struct request *request, struct reply *reply, const char *content_type,
                      char *text);

#endif
