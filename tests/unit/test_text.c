/* Messages and words: whole characters, quoting, nearness. */
#include <jansson.h>
#include <stdint.h>
#include <string.h>

#include "solver/base/error.h"
#include "solver/base/text.h"
#include "tests/unit/suite.h"

START_TEST(every_status_has_its_own_word) {
  for (int i = 0; i < STATUS_COUNT; i++) {
    ck_assert_str_ne(status_word((enum status)i), "unknown");
    ck_assert_uint_gt(strlen(status_sentence((enum status)i)), 0);
    for (int j = 0; j < i; j++) {
      ck_assert_str_ne(status_word((enum status)i), status_word((enum status)j));
    }
  }
  ck_assert_str_eq(status_word(STATUS_COUNT), "unknown");
}
END_TEST

START_TEST(error_set_stores_or_ignores) {
  struct error error = {.line = 7};
  ck_assert_int_eq(error_set(&error, STATUS_INVALID, "/a", "%d of %s", 3, "x"), STATUS_INVALID);
  ck_assert_str_eq(error.message, "3 of x");
  ck_assert_str_eq(error.pointer, "/a");
  ck_assert_int_eq(error.line, 0);
  ck_assert_int_eq(error_set(NULL, STATUS_IO, NULL, "nobody listens"), STATUS_IO);
}
END_TEST

/* A message that is cut must still be UTF-8, or the result document could not be written. */
START_TEST(long_messages_end_with_a_whole_character) {
  static const char *const characters[] = {"x", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"};
  for (size_t c = 0; c < 4; c++) {
    for (size_t shift = 0; shift < 4; shift++) {
      char text[1000] = "";
      memset(text, 'a', shift);
      while (strlen(text) < 900) {
        strcat(text, characters[c]);
      }
      struct error error;
      error_set(&error, STATUS_INVALID, text, "%s", text);
      json_t *message = json_string(error.message);
      json_t *pointer = json_string(error.pointer);
      ck_assert_ptr_nonnull(message);
      ck_assert_ptr_nonnull(pointer);
      ck_assert_uint_ge(strlen(error.message), sizeof error.message - 4);
      json_decref(message);
      json_decref(pointer);
    }
  }
}
END_TEST

START_TEST(repair_leaves_whole_characters_alone) {
  static const char *const pairs[][2] = {
      {"", ""},
      {"a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80z", "a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80z"},
      {"a\xFFz", "a?z"},
      {"\xC3", "?"},
      {"\xE2\x82", "??"},
      {"\xC0\x80", "??"},           /* overlong */
      {"\xE0\x80\x80", "???"},      /* overlong */
      {"\xED\xA0\x80", "???"},      /* surrogate */
      {"\xF4\x90\x80\x80", "????"}, /* above U+10FFFF */
      {"\xF5\x80\x80\x80", "????"},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    char text[40];
    strcpy(text, pairs[i][0]);
    text_repair(text);
    ck_assert_str_eq(text, pairs[i][1]);
  }
}
END_TEST

START_TEST(quoting_shortens_and_cleans) {
  char out[16];
  ck_assert_str_eq(text_quote(out, sizeof out, "short"), "\"short\"");
  ck_assert_str_eq(text_quote(out, sizeof out, "a\nb\x7F"), "\"a?b?\"");
  ck_assert_str_eq(text_quote(out, sizeof out, "1234567890123"), "\"1234567890123\"");
  ck_assert_str_eq(text_quote(out, sizeof out, "12345678901234"), "\"1234567890...\"");
  ck_assert_str_eq(text_quote(out, sizeof out, "123456789\xE2\x82\xAC\xE2\x82\xAC"),
                   "\"123456789...\"");
}
END_TEST

START_TEST(distances) {
  ck_assert_uint_eq(text_distance("", ""), 0);
  ck_assert_uint_eq(text_distance("width", "width"), 0);
  ck_assert_uint_eq(text_distance("Width", "width"), 0);
  ck_assert_uint_eq(text_distance("", "abc"), 3);
  ck_assert_uint_eq(text_distance("lenght", "length"), 1);
  ck_assert_uint_eq(text_distance("kitten", "sitting"), 3);
  ck_assert_uint_eq(text_distance("chamber-gap", "chamber_gap"), 1);
  char text[80];
  memset(text, 'a', sizeof text - 1);
  text[sizeof text - 1] = '\0';
  ck_assert_uint_eq(text_distance(text, "a"), SIZE_MAX);
}
END_TEST

START_TEST(nearest_word) {
  static const char *const words[] = {"length", "width", "height", "slit", "slit_floor"};
  ck_assert_str_eq(text_nearest("lenght", words, 5), "length");
  ck_assert_str_eq(text_nearest("widht", words, 5), "width");
  ck_assert_str_eq(text_nearest("slitfloor", words, 5), "slit_floor");
  ck_assert_ptr_null(text_nearest("colour", words, 5));
  ck_assert_ptr_null(text_nearest("length", words, 0));
}
END_TEST

int main(void) {
  Suite *suite = suite_create("base: error and text");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, every_status_has_its_own_word);
  tcase_add_test(tcase, error_set_stores_or_ignores);
  tcase_add_test(tcase, long_messages_end_with_a_whole_character);
  tcase_add_test(tcase, repair_leaves_whole_characters_alone);
  tcase_add_test(tcase, quoting_shortens_and_cleans);
  tcase_add_test(tcase, distances);
  tcase_add_test(tcase, nearest_word);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
