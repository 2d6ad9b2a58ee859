#include "solver/mesh/stretch.h"

enum status stretch_extend(struct grid_axis *axis, const struct stretch *list, int count) {
  enum status status = STATUS_OK;
  for (int s = 0; s < count && status == STATUS_OK; s++) {
    double start = axis->line[axis->line_count - 1];
    if (list[s].end > start + 1e-12) {
      status = grid_axis_divide(axis, list[s].end, list[s].division, list[s].tag);
    }
  }
  return status;
}

enum status stretch_mirror(struct grid_axis *axis, const struct stretch *list, int count) {
  enum status status = grid_axis_extend(axis, -list[count - 1].end, 0, 0);
  for (int s = count - 1; s >= 0 && status == STATUS_OK; s--) {
    struct grid_division division = *list[s].division;
    division.first = list[s].division->last;
    division.last = list[s].division->first;
    struct stretch mirrored = {s > 0 ? -list[s - 1].end : 0, &division, list[s].tag};
    status = stretch_extend(axis, &mirrored, 1);
  }
  return status;
}
