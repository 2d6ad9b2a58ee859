/* From the text of a study to its members. */
#include <stdio.h>
#include <string.h>

#include "solver/job/study.h"
#include "tests/unit/suite.h"

#define BASE                                                                                       \
  "{\"kind\":\"response\",\"actuator\":{\"family\":\"pneunet\",\"length\":\"24 mm\","              \
  "\"width\":\"20 mm\",\"height\":\"14 mm\",\"chambers\":[{\"config\":\"B\",\"count\":2}],"        \
  "\"side_wall\":\"2 mm\",\"top_wall\":\"2 mm\",\"bottom_layer\":\"4 mm\"},"                       \
  "\"material\":\"dragon-skin-20\",\"load\":{\"pressure\":{\"to\":\"10 kPa\",\"steps\":2}},"       \
  "\"timeout\":\"2 min\"}"
#define STUDY(rest) "{\"kind\":\"study\",\"name\":\"s\",\"base\":" BASE "," rest "}"
#define HYBRID                                                                                     \
  "{\"kind\":\"hlpv\",\"model\":{\"mass\":\"60 g\",\"gamma\":\"5.577 "                             \
  "N/psi\",\"modes\":{\"free\":{"                                                                  \
  "\"stiffness\":\"2000 N/m\",\"damping\":\"15 N s/m\",\"alpha\":\"-9 1/s\",\"beta\":\"9 "         \
  "1/s\"}}},"                                                                                      \
  "\"initial\":{\"mode\":\"free\"},\"input\":{\"hold\":[[\"0 s\",\"3 psi\"]]},\"end\":\"1 s\","    \
  "\"sample_rate\":\"120 Hz\",\"timeout\":\"2 min\"}"
#define HYBRIDS(rest) "{\"kind\":\"study\",\"base\":" HYBRID "," rest "}"
#define MASSES(...) "{\"pointer\":\"/model/mass\",\"values\":[" __VA_ARGS__ "]}"
#define GAP                                                                                        \
  "{\"pointer\":\"/actuator/chamber_gap\",\"name\":\"gap\",\"values\":[\"1 mm\",\"2 mm\"]}"
#define SIDES                                                                                      \
  "{\"pointer\":\"/actuator/taper/left\",\"values\":[\"0 deg\",\"2 deg\"]},"                       \
  "{\"pointer\":\"/actuator/taper/right\",\"values\":[\"0 deg\",\"2 deg\"]}"

static struct job_reader *reader;

static void set_up(void) {
  ck_assert_int_eq(job_reader_create(&reader, NULL), STATUS_OK);
}

static void tear_down(void) {
  job_reader_destroy(reader);
}

/* The members of a study that is valid; the caller releases both. */
static void expand(const char *text, struct job_spec *spec, struct study *study) {
  struct error error = {.status = STATUS_OK};
  enum status status = job_reader_read(reader, text, strlen(text), spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  ck_assert_int_eq(spec->kind, JOB_STUDY);
  ck_assert_int_eq(study_expand(reader, spec->document, true, study, &error), STATUS_OK);
}

static const char *gap_of(const struct study_member *member) {
  return json_string_value(
      json_object_get(json_object_get(member->document, "actuator"), "chamber_gap"));
}

START_TEST(a_grid_has_every_combination) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"grid\",\"parameters\":[" GAP "," SIDES "]"), &spec, &study);
  ck_assert_uint_eq(study.count, 8);
  ck_assert_str_eq(study.member[0].name, "gap 1 mm, left 0 deg, right 0 deg");
  ck_assert_str_eq(study.member[6].name, "gap 2 mm, left 2 deg, right 0 deg");
  ck_assert_str_eq(gap_of(&study.member[3]), "1 mm");
  ck_assert_str_eq(gap_of(&study.member[4]), "2 mm");
  ck_assert_str_eq(
      json_string_value(json_object_get(study.member[6].values, "/actuator/taper/left")), "2 deg");
  ck_assert_double_eq_tol(study.member[0].timeout_s, 120, 1e-9);
  ck_assert_double_eq_tol(spec.timeout_s, 7200, 1e-9);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(mirror_images_are_found) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"grid\",\"parameters\":[" SIDES "]"), &spec, &study);
  ck_assert_uint_eq(study.distinct, 3);
  ck_assert_int_eq(study.member[1].mirror_of, -1);
  ck_assert_int_eq(study.member[2].mirror_of, 1);
  ck_assert_int_eq(study.member[3].mirror_of, -1);
  ck_assert_str_eq(study.member[0].hash, study.member[0].mirrored_hash);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(gravity_and_planes_have_mirror_images) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"list\",\"designs\":["
               "{\"set\":{\"/load/gravity/1\":\"9.8 m/s2\"}},"
               "{\"set\":{\"/load/gravity/1\":\"-9.8 m/s2\"}},"
               "{\"set\":{\"/planes\":[{\"point\":[0,\"30 mm\",0],\"normal\":[0,-1,0]}]}},"
               "{\"set\":{\"/planes\":[{\"point\":[0,\"-30 mm\",0],\"normal\":[0,1,0]}]}}]"),
         &spec, &study);
  ck_assert_uint_eq(study.distinct, 2);
  ck_assert_int_eq(study.member[1].mirror_of, 0);
  ck_assert_int_eq(study.member[3].mirror_of, 2);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

/* A part of a job and its mirror image about y = 0. */
static const char *const mirrors[][2] = {
    {"{\"load\":{\"gravity\":[0,\"9.8 m/s2\",1]}}", "{\"load\":{\"gravity\":[0,\"-9.8 m/s2\",1]}}"},
    {"{\"load\":{\"gravity\":[0,\"-9.8 m/s2\",1]}}", "{\"load\":{\"gravity\":[0,\"9.8 m/s2\",1]}}"},
    {"{\"load\":{\"gravity\":[0,\"+1 m/s2\",1]}}", "{\"load\":{\"gravity\":[0,\"-1 m/s2\",1]}}"},
    {"{\"load\":{\"gravity\":[0,\"0 m/s2\",1]}}", "{\"load\":{\"gravity\":[0,\"0 m/s2\",1]}}"},
    {"{\"planes\":[{\"point\":[0,2,0],\"normal\":[0,0.5,1]}]}",
     "{\"planes\":[{\"point\":[0,-2,0],\"normal\":[0,-0.5,1]}]}"},
    {"{\"load\":{\"pressure\":{\"left\":1}}}", "{\"load\":{\"pressure\":{\"right\":1}}}"},
    {"{\"actuator\":{\"taper\":{\"left\":1,\"right\":2}}}",
     "{\"actuator\":{\"taper\":{\"left\":2,\"right\":1}}}"},
    {"{\"actuator\":{\"taper\":{\"right\":2}}}", "{\"actuator\":{\"taper\":{\"left\":2}}}"},
    {"{\"sensitivity\":false,\"load\":{}}", "{\"sensitivity\":false,\"load\":{}}"},
};

START_TEST(what_lies_across_changes_sides) {
  json_t *document = json_loads(mirrors[_i][0], 0, NULL);
  json_t *wanted = json_loads(mirrors[_i][1], 0, NULL);
  json_t *mirrored = job_mirror(document);
  ck_assert_msg(mirrored && json_equal(mirrored, wanted), "%s", mirrors[_i][0]);
  json_decref(mirrored);
  json_decref(wanted);
  json_decref(document);
}
END_TEST

START_TEST(derivatives_have_no_mirror_image) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"set\":{\"/sensitivity\":true},\"sampling\":\"grid\",\"parameters\":[" SIDES "]"),
         &spec, &study);
  ck_assert_uint_eq(study.distinct, 4);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(one_at_a_time_keeps_the_rest) {
  struct job_spec spec;
  struct study study;
  expand(
      STUDY("\"set\":{\"/accuracy\":\"fast\"},\"sampling\":\"one-at-a-time\",\"parameters\":[" GAP
            ",{\"pointer\":\"/mesh/gap_wall\",\"values\":[1,2,3]}]"),
      &spec, &study);
  ck_assert_uint_eq(study.count, 5);
  ck_assert_uint_eq(study.distinct, 5);
  ck_assert_str_eq(study.member[3].name, "gap_wall 2");
  ck_assert_str_eq(gap_of(&study.member[3]), "2 mm");
  ck_assert_str_eq(json_string_value(json_object_get(study.member[3].document, "accuracy")),
                   "fast");
  ck_assert_uint_eq(json_object_size(study.member[3].values), 1);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(designs_are_listed) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"list\",\"designs\":[{\"name\":\"as it is\",\"set\":{}},"
               "{\"labels\":{\"set\":\"1\"},\"set\":{\"/actuator/length\":null,"
               "\"/actuator/chamber_length\":\"11 mm\"}},{\"set\":{}}]"),
         &spec, &study);
  ck_assert_uint_eq(study.distinct, 2);
  ck_assert_str_eq(study.member[0].name, "as it is");
  ck_assert_str_eq(json_string_value(json_object_get(study.member[0].document, "name")),
                   "as it is");
  ck_assert_str_eq(study.member[1].name, "length null, chamber_length 11 mm");
  ck_assert_str_eq(json_string_value(json_object_get(study.member[1].labels, "set")), "1");
  ck_assert_str_eq(study.member[2].name, "design 3");
  ck_assert_int_eq(study.member[2].same_as, 0);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(members_hash_like_the_jobs_they_are) {
  struct job_spec spec, alone;
  struct study study;
  expand(STUDY("\"sampling\":\"list\",\"designs\":[{\"set\":{}}]"), &spec, &study);
  ck_assert_int_eq(job_reader_read(reader, BASE, strlen(BASE), &alone, NULL), STATUS_OK);
  ck_assert_str_eq(study.member[0].hash, alone.hash);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(rankings_are_read) {
  struct job_spec spec;
  struct study study;
  expand(STUDY("\"sampling\":\"list\",\"designs\":[{\"set\":{}}],\"ranking\":{\"stations\":"
               "[\"8 mm\",\"2.4 cm\"],\"weights\":{\"bending\":1,\"slope\":0,\"deflection\":0}}"),
         &spec, &study);
  ck_assert(study.ranking.asked && !study.ranking.by_station);
  ck_assert_int_eq(study.ranking.station_count, 2);
  ck_assert_double_eq_tol(study.ranking.station[1], 0.024, 1e-12);
  ck_assert_double_eq_tol(study.ranking.bending, 1, 1e-15);
  ck_assert_double_eq_tol(study.ranking.mean_weight, 0.5, 1e-15);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

/* A grid of a by b hybrid models; the last value of the first parameter repeats the first. */
static void write_grid(char *text, size_t size, int a, int b, const char *options) {
  size_t used = (size_t)snprintf(text, size,
                                 "{\"kind\":\"study\",\"base\":" HYBRID
                                 ",\"sampling\":\"grid\"%s,\"parameters\":["
                                 "{\"pointer\":\"/model/mass\",\"values\":[",
                                 options);
  for (int i = 0; i < a; i++) {
    used += (size_t)snprintf(text + used, size - used, "%s\"%d g\"", i ? "," : "",
                             40 + (i + 1 == a ? 0 : i));
  }
  used += (size_t)snprintf(text + used, size - used,
                           "]},{\"pointer\":\"/model/modes/free/damping\",\"values\":[");
  for (int i = 0; i < b; i++) {
    used += (size_t)snprintf(text + used, size - used, "%s\"%d N s/m\"", i ? "," : "", 1 + i);
  }
  snprintf(text + used, size - used, "]}]}");
}

START_TEST(hybrid_models_may_be_many) {
  static char text[20000];
  struct job_spec spec, member;
  struct study study;
  write_grid(text, sizeof text, 31, 40, "");
  ck_assert_int_eq(job_reader_read(reader, text, strlen(text), &spec, NULL), STATUS_OK);
  ck_assert_int_eq(study_expand(reader, spec.document, false, &study, NULL), STATUS_OK);
  ck_assert(study.light && !study.keep_samples);
  ck_assert_uint_eq(study.count, 1240);
  ck_assert_uint_eq(study.distinct, 1200);
  ck_assert_int_eq(study.member[1239].same_as, 39);
  ck_assert_int_eq(study.member[1199].same_as, -1);
  ck_assert_str_eq(study.member[41].name, "mass 41 g, damping 2 N s/m");
  ck_assert_ptr_null(study.member[41].document);
  ck_assert_int_eq(study_read_member(reader, spec.document, 41, NULL, &member, NULL), STATUS_OK);
  ck_assert_str_eq(member.hash, study.member[41].hash);
  ck_assert_int_eq(member.kind, JOB_HLPV);
  job_spec_release(&member);
  study_release(&study);
  job_spec_release(&spec);
}
END_TEST

START_TEST(too_many_hybrid_models_are_refused) {
  static char text[20000];
  struct job_spec spec;
  struct error error;
  write_grid(text, sizeof text, 101, 100, "");
  ck_assert_int_eq(job_reader_read(reader, text, strlen(text), &spec, &error), STATUS_TOO_LARGE);
  ck_assert_str_eq(error.pointer, "/parameters");
  ck_assert_msg(strstr(error.message, "10000") != NULL, "%s", error.message);
  write_grid(text, sizeof text, 30, 30, ",\"keep\":\"samples\"");
  ck_assert_int_eq(job_reader_read(reader, text, strlen(text), &spec, &error), STATUS_TOO_LARGE);
  ck_assert_str_eq(error.pointer, "/keep");
  /* 121 samples each: 826 members have 99946. */
  ck_assert_msg(strstr(error.message, "first 827 members have 100067 samples") != NULL, "%s",
                error.message);
}
END_TEST

/* Members of a kind that takes a process each: 10001 samples times ten are too many, too. */
START_TEST(samples_of_motions_are_limited) {
  static const char job[] =
      "{\"kind\":\"study\",\"base\":{\"kind\":\"bistable\",\"laws\":{\"a\":{\"per\":\"mm\","
      "\"coefficients\":[\"0 N\",\"5 N\"],\"area\":\"8 cm2\"}},\"actuators\":[{\"cells\":[{"
      "\"law\":\"a\",\"mass\":\"10 g\"}]}],\"plate\":{\"mass\":\"30 g\"},\"input\":{\"hold\":[["
      "\"0 s\",\"10 kPa\"]]},\"end\":\"10 s\",\"sample_rate\":\"1 kHz\"},\"sampling\":\"grid\","
      "\"keep\":\"%s\",\"parameters\":[{\"pointer\":\"/plate/mass\",\"values\":[\"1 g\",\"2 g\","
      "\"3 g\",\"4 g\",\"5 g\",\"6 g\",\"7 g\",\"8 g\",\"9 g\",\"10 g\"]}]}";
  char text[2000];
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  snprintf(text, sizeof text, job, "samples");
  ck_assert_int_eq(job_reader_read(reader, text, strlen(text), &spec, &error), STATUS_TOO_LARGE);
  ck_assert_str_eq(error.pointer, "/keep");
  ck_assert_msg(strstr(error.message, "100010 samples") != NULL, "%s", error.message);
  snprintf(text, sizeof text, job, "metrics");
  ck_assert_msg(job_reader_read(reader, text, strlen(text), &spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  job_spec_release(&spec);
}
END_TEST

#define LIST(set)                                                                                  \
  STUDY("\"sampling\":\"list\",\"designs\":[{\"set\":{}},{\"name\":\"B\",\"set\":" set "}]")
/* 70 characters of two bytes */
#define A10 "\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4\xC3\xA4"
#define A70 A10 A10 A10 A10 A10 A10 A10
#define MANY(p) "{\"pointer\":\"/mesh/" p "\",\"values\":[1,2,3,4,5,6,7,8,9,10,11]}"

static const struct {
  const char *text;
  enum status status;
  const char *pointer, *message;
} bad[] = {
    {"{\"kind\":\"study\",\"sampling\":\"list\"}", STATUS_INVALID, "", "\"base\" is missing"},
    {STUDY("\"sampling\":\"sobel\""), STATUS_INVALID, "/sampling", "one-at-a-time"},
    {STUDY("\"sampling\":\"list\""), STATUS_INVALID, "", "\"designs\" is missing"},
    {STUDY("\"sampling\":\"grid\""), STATUS_INVALID, "", "\"parameters\" is missing"},
    {STUDY("\"sampling\":\"grid\",\"parameters\":[" GAP "],\"designs\":[{\"set\":{}}]"),
     STATUS_INVALID, "/designs", "no use"},
    {STUDY("\"sampling\":\"grid\",\"parameters\":[" MANY("top") "," MANY("gap") "," MANY(
         "side_wall") "]"),
     STATUS_TOO_LARGE, "/parameters", "1000"},
    {LIST("{\"/actuator/taper/top\":2}"), STATUS_INVALID, "/designs/1/set/~1actuator~1taper~1top",
     "for example \"2 deg\""},
    {LIST("{\"/actuator/hight\":\"2 mm\"}"), STATUS_INVALID, "/designs/1/set/~1actuator~1hight",
     "did you mean \"height\""},
    {LIST("{\"/actuator/length\":\"9 mm\"}"), STATUS_GEOMETRY, "/designs/1/set/~1actuator~1length",
     "member \"B\", /actuator/length: walls and gaps"},
    {LIST("{\"/actuator/chamber_gap\":\"40 mm\"}"), STATUS_GEOMETRY, "/designs/1",
     "member \"B\", /actuator/length: walls and gaps"},
    {LIST("{\"actuator\":1}"), STATUS_INVALID, "/designs/1/set/actuator", "no JSON pointer"},
    {LIST("{\"/actuator~2\":1}"), STATUS_INVALID, "/designs/1/set/~1actuator~02", "~"},
    {LIST("{\"/actuator/length/x\":1}"), STATUS_INVALID, "/designs/1/set/~1actuator~1length~1x",
     "leads nowhere"},
    {LIST("{\"/actuator/chambers/1/count\":1}"), STATUS_INVALID,
     "/designs/1/set/~1actuator~1chambers~11~1count", "leads nowhere"},
    {LIST("{\"/load/gravity/x\":0}"), STATUS_INVALID, "/designs/1/set/~1load~1gravity~1x",
     "one of the 3 items"},
    {LIST("{\"/load/gravity/\":0}"), STATUS_INVALID, "/designs/1/set/~1load~1gravity~1",
     "one of the 3 items"},
    {LIST("{\"/load/gravity/1234567\":0}"), STATUS_INVALID,
     "/designs/1/set/~1load~1gravity~11234567", "one of the 3 items"},
    {LIST("{\"/load/gravity/2\":null}"), STATUS_INVALID, "/designs/1/set/~1load~1gravity~12",
     "too short"},
    {LIST("{\"/load/gravity/1\":\"1 m\"}"), STATUS_INVALID, "/designs/1/set/~1load~1gravity~11",
     "acceleration"},
    {LIST("{\"/actuator/~0~1\":1}"), STATUS_INVALID, "/designs/1/set/~1actuator~1~00~01",
     "is not known here"},
    {LIST("{\"/actuator/~\":1}"), STATUS_INVALID, "/designs/1/set/~1actuator~1~0",
     "a ~ is written ~0"},
    {LIST("{\"/" A70 "\":1}"), STATUS_INVALID, "/designs/1/set/~1" A70, "that a job can have"},
    {LIST("{\"/load/gravity/3\":0}"), STATUS_INVALID, "/designs/1/set/~1load~1gravity~13",
     "one of the 3 items"},
    {LIST("{\"/kind\":\"study\"}"), STATUS_INVALID, "/designs/1/set/~1kind",
     "the kind of its base"},
    {LIST("{\"/material\":null}"), STATUS_INVALID, "/designs/1", "\"material\" is missing"},
    {STUDY("\"set\":{\"/contact\":1},\"sampling\":\"list\",\"designs\":[{\"set\":{}}]"),
     STATUS_INVALID, "/set/~1contact", "true or false"},
    {STUDY("\"sampling\":\"one-at-a-time\",\"parameters\":[" GAP
           ",{\"pointer\":\"/actuator/length\",\"values\":[\"30 mm\",30]}]"),
     STATUS_INVALID, "/parameters/1/values/1", "30 mm"},
    {STUDY("\"sampling\":\"list\",\"designs\":[{\"set\":{}}],\"ranking\":{\"stations\":[\"8 mm\"],"
           "\"weights\":{\"bending\":0.5}}"),
     STATUS_INVALID, "/ranking/weights", "1.1"},
    {STUDY("\"sampling\":\"list\",\"designs\":[{\"set\":{}}],\"ranking\":{\"stations\":[\"8 mm\","
           "\"30 mm\"]}"),
     STATUS_INVALID, "/ranking/stations/1", "at most its length, 24 mm"},
    {HYBRIDS("\"sampling\":\"grid\",\"parameters\":[" MASSES("\"1 g\",\"-1 g\"") "]"),
     STATUS_INVALID, "/parameters/0/values/1", "member \"mass -1 g\", /model/mass: "},
    {HYBRIDS("\"sampling\":\"grid\",\"parameters\":[" MASSES(
         "\"1 g\"") "],\"ranking\":{\"stations\":[\"8 mm\"]}"),
     STATUS_INVALID, "/ranking", "of the kind \"hlpv\""},
    {HYBRIDS("\"sampling\":\"list\",\"designs\":[{\"set\":{\"/kind\":\"response\"}}]"),
     STATUS_INVALID, "/designs/0/set/~1kind", "the kind of its base"},
    {HYBRIDS("\"sampling\":\"list\",\"keep\":\"all\",\"designs\":[{\"set\":{}}]"), STATUS_INVALID,
     "/keep", "\"metrics\" or \"samples\""},
};

START_TEST(bad_studies_are_refused) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  const char *text = bad[_i].text;
  ck_assert_int_eq(job_reader_read(reader, text, strlen(text), &spec, &error), bad[_i].status);
  ck_assert_str_eq(error.pointer, bad[_i].pointer);
  ck_assert_msg(strstr(error.message, bad[_i].message) != NULL, "%s", error.message);
  ck_assert_int_ge(error.line, 1);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: studies");
  TCase *tcase = tcase_create("all");
  tcase_add_checked_fixture(tcase, set_up, tear_down);
  tcase_add_test(tcase, a_grid_has_every_combination);
  tcase_add_test(tcase, mirror_images_are_found);
  tcase_add_test(tcase, gravity_and_planes_have_mirror_images);
  tcase_add_loop_test(tcase, what_lies_across_changes_sides, 0, sizeof mirrors / sizeof *mirrors);
  tcase_add_test(tcase, derivatives_have_no_mirror_image);
  tcase_add_test(tcase, one_at_a_time_keeps_the_rest);
  tcase_add_test(tcase, designs_are_listed);
  tcase_add_test(tcase, members_hash_like_the_jobs_they_are);
  tcase_add_test(tcase, rankings_are_read);
  tcase_add_test(tcase, hybrid_models_may_be_many);
  tcase_add_test(tcase, too_many_hybrid_models_are_refused);
  tcase_add_test(tcase, samples_of_motions_are_limited);
  tcase_add_loop_test(tcase, bad_studies_are_refused, 0, sizeof bad / sizeof *bad);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
