/* STL files: both forms, what is refused and where, files that lie about their size. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "solver/rigid/stl.h"
#include "tests/unit/suite.h"

#define FACET(a, b, c)                                                                             \
  " facet normal 0 0 0\n  outer loop\n   vertex " a "\n   vertex " b "\n   vertex " c              \
  "\n  endloop\n endfacet\n"

static char path[] = "/tmp/test_rigid_stl_XXXXXX";

static void set_up(void) {
  strcpy(strrchr(path, '_'), "_XXXXXX");
  int file = mkstemp(path);
  ck_assert_int_ge(file, 0);
  close(file);
}

static void tear_down(void) {
  ck_assert_int_eq(unlink(path), 0);
}

static enum status read_text(const char *text, struct stl *stl, struct error *error) {
  /* A copy of the exact size, so that a sanitizer sees reads beyond it. */
  size_t size = strlen(text);
  unsigned char *copy = malloc(size);
  ck_assert_ptr_nonnull(copy);
  memcpy(copy, text, size);
  enum status status = stl_read(copy, size, stl, error);
  free(copy);
  return status;
}

START_TEST(text_gives_its_corners) {
  static const char text[] = "solid a part, facet by facet\r\n" FACET(
      "0 0 0", "1.5 -2e1 .5", "+3E-1 4. 5") "endsolid a part\nSOLID\n" FACET("1 2 3", "4 5 6",
                                                                             "7 8 -9") "EndSolid";
  static const double corners[18] = {0, 0, 0, 1.5, -20, 0.5, 0.3, 4, 5, 1, 2, 3, 4, 5, 6, 7, 8, -9};
  struct stl stl;
  ck_assert_int_eq(read_text(text, &stl, NULL), STATUS_OK);
  ck_assert_int_eq(stl.count, 2);
  for (int i = 0; i < 18; i++) {
    ck_assert_double_eq(stl.corner[i], corners[i]);
  }
  stl_release(&stl);
}
END_TEST

START_TEST(binary_gives_what_was_written) {
  double corner[18] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, -0.1, 1e30, -1e-30, 0, 0, 0, 0, 1};
  struct stl written = {2, corner}, stl;
  size_t size;
  unsigned char *data = stl_write(&written, &size);
  ck_assert_ptr_nonnull(data);
  ck_assert_uint_eq(size, 84 + 2 * 50);
  ck_assert_int_eq(stl_read(data, size, &stl, NULL), STATUS_OK);
  ck_assert_int_eq(stl.count, 2);
  for (int i = 0; i < 18; i++) {
    ck_assert_double_eq(stl.corner[i], (double)(float)corner[i]);
  }
  stl_release(&stl);
  /* A header that begins like text is no text while the size fits the count. */
  memcpy(data, "solid", 5);
  ck_assert_int_eq(stl_read(data, size, &stl, NULL), STATUS_OK);
  stl_release(&stl);
  free(data);
}
END_TEST

/* Little-endian numbers at fixed places, whatever the machine. */
START_TEST(binary_is_read_byte_by_byte) {
  unsigned char data[84 + 50] = {0};
  struct stl stl;
  data[80] = 1;
  data[84 + 12 + 2] = 0x80; /* 1.0 = 0x3f800000 */
  data[84 + 12 + 3] = 0x3F;
  data[84 + 48] = 0xFF; /* attributes, passed over */
  ck_assert_int_eq(stl_read(data, sizeof data, &stl, NULL), STATUS_OK);
  ck_assert_double_eq(stl.corner[0], 1);
  stl_release(&stl);
}
END_TEST

static const struct {
  const char *text, *phrase;
} broken[] = {
    {"", "0 bytes are no STL"},
    {"soli", "4 bytes are no STL"},
    {"{\"json\": \"and no STL, though it is as long as a header with the number of triangles of a "
     "file of 84 bytes is\"}",
     "is cut off, or none"},
    {"solid nothing\nendsolid nothing\n", "no triangle"},
    {"solid", "line 1 of the STL file has its end where \"facet\""},
    {"solid x\n facet normal 0 0 0\n outer loop\n vertex 0 0\n", "its end where a number"},
    {"solid x\n\n facet normal 0 0 zero\n", "line 3 of the STL file has \"zero\" where a number"},
    {"solid x\n facet normal 0 0 nan\n", "\"nan\" where a number"},
    {"solid x\n facet normal 0 0 0x1\n", "\"0x1\" where a number"},
    {"solid x\n facet normal 0 0 1e999\n", "single precision"},
    {"solid x\n facet normal 0 0 1e39\n", "single precision"},
    {"solid x\n facet normal 0 0 1-2\n", "single precision"},
    {"solid x\n" FACET("0 0 0", "1 0 0", "0 1 0") " fact\n", "line 9 of the STL file has \"fact\""},
    {"solid x\n" FACET("0 0 0", "1 0 0", "0 1 0"), "has its end where \"facet\" or \"endsolid\""},
    {"solid x\n facet normal 0 0 0\n outer loop\n vertex 0 0 0\n vertex 0 0 1\n endloop",
     "\"endloop\" where \"vertex\""},
    {"solid x\n" FACET("0 0 0", "1 0 0", "0 1 0") "endsolid\nmore", "where \"solid\" or the end"},
    {"solid x\n facet normal 0 0 "
     "99999999999999999999999999999999999999999999999999999999999999999999999999999999999\n",
     "single precision"},
};

START_TEST(broken_text_is_refused) {
  struct stl stl = {5, NULL};
  struct error error = {.message = ""};
  ck_assert_int_eq(read_text(broken[_i].text, &stl, &error), STATUS_INVALID);
  ck_assert_msg(strstr(error.message, broken[_i].phrase) != NULL, "%s", error.message);
  ck_assert(stl.count == 0 && stl.corner == NULL);
  ck_assert_str_eq(error.pointer, "");
}
END_TEST

START_TEST(binary_that_cannot_be_is_refused) {
  double corner[9] = {0};
  struct stl one = {1, corner}, stl;
  struct error error = {.message = ""};
  size_t size;
  unsigned char *data = stl_write(&one, &size);
  ck_assert_ptr_nonnull(data);
  ck_assert_int_eq(stl_read(data, size - 1, &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "1 triangles, which take 134 bytes, but it has 133"));
  uint32_t bits = 0x7F800000;
  memcpy(data + 84 + 12 + 4, &bits, 4);
  ck_assert_int_eq(stl_read(data, size, &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "corner 1 of triangle 1"));
  memset(data + 80, 0xFF, 4);
  ck_assert_int_eq(stl_read(data, size, &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "4294967295 triangles"));
  free(data);
}
END_TEST

/* ---- files ------------------------------------------------------------------------------ */

static void write_file(const void *data, size_t size, off_t length) {
  FILE *file = fopen(path, "wb");
  ck_assert_ptr_nonnull(file);
  ck_assert_uint_eq(fwrite(data, 1, size, file), size);
  ck_assert_int_eq(ftruncate(fileno(file), length), 0);
  ck_assert_int_eq(fclose(file), 0);
}

START_TEST(a_file_of_two_gigabytes_is_not_read) {
  struct stl stl;
  struct error error = {.message = ""};
  unsigned char head[84] = {0};
  /* Its header is right: 42,949,671 triangles. */
  const uint32_t count = 42949671;
  for (int i = 0; i < 4; i++) {
    head[80 + i] = (unsigned char)(count >> 8 * i);
  }
  write_file(head, sizeof head, 84 + 50 * (off_t)count);
  ck_assert_int_eq(stl_load(path, &stl, &error), STATUS_TOO_LARGE);
  ck_assert_msg(strstr(error.message, "has 2048 MiB: at most 64 MiB") != NULL, "%s", error.message);
}
END_TEST

START_TEST(a_header_that_lies_is_found_out) {
  struct stl stl;
  struct error error = {.message = ""};
  unsigned char head[84] = "binary";
  memset(head + 80, 0x7F, 4);
  write_file(head, sizeof head, 84 + 50 * 4);
  ck_assert_int_eq(stl_load(path, &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "2139062143 triangles, which take 106953107234"));
  /* More than are taken, in a file of the right size. */
  const uint32_t count = STL_TRIANGLES_MAX + 1;
  for (int i = 0; i < 4; i++) {
    head[80 + i] = (unsigned char)(count >> 8 * i);
  }
  write_file(head, sizeof head, 84 + 50 * (off_t)count);
  ck_assert_int_eq(stl_load(path, &stl, &error), STATUS_TOO_LARGE);
  ck_assert_ptr_nonnull(strstr(error.message, "at most 200000"));
}
END_TEST

START_TEST(files_are_read_like_their_bytes) {
  static const char text[] = "solid\n" FACET("0 0 0", "1 0 0", "0 1 0") "endsolid\n";
  struct stl stl;
  struct error error = {.message = ""};
  write_file(text, sizeof text - 1, sizeof text - 1);
  ck_assert_int_eq(stl_load(path, &stl, NULL), STATUS_OK);
  ck_assert_int_eq(stl.count, 1);
  stl_release(&stl);
  write_file("", 0, 0);
  ck_assert_int_eq(stl_load(path, &stl, &error), STATUS_INVALID);
  ck_assert_int_eq(stl_load("/tmp", &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "not a regular file"));
  ck_assert_int_eq(stl_load("/dev/zero", &stl, &error), STATUS_INVALID);
  ck_assert_int_eq(stl_load("/no/such/file.stl", &stl, &error), STATUS_INVALID);
  ck_assert_ptr_nonnull(strstr(error.message, "No such file"));
}
END_TEST

int main(void) {
  Suite *suite = suite_create("rigid: STL files");
  TCase *tcase = tcase_create("all");
  tcase_add_checked_fixture(tcase, set_up, tear_down);
  tcase_add_test(tcase, text_gives_its_corners);
  tcase_add_test(tcase, binary_gives_what_was_written);
  tcase_add_test(tcase, binary_is_read_byte_by_byte);
  tcase_add_loop_test(tcase, broken_text_is_refused, 0, sizeof broken / sizeof *broken);
  tcase_add_test(tcase, binary_that_cannot_be_is_refused);
  tcase_add_test(tcase, a_file_of_two_gigabytes_is_not_read);
  tcase_add_test(tcase, a_header_that_lies_is_found_out);
  tcase_add_test(tcase, files_are_read_like_their_bytes);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
