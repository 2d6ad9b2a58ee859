/* From the text of an identify job to its trials and steps, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/embed.h"
#include "solver/job/identify.h"
#include "solver/job/steps.h"
#include "tests/unit/suite.h"

enum { TEXT = 60000, ROWS = 40 };

static const char columns[] =
    "\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
    "\"s\"},\"set_point\":{\"name\":\"u\",\"unit\":\"kPa\"},\"h\":{\"name\":\"h\",\"unit\":\"mm\"}"
    ",\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"}}";
static const char one_mode[] = "\"modes\":[{\"name\":\"free\",\"rest\":\"0 mm\"}]";

/* Rows of a trial: a step up at t = 0 and one down at t = 2 s, 10 Hz. `change` may replace the row
 * `row` by a text. */
static char *add_trial(char *at, int trial, double up, int row, const char *change) {
  for (int i = 0; i < ROWS; i++) {
    bool rising = i < ROWS / 2;
    double t = 0.1 * i, since = rising ? t : t - 2.0, part = exp(-5.0 * since);
    double p = rising ? up * (1.0 - part) : up * part;
    if (i == row) {
      at += sprintf(at, "%s\\n", change);
    } else {
      at += sprintf(at, "%d,%.3f,%.4f,%.5f,%.5f\\n", trial, t, rising ? up : 0.0, 0.5 * p, p);
    }
  }
  return at;
}

/* A job of two trials; members: what stands after the table. */
static enum status read_trials(int row, const char *change, const char *members,
                               struct job_spec *spec, struct error *error) {
  static char table[TEXT], text[TEXT + 4000];
  char *at = table + sprintf(table, "n,t,u,h,p\\n");
  at = add_trial(at, 1, 20.0, row, change);
  add_trial(at, 2, 30.0, -1, NULL);
  snprintf(text, sizeof text, "{\"kind\":\"identify\",\"data\":{\"csv\":\"%s\"},%s}", table,
           members);
  *error = (struct error){.status = STATUS_OK};
  return job_spec_read(text, strlen(text), spec, error);
}

static void must_read(const char *rest, struct job_spec *spec) {
  struct error error;
  char members[3000];
  snprintf(members, sizeof members, "%s,%s%s%s", columns, one_mode, rest ? "," : "",
           rest ? rest : "");
  ck_assert_msg(read_trials(-1, NULL, members, spec, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
}

START_TEST(a_job_arrives_in_si_units) {
  struct job_spec spec;
  must_read(
      "\"mass\":\"60 g\",\"gamma\":\"5.577 N/psi\",\"rest_length\":\"82 mm\",\"transit\":\"50 "
      "ms\",\"noise\":{\"h\":\"0.1 mm\"},\"degree\":{\"damping\":0},\"per\":\"psi\"",
      &spec);
  const struct identify_spec *s = spec.identify;
  ck_assert_int_eq(spec.kind, JOB_IDENTIFY);
  suite_check_near(s->mass, 0.06);
  suite_check_near(s->gamma, 5.577 / 6894.757293168361);
  suite_check_near(s->rest_length, 0.082);
  suite_check_near(s->transit, 0.05);
  suite_check_near(s->noise[0], 1e-4);
  ck_assert_double_eq(s->noise[1], 0.0);
  suite_check_near(s->per, 6894.757293168361);
  ck_assert_int_eq(s->degree[IDENTIFY_STIFFNESS], 1);
  ck_assert_int_eq(s->degree[IDENTIFY_DAMPING], 0);
  ck_assert_int_eq(s->mode_count, 1);
  ck_assert_double_eq(s->mode[0].rest, 0.0);
  ck_assert_ptr_nonnull(spec.document);
  job_spec_release(&spec);
  must_read("\"degree\":\"auto\"", &spec);
  ck_assert(isnan(spec.identify->mass) && isnan(spec.identify->gamma));
  ck_assert_int_eq(spec.identify->degree[IDENTIFY_BETA], IDENTIFY_DEGREE_AUTO);
  suite_check_near(spec.identify->per, 1e3);
  job_spec_release(&spec);
}
END_TEST

START_TEST(trials_are_parted_into_steps) {
  struct job_spec spec;
  struct trials trials;
  struct steps steps;
  struct error error;
  must_read("\"held_out\":[\"2\"]", &spec);
  ck_assert_int_eq(trials_read(spec.document, spec.identify, &trials, &error), STATUS_OK);
  ck_assert_uint_eq(trials.count, 2);
  ck_assert(!trials.trial[0].held_out && trials.trial[1].held_out);
  ck_assert_uint_eq(trials.trial[1].count, ROWS);
  suite_check_near(trials.trial[0].set_point[3], 20e3);
  ck_assert_int_eq(steps_part(spec.identify, &trials, &steps, &error), STATUS_OK);
  ck_assert_uint_eq(steps.count, 4);
  suite_check_near(steps.step[2].set_point, 30e3);
  ck_assert_int_eq(steps.step[2].point, -1); /* only of the trial that is held out */
  ck_assert(steps.step[0].moves && !steps.step[0].settled);
  ck_assert_uint_eq(steps.step[1].first, ROWS / 2);
  /* Down from 20 kPa, and up to it. */
  ck_assert_uint_eq(steps.point_count, 2);
  ck_assert_double_eq(steps.point[0].set_point, 0.0);
  suite_check_near(steps.point[1].set_point, 20e3);
  steps_release(&steps);
  trials_release(&trials);
  job_spec_release(&spec);
}
END_TEST

/* What a fault in the data or the job is refused with. */
static const struct fault {
  int row;            /* of the first trial, or -1 */
  const char *change; /* in its place */
  const char *members;
  const char *at, *phrase;
} faults[] = {
    {3, "1,0.2,20,1,2", NULL, "/data/csv", "line 5 of the table: the time 0.2 s is there twice"},
    {3, "1,0.1,20,1,2", NULL, "/data/csv", "line 5 of the table: the time 0.1 s is not after"},
    {3, "1,0.3,20,nan,2", NULL, "/data/csv", "line 5"},
    {3, "1,0.3,20,lost,2", NULL, "/data/csv", "line 5"},
    {3, "2,0.3,20,1,2", NULL, "/data/csv", "line 2 of the table: the trial that begins here has 3"},
    {20, "2,2,20,1,2", NULL, "/data/csv", "rows"},
    {3, "1,0.3,21,1,2", NULL, "/data/csv", "line 6 of the table: the set-point is not held"},
    {-1, NULL, "\"held_out\":[\"3\"]", "/held_out/0", "no trial \"3\": one of the 2"},
    {-1, NULL, "\"held_out\":[\"1\",\"2\"]", "/held_out", "at least one that is left"},
    {-1, NULL, "\"mass\":\"-60 g\"", "/mass", "at least"},
    {-1, NULL, "\"gamma\":\"5 N\"", "/gamma", "N/kPa"},
    {-1, NULL, "\"per\":\"mm\"", "/per", "no unit of pressure"},
    {-1, NULL, "\"levels\":[\"5 mm\"]", "/levels", "parted by 0 levels"},
    {-1, NULL, "\"tables\":[{\"name\":\"a\",\"data\":{\"csv\":\"\"}}]", "/tables", "one of"},
};

START_TEST(faults_are_refused_with_their_place) {
  const struct fault *fault = &faults[_i];
  struct job_spec spec;
  struct error error;
  char members[3000];
  snprintf(members, sizeof members, "%s,%s%s%s", columns, one_mode, fault->members ? "," : "",
           fault->members ? fault->members : "");
  ck_assert_int_eq(read_trials(fault->row, fault->change, members, &spec, &error), STATUS_INVALID);
  ck_assert_msg(strncmp(error.pointer, fault->at, strlen(fault->at)) == 0, "%s: %s", error.pointer,
                error.message);
  ck_assert_msg(strstr(error.message, fault->phrase) != NULL, "%s", error.message);
  ck_assert_int_gt(error.line, 0);
}
END_TEST

/* Columns and modes that do not go with the data. */
static const struct {
  const char *members, *at, *phrase;
} misuses[] = {
    {"\"columns\":{\"time\":{\"name\":\"t\",\"unit\":\"s\"},\"set_point\":{\"name\":\"u\",\"unit\":"
     "\"kPa\"},\"h\":{\"name\":\"x\",\"unit\":\"mm\"},\"pressure\":{\"name\":\"p\",\"unit\":"
     "\"kPa\"}"
     "},\"modes\":[{\"name\":\"a\"}]",
     "/columns/h/name", "\"x\""},
    {"\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
     "\"s\"},\"set_point\":{\"name\":\"u\",\"unit\":\"psi\"},\"h\":{\"name\":\"h\",\"unit\":\"mm\"}"
     ",\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"}},\"modes\":[{\"name\":\"a\"}]",
     "/columns/pressure/unit", "psi"},
    {"\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
     "\"s\"},\"set_point\":{\"name\":\"u\",\"unit\":\"kPa\"},\"h\":{\"name\":\"h\",\"unit\":\"km\"}"
     ",\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"}},\"modes\":[{\"name\":\"a\"}]",
     "/columns/h/unit", "less than 10 m"},
    {"\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
     "\"h\"},\"set_point\":{\"name\":\"u\",\"unit\":\"kPa\"},\"h\":{\"name\":\"h\",\"unit\":\"mm\"}"
     ",\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"}},\"modes\":[{\"name\":\"a\"}]",
     "/data/csv", "unit of the time"},
    {"\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
     "\"kg\"},\"set_point\":{\"name\":\"u\",\"unit\":\"kPa\"},\"h\":{\"name\":\"h\",\"unit\":\"mm\""
     "},\"pressure\":{\"name\":\"p\",\"unit\":\"kPa\"}},\"modes\":[{\"name\":\"a\"}]",
     "/columns/time/unit", "\"ms\""},
};

START_TEST(columns_that_do_not_fit_are_refused) {
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(read_trials(-1, NULL, misuses[_i].members, &spec, &error), STATUS_INVALID);
  ck_assert_msg(strcmp(error.pointer, misuses[_i].at) == 0, "%s: %s", error.pointer, error.message);
  ck_assert_msg(strstr(error.message, misuses[_i].phrase) != NULL, "%s", error.message);
}
END_TEST

START_TEST(modes_without_a_jump_or_a_step_are_refused) {
  struct job_spec spec;
  struct error error;
  char members[3000];
  snprintf(members, sizeof members, "%s,\"modes\":[{\"name\":\"a\"},{\"name\":\"a\"}]", columns);
  ck_assert_int_eq(read_trials(-1, NULL, members, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/modes/1/name");
  snprintf(members, sizeof members,
           "%s,\"modes\":[{\"name\":\"a\"},{\"name\":\"b\"}],\"levels\":[\"200 mm\"]", columns);
  ck_assert_int_eq(read_trials(-1, NULL, members, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/modes/1");
  ck_assert_ptr_nonnull(strstr(error.message, "no step of its own"));
}
END_TEST

START_TEST(a_trial_without_a_step_is_refused) {
  char text[TEXT], *at = text;
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  at += sprintf(at, "{\"kind\":\"identify\",%s,%s,\"data\":{\"csv\":\"n,t,u,h,p\\n", columns,
                one_mode);
  at = add_trial(at, 1, 20.0, -1, NULL);
  for (int i = 0; i < 20; i++) {
    at += sprintf(at, "2,%d,20,10,20\\n", i);
  }
  snprintf(at, 10, "\"}}");
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/data/csv");
  ck_assert_ptr_nonnull(strstr(error.message, "line 42 of the table: nothing moves"));
}
END_TEST

START_TEST(a_pressure_without_a_course_is_refused) {
  char text[TEXT], *at = text;
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  at += sprintf(at, "{\"kind\":\"identify\",%s,%s,\"data\":{\"csv\":\"n,t,u,h,p\\n", columns,
                one_mode);
  for (int i = 0; i < 20; i++) {
    at += sprintf(at, "1,%d,20,%d,20\\n", i, i);
  }
  snprintf(at, 10, "\"}}");
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/columns/pressure/name");
  ck_assert_ptr_nonnull(strstr(error.message, "20 kPa in all rows"));
}
END_TEST

/* As many as are allowed in ten tables, and one more: nearly all the text that a job may have. */
START_TEST(too_many_trials_are_refused) {
  enum { TABLES = 10, SIZE = 1 << 20 };
  char *text = malloc(SIZE), *at = text;
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  at += sprintf(at, "{\"kind\":\"identify\",%s,%s,\"tables\":[", columns, one_mode);
  for (int table = 0; table <= TABLES; table++) {
    int rows = table < TABLES ? TRIALS_MAX / TABLES * TRIAL_ROWS_MIN : TRIAL_ROWS_MIN;
    at +=
        sprintf(at, "%s{\"name\":\"%d\",\"data\":{\"csv\":\"n,t,u,h,p\\n", table ? "," : "", table);
    for (int row = 0; row < rows; row++) {
      at += sprintf(at, "%d,%d,1,1,1\\n", row / TRIAL_ROWS_MIN, row % TRIAL_ROWS_MIN);
    }
    at += sprintf(at, "\"}}");
  }
  at += sprintf(at, "]}");
  ck_assert_int_lt(at - text, SIZE);
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_TOO_LARGE);
  ck_assert_str_eq(error.pointer, "/tables/10/data/csv");
  ck_assert_msg(strstr(error.message, "at most 10000") != NULL, "%s", error.message);
  free(text);
}
END_TEST

/* Two modes by the jump in the data; rows in transit belong to none. */
START_TEST(jumps_part_the_modes) {
  char text[TEXT], *at = text;
  struct job_spec spec;
  struct trials trials;
  struct steps steps;
  struct error error = {.status = STATUS_OK};
  at += sprintf(at,
                "{\"kind\":\"identify\",%s,\"modes\":[{\"name\":\"low\"},{\"name\":\"high\"}],"
                "\"transit\":\"0.25 s\",\"data\":{\"csv\":\"n,t,u,h,p\\n",
                columns);
  at = add_trial(at, 1, 20.0, -1, NULL);
  for (int i = 0; i < 60; i++) {
    double t = 0.1 * i, p = 40.0 * (1.0 - exp(-2.0 * t));
    at += sprintf(at, "2,%.2f,40,%.4f,%.4f\\n", t, i < 10 ? 0.3 * p : 30.0 + 0.3 * p, p);
  }
  for (int i = 0; i < 60; i++) {
    double p = 40.0 * exp(-2.0 * 0.1 * i);
    at += sprintf(at, "2,%.2f,0,%.4f,%.4f\\n", 6.0 + 0.1 * i, 30.0 + 0.3 * p, p);
  }
  snprintf(at, 10, "\"}}");
  ck_assert_msg(job_spec_read(text, strlen(text), &spec, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(trials_read(spec.document, spec.identify, &trials, &error), STATUS_OK);
  ck_assert_int_eq(steps_part(spec.identify, &trials, &steps, &error), STATUS_OK);
  ck_assert(steps.level[0] > 12.0e-3 && steps.level[0] < 30e-3);
  ck_assert_uint_eq(steps.count, 5);
  ck_assert(steps.step[2].before_switch && steps.step[2].count == 10 && steps.step[2].mode == 0);
  ck_assert(steps.step[3].after_switch && steps.step[3].mode == 1);
  ck_assert_uint_eq(steps.step[3].first, 13); /* 1.0, 1.1 and 1.2 s are in transit */
  ck_assert(steps.step[4].settled && !steps.step[4].after_switch);
  ck_assert_double_eq_tol(steps.step[4].before[0], 42e-3, 1e-5);
  steps_release(&steps);
  trials_release(&trials);
  job_spec_release(&spec);
}
END_TEST

/* Tables by name, each from a file of its own. */
START_TEST(several_tables_are_several_trials) {
  char folder[] = "/tmp/pneulab-identify-XXXXXX", path[100], text[4000], *embedded = NULL;
  static char table[TEXT];
  size_t length = 0;
  struct job_spec spec;
  struct trials trials;
  struct error error = {.status = STATUS_OK};
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/up.csv", folder);
  FILE *file = fopen(path, "w");
  fputs("n,t,u,h,p\n", file);
  add_trial(table, 1, 20.0, -1, NULL);
  for (const char *c = table; *c; c++) { /* the table is written for a JSON string */
    if (c[0] == '\\' && c[1] == 'n') {
      fputc('\n', file);
      c++;
    } else {
      fputc(*c, file);
    }
  }
  fclose(file);
  snprintf(text, sizeof text,
           "{\"kind\":\"identify\",%s,%s,\"tables\":[{\"name\":\"a\",\"data\":{\"file\":\"up.csv\"}"
           "},{\"name\":\"b\",\"data\":{\"file\":\"up.csv\"}}]}",
           columns, one_mode);
  char job[120];
  snprintf(job, sizeof job, "%s/job.json", folder);
  ck_assert_msg(embed_files(text, strlen(text), job, &embedded, &length, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(job_spec_read(embedded, length, &spec, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(trials_read(spec.document, spec.identify, &trials, &error), STATUS_OK);
  ck_assert_uint_eq(trials.count, 2);
  ck_assert_str_eq(trials.trial[1].name, "b/1");
  trials_release(&trials);
  job_spec_release(&spec);
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/tables/0/data/file");
  free(embedded);
  remove(path);
  remove(folder);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: identifications");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_job_arrives_in_si_units);
  tcase_add_test(tcase, trials_are_parted_into_steps);
  tcase_add_loop_test(tcase, faults_are_refused_with_their_place, 0,
                      sizeof faults / sizeof *faults);
  tcase_add_loop_test(tcase, columns_that_do_not_fit_are_refused, 0,
                      sizeof misuses / sizeof *misuses);
  tcase_add_test(tcase, modes_without_a_jump_or_a_step_are_refused);
  tcase_add_test(tcase, a_trial_without_a_step_is_refused);
  tcase_add_test(tcase, a_pressure_without_a_course_is_refused);
  tcase_add_test(tcase, too_many_trials_are_refused);
  tcase_add_test(tcase, jumps_part_the_modes);
  tcase_add_test(tcase, several_tables_are_several_trials);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
