/* Tables in text: delimiters, preambles, headers, numbers; and what is refused, with its line. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "tests/unit/suite.h"

static const struct table_column wanted[] = {{"x", "/columns/x"}, {"y", "/columns/y"}};

static enum status read_text(const char *text, struct table *table, struct error *error) {
  return table_read(text, strlen(text), "/data/csv", wanted, 2, table, error);
}

static const struct {
  const char *text;
  char delimiter;
  int line; /* of the first row */
} good[] = {
    {"x,y\n1,2\n3.5,-4e-1\n", ',', 2},
    {"x;y\n1;2\n3.5;-0.4\n", ';', 2},
    {"x;y\n1,0;2,0\n3,5;-0,4\n", ';', 2},
    {"x\ty\n1\t2\n3,5\t-,4\n", '\t', 2},
    {"\xEF\xBB\xBFx,y\r\n1,2\r\n3.5,-.4\r\n", ',', 2},
    {"x,y\r1,2\r3.5,-0.4", ',', 2},
    {"y,note,x\n2,\"a,b\",1\n-0.4,,3.5\n", ',', 2},
    {"\"x\",\"y\"\n\"1\",\"2\"\n\n,\n\"3.5\",\"-0.4\"\n,\n", ',', 2},
    {"title, with a comma\nmade;by;hand\n\nx ;  y;z\n(mm);(N);[-]\n1; 2 ;a\n3.5;-0.4;b\n", ';', 6},
    {"Thickness (mm);3;\nx;y;z\n1;2;\n3.5;-0.4;\n", ';', 3},
    {"\"two\nlines\",x,y\nq,1,2\nq,3.5,-0.4\n", ',', 3},
    {"\"5\"\" gauge\",x,y\nq,1,2\nq,3.5,-0.4\n", ',', 2},
};

START_TEST(reads) {
  struct table table;
  struct error error = {.status = STATUS_OK};
  enum status status = read_text(good[_i].text, &table, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert_uint_eq(table.rows, 2);
  ck_assert_int_eq(table.delimiter, good[_i].delimiter);
  ck_assert_int_eq(table.line[0], good[_i].line);
  ck_assert_double_eq(table.value[0][0], 1.0);
  ck_assert_double_eq(table.value[0][1], 3.5);
  ck_assert_double_eq(table.value[1][0], 2.0);
  ck_assert_double_eq(table.value[1][1], -0.4);
  table_release(&table);
  ck_assert_ptr_null(table.line);
}
END_TEST

static const struct {
  const char *text, *pointer, *phrase;
} bad[] = {
    {"", "/data/csv", "no line with the names"},
    {"1,2\n3,4\n", "/data/csv", "no line with the names"},
    {"x,y\n", "/data/csv", "no rows below its header, line 1"},
    {"x,z\n1,2\n", "/columns/y", "its header, line 1, has others: \"x\", \"z\""},
    {"a;b\nload;disp;other\n1;2;3\n", "/columns/x",
     "line 2, has others: \"load\", \"disp\", \"other\""},
    {"x,y,x\n1,2,3\n", "/columns/x", "columns 1 and 3 of the table (line 1) are both called"},
    {"x,y\n1,2\n\n3,abc\n", "/data/csv", "line 4 of the table, column \"y\": \"abc\" is not a num"},
    {"x,y\n1,2\n,4\n", "/data/csv", "line 3 of the table, column \"x\": the field is empty"},
    {"x,y\n1,2\n3\n", "/data/csv", "line 3 of the table, column \"y\": the line ends after 1 of 2"},
    {"x,y\n1,nan\n", "/data/csv", "\"nan\" is not a finite number"},
    {"x,y\n1,-Infinity\n", "/data/csv", "is not a finite number"},
    {"x,y\n1,1e999\n", "/data/csv", "beyond the range"},
    {"x,y\n1,0x10\n", "/data/csv", "\"0x10\" is not a number"},
    {"x,y\n1,1e\n", "/data/csv", "is not a number"},
    {"x,y\n1,.\n", "/data/csv", "is not a number"},
    {"x,y\n1,\"2\n3,4\n", "/data/csv", "line 2 of the table opens a quote"},
    {"x;y\n1,5;2\n1.5;2\n", "/data/csv",
     "line 3 of the table, column \"x\": \"1.5\" has a decimal"},
    {"x;y\n1;2,345.6\n", "/data/csv", "is not a number"},
};

START_TEST(refuses) {
  struct table table;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_text(bad[_i].text, &table, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, bad[_i].pointer);
  ck_assert_msg(strstr(error.message, bad[_i].phrase) != NULL, "%s", error.message);
  ck_assert_ptr_null(table.line);
}
END_TEST

START_TEST(names_the_nearest_column) {
  static const struct table_column column = {"Stress (MPa", "/columns/stress"};
  static const char text[] = "Strain,Stress (MPa)\n1,2\n";
  struct table table;
  struct error error;
  ck_assert_int_eq(table_read(text, sizeof text - 1, "", &column, 1, &table, &error),
                   STATUS_INVALID);
  ck_assert_msg(strstr(error.message, "did you mean \"Stress (MPa)\"?") != NULL, "%s",
                error.message);
}
END_TEST

START_TEST(one_column_serves_one_quantity) {
  static const struct table_column twice[] = {{"x", "/a"}, {"x", "/b"}};
  struct table table;
  struct error error;
  ck_assert_int_eq(table_read("x,y\n1,2\n", 8, "", twice, 2, &table, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/b");
}
END_TEST

START_TEST(rows_and_columns_are_limited) {
  static char text[12 * TABLE_ROWS_MAX + 100];
  struct table table;
  struct error error;
  for (int more = 0; more < 2; more++) {
    size_t length = (size_t)sprintf(text, "x,y\n");
    for (int i = 0; i < TABLE_ROWS_MAX + more; i++) {
      length += (size_t)sprintf(text + length, "%d,0\n", i);
    }
    enum status status = table_read(text, length, "/data/csv", wanted, 2, &table, &error);
    ck_assert_int_eq(status, more ? STATUS_TOO_LARGE : STATUS_OK);
    ck_assert_uint_eq(table.rows, more ? 0 : TABLE_ROWS_MAX);
    table_release(&table);
  }
  ck_assert_ptr_nonnull(strstr(error.message, "line 10002"));
  memset(text, ',', 300);
  ck_assert_int_eq(table_read(text, 300, "/data/csv", wanted, 2, &table, &error), STATUS_TOO_LARGE);
}
END_TEST

static const struct {
  const char *file;
  size_t rows;
  double strain, stress; /* of the last row */
} curves[] = {{"dragon-skin-10-medium", 457, 10.4090853668586, 1.84379103221798},
              {"dragon-skin-20", 404, 9.20455, 4.434225},
              {"dragon-skin-30", 311, 7.09091, 4.14551},
              {"ecoflex-00-30", 705, 16.06818, 1.35949}};

START_TEST(reads_the_measured_curves) {
  static char text[1 << 16];
  static const struct table_column columns[] = {{"Engineering Strain", ""},
                                                {"Engineering Stress (MPa)", ""}};
  const char *source = getenv("srcdir");
  char path[600];
  snprintf(path, sizeof path, "%s/data/tensile/%s.csv", source ? source : ".", curves[_i].file);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  struct table table;
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(table_read(text, size, "", columns, 2, &table, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_uint_eq(table.rows, curves[_i].rows);
  ck_assert_int_eq(table.line[0], 19);
  ck_assert_double_eq(table.value[0][table.rows - 1], curves[_i].strain);
  ck_assert_double_eq(table.value[1][table.rows - 1], curves[_i].stress);
  table_release(&table);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("base: tables");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, reads, 0, sizeof good / sizeof *good);
  tcase_add_loop_test(tcase, refuses, 0, sizeof bad / sizeof *bad);
  tcase_add_test(tcase, names_the_nearest_column);
  tcase_add_test(tcase, one_column_serves_one_quantity);
  tcase_add_test(tcase, rows_and_columns_are_limited);
  tcase_add_loop_test(tcase, reads_the_measured_curves, 0, sizeof curves / sizeof *curves);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
