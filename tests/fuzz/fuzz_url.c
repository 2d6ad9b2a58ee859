/* Any bytes as a request target: taken apart or refused, never worse; what is taken is clean. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/guard.h"
#include "server/http/url.h"
#include "tests/fuzz/fuzz.h"

static void check_clean(const char *text) {
  for (; *text; text++) {
    if ((unsigned char)*text < 0x20 || *text == 0x7f) {
      abort();
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *target = malloc(size + 1);
  struct url url;
  if (!target) {
    return 0;
  }
  memcpy(target, data, size);
  target[size] = '\0';
  guard_host_is_loopback(target);
  if (url_parse(target, &url) == NULL) {
    for (size_t i = 0; i < url.segment_count; i++) {
      check_clean(url.segments[i]);
      if (strchr(url.segments[i], '/') || strcmp(url.segments[i], "..") == 0) {
        abort();
      }
    }
    for (size_t i = 0; i < url.query_count; i++) {
      check_clean(url.query[i].name);
      check_clean(url.query[i].value);
    }
  }
  free(target);
  return 0;
}
