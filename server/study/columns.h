/* What the members of a study differ in, as columns of numbers and words. */
#ifndef PNEULAB_STUDY_COLUMNS_H
#define PNEULAB_STUDY_COLUMNS_H

#include "server/store/study.h"
#include "solver/base/units.h"
#include "solver/job/study.h"

struct columns;

/* Reads them from a study that was expanded from `document`, which both outlive *columns: the
 * parameters of the document, or of a list of designs all that any of them sets. Where a member
 * does not set one it has the value of the base. A column is one of numbers, in the unit of its
 * first value, when all values are quantities of one dimension; else of words. The caller owns
 * *columns. STATUS_NO_MEMORY. */
enum status columns_create(const struct units *units, const json_t *document,
                           const struct study *study, struct columns **columns,
                           struct error *error);

/* NULL is fine. */
void columns_destroy(struct columns *columns);

/* Their number, and each as the store takes it; texts belong to the columns. */
size_t columns_count(const struct columns *columns);
void columns_parameter(const struct columns *columns, size_t index,
                       struct study_parameter_row *parameter);

/* Fills the values of a member, one for each column. Texts live until the next call for the same
 * `row`, of which there are COLUMNS_ROWS. False without memory. */
enum { COLUMNS_ROWS = 64 };
bool columns_row(struct columns *columns, size_t row, size_t member,
                 struct study_value_row *values);

#endif
