/* Guarded reading of JSON, pointers, and places in the text. */
#include <stdlib.h>
#include <string.h>

#include "solver/job/json.h"
#include "tests/unit/suite.h"

static const struct {
  const char *text;
  int line, column; /* 0: not checked */
  const char *phrase;
} malformed[] = {
    {"", 1, 0, "not well-formed"},
    {"{", 1, 0, "not well-formed"},
    {"[1,]", 1, 4, "a bracket ends the array where a value is due: no comma before it"},
    {"{\"a\": 1,\n \"b\": 2,\n  \"a\": 3}", 3, 3, "duplicate object key"},
    {"{\"x\": {\"a\": 1, \"a\": 1}}", 1, 16, "duplicate object key"},
    {"[NaN]", 1, 0, "NaN"},
    {"[Infinity]", 1, 0, "Infinity"},
    {"[1e400]", 1, 0, "overflow"},
    {"[99999999999999999999]", 1, 0, "too big"},
    {"[\"\xFF\"]", 1, 0, "decode"},
    {"[\"\\u0000\"]", 1, 0, "NUL"},
    {"[1] 2", 1, 0, "end of file"},
    {"\"text\"", 1, 0, "'[' or '{'"},
    {"[01]", 1, 0, "not well-formed"},
    {"{'a': 1}", 1, 0, "not well-formed"},
    {"// remark\n{}", 1, 0, "not well-formed"},
};

START_TEST(refuses_malformed_text) {
  json_t *root = NULL;
  struct error error = {.status = STATUS_OK};
  const char *text = malformed[_i].text;
  ck_assert_int_eq(json_text_read(text, strlen(text), &root, &error), STATUS_SYNTAX);
  ck_assert_msg(strstr(error.message, malformed[_i].phrase) != NULL, "%s: %s", text, error.message);
  ck_assert_msg(error.line == malformed[_i].line, "%s: line %d", text, error.line);
  ck_assert_int_ge(error.column, 1);
  if (malformed[_i].column > 0) {
    ck_assert_msg(error.column == malformed[_i].column, "%s: column %d", text, error.column);
  }
}
END_TEST

static enum status read_nested(int depth, struct error *error) {
  char text[200] = "";
  for (int i = 0; i < depth; i++) {
    strcat(text, "[");
  }
  strcat(text, "\"]]}}[[{{\\\"[[[\"");
  for (int i = 0; i < depth; i++) {
    strcat(text, "]");
  }
  json_t *root = NULL;
  enum status status = json_text_read(text, strlen(text), &root, error);
  if (status == STATUS_OK) {
    json_decref(root);
  }
  return status;
}

/* Jansson cuts the place that it quotes in the middle of a character. */
START_TEST(messages_about_malformed_text_are_valid_text) {
  char text[200] = "[\"\\\xE2\x82\xAC";
  while (strlen(text) < 150) {
    strcat(text, "\xE2\x82\xAC");
  }
  json_t *root = NULL;
  struct error error;
  ck_assert_int_eq(json_text_read(text, strlen(text), &root, &error), STATUS_SYNTAX);
  json_t *message = json_string(error.message);
  ck_assert_ptr_nonnull(message);
  json_decref(message);
}
END_TEST

START_TEST(limits_the_depth) {
  struct error error;
  ck_assert_int_eq(read_nested(32, &error), STATUS_OK);
  ck_assert_int_eq(read_nested(33, &error), STATUS_SYNTAX);
  ck_assert_ptr_nonnull(strstr(error.message, "32"));
  ck_assert_int_eq(error.line, 1);
  ck_assert_int_eq(error.column, 33);
}
END_TEST

/* Deeper than any call stack would allow: the limit must act before the parser recurses. */
START_TEST(a_megabyte_of_brackets_is_refused) {
  size_t size = JSON_TEXT_MAX;
  char *text = malloc(size);
  memset(text, '[', size);
  json_t *root = NULL;
  ck_assert_int_eq(json_text_read(text, size, &root, NULL), STATUS_SYNTAX);
  free(text);
}
END_TEST

START_TEST(limits_the_size) {
  size_t size = JSON_TEXT_MAX;
  char *text = malloc(size + 1);
  memset(text, ' ', size + 1);
  memcpy(text, "[1]", 3);
  json_t *root = NULL;
  struct error error;
  ck_assert_int_eq(json_text_read(text, size, &root, &error), STATUS_OK);
  json_decref(root);
  ck_assert_int_eq(json_text_read(text, size + 1, &root, &error), STATUS_TOO_LARGE);
  ck_assert_ptr_nonnull(strstr(error.message, "1048577"));
  ck_assert_ptr_nonnull(strstr(error.message, "1048576"));
  free(text);
}
END_TEST

static const char document[] = "{\n  \"a\": {\"b\": [10, {\"c\": \"}],\"}, 12]},\n"
                               "  \"\xC3\xA4\": 1, \"x/y~z\": 2,\n  \"\\u0061\\n\": [3]}";

static const struct {
  const char *pointer;
  int line, column;
} places[] = {
    {"", 1, 1},          {"/a", 2, 8},           {"/a/b", 2, 14},   {"/a/b/0", 2, 15},
    {"/a/b/1", 2, 19},   {"/a/b/1/c", 2, 25},    {"/a/b/2", 2, 33}, {"/\xC3\xA4", 3, 8},
    {"/x~1y~0z", 3, 20}, {"/a\n/0", 4, 16},      {"/a/b/7", 2, 14}, {"/a/b/0/q", 2, 15},
    {"/missing", 1, 1},  {"/a/missing/b", 2, 8},
};

START_TEST(finds_the_place_of_a_pointer) {
  int line = 0, column = 0;
  json_text_locate(document, sizeof document - 1, places[_i].pointer, &line, &column);
  ck_assert_msg(line == places[_i].line && column == places[_i].column, "%s at %d:%d",
                places[_i].pointer, line, column);
}
END_TEST

START_TEST(pointers_grow_and_shrink) {
  struct json_pointer pointer = {.length = 0};
  size_t first = json_pointer_key(&pointer, "a/b~c");
  size_t second = json_pointer_index(&pointer, 12);
  ck_assert_str_eq(pointer.text, "/a~1b~0c/12");
  json_pointer_pop(&pointer, second);
  ck_assert_str_eq(pointer.text, "/a~1b~0c");
  json_pointer_pop(&pointer, first);
  ck_assert_str_eq(pointer.text, "");
}
END_TEST

START_TEST(pointers_that_do_not_fit_name_an_ancestor) {
  char key[300];
  memset(key, 'k', sizeof key - 1);
  key[sizeof key - 1] = '\0';
  struct json_pointer pointer = {.length = 0};
  json_pointer_key(&pointer, "a");
  size_t outer = json_pointer_key(&pointer, key);
  size_t inner = json_pointer_key(&pointer, "b");
  ck_assert_str_eq(pointer.text, "/a");
  json_pointer_pop(&pointer, inner);
  json_pointer_pop(&pointer, outer);
  json_pointer_key(&pointer, "c");
  ck_assert_str_eq(pointer.text, "/a/c");
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: json");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, refuses_malformed_text, 0, sizeof malformed / sizeof *malformed);
  tcase_add_test(tcase, messages_about_malformed_text_are_valid_text);
  tcase_add_test(tcase, limits_the_depth);
  tcase_add_test(tcase, a_megabyte_of_brackets_is_refused);
  tcase_add_test(tcase, limits_the_size);
  tcase_add_loop_test(tcase, finds_the_place_of_a_pointer, 0, sizeof places / sizeof *places);
  tcase_add_test(tcase, pointers_grow_and_shrink);
  tcase_add_test(tcase, pointers_that_do_not_fit_name_an_ancestor);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
