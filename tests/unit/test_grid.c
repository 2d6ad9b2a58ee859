/* Tensor grids: cells, faces, facing pairs and node search. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/mesh/grid.h"
#include "tests/unit/suite.h"

static void copy_point(const void *context, const double grid_point[3], double x[3]) {
  (void)context;
  memcpy(x, grid_point, 3 * sizeof *x);
}

/* Tags along the axes are 100 i + 10 j + k; the context lists the cells that are not solid. */
struct hole {
  int cell;
  enum cell_kind kind;
};

static int kind_of(const void *context, const int tag[3]) {
  const struct hole *hole = context;
  int cell = 100 * tag[0] + 10 * tag[1] + tag[2];
  for (; hole->cell >= 0; hole++) {
    if (hole->cell == cell) {
      return hole->kind;
    }
  }
  return CELL_SOLID;
}

static void build(const int cells[3], bool half, const struct hole *holes, struct mesh *mesh) {
  struct grid grid = {0};
  for (int d = 0; d < 3; d++) {
    ck_assert_int_eq(grid_axis_extend(&grid.axis[d], 0, 0, 0), STATUS_OK);
    for (int c = 0; c < cells[d]; c++) {
      ck_assert_int_eq(grid_axis_extend(&grid.axis[d], c + 1, 1, c), STATUS_OK);
    }
  }
  ck_assert_int_eq(grid_mesh(&grid, half, kind_of, copy_point, holes, mesh, NULL), STATUS_OK);
  grid_release(&grid);
}

static int count_faces(const struct mesh *mesh, enum face_kind kind) {
  int count = 0;
  for (int f = 0; f < mesh->face_count; f++) {
    count += mesh->faces[f].kind == kind;
  }
  return count;
}

START_TEST(axis_divides_stretches_evenly) {
  struct grid_axis axis = {0};
  ck_assert_int_eq(grid_axis_extend(&axis, 1, 0, 0), STATUS_OK);
  ck_assert_int_eq(grid_axis_extend(&axis, 2, 4, 7), STATUS_OK);
  ck_assert_int_eq(grid_axis_extend(&axis, 5, 1, 8), STATUS_OK);
  const double line[] = {1, 1.25, 1.5, 1.75, 2, 5};
  const int tag[] = {7, 7, 7, 7, 8};
  ck_assert_int_eq(axis.line_count, 6);
  for (int i = 0; i < 6; i++) {
    ck_assert_double_eq_tol(axis.line[i], line[i], 1e-15);
  }
  ck_assert_mem_eq(axis.tag, tag, sizeof tag);
  free(axis.line);
  free(axis.tag);
}
END_TEST

START_TEST(solid_block) {
  static const struct hole none[] = {{-1, CELL_SOLID}};
  struct mesh mesh;
  build((int[3]){2, 3, 4}, false, none, &mesh);
  ck_assert_int_eq(mesh.element_count, 24);
  ck_assert_int_eq(mesh.node_count, 5 * 7 * 9);
  ck_assert_int_eq(mesh.section_count, 5);
  ck_assert_int_eq(count_faces(&mesh, FACE_BASE), 12);
  ck_assert_int_eq(count_faces(&mesh, FACE_OUTER), 12 + 2 * 8 + 2 * 6);
  ck_assert_int_eq(count_faces(&mesh, FACE_CAVITY), 0);
  ck_assert_int_eq(mesh.facing_count, 0);
  ck_assert_double_eq(mesh.gap_width, 0);
  for (int n = 0; n < mesh.node_count; n++) {
    bool base = mesh.x[3 * n] == 0;
    ck_assert_int_eq(mesh.fixed[3 * n], base);
    ck_assert_int_eq(mesh.fixed[3 * n + 1], base);
    ck_assert_int_eq(mesh.node_section[n], (int)lrint(2 * mesh.x[3 * n]));
    ck_assert(n == 0 || mesh.node_section[n] >= mesh.node_section[n - 1]);
  }
  mesh_release(&mesh);
  mesh_release(&mesh); /* twice does no harm */
  mesh_release(NULL);
}
END_TEST

START_TEST(half_holds_the_plane_of_symmetry) {
  static const struct hole none[] = {{-1, CELL_SOLID}};
  struct mesh mesh;
  build((int[3]){2, 2, 2}, true, none, &mesh);
  ck_assert(mesh.half);
  ck_assert_int_eq(count_faces(&mesh, FACE_SYMMETRY), 4);
  ck_assert_int_eq(count_faces(&mesh, FACE_BASE), 4);
  for (int n = 0; n < mesh.node_count; n++) {
    bool base = mesh.x[3 * n] == 0, plane = mesh.x[3 * n + 1] == 0;
    ck_assert_int_eq(mesh.fixed[3 * n + 1], base || plane);
    ck_assert_int_eq(mesh.fixed[3 * n + 2], base);
  }
  mesh_release(&mesh);
}
END_TEST

START_TEST(cavity_has_six_faces) {
  static const struct hole holes[] = {{111, CELL_CAVITY}, {-1, CELL_SOLID}};
  struct mesh mesh;
  build((int[3]){3, 3, 3}, false, holes, &mesh);
  ck_assert_int_eq(mesh.element_count, 26);
  ck_assert_int_eq(mesh.node_count, 7 * 7 * 7 - 1); /* only the cavity's middle is missing */
  ck_assert_int_eq(count_faces(&mesh, FACE_CAVITY), 6);
  ck_assert_int_eq(mesh.facing_count, 0);
  mesh_release(&mesh);
}
END_TEST

/* A gap two cells wide along x, open at the top. */
START_TEST(faces_across_a_gap_are_paired) {
  static const struct hole holes[] = {{101, CELL_GAP}, {201, CELL_GAP}, {-1, CELL_SOLID}};
  struct mesh mesh;
  build((int[3]){4, 1, 2}, false, holes, &mesh);
  ck_assert_int_eq(mesh.facing_count, 1);
  ck_assert_double_eq_tol(mesh.gap_width, 2, 1e-15);
  int slave[QUAD9_NODES], master[QUAD9_NODES];
  mesh_face_nodes(&mesh, &mesh.facing[0].slave, slave);
  mesh_face_nodes(&mesh, &mesh.facing[0].master, master);
  for (int m = 0; m < QUAD9_NODES; m++) {
    const double *a = mesh.x + 3 * slave[m], *b = mesh.x + 3 * master[m];
    ck_assert_double_eq(a[0], 1);
    ck_assert_double_eq(b[0], 3);
    ck_assert_double_eq(a[1], b[1]);
    ck_assert_double_eq(a[2], b[2]);
  }
  mesh_release(&mesh);
}
END_TEST

START_TEST(nearest_node_is_found) {
  static const struct hole none[] = {{-1, CELL_SOLID}};
  struct mesh mesh;
  build((int[3]){2, 2, 2}, false, none, &mesh);
  int node = grid_find_node(&mesh, (double[3]){1.1, 0.6, 1.9}, -1);
  const double *x = mesh.x + 3 * node;
  ck_assert(x[0] == 1 && x[1] == 0.5 && x[2] == 2);
  node = grid_find_node(&mesh, (double[3]){1.1, 0.6, 1.9}, 4);
  ck_assert_double_eq(mesh.x[3 * node], 2);
  ck_assert_int_eq(grid_find_node(&mesh, (double[3]){0, 0, 0}, 99), -1);
  mesh_release(&mesh);
}
END_TEST

START_TEST(too_large_a_grid_is_refused) {
  static const struct hole none[] = {{-1, CELL_SOLID}};
  struct grid grid = {0};
  struct mesh mesh;
  struct error error;
  for (int d = 0; d < 3; d++) {
    grid_axis_extend(&grid.axis[d], 0, 0, 0);
    grid_axis_extend(&grid.axis[d], 1, 1000, 0);
  }
  ck_assert_int_eq(grid_mesh(&grid, false, kind_of, copy_point, none, &mesh, &error),
                   STATUS_TOO_LARGE);
  ck_assert_ptr_null(mesh.x);
  grid_release(&grid);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("grid");
  TCase *grid = tcase_create("grid");
  tcase_add_test(grid, axis_divides_stretches_evenly);
  tcase_add_test(grid, solid_block);
  tcase_add_test(grid, half_holds_the_plane_of_symmetry);
  tcase_add_test(grid, cavity_has_six_faces);
  tcase_add_test(grid, faces_across_a_gap_are_paired);
  tcase_add_test(grid, nearest_node_is_found);
  tcase_add_test(grid, too_large_a_grid_is_refused);
  suite_add_tcase(suite, grid);
  return suite_run(suite);
}
