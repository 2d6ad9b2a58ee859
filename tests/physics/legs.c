#include "tests/physics/legs.h"

#include <cblas.h>
#include <check.h>
#include <string.h>
#include "solver/mesh/grid.h"
#include "solver/verify/body.h"

enum tag { BAR, LEG, BETWEEN };
static const double bar = 1, leg_length = 8, thickness = 1;

static int kind_of(const void *context, const int tag[3]) {
  (void)context;
  return tag[0] == BAR || tag[1] == LEG ? CELL_SOLID : CELL_GAP;
}

static void keep_place(const void *context, const double grid_point[3], double x[3]) {
  (void)context;
  memcpy(x, grid_point, 3 * sizeof *x);
}

static void build_mesh(const struct legs_shape *shape, struct mesh *mesh) {
  struct grid grid = {0};
  struct error error = {0};
  int through = shape->along / 8;
  double half_gap = 0.5 * shape->gap, outer = half_gap + thickness;
  enum status status = grid_axis_extend(&grid.axis[0], 0, 0, 0);
  status = status ? status : grid_axis_extend(&grid.axis[0], bar, 1, BAR);
  status = status ? status : grid_axis_extend(&grid.axis[0], bar + leg_length, shape->along, LEG);
  status = status ? status : grid_axis_extend(&grid.axis[1], shape->half ? 0 : -outer, 0, 0);
  if (!shape->half) {
    status = status ? status : grid_axis_extend(&grid.axis[1], -half_gap, through, LEG);
    status = status ? status : grid_axis_extend(&grid.axis[1], 0, 1, BETWEEN);
  }
  status = status ? status : grid_axis_extend(&grid.axis[1], half_gap, 1, BETWEEN);
  status = status ? status : grid_axis_extend(&grid.axis[1], outer, through, LEG);
  status = status ? status : grid_axis_extend(&grid.axis[2], 0, 0, 0);
  status = status ? status : grid_axis_extend(&grid.axis[2], 1, 1, 0);
  status = status ? status : grid_mesh(&grid, shape->half, kind_of, keep_place, NULL, mesh, &error);
  grid_release(&grid);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  mesh->section_count = 0;
  mesh->wall_thickness = thickness;
  mesh->facing_count = shape->facing ? mesh->facing_count : 0;
  body_hold(mesh, 2, 0, HOLD_Z);
}

void legs_load(struct legs *legs, const struct legs_shape *shape) {
  const struct material_spec rubber = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 100};
  struct error error = {0};
  double outer = 0.5 * shape->gap + thickness;
  openblas_set_num_threads(1);
  *legs = (struct legs){.shape = *shape};
  build_mesh(shape, &legs->mesh);
  enum status status = model_create(&legs->mesh, &rubber, true, &legs->model, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  if (shape->half) { /* the way to the plane is half the gap */
    legs->model->contact.stiffness *= 2;
    legs->model->contact.smoothing *= 0.5;
  }
  ck_assert_int_eq(equilibrium_create(legs->model, &legs->solver, &error), STATUS_OK);
  ck_assert_int_eq(state_create(legs->model, &legs->state), STATUS_OK);
  body_add_traction(legs->model, 1, outer, (double[3]){0, -shape->upper, 0});
  body_add_traction(legs->model, 1, -outer, (double[3]){0, shape->lower, 0});
  legs->solver->options.traction_tolerance = 1e-3 * (shape->upper + shape->lower);
  struct path_options path = {.pressure_to = 0, .steps = 1, .dead_load = true};
  status = path_follow(legs->solver, &path, &legs->state, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
}

void legs_close(struct legs *legs) {
  state_release(&legs->state);
  equilibrium_destroy(legs->solver);
  model_destroy(legs->model);
  mesh_release(&legs->mesh);
}

static double tip(const struct legs *legs, int sign, int axis) {
  double middle = 0.5 * sign * (legs->shape.gap + thickness);
  return legs->state.u[3 * body_node(&legs->mesh, bar + leg_length, middle, 0) + axis];
}

double legs_tip(const struct legs *legs, int axis) {
  return tip(legs, 1, axis);
}

double legs_lower_tip(const struct legs *legs, int axis) {
  return tip(legs, -1, axis);
}
