/* Tables of numbers in text: columns separated by commas, semicolons or tabs, found by name. */
#ifndef PNEULAB_BASE_TABLE_H
#define PNEULAB_BASE_TABLE_H

#include <stddef.h>
#include "solver/base/error.h"

enum {
  TABLE_ROWS_MAX = 10000,
  TABLE_FIELDS_MAX = 256, /* columns that a text may have */
  TABLE_WANTED_MAX = 5    /* columns that are read of it */
};

/* A column to be read. */
struct table_column {
  const char *name;    /* in the header */
  const char *pointer; /* JSON pointer to that name in the job, for errors */
};

struct table {
  size_t rows;
  double *value[TABLE_WANTED_MAX]; /* of each wanted column, `rows` finite numbers */
  int *line;                       /* of each row, the line of the text that it stands in, from 1 */
  char delimiter;                  /* as found: ',', ';' or a tab */
};

/* Reads `count` wanted columns of the table in `text` into *table, which the caller releases.
 *
 * The delimiter is the one that divides most lines; of equals a tab goes before a semicolon and
 * that before a comma. Lines above the header are skipped: the header is the first line with all
 * wanted names (or with the most of them, for errors). A line of units in brackets may follow it.
 * Empty lines are skipped. Fields may be in double quotes, lines may end in CR, LF or both, a byte
 * order mark is skipped. Between semicolons or tabs numbers may have a decimal comma, but all of
 * the same kind.
 *
 * pointer: JSON pointer to the text in the job, for errors.
 * STATUS_INVALID with the line of the text in the message: a name that is not in the header or
 * twice in it, text or nothing where a number is due, numbers that are not finite, no rows, an
 * open quote; STATUS_TOO_LARGE for more rows or columns than allowed; STATUS_NO_MEMORY. */
enum status table_read(const char *text, size_t size, const char *pointer,
                       const struct table_column *wanted, size_t count, struct table *table,
                       struct error *error);

/* Releases what a table owns and clears it. */
void table_release(struct table *table);

#endif
