/* A study as a table, from rows as the database has them. */
#include "tests/unit/store_case.h"

#include <math.h>

#include "server/study/table.h"
#include "tests/unit/suite.h"

static void sql(const char *text) {
  char path[100];
  sqlite3 *db;
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  ck_assert_int_eq(sqlite3_open(path, &db), SQLITE_OK);
  ck_assert_msg(sqlite3_exec(db, text, NULL, NULL, NULL) == SQLITE_OK, "%s", sqlite3_errmsg(db));
  sqlite3_close(db);
}

/* Study 1 with members 0, 1 and 3: a length and a material; the last has failed. */
static void make_study(void) {
  sql("INSERT INTO job (id, kind, name, document, spec_hash, state, created_ms) VALUES "
      "(1, 'study', 'gaps', '{}', 's', 'queued', 1);"
      "INSERT INTO job (id, kind, name, document, spec_hash, state, reason_code, created_ms, "
      "study_id, member) VALUES "
      "(2, 'response', 'first', '{}', 'a', 'succeeded', '', 1, 1, 0),"
      "(3, 'response', 'second', '{}', 'b', 'succeeded', '', 1, 1, 1),"
      "(9, 'response', 'other', '{}', 'd', 'succeeded', '', 1, NULL, NULL),"
      "(5, 'response', 'third', '{}', 'c', 'failed', 'diverged', 1, 1, 3);"
      "INSERT INTO study (study_id, sampling, members, light) VALUES (1, 'list', 4, 0);"
      "INSERT INTO study_parameter VALUES (1, 0, '/a/gap', 'gap', 'mm', 0, 1, 1.0, 3.0),"
      "(1, 1, '/material', 'material', '', 1, 0, NULL, NULL);"
      "INSERT INTO study_value VALUES (1, 0, 0, 1.0, '1 mm'), (1, 0, 1, NULL, 'soft'),"
      "(1, 1, 0, 2.5, '2.5 mm'), (1, 1, 1, NULL, 'hard'), (1, 3, 1, NULL, 'soft');"
      "INSERT INTO metric VALUES (2, 'bending_angle_deg', 30.0), (2, 'mass_g', 10.0),"
      "(3, 'bending_angle_deg', 20.0), (9, 'else_mm', 1.0)");
}

START_TEST(test_rows_and_columns) {
  struct study_table *table;
  struct error error;
  make_study();
  ck_assert_msg(study_table_read(store, 1, &table, &error) == STATUS_OK, "%s", error.message);
  ck_assert_str_eq(table->name, "gaps");
  ck_assert_str_eq(table->sampling, "list");
  ck_assert_uint_eq(table->members, 3);
  ck_assert_uint_eq(table->wanted, 4);
  ck_assert_int_eq(table->member[2], 3);
  ck_assert_int_eq(table->job_id[2], 5);
  ck_assert_int_eq(table->state[2], JOB_STATE_FAILED);
  ck_assert_str_eq(table->reason[2], "diverged");
  ck_assert_str_eq(table->member_name[1], "second");
  ck_assert_uint_eq(table->parameters, 2);
  ck_assert_str_eq(table->parameter[0].unit, "mm");
  ck_assert(table->parameter[0].logarithmic && !table->parameter[0].categorical);
  ck_assert_double_eq(table->parameter[0].high, 3);
  ck_assert_double_eq(table->value[1 * 2 + 0], 2.5);
  ck_assert(isnan(table->value[2 * 2 + 0]));
  ck_assert_uint_eq(table->parameter[1].word_count, 2);
  ck_assert_str_eq(table->parameter[1].words[1], "hard");
  ck_assert_double_eq(table->value[1 * 2 + 1], 1);
  ck_assert_double_eq(table->value[2 * 2 + 1], 0);
  ck_assert_uint_eq(table->metrics, 2);
  ck_assert_str_eq(table->metric[0].title, "Bending angle");
  ck_assert_str_eq(table->metric[0].unit, "°");
  ck_assert_double_eq(table->metric[0].low, 20);
  ck_assert_double_eq(table->metric[0].high, 30);
  ck_assert_double_eq(table->result[0 * 2 + 1], 10);
  ck_assert(isnan(table->result[1 * 2 + 1]));
  study_table_destroy(table);
}
END_TEST

START_TEST(test_other_jobs) {
  struct study_table *table;
  struct error error;
  make_study();
  sql("INSERT INTO job (id, kind, name, document, spec_hash, created_ms) VALUES "
      "(20, 'study', 'new', '{}', 's', 1)");
  ck_assert_int_eq(study_table_read(store, 2, &table, &error), STATUS_NOT_FOUND);
  ck_assert_int_eq(study_table_read(store, 77, &table, &error), STATUS_NOT_FOUND);
  ck_assert_int_eq(study_table_read(store, 20, &table, &error), STATUS_OK);
  ck_assert_uint_eq(table->members + table->parameters + table->metrics, 0);
  study_table_destroy(table);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("study_table");
  TCase *table = tcase_create("table");
  tcase_add_checked_fixture(table, store_setup, store_teardown);
  tcase_set_timeout(table, 120);
  tcase_add_test(table, test_rows_and_columns);
  tcase_add_test(table, test_other_jobs);
  suite_add_tcase(suite, table);
  return suite_run(suite);
}
