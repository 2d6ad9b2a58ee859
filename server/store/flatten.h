/* A job document as rows of design_parameter. */
#ifndef PNEULAB_STORE_FLATTEN_H
#define PNEULAB_STORE_FLATTEN_H

#include <jansson.h>
#include <sqlite3.h>
#include <stdint.h>

#include "solver/base/error.h"

struct units;

/* Inserts one row for every leaf of the document but its name, its labels and what is about the
 * queue: quantities in SI with their unit, numbers and flags as they are, words as text. To be
 * called in a transaction. */
enum status flatten_store(sqlite3 *db, int64_t job_id, const json_t *root,
                          const struct units *units, struct error *error);

#endif
