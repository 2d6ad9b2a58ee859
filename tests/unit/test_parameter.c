/* The numbers of a job that derivatives can be taken to: which there are, what follows from a
 * change, and the key that asks for derivatives. */
#include <math.h>
#include <string.h>

#include "solver/job/parameter.h"
#include "tests/unit/suite.h"

/* The parameter of this name, or NULL. */
static const struct job_parameter *named(const struct job_parameter *list, int count,
                                         const char *pointer) {
  for (int i = 0; i < count; i++) {
    if (strcmp(list[i].pointer, pointer) == 0) {
      return &list[i];
    }
  }
  return NULL;
}

static void set(struct job_spec *spec, const char *pointer, double value) {
  struct job_parameter list[PARAMETERS_MAX];
  const struct job_parameter *parameter = named(list, parameter_list(spec, list), pointer);
  ck_assert_msg(parameter != NULL, "%s is no parameter", pointer);
  ck_assert_int_eq(parameter_set(spec, parameter, value, NULL), STATUS_OK);
  suite_check_near(parameter_value(spec, parameter), value);
}

START_TEST(what_the_job_gives_is_listed_in_its_units) {
  static const struct {
    const char *pointer, *unit;
    double value;
  } wanted[] = {
      {"/actuator/length", "mm", 118},        {"/actuator/width", "mm", 30},
      {"/actuator/height", "mm", 15.6},       {"/actuator/chamber_gap", "mm", 2},
      {"/actuator/side_wall", "mm", 2},       {"/actuator/top_wall", "mm", 1.5},
      {"/actuator/bottom_layer", "mm", 6},    {"/actuator/slit", "mm", 1},
      {"/actuator/channel/width", "mm", 4},   {"/actuator/channel/height", "mm", 2},
      {"/actuator/channel/cover", "mm", 1.5}, {"/actuator/taper/left", "deg", 2},
      {"/material/C/0", "MPa", 0.25},         {"/material/C/1", "MPa", -0.05},
      {"/material/C/2", "MPa", 0.005},        {"/material/density", "kg/m3", 1080},
      {"/material/bulk_ratio", "1", 1000},
  };
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  suite_must_read(NULL, NULL, &spec);
  int count = parameter_list(&spec, list);
  for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
    const struct job_parameter *p = named(list, count, wanted[i].pointer);
    ck_assert_msg(p != NULL, "%s is missing", wanted[i].pointer);
    ck_assert_str_eq(p->unit, wanted[i].unit);
    suite_check_near(parameter_value(&spec, p) / p->unit_si, wanted[i].value);
  }
  /* The walls across follow side_wall, the floor top_wall: the job does not give them. */
  ck_assert_ptr_null(named(list, count, "/actuator/gap_wall"));
  ck_assert_ptr_null(named(list, count, "/actuator/slit_floor"));
  ck_assert_ptr_null(named(list, count, "/actuator/chamber_length"));
}
END_TEST

START_TEST(dimensions_without_effect_are_no_parameters) {
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  suite_must_read("/actuator/chambers", "[{\"config\": \"A\", \"count\": 3}]", &spec);
  int count = parameter_list(&spec, list);
  ck_assert_ptr_null(named(list, count, "/actuator/slit"));
  ck_assert_ptr_null(named(list, count, "/actuator/chamber_gap"));
  suite_must_read("/actuator/height", "{\"base\": \"16 mm\", \"tip\": \"15 mm\"}", &spec);
  count = parameter_list(&spec, list);
  ck_assert_ptr_nonnull(named(list, count, "/actuator/height/tip"));
  ck_assert_ptr_nonnull(named(list, count, "/actuator/taper/left"));
  ck_assert_ptr_null(named(list, count, "/actuator/taper/top"));
}
END_TEST

START_TEST(each_law_has_its_coefficients) {
  static const struct {
    const char *material, *first, *last;
  } laws[] = {
      {"{\"model\": \"neo-hooke\", \"mu\": \"0.4 MPa\"}", "/material/mu", "/material/mu"},
      {"{\"model\": \"mooney-rivlin\", \"C10\": \"0.1 MPa\", \"C01\": \"0.02 MPa\"}",
       "/material/C10", "/material/C01"},
      {"{\"model\": \"ogden\", \"mu\": [\"0.6 MPa\", \"-0.01 MPa\"], \"alpha\": [1.3, -2]}",
       "/material/mu/1", "/material/alpha/1"},
      {"\"dragon-skin-20\"", "/material/C/0", "/material/C/1"},
  };
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  suite_must_read("/material", laws[_i].material, &spec);
  int count = parameter_list(&spec, list);
  ck_assert_ptr_nonnull(named(list, count, laws[_i].first));
  ck_assert_ptr_nonnull(named(list, count, laws[_i].last));
  set(&spec, laws[_i].last, 0.03);
}
END_TEST

START_TEST(what_depends_on_a_parameter_follows_it) {
  struct job_spec spec;
  suite_must_read(NULL, NULL, &spec);
  set(&spec, "/actuator/side_wall", 0.0021);
  suite_check_near(spec.pneunet.gap_wall, 0.0021);
  suite_check_near(spec.pneunet.stem, 0.0041);
  suite_check_near(spec.pneunet.length, 0.118);
  suite_check_near(spec.pneunet.cavity_length, 0.004 - 2e-4);
  set(&spec, "/actuator/taper/left", 0.03);
  ck_assert(!spec.half_model);
  static const char *const edits[][2] = {
      {"/actuator/length", NULL}, {"/actuator/chamber_length", "\"8 mm\""}, {NULL, NULL}};
  suite_must_read_edited(edits, &spec);
  set(&spec, "/actuator/chamber_gap", 0.003);
  suite_check_near(spec.pneunet.cavity_length, 0.004);
  suite_check_near(spec.pneunet.length, 0.118 + 11 * 0.001);
}
END_TEST

START_TEST(of_two_lengths_the_chamber_counts) {
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  suite_must_read("/actuator/chamber_length", "\"8 mm\"", &spec);
  int count = parameter_list(&spec, list);
  ck_assert_ptr_null(named(list, count, "/actuator/length"));
  set(&spec, "/actuator/chamber_length", 0.009);
  suite_check_near(spec.pneunet.length, 0.118 + 12 * 0.001);
}
END_TEST

START_TEST(an_impossible_value_is_refused) {
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  struct error error;
  suite_must_read(NULL, NULL, &spec);
  const struct job_parameter *wall =
      named(list, parameter_list(&spec, list), "/actuator/side_wall");
  ck_assert_int_eq(parameter_set(&spec, wall, 0.01, &error), STATUS_GEOMETRY);
}
END_TEST

START_TEST(the_key_chooses_parameters) {
  struct job_spec spec;
  struct job_parameter list[PARAMETERS_MAX];
  suite_must_read(NULL, NULL, &spec);
  ck_assert_int_eq(spec.sensitivity.count, 0);
  suite_must_read("/sensitivity", "false", &spec);
  ck_assert_int_eq(spec.sensitivity.count, 0);
  suite_must_read("/sensitivity", "true", &spec);
  ck_assert_int_eq(spec.sensitivity.count, parameter_list(&spec, list));
  suite_must_read("/sensitivity", "{\"parameters\": [\"/material/C/1\", \"/actuator/width\"]}",
                  &spec);
  ck_assert_int_eq(spec.sensitivity.count, 2);
  ck_assert_str_eq(spec.sensitivity.parameter[0].pointer, "/material/C/1");
  suite_check_near(parameter_value(&spec, &spec.sensitivity.parameter[1]), 0.03);
}
END_TEST

static const struct refusal refusals[] = {
    {"/sensitivity", "{\"parameters\": [\"/actuator/width\", \"/actuator/widht\"]}", STATUS_INVALID,
     "/sensitivity/parameters/1", "did you mean \"/actuator/width\"?"},
    {"/sensitivity", "{\"parameters\": [\"/actuator/gap_wall\"]}", STATUS_INVALID,
     "/sensitivity/parameters/0", "names no dimension or coefficient that this job gives"},
    {"/sensitivity", "{\"parameters\": [\"/load/pressure/to\"]}", STATUS_INVALID,
     "/sensitivity/parameters/0", "one of /actuator/length, /actuator/width"},
    {"/sensitivity", "{\"parameters\": [\"/material/C/3\"]}", STATUS_INVALID,
     "/sensitivity/parameters/0", "\"/material/C/3\""},
    {"/sensitivity", "{\"parameters\": [\"/material/C/0\", \"/material/C/0\"]}", STATUS_INVALID,
     "/sensitivity/parameters/1", "twice"},
    {"/sensitivity", "{\"parameters\": []}", STATUS_INVALID, "/sensitivity/parameters", "1"},
    {"/sensitivity", "{\"parameters\": [3]}", STATUS_INVALID, "/sensitivity/parameters/0",
     "string"},
    {"/sensitivity", "{\"parameter\": []}", STATUS_INVALID, "/sensitivity/parameter", "parameters"},
    {"/sensitivity", "[\"/material/C/0\"]", STATUS_INVALID, "/sensitivity",
     "true or false or an object"},
};
enum { REFUSALS = sizeof refusals / sizeof *refusals };

START_TEST(other_forms_of_the_key_are_refused) {
  suite_check_refusal(&refusals[_i]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: parameters");
  TCase *parameters = tcase_create("parameters");
  tcase_add_test(parameters, what_the_job_gives_is_listed_in_its_units);
  tcase_add_test(parameters, dimensions_without_effect_are_no_parameters);
  tcase_add_loop_test(parameters, each_law_has_its_coefficients, 0, 4);
  tcase_add_test(parameters, what_depends_on_a_parameter_follows_it);
  tcase_add_test(parameters, of_two_lengths_the_chamber_counts);
  tcase_add_test(parameters, an_impossible_value_is_refused);
  tcase_add_test(parameters, the_key_chooses_parameters);
  tcase_add_loop_test(parameters, other_forms_of_the_key_are_refused, 0, REFUSALS);
  suite_add_tcase(suite, parameters);
  return suite_run(suite);
}
