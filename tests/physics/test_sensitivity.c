/* Derivatives of the result: against differences of bodies that are solved anew, from the text of
 * the changed job on, and against laws of scale. */
#include <check.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/post/result_sensitivity.h"
#include "solver/post/shape.h"
#include "tests/physics/pneunet_case.h"
#include "tests/unit/suite.h"

enum { EDITS_MAX = 24, KEYS = 9, POINTS = 3, VALUES = KEYS + 3 * POINTS, SOLVES_MAX = 30 };

static const char *const keys[KEYS] = {
    "bending_angle_deg", "chord_angle_deg",   "end_face_angle_deg",
    "tip_deflection_mm", "tip_x_mm",          "tip_y_mm",
    "tip_z_mm",          "cavity_volume_mm3", "mass_g"};

/* A body: what differs from the job of suite_read_edited. */
struct design {
  const char *name;
  const char *edits[EDITS_MAX][2];
  int touching;         /* points that carry traction, at least */
  const char *skip[16]; /* parameters that are not compared with differences */
};

/* Three chambers pressed against each other; a short wall, so that contact comes early. */
static const struct design touching = {
    "three chambers, contact",
    {{"/actuator/chambers", "[{\"config\": \"B\", \"count\": 3}]"},
     {"/actuator/length", "\"28 mm\""},
     {"/actuator/height", "\"20 mm\""},
     {"/actuator/channel", NULL},
     {"/actuator/gap_wall", "\"1.9 mm\""},
     {"/actuator/chamber_gap", "\"1.2 mm\""},
     {"/actuator/taper", "{\"left\": \"2 deg\", \"right\": \"2 deg\", \"top\": \"1 deg\"}"},
     {"/material", "{\"model\": \"yeoh\", \"C\": [\"0.25 MPa\", \"-0.05 MPa\", \"0.005 MPa\"]}"},
     {"/load", "{\"pressure\": {\"to\": \"40 kPa\", \"steps\": 4}}"},
     {"/mesh",
      "{\"gap_wall\": 1, \"cavity\": 1, \"half_width\": 2, \"bottom\": 1, \"height\": 3}"}},
    10,
    /* Half a body: a difference of one side needs the whole; a taper of 0 has no lower side. */
    {"/actuator/taper/left", "/actuator/taper/right", "/actuator/taper/bottom",
     "/material/density"}};

/* Every dimension there is, Ogden's law, gravity aslant: the whole body is modelled. */
static const struct design slack = {
    "chambers B and C, gravity, no contact",
    {{"/actuator/chambers",
      "[{\"config\": \"B\", \"count\": 1}, {\"config\": \"C\", \"count\": 1}]"},
     {"/actuator/length", NULL},
     {"/actuator/chamber_length", "\"8.2 mm\""},
     {"/actuator/height", "{\"base\": \"18 mm\", \"tip\": \"16 mm\"}"},
     {"/actuator/gap_wall", "\"1.8 mm\""},
     {"/actuator/slit", "\"1.1 mm\""},
     {"/actuator/slit_floor", "\"1.4 mm\""},
     {"/actuator/stem", "\"5 mm\""},
     {"/actuator/channel", "{\"width\": \"4 mm\", \"height\": \"2 mm\", \"cover\": \"1.6 mm\"}"},
     {"/actuator/taper", "{\"left\": \"2 deg\", \"right\": \"1 deg\"}"},
     {"/material",
      "{\"model\": \"ogden\", \"mu\": [\"0.3 MPa\", \"-0.02 MPa\"], \"alpha\": [1.5, -3],"
      " \"bulk_ratio\": 200}"},
     {"/load", "{\"pressure\": {\"to\": \"10 kPa\", \"steps\": 1},"
               " \"gravity\": [0, \"5 m/s2\", \"-9.8 m/s2\"]}"},
     {"/contact", "false"},
     {"/mesh",
      "{\"gap_wall\": 1, \"cavity\": 1, \"half_width\": 1, \"bottom\": 1, \"height\": 1}"}},
    0,
    {"/actuator/width", "/actuator/side_wall", "/actuator/top_wall", "/actuator/height/base",
     "/actuator/channel/height", "/material/mu/0", "/actuator/chamber_gap", "/actuator/stem",
     "/actuator/channel/width", "/actuator/bottom_layer", "/actuator/taper/right",
     "/actuator/slit"}};

/* Two chambers that press the tip onto a floor. */
static const struct design resting = {
    "two chambers on a floor",
    {{"/actuator/chambers", "[{\"config\": \"B\", \"count\": 2}]"},
     {"/actuator/length", "\"18 mm\""},
     {"/actuator/channel", NULL},
     {"/material", "{\"model\": \"neo-hooke\", \"mu\": \"0.2 MPa\"}"},
     {"/load", "{\"pressure\": {\"to\": \"25 kPa\", \"steps\": 2}}"},
     {"/planes", "[{\"point\": [0, 0, \"-0.02 mm\"], \"normal\": [0.002, 0, 1]}]"},
     {"/mesh",
      "{\"gap_wall\": 1, \"cavity\": 1, \"half_width\": 1, \"bottom\": 1, \"height\": 1}"}},
    2,
    {NULL}};

/* Reads the design after one more change, unless its pointer is NULL. */
static void read_design(const struct design *design, const char *pointer, const char *value,
                        struct job_spec *spec) {
  const char *edits[EDITS_MAX + 2][2] = {{NULL, NULL}};
  struct error error = {0};
  int count = 0;
  for (; design->edits[count][0]; count++) {
    memcpy(edits[count], design->edits[count], sizeof edits[count]);
  }
  edits[count][0] = pointer;
  edits[count][1] = value;
  enum status status = suite_read_edited((const char *const(*)[2])edits, spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s %s: %s", pointer, error.pointer, error.message);
}

static bool gravity_acts(const struct job_spec *spec) {
  const double *g = spec->load.gravity;
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

/* ---- the derivatives ---- */

/* Follows the load of a design and returns the block of its last state, a new reference. The case
 * stays open. */
static json_t *find_derivatives(const struct design *design, struct pneunet_case *c) {
  struct job_spec spec;
  struct result_sensitivity *r;
  struct error error = {0};
  read_design(design, "/sensitivity", "true", &spec);
  spec.sensitivity.midline = true;
  case_open(c, &spec);
  case_follow(c);
  ck_assert_int_ge(contact_summarise(&c->model->contact).active, design->touching);
  enum status status = result_sensitivity_create(&c->spec, c->model, &r, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  struct path_point point = {.pressure = spec.load.pressure_to,
                             .dead = gravity_acts(&spec),
                             .recorded = true,
                             .state = &c->state};
  ck_assert_int_eq(result_sensitivity_add(r, &point), STATUS_OK);
  json_t *block = result_sensitivity_block(r);
  ck_assert_ptr_nonnull(block);
  result_sensitivity_destroy(r);
  return block;
}

/* The derivative of a key in an entry of the block; NAN when it is not there. */
static double derivative(const json_t *entry, const char *key) {
  const json_t *metrics = json_object_get(entry, "metrics");
  const json_t *last = json_array_get(json_object_get(entry, "samples"), 0);
  const json_t *value = json_object_get(last, key);
  value = value ? value : json_object_get(metrics, key);
  return value ? json_real_value(value) : NAN;
}

/* Some points along the midline, the first not at the base. */
static int midline_point(int which, int count) {
  return (which + 1) * (count - 1) / POINTS;
}

/* The derivative of a coordinate of one of them. */
static double point_derivative(const json_t *entry, int which) {
  const json_t *last = json_array_get(json_object_get(entry, "samples"), 0);
  const json_t *points = json_object_get(last, "midline_mm");
  int point = midline_point(which / 3, (int)json_array_size(points));
  const json_t *value = json_array_get(json_array_get(points, (size_t)point), (size_t)(which % 3));
  return value ? json_real_value(value) : NAN;
}

/* ---- differences ---- */

/* Whether the last solve left tractions away from their multipliers. */
static bool settles_slowly(struct pneunet_case *c) {
  for (int i = 0; i < c->model->contact.point_count; i++) {
    const struct contact_point *point = &c->model->contact.point[i];
    if (point->valid &&
        fabs(point->traction - point->lambda) > 2 * c->solver->options.traction_tolerance) {
      return true;
    }
  }
  return false;
}

/* The changed body under the same pressure, settled from the state of the unchanged one. */
static void solve_anew(const struct job_spec *spec, const struct pneunet_case *from,
                       double out[VALUES]) {
  struct pneunet_case c;
  struct shape shape;
  int iterations;
  case_open(&c, spec);
  ck_assert_int_eq(c.mesh.node_count, from->mesh.node_count);
  state_copy(c.model, &c.state, &from->state);
  c.solver->options.step_tolerance = 1e-12;
  c.solver->options.overlap_tolerance = 0;
  c.solver->options.traction_tolerance = 1e-9 * spec->load.pressure_to;
  struct fe_load load = {spec->load.pressure_to, spec->load.pressure_to, gravity_acts(spec)};
  enum status status;
  int solves = 0;
  do { /* one solve ends after so many updates of the multipliers, settled or not */
    c.solver->factor_fits = false;
    status = equilibrium_solve(c.solver, &load, load.pressure, &c.state, &iterations);
  } while (status == STATUS_OK && settles_slowly(&c) && ++solves < SOLVES_MAX);
  ck_assert_msg(status == STATUS_OK, "%s", status_word(status));
  shape_measure(&c.mesh, c.state.u, &shape);
  double degree = M_PI / 180, whole = c.mesh.half ? 2 : 1;
  double rest = c.mesh.x[3 * c.mesh.centreline[c.mesh.section_count - 1] + 2];
  double all[KEYS] = {shape.bending_angle / degree,
                      shape.chord_angle / degree,
                      shape.end_face_angle / degree,
                      1e3 * (rest - shape.tip[2]),
                      1e3 * shape.tip[0],
                      1e3 * shape.tip[1],
                      1e3 * shape.tip[2],
                      1e9 * whole * model_volume(c.model, &c.state, NULL),
                      1e3 * whole * c.model->reference_volume * spec->material.density_kg_m3};
  memcpy(out, all, sizeof all);
  double *midline = malloc(3 * sizeof *midline * (size_t)c.mesh.section_count);
  ck_assert_ptr_nonnull(midline);
  shape_midline(&c.mesh, c.state.u, midline);
  for (int i = 0; i < 3 * POINTS; i++) {
    int point = midline_point(i / 3, c.mesh.section_count);
    out[KEYS + i] = 1e3 * midline[3 * point + i % 3];
  }
  free(midline);
  case_close(&c);
}

/* Reads the design with the parameter changed to `value`, in its unit. */
static void read_changed(const struct design *design, const json_t *entry, double value,
                         struct job_spec *spec) {
  const char *pointer = json_string_value(json_object_get(entry, "parameter"));
  const char *unit = json_string_value(json_object_get(entry, "unit"));
  char text[60];
  if (strcmp(unit, "1") == 0) {
    snprintf(text, sizeof text, "%.15g", value);
  } else {
    snprintf(text, sizeof text, "\"%.15g %s\"", value, unit);
  }
  read_design(design, pointer, text, spec);
}

static void find_differences(const struct design *design, const struct pneunet_case *c,
                             const json_t *entry, double out[VALUES]) {
  double value = json_real_value(json_object_get(entry, "value")), h = 1e-4 * fabs(value);
  double side[2][VALUES];
  for (int s = 0; s < 2; s++) {
    struct job_spec spec;
    read_changed(design, entry, value + (s ? h : -h), &spec);
    solve_anew(&spec, c, side[s]);
  }
  for (int i = 0; i < VALUES; i++) {
    out[i] = (side[1][i] - side[0][i]) / (2 * h);
  }
}

static bool skipped(const struct design *design, const char *pointer) {
  for (int i = 0; design->skip[i]; i++) {
    if (strcmp(design->skip[i], pointer) == 0) {
      return true;
    }
  }
  return false;
}

/* Compares all metrics of one parameter: relative to the derivative itself, or, where that
 * nearly vanishes, to a thousandth of the metric a parameter's size. Returns the worst. */
static double compare(const struct design *design, const struct pneunet_case *c,
                      const json_t *entry, const double size[VALUES]) {
  double difference[VALUES], worst = 0;
  double value = fabs(json_real_value(json_object_get(entry, "value")));
  find_differences(design, c, entry, difference);
  for (int i = 0; i < VALUES; i++) {
    double found = i < KEYS ? derivative(entry, keys[i]) : point_derivative(entry, i - KEYS);
    ck_assert(i < KEYS || isfinite(found));
    double scale = fmax(fabs(difference[i]), 1e-3 * size[i] / value);
    if (isfinite(found)) {
      worst = fmax(worst, fabs(found - difference[i]) / scale);
    }
  }
  printf("| derivative to %s | %s | %.6g | %.6g | %.1e |\n",
         json_string_value(json_object_get(entry, "parameter")), design->name, difference[0],
         derivative(entry, keys[0]), worst);
  fflush(stdout);
  return worst;
}

static void compare_all(const struct design *design, const struct pneunet_case *c,
                        const json_t *block, double tolerance) {
  double size[VALUES], worst = 0;
  size_t index, compared = 0;
  json_t *entry;
  solve_anew(&c->spec, c, size);
  for (int i = 0; i < VALUES; i++) {
    size[i] = fabs(size[i]);
  }
  json_array_foreach(json_object_get(block, "parameters"), index, entry) {
    if (!skipped(design, json_string_value(json_object_get(entry, "parameter")))) {
      worst = fmax(worst, compare(design, c, entry, size));
      compared++;
    }
  }
  ck_assert_uint_ge(compared, 10);
  ck_assert_msg(worst <= tolerance, "%s: the worst derivative is off by %.2e", design->name, worst);
}

/* ---- tests ---- */

START_TEST(derivatives_without_contact_are_those_of_new_solutions) {
  struct pneunet_case c;
  json_t *block = find_derivatives(&slack, &c);
  compare_all(&slack, &c, block, 1e-4);
  json_decref(block);
  case_close(&c);
}
END_TEST

/* Angles do not change when pressure and moduli grow by one factor, nor when all lengths do: the
 * sum of value times derivative over either group is zero. Prints and returns it relative to its
 * largest term. */
static double balance(const struct design *design, const json_t *block, const char *unit,
                      double pressure_kPa, const char *key) {
  const json_t *entry, *pressure = json_object_get(block, "pressure");
  double sum = pressure_kPa * derivative(pressure, key), largest = fabs(sum);
  size_t index;
  json_array_foreach(json_object_get(block, "parameters"), index, entry) {
    if (strcmp(json_string_value(json_object_get(entry, "unit")), unit) == 0) {
      double term = json_real_value(json_object_get(entry, "value")) * derivative(entry, key);
      sum += term;
      largest = fmax(largest, fabs(term));
    }
  }
  printf("| scaling of all %s | %s | 0 | %.2e | %.1e |\n", unit, design->name, sum,
         fabs(sum) / largest);
  fflush(stdout);
  return fabs(sum) / largest;
}

/* The pressure needs no parameter: its derivative is the slope of the response. */
static void compare_slopes(const struct design *design, const struct pneunet_case *c,
                           const json_t *block) {
  double side[2][VALUES], h = 2e-4 * c->spec.load.pressure_to;
  for (int s = 0; s < 2; s++) {
    struct job_spec spec = c->spec;
    spec.load.pressure_to += s ? h : -h;
    solve_anew(&spec, c, side[s]);
  }
  for (int i = 0; i < KEYS - 1; i++) {
    double slope = (side[1][i] - side[0][i]) / (2e-3 * h);
    double found = derivative(json_object_get(block, "pressure"), keys[i]);
    printf("| d %s / d kPa | %s | %.8g | %.8g | - |\n", keys[i], design->name, slope, found);
    ck_assert_double_eq_tol(found, slope, 5e-5 * fabs(slope) + 1e-7);
  }
}

START_TEST(derivatives_with_contact_are_those_of_new_solutions) {
  struct pneunet_case c;
  json_t *block = find_derivatives(&touching, &c);
  compare_all(&touching, &c, block, 1e-4);
  compare_slopes(&touching, &c, block);
  ck_assert_double_lt(balance(&touching, block, "MPa", 40, "bending_angle_deg"), 1e-6);
  ck_assert_double_lt(balance(&touching, block, "MPa", 40, "end_face_angle_deg"), 1e-6);
  ck_assert_double_lt(balance(&touching, block, "mm", 0, "bending_angle_deg"), 1e-6);
  ck_assert_double_lt(balance(&touching, block, "mm", 0, "chord_angle_deg"), 1e-6);
  json_decref(block);
  case_close(&c);
}
END_TEST

START_TEST(derivatives_on_a_plane_are_those_of_new_solutions) {
  struct pneunet_case c;
  json_t *block = find_derivatives(&resting, &c);
  compare_slopes(&resting, &c, block);
  ck_assert_double_lt(balance(&resting, block, "MPa", 25, "bending_angle_deg"), 1e-4);
  ck_assert_double_lt(balance(&resting, block, "MPa", 25, "cavity_volume_mm3"), 1e-5);
  json_decref(block);
  case_close(&c);
}
END_TEST

/* A body that is symmetric but computed whole, for an unfelt force sideways, has the derivatives
 * of the half model: also to one of the two tapers, which no half model can have. */
START_TEST(half_a_body_gives_the_derivatives_of_the_whole) {
  struct pneunet_case half_case, whole_case;
  struct design half = touching, whole;
  const char *const contact[2] = {"/contact", "false"};
  const char *const sideways[2] = {"/load", "{\"pressure\": {\"to\": \"8 kPa\", \"steps\": 1},"
                                            " \"gravity\": [0, \"1e-9 m/s2\", 0]}"};
  const char *const straight[2] = {"/load", "{\"pressure\": {\"to\": \"8 kPa\", \"steps\": 1}}"};
  int last = 0;
  while (half.edits[last][0]) {
    last++;
  }
  half.touching = 0;
  memcpy(half.edits[last], contact, sizeof contact);
  whole = half;
  memcpy(half.edits[last + 1], straight, sizeof straight);
  memcpy(whole.edits[last + 1], sideways, sizeof sideways);
  json_t *of_half = find_derivatives(&half, &half_case);
  json_t *of_whole = find_derivatives(&whole, &whole_case);
  ck_assert(half_case.mesh.half && !whole_case.mesh.half);
  /* A half model does not move sideways, and the frame of its end face weighs the nodes in the
   * plane of symmetry twice. */
  const bool loose[VALUES] = {[2] = true, [5] = true};
  json_t *entry;
  size_t index;
  json_array_foreach(json_object_get(of_half, "parameters"), index, entry) {
    const json_t *other = json_array_get(json_object_get(of_whole, "parameters"), index);
    for (int k = 0; k < KEYS; k++) {
      double a = derivative(entry, keys[k]), b = derivative(other, keys[k]);
      if (!loose[k]) {
        ck_assert_double_eq_tol(a, b, 1e-5 * fabs(b) + 1e-8);
      }
    }
  }
  json_decref(of_half);
  json_decref(of_whole);
  case_close(&half_case);
  case_close(&whole_case);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("sensitivity");
  TCase *derivatives = tcase_create("derivatives");
  tcase_set_timeout(derivatives, 120);
  tcase_add_test(derivatives, derivatives_without_contact_are_those_of_new_solutions);
  tcase_add_test(derivatives, derivatives_with_contact_are_those_of_new_solutions);
  tcase_add_test(derivatives, derivatives_on_a_plane_are_those_of_new_solutions);
  tcase_add_test(derivatives, half_a_body_gives_the_derivatives_of_the_whole);
  suite_add_tcase(suite, derivatives);
  return suite_run(suite);
}
