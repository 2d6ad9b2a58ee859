/* Inside the store: is this file a sound database of this program? The checks change nothing. */
#ifndef PNEULAB_STORE_CHECK_H
#define PNEULAB_STORE_CHECK_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

#include "solver/base/error.h"

enum { CHECK_APPLICATION_ID = 0x504e4c42 }; /* "PNLB", in the header of our databases */

/* Looks at the file before SQLite does. A file that does not exist is fine unless the directory
 * shows that there was one. STATUS_DAMAGED when the header is none, the file is cut off, or it is
 * missing though jobs have left files; STATUS_CONFLICT when it is no regular file; STATUS_IO. */
enum status check_file(const char *directory, const char *path, struct error *error);

/* Whether the database is ours (or empty) and not newer than schema `newest`: else
 * STATUS_CONFLICT with advice, or STATUS_DAMAGED when that cannot be read. */
enum status check_owner(sqlite3 *db, const char *path, int newest, struct error *error);

/* Runs SQLite's quick check, for at most budget_ms (0: to the end). *complete: whether it came to
 * its end. STATUS_DAMAGED with what was found. */
enum status check_content(sqlite3 *db, const char *path, int64_t budget_ms, bool *complete,
                          struct error *error);

/* STATUS_DAMAGED with the advice that belongs to it. */
enum status check_damaged(const char *path, const char *finding, struct error *error);

#endif
