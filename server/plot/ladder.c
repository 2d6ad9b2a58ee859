#include "server/plot/ladder.h"

#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"

static void find_runs(struct ladder *ladder) {
  for (size_t i = 1; i < ladder->count; i++) {
    bool falling = ladder->points[i].x < ladder->points[i - 1].x;
    struct ladder_run *last = ladder->run_count ? &ladder->run[ladder->run_count - 1] : NULL;
    if (last && last->falling == falling) {
      last->last = i;
    } else if (ladder->run_count < LADDER_RUNS) {
      ladder->run[ladder->run_count++] = (struct ladder_run){i - 1, i, falling};
    }
  }
}

enum status ladder_read(const json_t *result, const char *key, struct ladder *ladder,
                        struct error *error) {
  const json_t *holds = json_object_get(result, "holds");
  size_t most = json_array_size(holds);
  *ladder = (struct ladder){.points = malloc((most + 1) * sizeof *ladder->points)};
  if (!ladder->points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu set-points", most);
  }
  for (size_t i = 0; i < most; i++) {
    const json_t *hold = json_array_get(holds, i);
    struct point p = {data_number(hold, "set_point_kPa"), data_number(hold, key)};
    if (isfinite(p.x) && isfinite(p.y)) {
      ladder->points[ladder->count++] = p;
    }
  }
  find_runs(ladder);
  return STATUS_OK;
}

void ladder_release(struct ladder *ladder) {
  free(ladder->points);
  *ladder = (struct ladder){.points = NULL};
}
