/* Tokens in their file and in memory, buckets of requests, files below a directory. */
#include <check.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "server/auth/limiter.h"
#include "server/auth/tokens.h"
#include "server/base/file.h"
#include "tests/unit/suite.h"

static char data[] = "/tmp/pneulab-auth-XXXXXX";

static void make_data(void) {
  strcpy(data + strlen(data) - 6, "XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(data));
}

static void remove_data(void) {
  file_remove_tree(data);
}

/* Writes a text as the file of tokens. */
static void write_tokens(const char *text) {
  char path[200];
  ck_assert(token_file_path(data, path, sizeof path));
  ck_assert_int_eq(file_write(path, text, strlen(text), NULL), STATUS_OK);
}

START_TEST(tokens_are_kept_as_hashes) {
  struct token_list list = {0}, read;
  struct error error;
  char first[TOKEN_SECRET_SIZE], second[TOKEN_SECRET_SIZE];
  unsigned char hash[TOKEN_HASH_BYTES];
  ck_assert_int_eq(token_file_read(data, &read, &error), STATUS_NOT_FOUND);
  ck_assert_int_eq(token_list_add(&list, "alice", ROLE_SUBMIT, first, &error), STATUS_OK);
  ck_assert_int_eq(token_list_add(&list, "bob", ROLE_READ, second, &error), STATUS_OK);
  ck_assert_int_eq(token_list_add(&list, "bob", ROLE_ADMIN, second, &error), STATUS_CONFLICT);
  ck_assert_int_eq(token_list_add(&list, "b b", ROLE_READ, second, &error), STATUS_INVALID);
  ck_assert_str_ne(first, second);
  ck_assert_uint_eq(strlen(first), TOKEN_SECRET_SIZE - 1);
  ck_assert_int_eq(token_list_revoke(&list, "bob", &error), STATUS_OK);
  ck_assert_int_eq(token_list_rotate(&list, "bob", second, &error), STATUS_NOT_FOUND);
  ck_assert_int_eq(token_file_write(data, &list, &error), STATUS_OK);
  ck_assert_int_eq(token_file_read(data, &read, &error), STATUS_OK);
  ck_assert_uint_eq(read.count, 1);
  ck_assert_str_eq(read.tokens[0].name, "alice");
  ck_assert_int_eq(read.tokens[0].role, ROLE_SUBMIT);
  token_hash(first, hash);
  ck_assert_mem_eq(read.tokens[0].hash, hash, sizeof hash);
  token_list_clear(&list);
  token_list_clear(&read);
}
END_TEST

#define HASH "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
#define BAD_HASH "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdeF"
#define ENTRY(NAME, ROLE, SUM)                                                                     \
  "{\"name\":\"" NAME "\",\"role\":\"" ROLE "\",\"sha256\":\"" SUM "\",\"created\":\"2026\"}"

static const char *const damaged[] = {
    "",
    "{}",
    "[]",
    "{\"tokens\":{}}",
    "{\"tokens\":[1]}",
    "{\"tokens\":[{}]}",
    "{\"tokens\":[" ENTRY("a", "root", HASH) "]}",
    "{\"tokens\":[" ENTRY("a", "none", HASH) "]}",
    "{\"tokens\":[" ENTRY("a", "read", "12") "]}",
    "{\"tokens\":[" ENTRY("a", "read", HASH "0") "]}",
    "{\"tokens\":[" ENTRY("a", "read", "g" HASH) "]}",
    "{\"tokens\":[" ENTRY("a", "read", BAD_HASH) "]}",
    "{\"tokens\":[{\"name\":\"a\",\"role\":\"read\",\"sha256\":\"" HASH
    "\",\"created\":\"2026-01-01T00:00:00.000000000000000Z\"}]}",
    "{\"tokens\":[{\"name\":\"a\",\"role\":\"read\",\"sha256\":\"" HASH
    "\",\"created\":\"2026\",\"more\":1}]}",
    "{\"tokens\":[{\"name\":\"a\",\"role\":\"read\",\"sha256\":\"" HASH "\",\"created\":2026}]}",
    "{\"tokens\":[{\"name\":1,\"role\":\"read\",\"sha256\":\"" HASH "\",\"created\":\"\"}]}",
    "{\"tokens\":[],\"tokens\":[]}",
    "{\"tokens\":[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]"
    "}",
    "{\"tokens\":[" ENTRY("", "read", HASH) "]}",
    "{\"tokens\":[" ENTRY("a", "read", HASH) "," ENTRY("a", "admin", HASH) "]}",
    "{\"tokens\":[" ENTRY("a", "read", HASH) "]",
    "{\"tokens\":[" ENTRY("a", "read", HASH) ",]}"};

START_TEST(damaged_files_are_refused) {
  struct token_list list;
  struct tokens *tokens;
  struct error error;
  write_tokens(damaged[_i]);
  ck_assert_int_eq(token_file_read(data, &list, &error), STATUS_SYNTAX);
  ck_assert_ptr_nonnull(strstr(error.message, "tokens.json"));
  ck_assert_uint_eq(list.count, 0);
  ck_assert_int_eq(tokens_create(data, false, &tokens, &error), STATUS_SYNTAX);
}
END_TEST

START_TEST(tokens_have_their_limits) {
  struct token_list list = {0}, read;
  struct error error;
  char secret[TOKEN_SECRET_SIZE], name[20], path[PATH_MAX + 10];
  for (int i = 0; i < TOKENS_MAX; i++) {
    snprintf(name, sizeof name, "name-%d", i);
    ck_assert_int_eq(token_list_add(&list, name, ROLE_READ, secret, &error), STATUS_OK);
  }
  ck_assert_int_eq(token_list_add(&list, "more", ROLE_READ, secret, &error), STATUS_NO_MEMORY);
  ck_assert_int_eq(token_file_write(data, &list, &error), STATUS_OK);
  ck_assert_int_eq(token_file_read(data, &read, &error), STATUS_OK);
  ck_assert_uint_eq(read.count, TOKENS_MAX);
  token_list_clear(&read);
  memset(path, 'x', sizeof path - 1); /* a path that no file can have */
  path[sizeof path - 1] = '\0';
  ck_assert_int_eq(token_file_read(path, &read, &error), STATUS_TOO_LARGE);
  ck_assert_int_ne(token_file_write(path, &list, &error), STATUS_OK);
  ck_assert_int_eq(token_file_write("/nowhere", &list, &error), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(error.message, "/nowhere/tokens.json"));
  token_file_path(data, path, sizeof path);
  write_tokens("{}");
  ck_assert_int_eq(truncate(path, 2 << 20), 0);
  ck_assert_int_eq(token_file_read(data, &read, &error), STATUS_TOO_LARGE);
  unlink(path);
  mkdir(path, 0700); /* in the place of the file */
  ck_assert_int_eq(token_file_write(data, &list, &error), STATUS_IO);
  snprintf(path, sizeof path, "%s/tokens.json.new", data);
  ck_assert_int_eq(access(path, F_OK), -1); /* nothing is left behind */
  token_list_clear(&list);
}
END_TEST

/* A file that holds one token too many. */
START_TEST(too_many_tokens_are_refused) {
  struct token_list read;
  struct error error;
  char *text = NULL, path[200];
  size_t size;
  FILE *out = open_memstream(&text, &size);
  ck_assert_ptr_nonnull(out);
  for (int i = 0; i <= TOKENS_MAX; i++) {
    fprintf(out, "%s{\"name\":\"n%d\",\"role\":\"read\",\"sha256\":\"" HASH "\",\"created\":\"\"}",
            i == 0 ? "{\"tokens\":[" : ",", i);
  }
  fputs("]}", out);
  fclose(out);
  write_tokens(text);
  ck_assert_int_eq(token_file_read(data, &read, &error), STATUS_SYNTAX);
  ck_assert_uint_eq(read.count, 0);
  free(text);
  token_file_path(data, path, sizeof path);
  unlink(path);
}
END_TEST

START_TEST(tokens_follow_their_file) {
  struct token_list list = {0};
  struct tokens *tokens;
  struct error error;
  struct caller caller;
  char secret[TOKEN_SECRET_SIZE], longer[TOKEN_SECRET_SIZE + 1], path[200];
  ck_assert_int_eq(tokens_create(data, false, &tokens, &error), STATUS_OK);
  ck_assert(!tokens_required(tokens));
  token_list_add(&list, "alice", ROLE_ADMIN, secret, &error);
  token_file_write(data, &list, &error);
  ck_assert(!tokens_check(tokens, secret, &caller));
  tokens_refresh(tokens);
  ck_assert(tokens_required(tokens));
  ck_assert(tokens_check(tokens, secret, &caller));
  ck_assert_str_eq(caller.name, "alice");
  ck_assert_int_eq(caller.role, ROLE_ADMIN);
  snprintf(longer, sizeof longer, "%s0", secret);
  ck_assert(!tokens_check(tokens, longer, &caller));
  ck_assert(!tokens_check(tokens, "", &caller));
  write_tokens("{\"tokens\":[");
  tokens_refresh(tokens);
  ck_assert(tokens_check(tokens, secret, &caller)); /* a damaged file changes nothing */
  token_file_path(data, path, sizeof path);
  unlink(path);
  tokens_refresh(tokens);
  ck_assert(!tokens_check(tokens, secret, &caller));
  ck_assert(tokens_required(tokens)); /* a file that is gone opens nothing */
  tokens_destroy(tokens);
  token_list_clear(&list);
}
END_TEST

START_TEST(buckets_run_dry_and_fill_again) {
  struct limiter *limiter;
  struct timespec pause = {.tv_nsec = 60000000};
  double wait_s;
  ck_assert_int_eq(limiter_create(20, 3, &limiter, NULL), STATUS_OK);
  for (int i = 0; i < 3; i++) {
    ck_assert(limiter_take(limiter, "a", &wait_s));
  }
  ck_assert(!limiter_take(limiter, "a", &wait_s));
  ck_assert(wait_s > 0 && wait_s <= 0.05);
  ck_assert(limiter_take(limiter, "b", &wait_s)); /* others have their own */
  nanosleep(&pause, NULL);
  ck_assert(limiter_take(limiter, "a", &wait_s));
  limiter_destroy(limiter);
  ck_assert_int_eq(limiter_create(0, 0, &limiter, NULL), STATUS_OK);
  for (int i = 0; i < 1000; i++) {
    ck_assert(limiter_take(limiter, "a", &wait_s));
  }
  limiter_destroy(limiter);
}
END_TEST

/* More parties than there is room for: the one that asks all the time is not forgotten. */
START_TEST(many_parties_do_not_empty_the_memory) {
  struct limiter *limiter;
  char party[200];
  double wait_s;
  int taken = 0;
  ck_assert_int_eq(limiter_create(0.001, 2, &limiter, NULL), STATUS_OK);
  for (int i = 0; i < 40000; i++) {
    snprintf(party, sizeof party, "2001:db8::%x", i);
    limiter_take(limiter, party, &wait_s);
    taken += i % 8 == 0 && limiter_take(limiter, "busy", &wait_s);
  }
  ck_assert_int_le(taken, 4);
  memset(party, 'x', sizeof party - 1);
  party[sizeof party - 1] = '\0';
  ck_assert(limiter_take(limiter, party, &wait_s)); /* a long name is cut, not copied beyond */
  limiter_destroy(limiter);
}
END_TEST

START_TEST(files_are_opened_below_a_directory_only) {
  static const char *const refused[] = {"../passwd", "/etc/passwd", "link", "up/file",
                                        "folder",    "pipe",        "none", "folder/../../x"};
  char path[200];
  size_t size = 0;
  snprintf(path, sizeof path, "%s/folder", data);
  mkdir(path, 0700);
  snprintf(path, sizeof path, "%s/folder/file", data);
  ck_assert_int_eq(file_write(path, "abc", 3, NULL), STATUS_OK);
  snprintf(path, sizeof path, "%s/link", data);
  ck_assert_int_eq(symlink("folder/file", path), 0);
  snprintf(path, sizeof path, "%s/up", data);
  ck_assert_int_eq(symlink("folder", path), 0);
  snprintf(path, sizeof path, "%s/pipe", data);
  ck_assert_int_eq(mkfifo(path, 0600), 0);
  int fd = file_open_below(data, "folder/file", &size);
  ck_assert_int_ge(fd, 0);
  ck_assert_uint_eq(size, 3);
  close(fd);
  for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
    ck_assert_msg(file_open_below(data, refused[i], &size) == -1, "%s", refused[i]);
  }
  ck_assert_int_eq(file_open_below("/nowhere", "file", &size), -1);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("access");
  TCase *tests = tcase_create("access");
  tcase_add_checked_fixture(tests, make_data, remove_data);
  tcase_add_test(tests, tokens_are_kept_as_hashes);
  tcase_add_loop_test(tests, damaged_files_are_refused, 0, sizeof damaged / sizeof *damaged);
  tcase_add_test(tests, tokens_have_their_limits);
  tcase_add_test(tests, too_many_tokens_are_refused);
  tcase_add_test(tests, tokens_follow_their_file);
  tcase_add_test(tests, buckets_run_dry_and_fill_again);
  tcase_add_test(tests, many_parties_do_not_empty_the_memory);
  tcase_add_test(tests, files_are_opened_below_a_directory_only);
  suite_add_tcase(suite, tests);
  return suite_run(suite);
}
