#include "server/http/encoding.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

static const char separators[] = " \t,";

/* Whether the parameters behind a coding leave it a weight: all do but ";q=0", with or without a
 * point and noughts behind it. */
static bool weight_positive(const char *parameters, size_t length) {
  const char *end = parameters + length;
  for (const char *at = parameters; at < end; at++) {
    if (*at == ';') {
      at++;
      at += strspn(at, " \t");
      if (at + 2 <= end && strncasecmp(at, "q=", 2) == 0) {
        size_t noughts = strspn(at + 2, "0.");
        return noughts == 0 || at + 2 + noughts < end;
      }
    }
  }
  return true;
}

bool encoding_accepted(const char *accept, const char *coding) {
  bool any = false;
  size_t wanted = strlen(coding);
  while (accept && *accept) {
    accept += strspn(accept, separators);
    size_t length = strcspn(accept, ",");
    size_t name = strcspn(accept, " \t,;");
    size_t used = length;
    while (used > name && (accept[used - 1] == ' ' || accept[used - 1] == '\t')) {
      used--;
    }
    bool positive = weight_positive(accept + name, used - name);
    if (name == wanted && strncasecmp(accept, coding, wanted) == 0) {
      return positive;
    }
    any = any || (name == 1 && *accept == '*' && positive);
    accept += length;
  }
  return any;
}
