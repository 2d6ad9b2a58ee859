#include "server/base/option.h"

#include <arpa/inet.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 100, HELP_COLUMN = 27, LONG_ONLY = 256 };

static enum status take_text(const struct option_row *row, const char *text, char *field,
                             struct error *error) {
  size_t length = strlen(text);
  if (length == 0 || length >= row->size) {
    return error_set(error, STATUS_INVALID, NULL, "--%s takes 1 to %zu characters.", row->name,
                     row->size - 1);
  }
  memcpy(field, text, length + 1);
  return STATUS_OK;
}

static enum status take_list(const struct option_row *row, const char *text, char *field,
                             struct error *error) {
  size_t used = strlen(field), length = strlen(text);
  if (length == 0 || used + 1 + length >= row->size) {
    return error_set(error, STATUS_INVALID, NULL, "--%s takes 1 to %zu characters in all.",
                     row->name, row->size - 2);
  }
  if (used > 0) {
    field[used++] = ',';
  }
  memcpy(field + used, text, length + 1);
  return STATUS_OK;
}

static enum status take_number(const struct option_row *row, const char *text, double *value,
                               struct error *error) {
  char *end;
  errno = 0;
  double number = strtod(text, &end);
  if (end == text || *end != '\0' || errno != 0 || !isfinite(number) || number < row->low ||
      number > row->high) {
    return error_set(error, STATUS_INVALID, NULL,
                     "--%s %s: expected a number from %g to %g, for example --%s %g.", row->name,
                     text, row->low, row->high, row->name, row->low > 1 ? row->low : 1.0);
  }
  *value = number;
  return STATUS_OK;
}

static enum status take_count(const struct option_row *row, const char *text, double *value,
                              struct error *error) {
  enum status status = take_number(row, text, value, error);
  if (status == STATUS_OK && floor(*value) != *value) {
    status = error_set(error, STATUS_INVALID, NULL, "--%s %s: expected a whole number.", row->name,
                       text);
  }
  return status;
}

/* Splits "127.0.0.1:8080" or "[::1]:8080". */
static enum status take_address(const struct option_row *row, const char *text,
                                struct option_address *field, struct error *error) {
  static const struct option_row port_row = {.name = "port", .high = 65535};
  const char *colon = strrchr(text, ':');
  size_t length = colon ? (size_t)(colon - text) : 0;
  char host[sizeof field->host];
  double port = 0;
  if (length > 0 && length < sizeof host) {
    memcpy(host, text, length);
    host[length] = '\0';
    if (host[0] == '[' && host[length - 1] == ']') {
      memmove(host, host + 1, length - 2);
      host[length - 2] = '\0';
    }
    unsigned char raw[16];
    if ((inet_pton(AF_INET, host, raw) == 1 || inet_pton(AF_INET6, host, raw) == 1) &&
        take_count(&port_row, colon + 1, &port, NULL) == STATUS_OK) {
      memcpy(field->host, host, sizeof host);
      field->port = (unsigned)port;
      return STATUS_OK;
    }
  }
  return error_set(error, STATUS_INVALID, NULL,
                   "--%s %s: expected a numeric address and a port, for example "
                   "127.0.0.1:8080 or [::1]:8080.",
                   row->name, text);
}

static enum status take_word(const struct option_row *row, const char *text, unsigned *field,
                             struct error *error) {
  const char *word = row->value;
  for (unsigned i = 0; *word; i++) {
    size_t length = strcspn(word, "|");
    if (strlen(text) == length && memcmp(word, text, length) == 0) {
      *field = i;
      return STATUS_OK;
    }
    word += length + (word[length] == '|');
  }
  return error_set(error, STATUS_INVALID, NULL, "--%s %s: expected one of %s.", row->name, text,
                   row->value);
}

static enum status option_take(const struct option_row *row, const char *text, void *fields,
                               struct error *error) {
  void *field = (char *)fields + row->offset;
  double value = 0;
  enum status status = STATUS_OK;
  switch (row->kind) {
  case OPTION_TEXT:
    return take_text(row, text, field, error);
  case OPTION_LIST:
    return take_list(row, text, field, error);
  case OPTION_NUMBER:
    return take_number(row, text, field, error);
  case OPTION_WORD:
    return take_word(row, text, field, error);
  case OPTION_ADDRESS:
    return take_address(row, text, field, error);
  case OPTION_COUNT:
    status = take_count(row, text, &value, error);
    *(unsigned *)field = (unsigned)value;
    return status;
  case OPTION_MIB:
    status = take_count(row, text, &value, error);
    *(uint64_t *)field = (uint64_t)value << 20;
    return status;
  case OPTION_FLAG:
    *(bool *)field = true;
    return STATUS_OK;
  case OPTION_ACTION:
    *(unsigned *)field = (unsigned)row->low;
    return STATUS_OK;
  }
  return status;
}

enum status option_preset(const struct option_row *rows, size_t count, void *fields,
                          struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    if (rows[i].preset) {
      status = option_take(&rows[i], rows[i].preset, fields, error);
    }
  }
  return status;
}

/* The row that getopt_long's answer stands for, NULL for its complaints. */
static const struct option_row *row_of(const struct option_row *rows, size_t count, int code) {
  if (code >= LONG_ONLY && (size_t)(code - LONG_ONLY) < count) {
    return &rows[code - LONG_ONLY];
  }
  for (size_t i = 0; i < count; i++) {
    if (rows[i].letter != '\0' && rows[i].letter == code) {
      return &rows[i];
    }
  }
  return NULL;
}

enum status option_read(const struct option_row *rows, size_t count, const char *program, int argc,
                        char **argv, void *fields, int *used, bool *stopped, struct error *error) {
  struct option names[ROWS_MAX + 1] = {0};
  char letters[2 * ROWS_MAX + 1] = "";
  char *letter = letters;
  int code;
  for (size_t i = 0; i < count && i < ROWS_MAX; i++) {
    names[i] = (struct option){rows[i].name, rows[i].value ? required_argument : no_argument, NULL,
                               LONG_ONLY + (int)i};
    if (rows[i].letter) {
      *letter++ = rows[i].letter;
      *letter = rows[i].value ? ':' : '\0';
      letter += rows[i].value != NULL;
    }
  }
  *letter = '\0';
  *stopped = false;
  opterr = 0;
  while (!*stopped && (code = getopt_long(argc, argv, letters, names, NULL)) != -1) {
    const struct option_row *row = row_of(rows, count, code);
    if (!row) {
      return error_set(error, STATUS_INVALID, NULL,
                       "Unknown option or missing value; see %s --help.", program);
    }
    enum status status = option_take(row, optarg, fields, error);
    if (status != STATUS_OK) {
      return status;
    }
    *stopped = row->kind == OPTION_ACTION;
  }
  *used = optind;
  return STATUS_OK;
}

void option_help(const struct option_row *rows, size_t count, FILE *out) {
  for (size_t i = 0; i < count; i++) {
    const struct option_row *row = &rows[i];
    int width = row->letter ? fprintf(out, "  -%c, ", row->letter) : fprintf(out, "      ");
    width +=
        fprintf(out, "--%s%s%s", row->name, row->value ? " " : "", row->value ? row->value : "");
    if (width + 2 > HELP_COLUMN) {
      fputc('\n', out);
      width = 0;
    }
    fprintf(out, "%*s%s", HELP_COLUMN - width, "", row->help);
    if (row->preset) {
      fprintf(out, " (default: %s)", row->preset);
    }
    fputc('\n', out);
  }
}
