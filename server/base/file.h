/* Files and directories. Errors name the path and the system's reason. */
#ifndef PNEULAB_SERVER_FILE_H
#define PNEULAB_SERVER_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "solver/base/error.h"

/* Creates the directory and its missing parents (mode 0755). STATUS_IO on failure. */
enum status file_make_directory(const char *path, struct error *error);

/* Removes a directory with everything in it; links are removed, not followed. A path that does
 * not exist is fine. */
void file_remove_tree(const char *path);

/* Reads a regular file of at most `limit` bytes. *data gets `*size` bytes and a NUL, malloc'd,
 * owned by the caller. STATUS_NOT_FOUND, STATUS_TOO_LARGE, STATUS_NO_MEMORY or STATUS_IO. */
enum status file_read(const char *path, size_t limit, char **data, size_t *size,
                      struct error *error);

/* Opens a regular file below a directory for reading: no part of `path` may be a link or lead
 * upwards, so that what a worker leaves in its folder cannot show other files; a pipe does not keep
 * anybody waiting. -1 when there is none. The descriptor is the caller's; *size gets its length. */
int file_open_below(const char *directory, const char *path, size_t *size);

/* Writes the whole file (mode 0644), replacing an old one. STATUS_IO on failure. */
enum status file_write(const char *path, const char *data, size_t size, struct error *error);

/* Makes the content of a file, or the entries of a directory, durable. STATUS_IO, STATUS_NO_SPACE
 * or STATUS_NOT_FOUND. */
enum status file_sync(const char *path, struct error *error);

/* Makes the entry of a file in its directory durable. */
enum status file_sync_parent(const char *path, struct error *error);

/* The bytes that a directory with everything in it takes on the disk, 0 when it is not there. */
int64_t file_tree_bytes(const char *path);

/* Whether name is a plain file name: 1 to 100 of [A-Za-z0-9._-], not starting with a dot. */
bool file_name_is_plain(const char *name);

#endif
