/* Jobs of grasps: objects and courses that are taken, and those that are refused; what the fingers
 * of a gripper see. */
#include <math.h>
#include <string.h>

#include "solver/job/grasp_lead.h"
#include "tests/unit/suite.h"

static const char grasp[] =
    "{\"kind\": \"grasp\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"60 mm\", "
    "\"width\": \"20 mm\", \"height\": \"15 mm\", \"chambers\": [{\"config\": \"B\", \"count\": "
    "4}], \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"4 mm\"}, "
    "\"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"30 kPa\"}, \"gravity\": "
    "[\"9.8 m/s2\", 0, 0]}, \"object\": {\"shape\": {\"form\": \"sphere\", \"diameter\": \"40 "
    "mm\"}, \"position\": [\"50 mm\", 0, \"-30 mm\"], \"friction\": 0.5}, \"grasp\": {\"pull\": "
    "{\"direction\": [2, 0, 0], \"distance\": \"50 mm\"}}}";

/* The corner of a cube of 10 mm as a binary STL file, and without one of its faces. */
#define TETRAHEDRON                                                                                \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAgQQAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACBBAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAgQQAAAAAAACBBAAAAAAAAAAAAAAAAAAAAAAAAAAAgQQAA"           \
  "AAAAAAAAAAAAAAAAIEEAAAAAAAAAAAAAAAAAACBBAAA="
#define THREE_FACES                                                                                \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAADAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAgQQAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACBBAAAAAAAAAAAAAAAAAAAAAAAAIEEAAAAAAAAA"           \
  "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAgQQAAAAAAACBBAAAAAAAA"

#define SHAPE(text)                                                                                \
  { "/object/shape", "{\"form\": " text "}" }
#define BLOCKED(more)                                                                              \
  { "/grasp", "{\"blocked\": {\"distance\": \"20 mm\"}" more "}" }
#define NO_OBJECT                                                                                  \
  { "/object", NULL }
#define FINGERS                                                                                    \
  { "/grasp/fingers", "{\"count\": 3, \"radius\": \"30 mm\", \"tilt\": \"10 deg\"}" }

#define FREE(mass)                                                                                 \
  {"/object/motion", "\"free\""}, {                                                                \
    "/object/mass", "\"" mass "\""                                                                 \
  }
#define PULL(keys)                                                                                 \
  { "/grasp/pull", "{" keys "}" }
#define TURN(axis) "{\"turn\": {\"axis\": [" axis "], \"angle\": \"90 deg\"}}"
#define BALL(place)                                                                                \
  {                                                                                                \
    "/object", "{\"shape\": {\"form\": \"sphere\", \"diameter\": \"40 mm\"}, \"position\": " place \
               ", \"friction\": 0.5, \"motion\": \"free\", \"mass\": \"50 g\"}"                    \
  }
#define HELD_BY_THREE(place) BALL(place), {"/grasp", "{}"}, FINGERS

static const struct variant variants[] = {
    {grasp, {{NULL}}, NULL, NULL},
    {grasp, {{"/grasp", "{}"}}, NULL, NULL},
    {grasp, {{"/grasp/approach", "{\"from\": [0, 0, \"-60 mm\"]}"}}, NULL, NULL},
    {grasp, {FINGERS}, NULL, NULL},
    {grasp, {{"/grasp/release", "true"}}, NULL, NULL},
    {grasp, {{"/grasp/numerics", "{\"longest_step\": \"1 mm\", \"stiffness\": 2}"}}, NULL, NULL},
    {grasp, {{"/grasp/dynamics", "{\"use\": \"never\"}"}}, NULL, NULL},
    /* shapes */
    {grasp, {SHAPE("\"cylinder\", \"diameter\": \"65 mm\", \"length\": \"0.2 m\"")}, NULL, NULL},
    {grasp,
     {SHAPE("\"cylinder\", \"diameter\": \"65 mm\", \"length\": \"9 mm\", \"rim\": \"5 mm\"")},
     "/object/shape/rim",
     "from 0 (sharp) to 4.5 mm"},
    {grasp,
     {SHAPE("\"frustum\", \"base_diameter\": \"6 cm\", \"tip_diameter\": \"85 mm\", \"length\": "
            "\"110 mm\", \"rim\": \"3 mm\"")},
     NULL,
     NULL},
    {grasp, {SHAPE("\"box\", \"size\": [\"6 cm\", \"60 mm\", \"120 mm\"]")}, NULL, NULL},
    {grasp,
     {SHAPE("\"box\", \"size\": [\"6 cm\", \"60 mm\", \"120 mm\"], \"edge\": \"31 mm\"")},
     "/object/shape/edge",
     "from 0 (sharp) to 30 mm"},
    {grasp,
     {SHAPE("\"revolution\", \"profile\": [[\"-5 cm\", \"3 cm\"], [0, \"2 cm\"], [\"5 cm\", 0]]")},
     NULL,
     NULL},
    {grasp,
     {SHAPE("\"revolution\", \"profile\": [[\"-5 cm\", \"3 cm\"], [\"-5 cm\", \"2 cm\"]]")},
     "/object/shape/profile",
     "encloses nothing"},
    {grasp,
     {SHAPE("\"revolution\", \"profile\": [[\"-5 cm\", \"3 cm\"], [0, \"-2 cm\"]]")},
     "/object/shape/profile/1",
     "is -20 mm"},
    {grasp,
     {SHAPE("\"revolution\", \"profile\": [[\"-5 cm\", 0], [0, 0]]")},
     "/object/shape/profile",
     "encloses nothing"},
    {grasp, {SHAPE("\"plane\"")}, NULL, NULL},
    {grasp, {SHAPE("\"surface\", \"stl\": {\"base64\": \"" TETRAHEDRON "\"}")}, NULL, NULL},
    {grasp,
     {SHAPE("\"surface\", \"stl\": {\"base64\": \"" THREE_FACES "\"}")},
     "/object/shape/stl",
     "3 triangles"},
    {grasp,
     {SHAPE("\"surface\", \"stl\": {\"base64\": \"c29saWQgYQ==\"}")},
     "/object/shape/stl/base64",
     "\"facet\" or \"endsolid\""},
    {grasp,
     {SHAPE("\"surface\", \"stl\": {\"base64\": \"" TETRAHEDRON "\"}, \"crease\": \"190 deg\"")},
     "/object/shape/crease",
     "180"},
    {grasp,
     {SHAPE("\"surface\", \"stl\": {\"base64\": \"c29s?WQgYQ==\"}")},
     "/object/shape/stl/base64",
     "not base64"},
    {grasp,
     {SHAPE("\"surface\", \"stl\": {\"file\": \"part.stl\"}")},
     "/object/shape/stl/file",
     "on the command line only"},
    {grasp, {SHAPE("\"torus\"")}, "/object/shape/form", "\"sphere\""},
    /* objects */
    {grasp, {{"/object/friction", "-0.1"}}, "/object/friction", "0"},
    {grasp, {{"/object/friction", NULL}}, "/object", "\"friction\" is missing"},
    {grasp, {{"/object/axis", "[0, 0, 0]"}}, "/object/axis", "has no length"},
    {grasp,
     {{"/object/rotation", "{\"axis\": [0, 0, 0], \"angle\": \"5 deg\"}"}},
     "/object/rotation/axis",
     "has no length"},
    {grasp, {{"/object/colour", "\"red\""}}, "/object/colour", "not known here"},
    /* courses */
    {grasp, {{"/grasp/pull/direction", "[0, 0, 0]"}}, "/grasp/pull/direction", "has no length"},
    {grasp, {{"/grasp/pull/distance", "\"0 mm\""}}, "/grasp/pull/distance", ""},
    {grasp, {{"/grasp/pull/rate", "\"-5 mm/s\""}}, "/grasp/pull/rate", ""},
    {grasp,
     {{"/grasp/fingers", "{\"count\": 7, \"radius\": \"30 mm\"}"}},
     "/grasp/fingers/count",
     "6"},
    {grasp, {NO_OBJECT}, "", "\"object\" is missing"},
    {grasp, {FREE("-1 g")}, "/object/mass", "-1 g"},
    {grasp, {{"/object/motion", "\"free\""}}, "/object", "\"mass\" is missing"},
    {grasp, {{"/object/mass", "\"50 g\""}}, "/object/mass", "needs no mass"},
    {grasp, {FREE("50 g")}, "/grasp/pull", "is not led"},
    {grasp, {FREE("50 g"), {"/grasp", "{}"}, {"/load/gravity", NULL}}, "/object/motion", "draws"},
    {grasp,
     {FREE("50 g"), {"/grasp", "{}"}, {"/object/shape", "{\"form\": \"plane\"}"}},
     "/object/motion",
     "no volume"},
    {grasp, {PULL("\"direction\": [1, 0, 0], \"force\": \"2 N\"")}, "/grasp/pull/force", "free"},
    {grasp, {PULL("\"direction\": [1, 0, 0]")}, "/grasp/pull", "none of"},
    {grasp, {PULL("\"distance\": \"9 mm\"")}, "/grasp/pull", "\"direction\" is missing"},
    {grasp,
     {PULL("\"path\": [{\"move\": [\"1 mm\", 0, 0]}], \"distance\": \"9 mm\"")},
     "/grasp/pull",
     "several of"},
    {grasp,
     {PULL("\"path\": [{\"move\": [\"1 mm\", 0, 0]}], \"direction\": [1, 0, 0]")},
     "/grasp/pull/direction",
     "each of its legs"},
    {grasp, {PULL("\"path\": [{\"duration\": \"1 s\"}]")}, "/grasp/pull/path/0", "neither"},
    {grasp, {PULL("\"path\": [" TURN("0, 0, 0") "]")}, "/grasp/pull/path/0/turn/axis", "no length"},
    {grasp,
     {PULL("\"steps\": 600, \"path\": [" TURN("1, 0, 0") ", " TURN("1, 0, 0") "]")},
     "/grasp/pull/steps",
     "up to 500 here"},
    {grasp, {HELD_BY_THREE("[\"50 mm\", 0, 0]")}, NULL, NULL},
    {grasp,
     {HELD_BY_THREE("[\"50 mm\", 0, 0]"),
      {"/grasp/pull", "{\"direction\": [-1, 0, 0], \"force\": \"2 N\"}"}},
     NULL,
     NULL},
    {grasp,
     {HELD_BY_THREE("[\"50 mm\", 0, 0]"),
      {"/grasp/pull", "{\"direction\": [0, 1, 0], \"force\": \"2 N\"}"}},
     "/grasp/pull/direction",
     "along the axis"},
    {grasp,
     {HELD_BY_THREE("[\"50 mm\", 0, 0]"), {"/load/gravity", "[0, 0, \"9.8 m/s2\"]"}},
     "/load/gravity",
     "along the axis"},
    {grasp,
     {HELD_BY_THREE("[\"50 mm\", 0, 0]"), {"/grasp/approach", "{\"from\": [0, \"60 mm\", 0]}"}},
     "/grasp/approach/from",
     "along the axis"},
    {grasp, {HELD_BY_THREE("[\"50 mm\", \"1 mm\", 0]")}, "/object", "do not all see"},
    {grasp,
     {HELD_BY_THREE("[\"50 mm\", 0, 0]"), {"/actuator/taper", "{\"left\": \"1 deg\"}"}},
     "/object",
     "do not all see"},
    {grasp, {BLOCKED("")}, "/grasp/blocked", "a plate in its place"},
    {grasp, {BLOCKED(""), NO_OBJECT}, NULL, NULL},
    {grasp,
     {BLOCKED(", \"pull\": {\"direction\": [1, 0, 0], \"distance\": \"1 mm\"}"), NO_OBJECT},
     "/grasp/pull",
     "no such stage"},
    {grasp,
     {BLOCKED(""), NO_OBJECT, {"/grasp/blocked/direction", "[0, 0, 0]"}},
     "/grasp/blocked/direction",
     "has no length"},
};

START_TEST(variants_are_taken_or_refused) {
  suite_check_variant(&variants[_i]);
}
END_TEST

static void read_grasp(const char *const (*edits)[2], struct job_spec *spec) {
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(suite_read_document(grasp, edits, spec, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(spec->kind, JOB_GRASP);
}

static void check_vector(const double value[3], double x, double y, double z) {
  const double wanted[] = {x, y, z};
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq_tol(value[i], wanted[i], 1e-12);
  }
}

START_TEST(numbers_are_in_si) {
  const char *const edits[][2] = {
      {"/object/axis", "[0, 3, 0]"},
      {"/object/rotation", "{\"axis\": [0, 2, 0], \"angle\": \"90 deg\"}"},
      {"/grasp/approach", "{\"from\": [0, 0, \"-6 cm\"], \"rate\": \"1 cm/s\", \"steps\": 3}"},
      {NULL, NULL}};
  struct job_spec spec;
  read_grasp(edits, &spec);
  const struct grasp_spec *g = spec.grasp;
  ck_assert_int_eq(spec.accuracy, ACCURACY_FAST);
  ck_assert_double_eq_tol(g->object.shape.diameter, 0.04, 1e-15);
  ck_assert_double_eq(g->object.friction, 0.5);
  check_vector(g->object.place, 0.05, 0, -0.03);
  /* z was turned to y by a turn about -x, which left x alone and brought y to -z; then about y. */
  for (int i = 0; i < 3; i++) {
    const double *row = g->object.rotation[i];
    check_vector(row, i == 2 ? -1 : 0, i == 0 ? -1 : 0, i == 1 ? 1 : 0);
  }
  check_vector(g->approach.from, 0, 0, -0.06);
  ck_assert_double_eq_tol(g->approach.rate, 0.01, 1e-15);
  check_vector(g->pull.direction, 1, 0, 0);
  ck_assert_int_eq(g->pull.leg_count, 1);
  ck_assert_double_eq_tol(g->pull.leg[0].seconds, g->pull.leg[0].move[0] / 5e-3, 1e-12);
  ck_assert_int_eq(g->pull.steps, 30);
  ck_assert_double_nan(g->damping_time);
  check_vector(g->gravity, 9.8, 0, 0);
  job_spec_release(&spec);
}
END_TEST

/* A path by legs: a shift, three turns in one, and a way back with a turn of a quarter. */
START_TEST(a_path_leads_the_object_leg_by_leg) {
  const char *const edits[][2] = {
      PULL(
          "\"steps\": 2, \"path\": [{\"move\": [\"6 mm\", 0, 0]}, {\"turn\": {\"axis\": [0, 2, 0], "
          "\"angle\": \"1080 deg\"}}, {\"move\": [\"-6 mm\", 0, 0], \"turn\": {\"axis\": [0, 0, "
          "-1], "
          "\"angle\": \"90 deg\"}, \"duration\": \"7 s\"}]"),
      {NULL, NULL}};
  const double nowhere[3] = {0, 0, 0};
  struct job_spec spec;
  struct grasp_lead lead;
  read_grasp(edits, &spec);
  const struct grasp_pull *pull = &spec.grasp->pull;
  ck_assert_int_eq(pull->leg_count, 3);
  ck_assert_int_eq(pull->steps, 6);
  ck_assert_double_eq_tol(pull->leg[0].seconds, 6.0 / 5, 1e-12);
  ck_assert_double_eq_tol(pull->leg[1].seconds, 1080.0 / 45, 1e-9);
  ck_assert_double_eq(pull->leg[2].seconds, 7);
  ck_assert(!grasp_symmetric(spec.grasp));
  grasp_lead_at(spec.grasp, nowhere, 1.0 / 6, &lead);
  check_vector(lead.pose.place, 0.053, 0, -0.03);
  check_vector(lead.direction, 1, 0, 0);
  check_vector(lead.axis, 0, 0, 0);
  grasp_lead_at(spec.grasp, nowhere, 1.0 / 3 + 0.25 / 9, &lead);
  check_vector(lead.pose.place, 0.056, 0, -0.03);
  check_vector(lead.pose.rotation, 0, 0, 1);
  check_vector(lead.axis, 0, 1, 0);
  grasp_lead_at(spec.grasp, nowhere, 2.0 / 3, &lead);
  check_vector(lead.pose.rotation, 1, 0, 0);
  ck_assert_double_eq_tol(lead.turned, 6 * M_PI, 1e-12);
  grasp_lead_at(spec.grasp, nowhere, 1, &lead);
  check_vector(lead.pose.place, 0.05, 0, -0.03);
  check_vector(lead.pose.rotation, 0, 1, 0);
  check_vector(lead.direction, -1, 0, 0);
  ck_assert_double_eq_tol(lead.way, 0.012, 1e-15);
  job_spec_release(&spec);
}
END_TEST

START_TEST(a_plate_faces_the_tip) {
  const char *const edits[][2] = {BLOCKED(""), NO_OBJECT, {NULL, NULL}};
  struct job_spec spec;
  read_grasp(edits, &spec);
  const struct grasp_object *plate = &spec.grasp->object;
  ck_assert_int_eq(plate->shape.form, GRASP_PLANE);
  check_vector(plate->place, 0, 0, -0.02);
  ck_assert_double_eq_tol(plate->rotation[2][2], 1, 1e-15);
  ck_assert(grasp_symmetric(spec.grasp));
  job_spec_release(&spec);
}
END_TEST

/* Three fingers around an object on the axis of the gripper see the same; of an object beside it
 * only those that are each other's mirror images about the line to it would. */
START_TEST(fingers_see_an_object_on_the_axis_alike) {
  const char *const edits[][2] = {FINGERS, {"/object/position", "[\"50 mm\", 0, 0]"}, {NULL, NULL}};
  struct job_spec spec;
  read_grasp(edits, &spec);
  struct grasp_spec seen[3];
  for (int k = 0; k < 3; k++) {
    seen[k] = grasp_of_finger(spec.grasp, k);
    ck_assert(grasp_symmetric(&seen[k]));
    ck_assert(grasp_same(&seen[0], &seen[k]));
  }
  double c = cos(M_PI / 18), s = sin(M_PI / 18);
  check_vector(seen[1].object.place, 0.05 * c - 0.03 * s, 0, -0.05 * s - 0.03 * c);
  check_vector(seen[1].pull.direction, c, 0, -s);
  spec.grasp->object.place[2] = 0.001;
  seen[0] = grasp_of_finger(spec.grasp, 0);
  seen[1] = grasp_of_finger(spec.grasp, 1);
  ck_assert(grasp_symmetric(&seen[0]));
  ck_assert(!grasp_symmetric(&seen[1]));
  ck_assert(!grasp_same(&seen[0], &seen[1]));
  job_spec_release(&spec);
}
END_TEST

/* Which poses of a shape are symmetric about y = 0. */
START_TEST(symmetry_depends_on_shape_and_pose) {
  static const struct {
    enum grasp_form form;
    double axis[3], y;
    bool symmetric;
  } cases[] = {
      {GRASP_SPHERE, {0, 0, 1}, 0, true},    {GRASP_SPHERE, {0, 0, 1}, 1e-3, false},
      {GRASP_CYLINDER, {0, 1, 0}, 0, true},  {GRASP_CYLINDER, {1, 0, 1}, 0, true},
      {GRASP_CYLINDER, {1, 1, 0}, 0, false}, {GRASP_FRUSTUM, {0, 1, 0}, 0, false},
      {GRASP_FRUSTUM, {1, 0, 2}, 0, true},   {GRASP_PLANE, {1, 0, 2}, 1e-3, true},
      {GRASP_PLANE, {0, 1, 2}, 0, false},    {GRASP_BOX, {1, 0, 2}, 0, true},
      {GRASP_BOX, {1, 1, 0}, 0, false},      {GRASP_SURFACE, {0, 0, 1}, 0, false},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char axis[60];
    snprintf(axis, sizeof axis, "[%g, %g, %g]", cases[i].axis[0], cases[i].axis[1],
             cases[i].axis[2]);
    const char *const edits[][2] = {{"/object/axis", axis}, {NULL, NULL}};
    struct job_spec spec;
    read_grasp(edits, &spec);
    spec.grasp->object.shape.form = cases[i].form;
    memcpy(spec.grasp->object.shape.size, (double[]){0.02, 0.03, 0.04}, 3 * sizeof(double));
    spec.grasp->object.place[1] = cases[i].y;
    ck_assert_msg(grasp_symmetric(spec.grasp) == cases[i].symmetric, "case %zu", i);
    job_spec_release(&spec);
  }
}
END_TEST

/* A body of revolution across the finger is symmetric when its profile is. */
START_TEST(an_even_profile_is_symmetric) {
  static const char *const top[] = {"3 cm", "2 cm"};
  for (int i = 0; i < 2; i++) {
    char shape[200];
    snprintf(shape, sizeof shape,
             "{\"form\": \"revolution\", \"profile\": [[\"-5 cm\", \"3 cm\"], [0, \"4 cm\"], "
             "[\"5 cm\", \"%s\"]]}",
             top[i]);
    const char *const edits[][2] = {
        {"/object/shape", shape}, {"/object/axis", "[0, 1, 0]"}, {NULL, NULL}};
    struct job_spec spec;
    read_grasp(edits, &spec);
    ck_assert_int_eq(grasp_symmetric(spec.grasp), i == 0);
    job_spec_release(&spec);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: grasps");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_loop_test(tcase, variants_are_taken_or_refused, 0, sizeof variants / sizeof *variants);
  tcase_add_test(tcase, numbers_are_in_si);
  tcase_add_test(tcase, a_path_leads_the_object_leg_by_leg);
  tcase_add_test(tcase, a_plate_faces_the_tip);
  tcase_add_test(tcase, fingers_see_an_object_on_the_axis_alike);
  tcase_add_test(tcase, symmetry_depends_on_shape_and_pose);
  tcase_add_test(tcase, an_even_profile_is_symmetric);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
