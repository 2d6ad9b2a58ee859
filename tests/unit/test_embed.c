/* Files that a job names: their content in their place, and what is refused. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <sys/stat.h>

#include "solver/base/base64.h"
#include "solver/job/embed.h"
#include "tests/unit/suite.h"

static char folder[] = "/tmp/test_embed_XXXXXX";

static void path_in_folder(char *path, size_t size, const char *name) {
  snprintf(path, size, "%s/%s", folder, name);
}

static void write_file(const char *name, const char *bytes, size_t size) {
  char path[200];
  path_in_folder(path, sizeof path, name);
  FILE *file = fopen(path, "wb");
  ck_assert_ptr_nonnull(file);
  ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
  fclose(file);
}

static void set_up(void) {
  char path[200];
  strcpy(strrchr(folder, '_'), "_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
  path_in_folder(path, sizeof path, "sub");
  ck_assert_int_eq(mkdir(path, 0700), 0);
  write_file("a.csv", "x,y\r\n1,2\r\n", 10);
  write_file("latin.csv", "x (\xB5m)\n", 7);
  write_file("nul.csv", "x\0y", 3);
  write_file("bad.json", "{\n  oops }", 10);
  static const char part[] =
      "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1.5\n"
      "endloop\nendfacet\nendsolid\n";
  write_file("part.stl", part, sizeof part - 1);
  write_file("bad.stl", part, sizeof part - 20);
  char *many = calloc(1, 84 + 50 * 14744);
  ck_assert_ptr_nonnull(many);
  memcpy(many + 80, "\x98\x39", 2);
  write_file("many.stl", many, 84 + 50 * 14744);
  free(many);
  static const char base[] =
      "{\"kind\":\"response\",\"measured\":{\"data\":{\"file\":\"../a.csv\"}}}";
  write_file("sub/base.json", base, sizeof base - 1);
  static const char loop[] = "{\"base\":{\"file\":\"loop.json\"}}";
  write_file("loop.json", loop, sizeof loop - 1);
  char *large = calloc(1, (1 << 20) + 1);
  ck_assert_ptr_nonnull(large);
  memset(large, ' ', (1 << 20) + 1);
  write_file("large.csv", large, (1 << 20) + 1);
  free(large);
}

static void tear_down(void) {
  static const char *const names[] = {"part.stl",  "bad.stl",   "many.stl", "a.csv",
                                      "latin.csv", "nul.csv",   "bad.json", "sub/base.json",
                                      "loop.json", "large.csv", "sub"};
  char path[200];
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    path_in_folder(path, sizeof path, names[i]);
    remove(path);
  }
  rmdir(folder);
}

/* Embeds as if the text stood in job.json of the folder; NULL when refused. */
static json_t *embed(const char *text, struct error *error) {
  char path[200], *embedded = NULL;
  size_t length = 0;
  path_in_folder(path, sizeof path, "job.json");
  if (embed_files(text, strlen(text), path, &embedded, &length, error) != STATUS_OK) {
    ck_assert_ptr_null(embedded);
    return NULL;
  }
  json_t *document = json_loadb(embedded, length, 0, NULL);
  ck_assert_ptr_nonnull(document);
  free(embedded);
  return document;
}

static const char *string_at(const json_t *document, const char *a, const char *b, const char *c) {
  const json_t *value = json_object_get(document, a);
  value = b ? json_object_get(value, b) : value;
  return json_string_value(c ? json_object_get(value, c) : value);
}

START_TEST(text_without_files_is_left_as_it_is) {
  static const char text[] = " {\"kind\" : \"verify\",\n\"data\":{\"csv\":\"x\"}, \"n\": 1.50}";
  char *embedded = NULL;
  size_t length = 0;
  ck_assert_int_eq(embed_files(text, sizeof text - 1, NULL, &embedded, &length, NULL), STATUS_OK);
  ck_assert_str_eq(embedded, text);
  ck_assert_uint_eq(length, sizeof text - 1);
  free(embedded);
}
END_TEST

START_TEST(tables_become_text) {
  json_t *document = embed("{\"data\":{\"file\":\"a.csv\"},\"measured\":{\"data\":"
                           "{\"file\":\"./sub/../a.csv\"}},\"other\":{\"file\":\"a.csv\"}}",
                           NULL);
  ck_assert_str_eq(string_at(document, "data", "csv", NULL), "x,y\r\n1,2\r\n");
  ck_assert_uint_eq(json_object_size(json_object_get(document, "data")), 1);
  ck_assert_str_eq(string_at(document, "measured", "data", "csv"), "x,y\r\n1,2\r\n");
  ck_assert_str_eq(string_at(document, "other", "file", NULL), "a.csv");
  json_decref(document);
  document = embed("{\"input\":{\"data\":{\"file\":\"a.csv\"},\"between\":\"linear\"}}", NULL);
  ck_assert_str_eq(string_at(document, "input", "data", "csv"), "x,y\r\n1,2\r\n");
  json_decref(document);
  document = embed("{\"actuators\":[{},{\"input\":{\"data\":{\"file\":\"a.csv\"}}}]}", NULL);
  const json_t *second = json_array_get(json_object_get(document, "actuators"), 1);
  ck_assert_str_eq(string_at(second, "input", "data", "csv"), "x,y\r\n1,2\r\n");
  json_decref(document);
  document = embed("{\"data\":{\"file\":\"latin.csv\"}}", NULL);
  ck_assert_str_eq(string_at(document, "data", "csv", NULL), "x (\xC2\xB5m)\n");
  json_decref(document);
}
END_TEST

START_TEST(a_surface_becomes_base64) {
  json_t *document = embed("{\"object\":{\"shape\":{\"stl\":{\"file\":\"part.stl\"}}}}", NULL);
  const json_t *shape = json_object_get(json_object_get(document, "object"), "shape");
  const char *text = string_at(shape, "stl", "base64", NULL);
  ck_assert_ptr_nonnull(text);
  unsigned char bytes[200];
  size_t size = 0;
  ck_assert_uint_lt(strlen(text), sizeof bytes);
  ck_assert(base64_decode(text, strlen(text), bytes, &size));
  /* One triangle in binary, whose last corner is (0, 0, 1.5). */
  ck_assert_uint_eq(size, 84 + 50);
  ck_assert_int_eq(bytes[80], 1);
  ck_assert_mem_eq(bytes + 84 + 44, "\0\0\xC0\x3F", 4);
  json_decref(document);
}
END_TEST

/* RFC 4648, section 10, and what is none. */
START_TEST(base64_goes_to_and_fro) {
  static const char *const pairs[][2] = {{"", ""},
                                         {"f", "Zg=="},
                                         {"fo", "Zm8="},
                                         {"foo", "Zm9v"},
                                         {"foob", "Zm9vYg=="},
                                         {"fooba", "Zm9vYmE="},
                                         {"foobar", "Zm9vYmFy"}};
  static const char *const wrong[] = {"Z", "Zg=", "Zg===", "Z===", "Zg==Zg==", "Zm9?", "=m9v"};
  unsigned char bytes[16];
  size_t length = 0, size = 0;
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    char *text = base64_encode(pairs[i][0], strlen(pairs[i][0]), &length);
    ck_assert_str_eq(text, pairs[i][1]);
    ck_assert(base64_decode(text, length, bytes, &size));
    ck_assert_uint_eq(size, strlen(pairs[i][0]));
    ck_assert_mem_eq(bytes, pairs[i][0], size);
    free(text);
  }
  ck_assert(base64_decode("Zm\n9v \t", 7, bytes, &size));
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    ck_assert_msg(!base64_decode(wrong[i], strlen(wrong[i]), bytes, &size), "%s", wrong[i]);
  }
}
END_TEST

START_TEST(a_base_becomes_its_document_with_its_own_files) {
  json_t *document = embed("{\"base\":{\"file\":\"sub/base.json\"}}", NULL);
  ck_assert_str_eq(string_at(document, "base", "kind", NULL), "response");
  ck_assert_str_eq(string_at(json_object_get(document, "base"), "measured", "data", "csv"),
                   "x,y\r\n1,2\r\n");
  json_decref(document);
  document = embed("{\"base\":{\"data\":{\"file\":\"a.csv\"}}}", NULL);
  ck_assert_str_eq(string_at(document, "base", "data", "csv"), "x,y\r\n1,2\r\n");
  json_decref(document);
}
END_TEST

START_TEST(a_law_becomes_its_snap_job) {
  json_t *document = embed("{\"snap\":{\"file\":\"sub/base.json\"},\"laws\":{\"b\":{\"snap\":"
                           "{\"file\":\"sub/base.json\"}},\"c\":{\"table\":[]}}}",
                           NULL);
  const json_t *laws = json_object_get(document, "laws");
  ck_assert_str_eq(string_at(document, "snap", "kind", NULL), "response");
  ck_assert_str_eq(string_at(laws, "b", "snap", "kind"), "response");
  ck_assert_uint_eq(json_object_size(json_object_get(laws, "c")), 1);
  json_decref(document);
}
END_TEST

START_TEST(a_base_that_names_itself_ends) {
  json_t *document = embed("{\"base\":{\"file\":\"loop.json\"}}", NULL);
  ck_assert_ptr_nonnull(document);
  json_decref(document);
}
END_TEST

static const struct {
  const char *text;
  enum status status;
  const char *pointer, *phrase;
  int line;
} refusals[] = {
    {"{\n\"data\": {\n\"file\": \"b.csv\"}}", STATUS_INVALID, "/data/file", "No such file", 3},
    {"{\"data\":{\"file\":\"sub\"}}", STATUS_INVALID, "/data/file", "not a regular file", 1},
    {"{\"data\":{\"file\":\"/dev/zero\"}}", STATUS_INVALID, "/data/file", "not a regular", 1},
    {"{\"data\":{\"file\":\"large.csv\"}}", STATUS_INVALID, "/data/file", "larger than 1 MiB", 1},
    {"{\"data\":{\"file\":\"nul.csv\"}}", STATUS_INVALID, "/data/file", "no text in UTF-8", 1},
    {"{\"data\":{\"file\":\"bad.json\"}}", STATUS_INVALID, "/data/file", "no table", 1},
    {"{\"data\":{\"file\":5}}", STATUS_INVALID, "/data/file", "one string", 1},
    {"{\"data\":{\"file\":\"a.csv\",\"csv\":\"\"}}", STATUS_INVALID, "/data/file", "beside it", 1},
    {"{\"base\":{\"file\":\"a.csv\"}}", STATUS_INVALID, "/base/file", "no job document", 1},
    {"{\"base\":{\"file\":\"bad.json\"}}", STATUS_SYNTAX, "/base/file", "line 2 of that file", 0},
    {"{\"actuators\":[{},{\"input\":{\"data\":{\"file\":\"b.csv\"}}}]}", STATUS_INVALID,
     "/actuators/1/input/data/file", "No such file", 1},
    {"{\"laws\":{\"a\":{\"snap\":{\"file\":\"a.csv\"}}}}", STATUS_INVALID, "/laws/a/snap/file",
     "no job document", 1},
    {"{\"object\":{\"shape\":{\"stl\":{\"file\":\"b.stl\"}}}}", STATUS_INVALID,
     "/object/shape/stl/file", "\"b.stl\": the STL file cannot be opened (No such file", 1},
    {"{\"object\":{\"shape\":{\"stl\":{\"file\":\"bad.stl\"}}}}", STATUS_INVALID,
     "/object/shape/stl/file", "\"bad.stl\": line 7 of the STL file", 1},
    {"{\"object\":{\"shape\":{\"stl\":{\"file\":\"many.stl\"}}}}", STATUS_INVALID,
     "/object/shape/stl/file", "\"many.stl\" has 14744 triangles: at most 14743", 1},
    {"{\"object\":{\"shape\":{\"stl\":{\"file\":\"large.csv\"}}}}", STATUS_INVALID,
     "/object/shape/stl/file", "is cut off, or none", 1},
    {"{\"data\":", STATUS_SYNTAX, "", "", 1},
};

START_TEST(refuses) {
  struct error error = {.status = STATUS_OK};
  ck_assert_ptr_null(embed(refusals[_i].text, &error));
  ck_assert_int_eq(error.status, refusals[_i].status);
  ck_assert_str_eq(error.pointer, refusals[_i].pointer);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s", error.message);
  if (refusals[_i].line > 0) {
    ck_assert_int_eq(error.line, refusals[_i].line);
  }
}
END_TEST

START_TEST(a_reader_of_jobs_opens_no_files) {
  static const char *const texts[][2] = {
      {"{\"kind\":\"response\",\"data\":{\"file\":\"a.csv\"}}", "/data/file"},
      {"{\"kind\":\"response\",\"measured\":{\"data\":{\"file\":\"a.csv\"}}}",
       "/measured/data/file"},
      {"{\"base\":{\"measured\":{\"data\":{\"file\":1}}}}", "/base/measured/data/file"},
      {"{\"laws\":{\"a\":{\"snap\":{\"file\":\"x\"}}}}", "/laws/a/snap/file"},
      {"{\"base\":{\"file\":\"x\"}}", "/base/file"}};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    struct job_spec spec;
    struct error error = {.status = STATUS_OK};
    ck_assert_int_eq(job_spec_read(texts[i][0], strlen(texts[i][0]), &spec, &error),
                     STATUS_INVALID);
    ck_assert_str_eq(error.pointer, texts[i][1]);
    ck_assert_msg(strstr(error.message, "--embed") != NULL, "%s", error.message);
    ck_assert_int_ge(error.line, 1);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: files that it names");
  TCase *tcase = tcase_create("all");
  tcase_add_checked_fixture(tcase, set_up, tear_down);
  tcase_add_test(tcase, text_without_files_is_left_as_it_is);
  tcase_add_test(tcase, tables_become_text);
  tcase_add_test(tcase, a_surface_becomes_base64);
  tcase_add_test(tcase, base64_goes_to_and_fro);
  tcase_add_test(tcase, a_base_becomes_its_document_with_its_own_files);
  tcase_add_test(tcase, a_law_becomes_its_snap_job);
  tcase_add_test(tcase, a_base_that_names_itself_ends);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refusals / sizeof *refusals);
  tcase_add_test(tcase, a_reader_of_jobs_opens_no_files);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
