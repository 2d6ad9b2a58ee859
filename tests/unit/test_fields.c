/* Fields at the nodes against closed forms, and the files that carry them. */
#include <cblas.h>
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "solver/mesh/grid.h"
#include "solver/post/contact_field.h"
#include "solver/post/csv.h"
#include "solver/post/export.h"
#include "solver/post/fields.h"
#include "solver/post/output.h"
#include "tests/unit/suite.h"

/* ---- bodies ---- */

static int solid_cell(const void *context, const int tag[3]) {
  (void)context;
  (void)tag;
  return CELL_SOLID;
}

/* Every second cell along axis 0 is a gap. */
static int gap_cell(const void *context, const int tag[3]) {
  (void)context;
  return tag[0] % 2 ? CELL_GAP : CELL_SOLID;
}

static void cube_map(const void *context, const double s[3], double x[3]) {
  (void)context;
  memcpy(x, s, 3 * sizeof *x);
}

/* A quarter of a cylinder, radii 1 to 2, height 1. */
static void cylinder_map(const void *context, const double s[3], double x[3]) {
  (void)context;
  double r = pow(2, s[0]), angle = 0.5 * M_PI * s[1];
  x[0] = s[1] < 1 ? r * cos(angle) : 0;
  x[1] = r * sin(angle);
  x[2] = s[2];
}

/* The unit cube in cells, mapped. */
static void build(const int cells[3], grid_kind_fn kind, grid_map_fn map, struct mesh *mesh) {
  struct grid grid = {0};
  struct error error = {0};
  for (int d = 0; d < 3; d++) {
    ck_assert_int_eq(grid_axis_extend(&grid.axis[d], 0, 0, 0), STATUS_OK);
    for (int c = 0; c < cells[d]; c++) {
      ck_assert_int_eq(grid_axis_extend(&grid.axis[d], (c + 1.0) / cells[d], 1, c), STATUS_OK);
    }
  }
  ck_assert_int_eq(grid_mesh(&grid, false, kind, map, NULL, mesh, &error), STATUS_OK);
  mesh->wall_thickness = 1;
  grid_release(&grid);
}

static struct fe_model *create_model(const struct mesh *mesh,
                                     const struct material_spec *material) {
  struct fe_model *model;
  struct error error = {0};
  openblas_set_num_threads(1);
  ck_assert_int_eq(model_create(mesh, material, false, &model, &error), STATUS_OK);
  return model;
}

/* ---- stress ---- */

struct law {
  struct material_spec material;
  double difference; /* sigma_xx - sigma_yy at the stretch below, Pa */
};
static const double lambda = 1.7;

/* Uniaxial tension of an incompressible body, Pa. */
static struct law law(int index) {
  double l = lambda, i1 = l * l + 2 / l, square = l * l - 1 / l;
  switch (index) {
  case 0:
    return (struct law){{.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {4e5}, .bulk_ratio = 1000},
                        4e5 * square};
  case 1:
    return (struct law){
        {.model = MATERIAL_YEOH, .terms = 3, .c = {25e4, -5e4, 5e3}, .bulk_ratio = 1000},
        2 * square * (25e4 - 2 * 5e4 * (i1 - 3) + 3 * 5e3 * (i1 - 3) * (i1 - 3))};
  case 2:
    return (struct law){
        {.model = MATERIAL_MOONEY_RIVLIN, .terms = 2, .c = {1e5, 2e4}, .bulk_ratio = 1000},
        2 * square * (1e5 + 2e4 / l)};
  default:
    return (struct law){{.model = MATERIAL_OGDEN,
                         .terms = 2,
                         .c = {6e5, -1e4},
                         .alpha = {1.3, -2},
                         .bulk_ratio = 1000},
                        6e5 * (pow(l, 1.3) - pow(l, -0.65)) - 1e4 * (pow(l, -2) - l)};
  }
}

START_TEST(uniaxial_stress) {
  struct law tested = law(_i);
  struct mesh mesh;
  struct fe_state state;
  build((int[3]){2, 1, 2}, solid_cell, cube_map, &mesh);
  struct fe_model *m = create_model(&mesh, &tested.material);
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  for (int n = 0; n < 3 * mesh.node_count; n++) {
    state.u[n] = mesh.x[n] * ((n % 3 == 0 ? lambda : 1 / sqrt(lambda)) - 1);
  }
  for (int e = 0; e < mesh.element_count; e++) { /* free sides: the mean stress is a third */
    state.p[ELEMENT_PRESSURES * e] = tested.difference / 3;
  }
  double(*stress)[STRESS_COMPONENTS] = calloc((size_t)mesh.node_count, sizeof *stress);
  ck_assert_ptr_nonnull(stress);
  ck_assert_int_eq(stress_at_nodes(m, &state, stress), STATUS_OK);
  double tolerance = 1e-9 * fabs(tested.difference);
  for (int n = 0; n < mesh.node_count; n++) {
    ck_assert_double_eq_tol(stress[n][0], tested.difference, tolerance);
    for (int c = 1; c < STRESS_COMPONENTS; c++) {
      ck_assert_double_eq_tol(stress[n][c], 0, tolerance);
    }
    ck_assert_double_eq_tol(stress_von_mises(stress[n]), tested.difference, tolerance);
    ck_assert_double_eq_tol(stress_largest(stress[n]), tested.difference, tolerance);
    ck_assert_double_eq_tol(stress_pressure(stress[n]), -tested.difference / 3, tolerance);
  }
  struct stress_peak peak = stress_peak(m, &state);
  ck_assert_double_eq_tol(peak.von_mises, tested.difference, tolerance);
  ck_assert_double_eq_tol(peak.principal, tested.difference, tolerance);
  free(stress);
  state_release(&state);
  model_destroy(m);
  mesh_release(&mesh);
}
END_TEST

START_TEST(invariants_of_shear) {
  const double shear[STRESS_COMPONENTS] = {0, 0, 0, 0, -3, 0};
  ck_assert_double_eq_tol(stress_von_mises(shear), 3 * sqrt(3), 1e-12);
  ck_assert_double_eq_tol(stress_largest(shear), 3, 1e-12);
  ck_assert_double_eq_tol(stress_pressure(shear), 0, 1e-12);
}
END_TEST

/* Holds the planes of symmetry and both ends; the inner face becomes the cavity. */
static void hold_cylinder(struct mesh *mesh) {
  memset(mesh->fixed, 0, 3 * (size_t)mesh->node_count);
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * n;
    mesh->fixed[3 * n] = fabs(x[0]) < 1e-12;
    mesh->fixed[3 * n + 1] = fabs(x[1]) < 1e-12;
    mesh->fixed[3 * n + 2] = x[2] < 1e-12 || x[2] > 1 - 1e-12;
  }
  for (int f = 0; f < mesh->face_count; f++) {
    mesh->faces[f].kind = mesh->faces[f].kind == FACE_BASE ? FACE_CAVITY : FACE_OUTER;
  }
}

/* Raises the pressure to `pressure` in steps, by full Newton steps. */
static void inflate(struct fe_model *m, struct fe_state *state, double pressure) {
  double *du = calloc((size_t)m->dof_count, sizeof *du);
  ck_assert_ptr_nonnull(du);
  for (int step = 1; step <= 5; step++) {
    struct fe_load load = {pressure * step / 5, pressure * step / 5, 0};
    double largest = 1;
    for (int k = 0; k < 60 && largest > 1e-11; k++) {
      ck_assert_int_eq(model_evaluate(m, state, &load, true), STATUS_OK);
      model_factor(m);
      for (int i = 0; i < m->dof_count; i++) {
        m->residual[i] = -m->residual[i];
      }
      model_solve(m, m->residual, du);
      model_recover(m, state, du, 1);
      largest = 0;
      for (int n = 0; n < 3 * m->mesh->node_count; n++) {
        double change = m->equation[n] >= 0 ? du[m->equation[n]] : 0;
        state->u[n] += change;
        largest = fmax(largest, fabs(change));
      }
    }
    ck_assert_double_le(largest, 1e-11);
  }
  free(du);
}

/* The neo-Hookean cylinder (mu = 1) in plane strain whose inner radius has grown from 1 to a:
 * with r^2 = R^2 + a^2 - 1 the hoop stretch is l = r/R, and sigma_tt - sigma_rr = l^2 - l^-2.
 * Integrated from the free outer face: 2 sigma_rr = ln(l_b^2/l^2) + l^-2 - l_b^-2. */
static void cylinder_stress(double a, double radius, double *radial, double *hoop) {
  double k = a * a - 1, l2 = 1 + k / (radius * radius), b2 = 1 + k / 4;
  *radial = 0.5 * (log(b2 / l2) + 1 / l2 - 1 / b2);
  *hoop = *radial + l2 - 1 / l2;
}

/* Largest error of radial and hoop stress over all nodes, over the inner pressure. */
static double cylinder_error(int n) {
  const struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1e5};
  struct mesh mesh;
  struct fe_state state;
  build((int[3]){n, 4 * n, 1}, solid_cell, cylinder_map, &mesh);
  hold_cylinder(&mesh);
  struct fe_model *m = create_model(&mesh, &material);
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  double radial, hoop, a = 1.3, worst = 0;
  cylinder_stress(a, 1, &radial, &hoop);
  double pressure = -radial;
  inflate(m, &state, pressure);
  double(*stress)[STRESS_COMPONENTS] = calloc((size_t)mesh.node_count, sizeof *stress);
  ck_assert_ptr_nonnull(stress);
  ck_assert_int_eq(stress_at_nodes(m, &state, stress), STATUS_OK);
  for (int i = 0; i < mesh.node_count; i++) {
    const double *x = mesh.x + 3 * i, *s = stress[i];
    double radius = hypot(x[0], x[1]), c = x[0] / radius, d = x[1] / radius;
    cylinder_stress(a, radius, &radial, &hoop);
    worst = fmax(worst, fabs(s[0] * c * c + s[1] * d * d + 2 * s[3] * c * d - radial));
    worst = fmax(worst, fabs(s[0] * d * d + s[1] * c * c - 2 * s[3] * c * d - hoop));
  }
  free(stress);
  state_release(&state);
  model_destroy(m);
  mesh_release(&mesh);
  return worst / pressure;
}

START_TEST(cylinder_stresses) {
  double coarse = cylinder_error(2), fine = cylinder_error(4);
  printf("thick cylinder, radial and hoop stress at the nodes, largest error over the pressure: "
         "%.4f (2 x 8), %.4f (4 x 16), order %.2f\n",
         coarse, fine, log2(coarse / fine));
  ck_assert_double_lt(fine, 0.025);
  ck_assert_double_gt(coarse / fine, 3.2); /* second order at the surfaces */
}
END_TEST

/* ---- contact pressure ---- */

START_TEST(contact_pressure) {
  const struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 100};
  struct mesh mesh;
  build((int[3]){3, 2, 2}, gap_cell, cube_map, &mesh);
  struct fe_model *m = create_model(&mesh, &material);
  struct contact *contact = &m->contact;
  double *u = calloc(3 * (size_t)mesh.node_count, sizeof *u);
  double *pressure = malloc(sizeof *pressure * (size_t)mesh.node_count);
  ck_assert_ptr_nonnull(u);
  ck_assert_ptr_nonnull(pressure);
  for (int i = 0; i < contact->point_count; i++) {
    if (contact->point[i].pair >= 0) {
      contact->point[i].valid = true;
      contact->point[i].traction = 1000;
    }
  }
  for (int n = 0; n < mesh.node_count; n++) { /* the faces have 1.5 x 2 times their area */
    u[3 * n + 1] = 0.5 * mesh.x[3 * n + 1];
    u[3 * n + 2] = mesh.x[3 * n + 2];
  }
  ck_assert_int_eq(contact_field(contact, mesh.node_count, u, pressure), STATUS_OK);
  for (int n = 0; n < mesh.node_count; n++) {
    double x = 3 * mesh.x[3 * n];
    bool facing = fabs(x - 1) < 1e-9 || fabs(x - 2) < 1e-9;
    ck_assert_double_eq_tol(pressure[n], facing ? 1000.0 / 3 : 0, 1e-9);
  }
  free(u);
  free(pressure);
  model_destroy(m);
  mesh_release(&mesh);
}
END_TEST

/* ---- files ---- */

/* Places of VTK's nodes in the unit cube, and in the unit square. */
static const double hex_place[27][3] = {
    {0, 0, 0},   {1, 0, 0},   {1, 1, 0},   {0, 1, 0},   {0, 0, 1},   {1, 0, 1},   {1, 1, 1},
    {0, 1, 1},   {.5, 0, 0},  {1, .5, 0},  {.5, 1, 0},  {0, .5, 0},  {.5, 0, 1},  {1, .5, 1},
    {.5, 1, 1},  {0, .5, 1},  {0, 0, .5},  {1, 0, .5},  {1, 1, .5},  {0, 1, .5},  {0, .5, .5},
    {1, .5, .5}, {.5, 0, .5}, {.5, 1, .5}, {.5, .5, 0}, {.5, .5, 1}, {.5, .5, .5}};
static const double quad_place[9][2] = {{0, 0},  {1, 0},  {1, 1},  {0, 1},  {.5, 0},
                                        {1, .5}, {.5, 1}, {0, .5}, {.5, .5}};

START_TEST(node_order) {
  const int *hex = vtu_order_hex27(), *quad = vtu_order_quad9(0), *flipped = vtu_order_quad9(1);
  for (int n = 0; n < 27; n++) {
    const double place[3] = {hex[n] / 9 / 2.0, hex[n] / 3 % 3 / 2.0, hex[n] % 3 / 2.0};
    for (int i = 0; i < 3; i++) {
      ck_assert_double_eq(place[i], hex_place[n][i]);
    }
  }
  for (int n = 0; n < 9; n++) {
    ck_assert_double_eq(quad[n] / 3 / 2.0, quad_place[n][0]);
    ck_assert_double_eq(quad[n] % 3 / 2.0, quad_place[n][1]);
    ck_assert_double_eq(flipped[n] / 3 / 2.0, quad_place[n][1]);
    ck_assert_double_eq(flipped[n] % 3 / 2.0, quad_place[n][0]);
  }
}
END_TEST

START_TEST(csv_text) {
  char *text = NULL;
  size_t size = 0;
  FILE *file = open_memstream(&text, &size);
  json_t *rows = json_pack("[{s:f, s:s}, {s:s, s:i, s:b}]", "a", 0.1, "b", "say \"x\", y", "b",
                           "two\nlines", "c,d", 7, "e", 1);
  ck_assert_ptr_nonnull(file);
  ck_assert_ptr_nonnull(rows);
  csv_write_objects(file, rows);
  fclose(file);
  ck_assert_str_eq(text,
                   "a,b,\"c,d\",e\r\n0.1,\"say \"\"x\"\", y\",,\r\n,\"two\nlines\",7,true\r\n");
  json_decref(rows);
  free(text);
}
END_TEST

/* Names of the files that a run of `steps` steps lists after `recorded` states. */
static json_t *exported(int steps, int recorded, const char *directory) {
  struct job_spec spec;
  struct error error = {0};
  struct export *export;
  struct fe_state state;
  struct mesh mesh;
  ck_assert_int_eq(suite_read_changed(NULL, NULL, &spec, &error), STATUS_OK);
  spec.load.steps = steps;
  build((int[3]){1, 1, 1}, solid_cell, cube_map, &mesh);
  struct fe_model *m = create_model(&mesh, &spec.material);
  ck_assert_int_eq(state_create(m, &state), STATUS_OK);
  ck_assert_int_eq(export_create(&spec, m, directory, &export, &error), STATUS_OK);
  for (int k = 0; k < recorded; k++) {
    ck_assert_int_eq(export_add(export, &state, 1e3 * k, &error), STATUS_OK);
  }
  json_t *names = json_array(), *none = json_array();
  ck_assert_int_eq(export_finish(export, &state, none, none, names, &error), STATUS_OK);
  json_decref(none);
  export_destroy(export);
  state_release(&state);
  model_destroy(m);
  mesh_release(&mesh);
  return names;
}

/* Removes the files, each of which has to be there, and their directory, then empty. */
static void remove_all(json_t *names, const char *directory) {
  size_t index;
  json_t *name;
  char path[200];
  json_array_foreach(names, index, name) {
    snprintf(path, sizeof path, "%s/%s", directory, json_string_value(name));
    ck_assert_msg(remove(path) == 0, "%s", path);
  }
  ck_assert_int_eq(rmdir(directory), 0);
  json_decref(names);
}

START_TEST(number_of_files) {
  static const struct {
    int steps, recorded, states; /* states with files */
    const char *last;
  } cases[] = {{10, 11, 11, "volume-0010.vtu"},
               {10, 1, 1, "volume-0000.vtu"},
               {1000, 1001, 51, "volume-1000.vtu"},
               {1000, 30, 3, "volume-0029.vtu"},
               {99, 100, 51, "volume-0099.vtu"}};
  char directory[] = "/tmp/fields-XXXXXX";
  ck_assert_ptr_nonnull(mkdtemp(directory));
  json_t *names = exported(cases[_i].steps, cases[_i].recorded, directory);
  size_t count = json_array_size(names);
  /* two tables, the deck, surface.bin, two collections */
  ck_assert_uint_eq(count, 6 + 2 * (size_t)cases[_i].states);
  ck_assert_str_eq(json_string_value(json_array_get(names, count - 1)), cases[_i].last);
  remove_all(names, directory);
}
END_TEST

START_TEST(no_room) {
  struct error error = {0};
  struct output output;
  ck_assert_int_eq(output_open(&output, "/nowhere/at all", "x.vtu", &error), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(error.message, "/nowhere/at all/x.vtu"));
  char directory[] = "/tmp/fields-XXXXXX";
  ck_assert_ptr_nonnull(mkdtemp(directory));
  ck_assert_int_eq(output_open(&output, directory, "x.vtu", &error), STATUS_OK);
  fputs("half", output.file);
  ck_assert_int_eq(output_close(&output, STATUS_NO_MEMORY, &error), STATUS_NO_MEMORY);
  ck_assert_int_eq(rmdir(directory), 0); /* nothing is left behind */
}
END_TEST

int main(void) {
  Suite *suite = suite_create("fields");
  TCase *fields = tcase_create("fields");
  tcase_set_timeout(fields, 120);
  tcase_add_loop_test(fields, uniaxial_stress, 0, 4);
  tcase_add_test(fields, invariants_of_shear);
  tcase_add_test(fields, cylinder_stresses);
  tcase_add_test(fields, contact_pressure);
  tcase_add_test(fields, node_order);
  tcase_add_test(fields, csv_text);
  tcase_add_loop_test(fields, number_of_files, 0, 5);
  tcase_add_test(fields, no_room);
  suite_add_tcase(suite, fields);
  return suite_run(suite);
}
