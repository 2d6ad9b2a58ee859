#include "server/auth/token_command.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "server/auth/token_file.h"
#include "server/base/file.h"
#include "server/base/option.h"

struct command {
  char data[PATH_MAX];
  unsigned role; /* index among the words of --role */
  unsigned help;
};

#define FIELD(member) offsetof(struct command, member), sizeof(((struct command *)0)->member)

static const struct option_row rows[] = {
    {OPTION_TEXT, 'd', "data", "DIR", FIELD(data), 0, 0, "var", "the daemon's data directory"},
    {OPTION_WORD, 'r', "role", "read|submit|admin", FIELD(role), 0, 0, "read",
     "what a new token may do"},
    {OPTION_ACTION, 'h', "help", NULL, FIELD(help), 1, 0, NULL, "print this text"},
};

enum { ROW_COUNT = sizeof rows / sizeof *rows };

static void print_help(FILE *out) {
  fputs("usage: pneulabd token add NAME [--role read|submit|admin] [--data DIR]\n"
        "       pneulabd token list|rotate NAME|revoke NAME [--data DIR]\n"
        "Manages the bearer tokens of a daemon. add and rotate print the secret, once.\n\n",
        out);
  option_help(rows, ROW_COUNT, out);
}

/* Keeps other token commands out until the process ends. */
static enum status lock_take(const char *data, int *lock, struct error *error) {
  char path[PATH_MAX];
  int length = snprintf(path, sizeof path, "%s/tokens.lock", data);
  *lock = length > 0 && (size_t)length < sizeof path
              ? open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600)
              : -1;
  if (*lock < 0 || flock(*lock, LOCK_EX) != 0) {
    return error_set(error, STATUS_IO, NULL, "Cannot lock %s/tokens.lock: %s.", data,
                     strerrordesc_np(errno));
  }
  return STATUS_OK;
}

static void print_list(const struct token_list *list) {
  for (size_t i = 0; i < list->count; i++) {
    printf("%-30s %-6s %s\n", list->tokens[i].name, role_word(list->tokens[i].role),
           list->tokens[i].created);
  }
}

/* What the command changes in the list. *secret stays empty when there is no new one. */
static enum status list_change(struct token_list *list, const char *verb, const char *name,
                               enum role role, char secret[TOKEN_SECRET_SIZE],
                               struct error *error) {
  if (strcmp(verb, "add") == 0) {
    return token_list_add(list, name, role, secret, error);
  }
  if (strcmp(verb, "rotate") == 0) {
    return token_list_rotate(list, name, secret, error);
  }
  return token_list_revoke(list, name, error);
}

static enum status command_run(const struct command *command, const char *verb, const char *name,
                               struct error *error) {
  struct token_list list = {0};
  char secret[TOKEN_SECRET_SIZE] = "";
  int lock = -1;
  enum status status = file_make_directory(command->data, error);
  if (status == STATUS_OK) {
    status = lock_take(command->data, &lock, error);
  }
  if (status == STATUS_OK) {
    status = token_file_read(command->data, &list, error);
    status = status == STATUS_NOT_FOUND ? STATUS_OK : status;
  }
  if (status == STATUS_OK && !name) {
    print_list(&list);
  } else if (status == STATUS_OK) {
    status = list_change(&list, verb, name, (enum role)(ROLE_READ + command->role), secret, error);
    if (status == STATUS_OK) {
      status = token_file_write(command->data, &list, error);
    }
    if (status == STATUS_OK && secret[0]) {
      puts(secret);
    }
  }
  explicit_bzero(secret, sizeof secret);
  token_list_clear(&list);
  if (lock >= 0) {
    close(lock);
  }
  return status;
}

/* Whether the words after the options are a command with its arguments. */
static bool words_are_right(char **words, int count) {
  static const char *const named[] = {"add", "rotate", "revoke"};
  if (count == 1) {
    return strcmp(words[0], "list") == 0;
  }
  for (size_t i = 0; count == 2 && i < sizeof named / sizeof *named; i++) {
    if (strcmp(words[0], named[i]) == 0) {
      return true;
    }
  }
  return false;
}

int token_command(int argc, char **argv) {
  struct command command = {.role = 0};
  struct error error;
  int used = 0;
  bool stopped = false;
  if (option_preset(rows, ROW_COUNT, &command, &error) != STATUS_OK ||
      option_read(rows, ROW_COUNT, "pneulabd token", argc, argv, &command, &used, &stopped,
                  &error) != STATUS_OK) {
    fprintf(stderr, "pneulabd token: %s\n", error.message);
    return 2;
  }
  if (command.help) {
    print_help(stdout);
    return EXIT_SUCCESS;
  }
  if (!words_are_right(argv + used, argc - used)) {
    print_help(stderr);
    return 2;
  }
  const char *name = argc - used == 2 ? argv[used + 1] : NULL;
  if (command_run(&command, argv[used], name, &error) != STATUS_OK) {
    fprintf(stderr, "pneulabd token: %s\n", error.message);
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
