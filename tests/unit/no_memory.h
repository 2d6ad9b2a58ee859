/* Allocations that fail on demand: those of the program's own code (linked with --wrap), and so of
 * Jansson, and of SQLite. */
#ifndef PNEULAB_TESTS_UNIT_NO_MEMORY_H
#define PNEULAB_TESTS_UNIT_NO_MEMORY_H

#include <stdbool.h>

/* Puts the hooks into SQLite; before it is used. */
void no_memory_install(void);

/* From now on the allocation number `first` fails, counted from 1 over all threads, and with
 * `onwards` all that follow it, too. */
void no_memory_arm(long first, bool onwards);

/* Allocations succeed again. Returns whether one has failed. */
bool no_memory_disarm(void);

#endif
