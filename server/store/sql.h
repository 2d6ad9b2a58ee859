/* Short forms for SQLite statements. */
#ifndef PNEULAB_STORE_SQL_H
#define PNEULAB_STORE_SQL_H

#include <sqlite3.h>
#include <stdarg.h>
#include <stdint.h>

#include "solver/base/error.h"

/* Fills *error from the connection's last error: STATUS_CONFLICT for a broken constraint,
 * STATUS_NO_MEMORY, STATUS_TOO_LARGE, STATUS_NO_SPACE for a full disk, STATUS_BUSY when another
 * program holds the file, STATUS_DAMAGED for a file that is no sound database, else STATUS_IO. */
enum status sql_fail(sqlite3 *db, struct error *error);

/* The status that stands for a result code of SQLite; system_code: errno of its last system call,
 * or 0. */
enum status sql_status(int code, int system_code);

/* Prepares a statement and binds its parameters in order. types: one letter a parameter,
 * i (int64_t), d (double), t (const char *, NULL binds SQL NULL), n (nothing: SQL NULL).
 * Texts must live until the statement is done. On success the caller owns *statement and ends with
 * sql_done, or with sqlite3_finalize when its text was made up and will hardly come again. A
 * connection has at most one statement of a text in use at a time. */
enum status sql_prepare(sqlite3 *db, sqlite3_stmt **statement, struct error *error,
                        const char *text, const char *types, ...);

/* Ends the use of a statement; it is kept for the next one of the same text. NULL is fine. */
void sql_done(sqlite3_stmt *statement);

/* Closes a connection and the statements that it keeps. NULL is fine. */
void sql_close(sqlite3 *db);

/* Prepares, binds as above and runs a statement that returns no rows. */
enum status sql_run(sqlite3 *db, struct error *error, const char *text, const char *types, ...);

/* Takes a row of a query. Any status but STATUS_OK ends the reading. */
typedef enum status sql_taker(sqlite3_stmt *row, void *context, struct error *error);

/* Prepares and binds as above, and hands each row to the taker. Returns the first status that is
 * not STATUS_OK. */
enum status sql_each(sqlite3 *db, struct error *error, sql_taker *take, void *context,
                     const char *text, const char *types, ...);
enum status sql_each_list(sqlite3 *db, struct error *error, sql_taker *take, void *context,
                          const char *text, const char *types, va_list arguments);

/* Takers of the first column of one row: an int64_t, or a double. */
enum status sql_take_integer(sqlite3_stmt *row, void *integer, struct error *error);
enum status sql_take_number(sqlite3_stmt *row, void *number, struct error *error);

/* One step. *row tells whether there is a row to read. */
enum status sql_step(sqlite3_stmt *statement, int *row, struct error *error);

/* A text column as malloc'd copy, "" for NULL; NULL only without memory. */
char *sql_text_copy(sqlite3_stmt *statement, int column);

/* A text column, "" for NULL, valid until the next step. */
const char *sql_text(sqlite3_stmt *statement, int column);

#endif
