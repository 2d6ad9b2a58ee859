/* Why jobs failed, by reason. */
#ifndef PNEULAB_STORE_FAILURES_H
#define PNEULAB_STORE_FAILURES_H

#include "server/store/store.h"

enum { FAILURE_GROUPS = 12 };

/* Failed and timed out jobs of one reason_code, and the newest of them. */
struct failure_group {
  char *reason_code;
  int64_t count, newest;
  char *newest_name, *newest_message;
};

/* Groups the thousand newest failed and the thousand newest timed out jobs by reason, most frequent
 * first. On success failures_clear ends the use of the *count groups. */
enum status store_failures(struct store *store, struct failure_group groups[FAILURE_GROUPS],
                           size_t *count, struct error *error);
void failures_clear(struct failure_group *groups, size_t count);

#endif
