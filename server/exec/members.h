/* What the solver of a bundle says of its members. */
#ifndef PNEULAB_EXEC_MEMBERS_H
#define PNEULAB_EXEC_MEMBERS_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "server/exec/process.h"

/* A member begins, or is done. */
struct member_event {
  size_t member;
  bool done;
  struct process_end end; /* once it is done */
};

typedef void member_taker(void *context, const struct member_event *event);

/* Hands on what the lines behind *offset say of the `count` members, read as by follow_lines; other
 * lines and members are passed over. Whose turn it is the taker knows. False when nothing whole was
 * added. */
bool members_follow(const char *path, off_t *offset, size_t count, member_taker *take,
                    void *context);

#endif
