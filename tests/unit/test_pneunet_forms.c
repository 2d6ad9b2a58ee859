/* Forms of pneu-nets beyond boxes: shapes of the gaps. */
#include <math.h>
#include <string.h>

#include "solver/mesh/pneunet.h"
#include "tests/unit/mesh_volume.h"
#include "tests/unit/suite.h"

static double solid(const struct job_spec *spec, int split) {
  struct mesh mesh;
  struct pneunet_cells cells = pneunet_resolution(spec);
  cells.height.split = split;
  cells.slit.split = split;
  cells.floor.split = split;
  ck_assert_int_eq(pneunet_mesh_cells(spec, &cells, &mesh, NULL), STATUS_OK);
  double volume = (mesh.half ? 2 : 1) * mesh_solid_volume(&mesh);
  mesh_release(&mesh);
  return volume;
}

/* ---- gaps ------------------------------------------------------------------------------- */

/* Area, seen from the side, by which half a gap is smaller than a rectangular one up to height z:
 * the integral of the formulas in spec.h. */
static double lost_area(const struct pneunet_spec *p, double z) {
  double narrowing = 0.5 * (p->chamber_gap - p->gap_root);
  if (p->gap_shape == GAP_U) {
    double d = p->gap_round, below = fmin(z, d), c = 1 - below / d;
    return narrowing * (below - d * (M_PI / 4 - 0.5 * (c * sqrt(1 - c * c) + asin(c))));
  }
  return narrowing * (z - 0.5 * z * z / (p->height_base - p->bottom_layer));
}

/* Silicone that the shape adds: beside a detached chamber there is none under it but the stem. */
static double added_volume(const struct pneunet_spec *p, int attached_sides, int detached_sides) {
  double side = lost_area(p, p->height_base - p->bottom_layer) * p->width;
  return attached_sides * side +
         detached_sides * (side - lost_area(p, p->slit) * (p->width - 2 * p->stem));
}

static const struct {
  const char *shape, *root, *round;
  double tolerance; /* of the added volume: straight sides are exact, quarters of circles lie
                     * within one element of this mesh */
} shapes[] = {
    {"\"V\"", NULL, NULL, 1e-11},
    {"\"V\"", "\"1.5 mm\"", NULL, 1e-11},
    {"\"trapezoidal\"", NULL, NULL, 1e-11},
    {"\"U\"", NULL, NULL, 0.25},
    {"\"U\"", "\"1 mm\"", "\"3 mm\"", 0.05},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void read_shape(int k, struct job_spec *spec) {
  const char *edits[6][2] = {{"/actuator/taper", "{}"}, {"/actuator/gap_shape", shapes[k].shape}};
  int count = 2;
  if (shapes[k].root) {
    edits[count][0] = "/actuator/gap_root";
    edits[count++][1] = shapes[k].root;
  }
  if (shapes[k].round) {
    edits[count][0] = "/actuator/gap_round";
    edits[count++][1] = shapes[k].round;
  }
  suite_must_read_edited((const char *const(*)[2])edits, spec);
}

START_TEST(gaps_add_the_silicone_of_their_shape) {
  struct job_spec spec, straight;
  read_shape(_i, &spec);
  suite_must_read("/actuator/taper", "{}", &straight);
  /* 7 chambers B, 5 C: 11 gaps, of which the last five have ten sides, nine of them detached */
  double added = added_volume(&spec.pneunet, 13, 9);
  double coarse = solid(&spec, 1) - solid(&straight, 1);
  double fine = solid(&spec, 4) - solid(&straight, 4);
  ck_assert_double_eq_tol(coarse / added, 1, shapes[_i].tolerance);
  ck_assert_double_eq_tol(fine / added, 1, fmax(1e-11, 0.3 * shapes[_i].tolerance));
}
END_TEST

START_TEST(defaults_of_the_gap_follow_its_width) {
  struct job_spec spec;
  suite_must_read("/actuator/gap_shape", "\"V\"", &spec);
  suite_check_near(spec.pneunet.gap_root, 0.0002);
  suite_must_read("/actuator/gap_shape", "\"trapezoidal\"", &spec);
  suite_check_near(spec.pneunet.gap_root, 0.001);
  suite_must_read("/actuator/gap_shape", "\"U\"", &spec);
  suite_check_near(spec.pneunet.gap_root, 0.0002);
  suite_check_near(spec.pneunet.gap_round, 0.0009);
  suite_must_read("/actuator/gap_root", "\"1 mm\"", &spec);
  suite_check_near(spec.pneunet.gap_root, 0.002);
}
END_TEST

/* The narrowest place of a gap is its root, wherever the mesh has its lines. */
START_TEST(the_narrowest_place_is_the_root) {
  struct job_spec spec;
  struct mesh mesh;
  suite_must_read("/actuator/gap_shape", "\"V\"", &spec);
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  ck_assert_double_eq_tol(mesh.gap_width, spec.pneunet.gap_root, 1e-15);
  double narrowest = INFINITY;
  for (int f = 0; f < mesh.facing_count; f++) {
    int slave[QUAD9_NODES], master[QUAD9_NODES];
    mesh_face_nodes(&mesh, &mesh.facing[f].slave, slave);
    mesh_face_nodes(&mesh, &mesh.facing[f].master, master);
    for (int m = 0; mesh.facing[f].slave.axis == 0 && m < QUAD9_NODES; m++) {
      double width = mesh.x[3 * master[m]] - mesh.x[3 * slave[m]];
      narrowest = fmin(narrowest, width);
      /* matched faces: points opposite each other at equal y and z */
      ck_assert_double_eq_tol(mesh.x[3 * master[m] + 2], mesh.x[3 * slave[m] + 2], 1e-12);
    }
  }
  ck_assert_double_eq_tol(narrowest, spec.pneunet.gap_root, 1e-12);
  mesh_release(&mesh);
}
END_TEST

/* Nothing turns inside out in bodies far from the usual; mesh_solid_volume looks at every Gauss
 * point. */
static const char *const extremes[][6][2] = {
    {{"/actuator/chamber_gap", "\"6 mm\""}, {"/actuator/gap_root", "\"1 um\""}},
    {{"/actuator/chamber_gap", "\"0.05 mm\""}, {"/actuator/gap_root", "\"0.001 mm\""}},
    {{"/actuator/gap_wall", "\"0.1 mm\""}, {"/actuator/chamber_gap", "\"6 mm\""}},
    {{"/actuator/gap_wall", "\"3.4 mm\""}},
    {{"/actuator/height", "\"100 mm\""}},
    {{"/actuator/height", "{\"base\": \"40 mm\", \"tip\": \"11 mm\"}"}},
    {{"/actuator/bottom_layer", "\"4 mm\""}, {"/actuator/slit", "\"6 mm\""}},
    {{"/actuator/taper", "{\"top\": \"2 deg\", \"left\": \"5 deg\"}"},
     {"/actuator/tapered_walls", "\"scaled\""}},
    {{"/actuator/chambers",
      "[{\"config\": \"A\", \"count\": 3}, {\"config\": \"B\", \"count\": 1},"
      " {\"config\": \"A\", \"count\": 1}, {\"config\": \"C\", \"count\": 2}]"}},
};
enum { EXTREMES = sizeof extremes / sizeof *extremes };

START_TEST(extreme_gaps_do_not_invert) {
  static const char *const words[] = {"\"U\"", "\"V\"", "\"trapezoidal\""};
  const char *edits[9][2] = {{"/actuator/gap_shape", words[_i / EXTREMES]}};
  for (int k = 0; extremes[_i % EXTREMES][k][0]; k++) {
    memcpy(edits[k + 1], extremes[_i % EXTREMES][k], sizeof edits[0]);
  }
  struct job_spec spec;
  suite_must_read_edited((const char *const(*)[2])edits, &spec);
  for (int tier = ACCURACY_FAST; tier <= ACCURACY_FINE; tier++) {
    spec.accuracy = (enum accuracy)tier;
    ck_assert_double_gt(solid(&spec, 1), 0);
  }
}
END_TEST

static const struct refusal refusals[] = {
    {"/actuator/gap_shape", "\"W\"", STATUS_INVALID, "/actuator/gap_shape", "\"trapezoidal\""},
    {"/actuator/gap_root", "\"0 mm\"", STATUS_INVALID, "/actuator/gap_root", "at least 1 um"},
    {"/actuator/gap_root", "0.2", STATUS_INVALID, "/actuator/gap_root", "write \"0.2 mm\""},
};

START_TEST(gap_refusals) {
  suite_check_refusal(&refusals[_i]);
}
END_TEST

static const struct {
  const char *shape, *key, *value, *phrase;
} limits[] = {
    {"\"V\"", "/actuator/gap_root", "\"2.1 mm\"", "2.1 mm wide at the root but only 2 mm"},
    {"\"U\"", "/actuator/gap_round", "\"9.7 mm\"", "which are 9.6 mm high"},
};

START_TEST(gap_limits) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  const char *const edits[][2] = {
      {"/actuator/gap_shape", limits[_i].shape}, {limits[_i].key, limits[_i].value}, {NULL, NULL}};
  ck_assert_int_eq(suite_read_edited(edits, &spec, &error), STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, limits[_i].key);
  ck_assert_msg(strstr(error.message, limits[_i].phrase) != NULL, "%s", error.message);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("pneunet: forms");
  TCase *gaps = tcase_create("gaps");
  tcase_set_timeout(gaps, 60);
  tcase_add_loop_test(gaps, gaps_add_the_silicone_of_their_shape, 0, SHAPES);
  tcase_add_test(gaps, defaults_of_the_gap_follow_its_width);
  tcase_add_test(gaps, the_narrowest_place_is_the_root);
  tcase_add_loop_test(gaps, extreme_gaps_do_not_invert, 0, 3 * EXTREMES);
  tcase_add_loop_test(gaps, gap_refusals, 0, sizeof refusals / sizeof *refusals);
  tcase_add_loop_test(gaps, gap_limits, 0, sizeof limits / sizeof *limits);
  suite_add_tcase(suite, gaps);
  return suite_run(suite);
}
