/* What the store measures of itself. */
#ifndef PNEULAB_STORE_METER_H
#define PNEULAB_STORE_METER_H

#include <stdint.h>

#include "server/base/meter.h"

struct store_meter {
  struct histogram write; /* s of a transaction */
  atomic_uint_fast64_t wait_micro, failures;
  int64_t begun_us; /* of the open transaction; under the writer's mutex */
};

#endif
