/* The local engine: a fixed number of threads, each running one worker process at a time for the
 * oldest job in the store. */
#ifndef PNEULAB_EXEC_POOL_H
#define PNEULAB_EXEC_POOL_H

#include "server/exec/executor.h"
#include "server/exec/isolation.h"

struct pool_settings {
  struct engine_settings engine;
  struct store_taste taste;          /* which jobs are its own */
  const struct isolation *isolation; /* lives as long as the pool */
  unsigned workers;
};

/* Starts the threads; the settings are copied. The caller owns *engine. */
enum status pool_create(const struct pool_settings *settings, struct engine *engine,
                        struct error *error);

#endif
