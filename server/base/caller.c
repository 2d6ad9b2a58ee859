#include "server/base/caller.h"

#include <string.h>

static const char *const words[ROLE_COUNT] = {"none", "read", "submit", "admin"};

const char *role_word(enum role role) {
  return words[role];
}

bool role_parse(const char *word, enum role *role) {
  for (int i = ROLE_READ; i < ROLE_COUNT; i++) {
    if (strcmp(word, words[i]) == 0) {
      *role = (enum role)i;
      return true;
    }
  }
  return false;
}
