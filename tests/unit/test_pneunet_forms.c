/* Forms of pneu-nets beyond boxes: shapes of the gaps, suckers. */
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
    {"/actuator/gap_root", "0.2", STATUS_INVALID, "/actuator/gap_root", "for example \"0.2 mm\""},
};

START_TEST(gap_refusals) {
  suite_check_refusal(&refusals[_i]);
}
END_TEST

static const struct {
  const char *shape, *key, *value, *phrase;
} limits[] = {
    {"\"V\"", "/actuator/gap_root", "\"2.1 mm\"", "at most chamber_gap, 2 mm"},
    {"\"U\"", "/actuator/gap_round", "\"9.7 mm\"", "at most their height, 9.6 mm"},
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

/* ---- suckers ---------------------------------------------------------------------------- */

#define THREE_SUCKERS                                                                              \
  "[{\"position\": \"40 mm\", \"diameter\": \"20 mm\"},"                                           \
  " {\"position\": \"70 mm\", \"diameter\": \"18 mm\", \"wall\": \"1 mm\"},"                       \
  " {\"position\": \"100 mm\", \"diameter\": \"16 mm\", \"depth\": \"5 mm\"}]"

static double rings_by_hand(const struct pneunet_spec *p) {
  double volume = 0;
  for (int k = 0; k < p->sucker_count; k++) {
    const struct sucker_spec *s = &p->sucker[k];
    volume += M_PI * s->wall * (s->diameter + s->wall) * s->depth;
  }
  return volume;
}

static const char *const bodies[][6][2] = {
    {{"/actuator/suckers", THREE_SUCKERS}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/actuator/taper", "{}"}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/symmetry", "\"none\""}},
    {{"/actuator/suckers", THREE_SUCKERS},
     {"/actuator/taper", "{\"left\": \"0.5 deg\", \"right\": \"2.5 deg\"}"}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/actuator/tapered_walls", "\"scaled\""}},
    {{"/actuator/suckers", THREE_SUCKERS},
     {"/actuator/taper", "{\"bottom\": \"1 deg\", \"top\": \"1 deg\", \"left\": \"2 deg\","
                         " \"right\": \"2 deg\"}"}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/actuator/gap_shape", "\"V\""}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/actuator/channel", NULL}},
    {{"/actuator/suckers", THREE_SUCKERS}, {"/actuator/channel/width", "\"10 mm\""}},
    {{"/actuator/suckers", THREE_SUCKERS},
     {"/actuator/chambers", "[{\"config\": \"A\", \"count\": 2}]"}},
    /* a hundredth of a millimetre within the limits, on all sides */
    {{"/actuator/suckers", "[{\"position\": \"8.61 mm\", \"diameter\": \"14 mm\"},"
                           " {\"position\": \"25.73 mm\", \"diameter\": \"14 mm\"},"
                           " {\"position\": \"108.5 mm\", \"diameter\": \"15.8 mm\"}]"}},
    /* of very different sizes, thin and thick */
    {{"/actuator/suckers",
      "[{\"position\": \"30 mm\", \"diameter\": \"24 mm\", \"wall\": \"0.3 mm\"},"
      " {\"position\": \"50 mm\", \"diameter\": \"6 mm\", \"wall\": \"3 mm\"},"
      " {\"position\": \"70 mm\", \"diameter\": \"2 mm\", \"wall\": \"1 mm\", \"depth\": \"20 "
      "mm\"},"
      " {\"position\": \"98 mm\", \"diameter\": \"15 mm\", \"depth\": \"0.1 mm\"}]"}},
    /* tiny and long beside one long cavity */
    {{"/actuator/suckers",
      "[{\"position\": \"59 mm\", \"diameter\": \"1 mm\", \"wall\": \"0.2 mm\"}]"},
     {"/actuator/chambers", "[{\"config\": \"B\", \"count\": 1}]"}},
    /* a body that ends in a point, almost */
    {{"/actuator/suckers", "[{\"position\": \"105 mm\", \"diameter\": \"7 mm\"}]"},
     {"/actuator/stem", "\"3 mm\""},
     {"/actuator/taper", "{\"left\": \"5.3 deg\", \"right\": \"5.3 deg\"}"}},
};
enum { BODIES = sizeof bodies / sizeof *bodies };

/* The rings add their own volume and change no other; no element is inverted. */
START_TEST(suckers_add_their_rings) {
  const char *edits[8][2] = {{NULL, NULL}};
  struct job_spec with;
  memcpy(edits, bodies[_i], sizeof bodies[_i]);
  suite_must_read_edited((const char *const(*)[2])edits, &with);
  struct job_spec without = with;
  without.pneunet.sucker_count = 0;
  for (int tier = ACCURACY_FAST; tier <= ACCURACY_FINE; tier++) {
    with.accuracy = without.accuracy = (enum accuracy)tier;
    double added = solid(&with, 1) - solid(&without, 1);
    ck_assert_double_eq_tol(added / rings_by_hand(&with.pneunet), 1, 5e-3);
  }
}
END_TEST

/* Every node of the rings lies between two circles, and the centreline stays in the middle of the
 * bottom face. */
START_TEST(suckers_are_round) {
  struct job_spec spec;
  struct mesh mesh;
  suite_must_read("/actuator/suckers", THREE_SUCKERS, &spec);
  const struct pneunet_spec *p = &spec.pneunet;
  ck_assert_int_eq(pneunet_mesh(&spec, &mesh, NULL), STATUS_OK);
  int on_circle[3] = {0};
  for (int n = 0; n < mesh.node_count; n++) {
    const double *x = mesh.x + 3 * n;
    if (x[2] >= -1e-9) {
      continue;
    }
    int k = x[0] < 0.055 ? 0 : x[0] < 0.085 ? 1 : 2;
    const struct sucker_spec *s = &p->sucker[k];
    double r = hypot(x[0] - s->position, x[1]), opening = 0.5 * s->diameter;
    ck_assert_double_ge(r, opening - 1e-12);
    ck_assert_double_le(r, opening + s->wall + 1e-12);
    ck_assert_double_ge(x[2], -s->depth - 1e-12);
    ck_assert(!mesh.node_core[n]);
    on_circle[k] += fabs(r - opening) < 1e-12 || fabs(r - opening - s->wall) < 1e-12;
  }
  for (int k = 0; k < 3; k++) {
    ck_assert_int_gt(on_circle[k], 40);
  }
  for (int s = 0; s < mesh.section_count; s++) {
    const double *x = mesh.x + 3 * mesh.centreline[s];
    ck_assert(x[1] == 0 && fabs(x[2]) < 1e-15);
    ck_assert(s == 0 || x[0] > mesh.x[3 * mesh.centreline[s - 1]]);
  }
  mesh_release(&mesh);
}
END_TEST

#define AT(position, rest) "[{\"position\": \"" position "\"" rest "}]"

static const struct refusal sucker_refusals[] = {
    {"/actuator/suckers", AT("40 mm", ""), STATUS_INVALID, "/actuator/suckers/0",
     "\"diameter\" is missing"},
    {"/actuator/suckers", AT("40 mm", ", \"diameter\": 20"), STATUS_INVALID,
     "/actuator/suckers/0/diameter", "for example \"20 mm\""},
    {"/actuator/suckers", AT("40 mm", ", \"diameter\": \"0 mm\""), STATUS_INVALID,
     "/actuator/suckers/0/diameter", "at least 1 um"},
    {"/actuator/suckers", "{}", STATUS_INVALID, "/actuator/suckers", "must be an array"},
    {"/actuator/suckers", AT("11.5 mm", ", \"diameter\": \"20 mm\""), STATUS_GEOMETRY,
     "/actuator/suckers/0/position", "at its base: the middle must be between 11.6 mm and 106.4"},
    {"/actuator/suckers", AT("110 mm", ", \"diameter\": \"15 mm\""), STATUS_GEOMETRY,
     "/actuator/suckers/0/position", "at its tip: the middle must be between 9.1 mm and 108.9 mm"},
    {"/actuator/suckers", AT("100 mm", ", \"diameter\": \"20 mm\""), STATUS_GEOMETRY,
     "/actuator/suckers/0/diameter", "the diameter can be at most 19.8"},
    {"/actuator/suckers", AT("50 mm", ", \"diameter\": \"4 mm\", \"wall\": \"2.1 mm\""),
     STATUS_GEOMETRY, "/actuator/suckers/0/wall", "at most 2 mm"},
    {"/actuator/suckers",
     "[{\"position\": \"40 mm\", \"diameter\": \"20 mm\"},"
     " {\"position\": \"61 mm\", \"diameter\": \"16 mm\"}]",
     STATUS_GEOMETRY, "/actuator/suckers/1/position", "at least 21.1 mm"},
    {"/actuator/suction_pressure", "\"200 kPa\"", STATUS_INVALID, "/actuator/suction_pressure",
     "at most 101"},
};

START_TEST(sucker_refusals_name_the_limit) {
  suite_check_refusal(&sucker_refusals[_i]);
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
  TCase *suckers = tcase_create("suckers");
  tcase_set_timeout(suckers, 60);
  tcase_add_loop_test(suckers, suckers_add_their_rings, 0, BODIES);
  tcase_add_test(suckers, suckers_are_round);
  tcase_add_loop_test(suckers, sucker_refusals_name_the_limit, 0,
                      sizeof sucker_refusals / sizeof *sucker_refusals);
  suite_add_tcase(suite, suckers);
  return suite_run(suite);
}
