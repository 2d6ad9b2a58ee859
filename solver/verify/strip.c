#include "solver/verify/strip.h"

#include <string.h>
#include "solver/mesh/grid.h"
#include "solver/verify/body.h"

static int all_solid(const void *context, const int tag[3]) {
  (void)context;
  (void)tag;
  return CELL_SOLID;
}

static void identity(const void *context, const double grid_point[3], double x[3]) {
  (void)context;
  memcpy(x, grid_point, 3 * sizeof *x);
}

enum status strip_build(double height, int cells, bool plane_strain, struct mesh *mesh) {
  struct grid grid = {0};
  const double start[3] = {0, -0.5 * height, -0.5 * height},
               end[3] = {1, 0.5 * height, 0.5 * height};
  enum status status = STATUS_OK;
  for (int d = 0; status == STATUS_OK && d < 3; d++) {
    status = grid_axis_extend(&grid.axis[d], start[d], 0, 0);
    if (status == STATUS_OK) {
      status = grid_axis_extend(&grid.axis[d], end[d], d == 0 ? cells : 1, 0);
    }
  }
  if (status == STATUS_OK) {
    status = grid_mesh(&grid, false, all_solid, identity, NULL, mesh, NULL);
  }
  grid_release(&grid);
  if (status != STATUS_OK) {
    return status;
  }
  mesh->wall_thickness = height;
  memset(mesh->node_core, 1, (size_t)mesh->node_count);
  memset(mesh->fixed, 0, 3 * (size_t)mesh->node_count);
  body_hold(mesh, 0, 0, HOLD_X);
  body_hold(mesh, plane_strain ? -1 : 1, 0, HOLD_Y);
  mesh->fixed[3 * body_node(mesh, 0, 0, 0) + 2] = 1;
  return STATUS_OK;
}
