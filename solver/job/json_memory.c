/* Reading JSON where memory may run out.
 *
 * Jansson's reader overlooks it when the buffer of its token cannot grow, and then copies the token
 * from beyond the end of that buffer. So while it reads, an allocation that fails is served from a
 * reserve that was taken before, and the next byte of the text is an end of the text to it: what it
 * needs until then is less than the reserve. Its allocation functions have no argument of their
 * own, hence the variable of the thread. */
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/json.h"

struct reserve {
  char *block;
  size_t size, used;
  bool touched;
};

static _Thread_local struct reserve *reserve; /* while this thread reads */

enum { ALIGNMENT = 16, RESERVE_MIN = 4096, RESERVE_FACTOR = 4 };

static void *allocate(size_t size) {
  void *block = malloc(size);
  if (block || !reserve) {
    return block;
  }
  reserve->touched = true;
  if (size > reserve->size - reserve->used) {
    return NULL;
  }
  block = reserve->block + reserve->used;
  size_t rounded = (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
  size_t room = reserve->size - reserve->used;
  reserve->used += rounded < room ? rounded : room;
  return block;
}

static void release(void *block) {
  const char *at = block;
  if (!reserve || at < reserve->block || at >= reserve->block + reserve->size) {
    free(block);
  }
}

static void install(void) {
  json_set_alloc_funcs(allocate, release);
}

/* The text byte by byte, until the reserve is touched. */
struct feed {
  const char *text;
  size_t size, at;
};

static size_t feed_byte(void *buffer, size_t room, void *context) {
  struct feed *feed = context;
  if (feed->at == feed->size || room == 0 || reserve->touched) {
    return 0;
  }
  *(char *)buffer = feed->text[feed->at++];
  return 1;
}

json_t *json_read(const char *text, size_t size, size_t flags, json_error_t *problem) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  struct reserve own = {.size = RESERVE_FACTOR * size + RESERVE_MIN};
  struct feed feed = {.text = text, .size = size};
  pthread_once(&once, install);
  own.block = malloc(own.size);
  if (!own.block) {
    errno = ENOMEM;
    return NULL;
  }
  reserve = &own;
  json_t *root = json_load_callback(feed_byte, &feed, flags, problem);
  if (own.touched) {
    json_decref(root);
    root = NULL;
  }
  reserve = NULL;
  free(own.block);
  errno = own.touched ? ENOMEM : 0;
  return root;
}
