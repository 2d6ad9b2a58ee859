/* A job document as design parameters, one a leaf. */
#ifndef PNEULAB_STORE_FLATTEN_H
#define PNEULAB_STORE_FLATTEN_H

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

#include "solver/base/error.h"

struct units;

/* A leaf of the document: a quantity in SI with its unit, a number or flag as it is, a word as
 * text. Texts live as long as the call that hands it over. */
struct parameter {
  const char *pointer;
  bool has_value;
  double value;
  const char *text, *unit;
};

typedef enum status parameter_take(void *context, const struct parameter *parameter,
                                   struct error *error);

/* Hands over every leaf of a document but its name, its labels and what is about the queue, until
 * take() fails; returns what it has returned last. STATUS_NO_MEMORY. The document is one that was
 * accepted. */
enum status flatten_each(const char *document, const struct units *units, parameter_take *take,
                         void *context, struct error *error);

/* Inserts the rows of design_parameter of a job. They are there from its first attempt or its end
 * on, whichever is first: that keeps the work out of the submission, whose client waits. Members
 * that are cancelled with their study before they start have none. To be called in a
 * transaction. */
enum status flatten_store(sqlite3 *db, int64_t job_id, const struct units *units,
                          struct error *error);

#endif
