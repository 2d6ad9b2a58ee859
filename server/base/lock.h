/* The lock that keeps two daemons from using one data directory. */
#ifndef PNEULAB_SERVER_LOCK_H
#define PNEULAB_SERVER_LOCK_H

#include "solver/base/error.h"

/* Creates the directory if need be and takes its lock; closing *lock, or the end of the process
 * however it comes, gives it back. STATUS_CONFLICT when another process has it, STATUS_IO. */
enum status lock_take(const char *directory, int *lock, struct error *error);

#endif
