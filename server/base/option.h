/* Command lines from a table: each row tells an option's name, what it takes, where the value goes
 * and its line of help. Parsing, --help and the manual page all come from the rows. */
#ifndef PNEULAB_SERVER_OPTION_H
#define PNEULAB_SERVER_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "solver/base/error.h"

enum option_kind {
  OPTION_TEXT,    /* char[size]: 1 to size - 1 characters */
  OPTION_LIST,    /* char[size]: texts joined by commas; given again, it adds to them */
  OPTION_COUNT,   /* unsigned: a whole number from low to high */
  OPTION_NUMBER,  /* double: from low to high, in the unit of the option's value */
  OPTION_MIB,     /* uint64_t in bytes: a whole number of MiB from low to high */
  OPTION_WORD,    /* unsigned: index among the words of `value`*/
  OPTION_FLAG,    /* bool: takes no value and becomes true */
  OPTION_ADDRESS, /* struct option_address */
  OPTION_ACTION   /* unsigned: takes no value, becomes `low`, and reading stops */
};

/* A numeric address without brackets, and a port; 0 picks a free one. */
struct option_address {
  char host[64];
  unsigned port;
};

struct option_row {
  enum option_kind kind;
  char letter;         /* 'd' for -d; 0 for none */
  const char *name;    /* "data" for --data */
  const char *value;   /* what it takes, as help calls it ("DIR"), for OPTION_WORD the words
                          ("local|slurm"); NULL for flags and actions */
  size_t offset, size; /* of the field in the struct that is filled */
  double low, high;    /* limits of numbers; low is the number of an OPTION_ACTION */
  const char *preset; /* the value without the option, as one would give it; NULL: the field's zero,
                         or what the program finds out by itself (then `help` says it) */
  const char *help;   /* one line, lower case, without its default */
};

/* Sets the fields of all rows that have a preset. The rows are the program's own: a preset that
 * is not allowed is a fault of the program. */
enum status option_preset(const struct option_row *rows, size_t count, void *fields,
                          struct error *error);

/* Reads a command line into *fields. *used gets the number of leading elements of argv that
 * belong to options; other arguments are moved behind them. *stopped tells that an OPTION_ACTION
 * ended the reading. STATUS_INVALID with a sentence that names the option, what is allowed and an
 * example; `program` is named in it. At most 100 rows. */
enum status option_read(const struct option_row *rows, size_t count, const char *program, int argc,
                        char **argv, void *fields, int *used, bool *stopped, struct error *error);

/* Writes one line of help for each row. */
void option_help(const struct option_row *rows, size_t count, FILE *out);

#endif
