/* Lists of jobs: every filter with every order, page by page, against a plain query; and no query
 * that looks through a table. */
#include "tests/unit/store_case.h"
#include "tests/unit/suite.h"

enum { JOBS = 240 };

/* Jobs of three kinds in all states, with few names and times, so that many are equal. */
static void fill(void) {
  char sql[900];
  for (int i = 0; i < JOBS; i++) {
    int state = (i * 7 + i / 11) % JOB_STATE_COUNT;
    bool terminal = job_state_terminal((enum job_state)state);
    snprintf(
        sql, sizeof sql,
        "INSERT INTO job (state, kind, name, document, spec_hash, created_ms, finished_ms, "
        "study_id, member) VALUES ('%s', '%s', 'name %d', '{}', 'h', %d, nullif(%d, 0), "
        "nullif(%d, 0), iif(%d, %d, NULL));"
        "INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name) SELECT "
        "id, l.column1, l.column2, kind, state, finished_ms, name FROM job, (VALUES "
        "('half', '%d'), ('tenth', '%d'), ('all', 'x')) AS l WHERE id = last_insert_rowid()",
        job_state_word((enum job_state)state),
        (const char *[]){"response", "snap", "hlpv"}[i % 5 % 3], i * 5 % 9, i,
        terminal ? 1000 + i * 13 % 17 : 0, 1000 * (i * 7 % 23 % 3), i * 7 % 23 % 3, i, i % 2,
        i % 10);
    ck_assert(sql_allowed(sql));
  }
}

/* The ids that a plain query finds, separated by spaces. */
static char *plain_ids(const struct list_query *query) {
  static const char *const keys[] = {[LIST_BY_ID] = "id",
                                     [LIST_BY_CREATED] = "created_ms",
                                     [LIST_BY_FINISHED] = "coalesce(finished_ms, 0)",
                                     [LIST_BY_NAME] = "name",
                                     [LIST_BY_STATE] = "state"};
  char path[100], sql[2000], states[200] = "''", *text = NULL;
  size_t size, used = 0;
  sqlite3 *db;
  sqlite3_stmt *statement;
  bool any = true;
  for (int i = 0; i < JOB_STATE_COUNT; i++) {
    if (query->states[i]) {
      strcat(strcat(strcat(states, ", '"), job_state_word((enum job_state)i)), "'");
      any = false;
    }
  }
  used = (size_t)snprintf(sql, sizeof sql, "SELECT id FROM job WHERE (%d OR state IN (%s))", any,
                          states);
  if (query->kind) {
    used += (size_t)snprintf(sql + used, sizeof sql - used, " AND kind = '%s'", query->kind);
  }
  if (query->study != LIST_STUDY_ANY) {
    used += (size_t)snprintf(sql + used, sizeof sql - used, " AND study_id IS nullif(%d, -1)",
                             (int)query->study);
  }
  for (size_t i = 0; i < query->label_count; i++) {
    used += (size_t)snprintf(sql + used, sizeof sql - used,
                             " AND EXISTS (SELECT 1 FROM job_label WHERE job_id = job.id AND "
                             "job_label.name = '%s' AND value = '%s')",
                             query->labels[i].name, query->labels[i].value);
  }
  snprintf(sql + used, sizeof sql - used, " ORDER BY %s %s, id %s", keys[query->sort],
           query->descending ? "DESC" : "ASC", query->descending ? "DESC" : "ASC");
  FILE *out = open_memstream(&text, &size);
  snprintf(path, sizeof path, "%s/pneulab.db", directory);
  ck_assert_int_eq(sqlite3_open(path, &db), SQLITE_OK);
  ck_assert_msg(sqlite3_prepare_v2(db, sql, -1, &statement, NULL) == SQLITE_OK, "%s", sql);
  while (sqlite3_step(statement) == SQLITE_ROW) {
    fprintf(out, "%d ", sqlite3_column_int(statement, 0));
  }
  sqlite3_finalize(statement);
  sqlite3_close(db);
  fclose(out);
  return text;
}

/* The ids of all pages. */
static char *paged_ids(struct list_query query) {
  char *text = NULL, *next = NULL, *cursor = NULL;
  size_t size, count;
  struct job_record *records;
  struct error error;
  FILE *out = open_memstream(&text, &size);
  do {
    query.cursor = cursor;
    ck_assert_msg(store_list(store, &query, &records, &count, &next, &error) == STATUS_OK, "%s",
                  error.message);
    ck_assert_uint_le(count, (size_t)query.limit);
    for (size_t i = 0; i < count; i++) {
      fprintf(out, "%d ", (int)records[i].id);
      job_record_clear(&records[i]);
    }
    free(records);
    free(cursor);
    cursor = next;
  } while (next);
  fclose(out);
  return text;
}

static void compare(struct list_query query) {
  for (int sort = LIST_BY_ID; sort <= LIST_BY_STATE; sort++) {
    for (int descending = 0; descending < 2; descending++) {
      query.sort = (unsigned)sort;
      query.descending = descending;
      char *expected = plain_ids(&query), *found = paged_ids(query);
      ck_assert_msg(strcmp(expected, found) == 0, "sort %d %d:\n%s\n%s", sort, descending, expected,
                    found);
      free(expected);
      free(found);
    }
  }
}

START_TEST(pages_agree_with_a_plain_query) {
  static const char *const kinds[] = {NULL, "snap", "none"};
  fill();
  for (int k = 0; k < 3; k++) {
    for (int s = 0; s < 3; s++) {
      for (size_t labels = 0; labels < 4; labels++) {
        struct list_query query = {.kind = kinds[k], .limit = 7 + 20 * s, .label_count = labels};
        query.study = (int64_t[]){LIST_STUDY_ANY, LIST_STUDY_NONE, 2000}[(k + s + (int)labels) % 3];
        query.states[JOB_STATE_SUCCEEDED] = s > 0;
        query.states[JOB_STATE_QUEUED] = query.states[JOB_STATE_FAILED] = s > 1;
        query.labels[0].name = "half", query.labels[0].value = "1";
        query.labels[1].name = "tenth", query.labels[1].value = labels == 3 ? "3" : "5";
        query.labels[2].name = "all", query.labels[2].value = "x";
        compare(query);
      }
    }
  }
}
END_TEST

/* Of 5000 jobs in two states half have one label, half the other, and seven have both. */
static void fill_apart(void) {
  ck_assert(sql_allowed(
      "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 5000) "
      "INSERT INTO job (state, kind, name, document, spec_hash, created_ms, finished_ms) "
      "SELECT iif(i % 3, 'succeeded', 'failed'), 'response', 'name ' || (i * 17 % 23), '{}', 'h', "
      "i, i * 31 % 97 FROM n;"
      "INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name) "
      "SELECT id, iif(id % 2, 'p', 'q'), 'x', kind, state, finished_ms, name FROM job;"
      "INSERT INTO job_label (job_id, name, value, kind, state, finished_ms, job_name) "
      "SELECT id, iif(id % 2, 'q', 'p'), 'x', kind, state, finished_ms, name FROM job "
      "WHERE id % 709 = 5"));
}

START_TEST(labels_that_hardly_meet_are_found_page_by_page) {
  struct list_query query = {.limit = 3, .label_count = 2};
  fill_apart();
  query.labels[0].name = "p", query.labels[0].value = "x";
  query.labels[1].name = "q", query.labels[1].value = "x";
  compare(query);
  query.labels[1].value = "nowhere";
  compare(query);
}
END_TEST

START_TEST(foreign_cursors_are_refused) {
  static const struct {
    int sort;
    const char *cursor;
  } wrong[] = {
      {LIST_BY_ID, "0"},         {LIST_BY_ID, "x"},        {LIST_BY_ID, ""},
      {LIST_BY_ID, "1-2"},       {LIST_BY_ID, "-1"},       {LIST_BY_ID, "99999999999999999999"},
      {LIST_BY_FINISHED, "1"},   {LIST_BY_FINISHED, "1-"}, {LIST_BY_FINISHED, "1-x"},
      {LIST_BY_NAME, "1"},       {LIST_BY_NAME, "1-6"},    {LIST_BY_NAME, "1-6x"},
      {LIST_BY_STATE, "1-done"}, {LIST_BY_STATE, "1"},     {LIST_BY_CREATED, "1 "}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    struct list_query query = {
        .sort = (unsigned)wrong[i].sort, .cursor = wrong[i].cursor, .limit = 5};
    struct job_record *records;
    struct error error;
    size_t count;
    char *next;
    ck_assert_msg(store_list(store, &query, &records, &count, &next, &error) == STATUS_INVALID,
                  "%s", wrong[i].cursor);
    ck_assert_ptr_null(records);
  }
}
END_TEST

/* A page goes on behind its place, also when the job there is gone or has another state. */
START_TEST(a_cursor_outlives_its_job) {
  struct list_query query = {.sort = LIST_BY_STATE, .limit = 3};
  struct job_record *records;
  struct error error;
  size_t count;
  char *next;
  fill();
  ck_assert_int_eq(store_list(store, &query, &records, &count, &next, &error), STATUS_OK);
  int64_t last = records[2].id;
  for (size_t i = 0; i < count; i++) {
    job_record_clear(&records[i]);
  }
  free(records);
  ck_assert_int_eq(store_delete(store, last, &error), STATUS_OK);
  query.cursor = next;
  char *rest;
  ck_assert_int_eq(store_list(store, &query, &records, &count, &rest, &error), STATUS_OK);
  ck_assert_uint_eq(count, 3);
  for (size_t i = 0; i < count; i++) {
    ck_assert_int_gt(records[i].id, last);
    job_record_clear(&records[i]);
  }
  free(records);
  free(next);
  free(rest);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("store_list");
  TCase *tests = tcase_create("store_list");
  tcase_add_checked_fixture(tests, store_setup, store_teardown);
  tcase_set_timeout(tests, 120);
  tcase_add_test(tests, pages_agree_with_a_plain_query);
  tcase_add_test(tests, labels_that_hardly_meet_are_found_page_by_page);
  tcase_add_test(tests, foreign_cursors_are_refused);
  tcase_add_test(tests, a_cursor_outlives_its_job);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
