/* Who sends a request, and what they may do. */
#ifndef PNEULAB_SERVER_CALLER_H
#define PNEULAB_SERVER_CALLER_H

#include <stdbool.h>

/* Each role may do all that the ones before it may. */
enum role {
  ROLE_NONE,   /* anybody who reaches the port */
  ROLE_READ,   /* look at jobs and their results */
  ROLE_SUBMIT, /* submit and control jobs */
  ROLE_ADMIN   /* all, including the copy of the database */
};

enum { ROLE_COUNT = ROLE_ADMIN + 1 };

/* The name is that of the token; without tokens it is "" and the role is ROLE_ADMIN. */
struct caller {
  char name[64];
  enum role role;
};

/* "none", "read", "submit" or "admin". */
const char *role_word(enum role role);

/* The role that a token may have by its word; false when there is none. */
bool role_parse(const char *word, enum role *role);

#endif
