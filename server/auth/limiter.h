/* Token buckets: how often each of many parties may do something. */
#ifndef PNEULAB_AUTH_LIMITER_H
#define PNEULAB_AUTH_LIMITER_H

#include <stdbool.h>

#include "solver/base/error.h"

struct limiter;

/* rate_hz: how often each party may, over a long time (0: as often as it likes); burst: how often
 * at once, at least 1. Keeps a fixed number of parties in mind; the one heard of longest ago is
 * forgotten first. The caller owns *limiter. */
enum status limiter_create(double rate_hz, double burst, struct limiter **limiter,
                           struct error *error);
void limiter_destroy(struct limiter *limiter);

/* Whether the party may now; if not, *wait_s says when it may again. Any thread. */
bool limiter_take(struct limiter *limiter, const char *party, double *wait_s);

#endif
