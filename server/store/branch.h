/* Inside lists: the ranges of an index of which a page is put together.
 *
 * In an index (state, name) the jobs of one state stand in the order of their names. A list of all
 * states is the merger of ten such ranges, and nothing has to be sorted or skipped. With a label
 * the table job_label has indices of the same kind, which begin with the label and the kind. */
#ifndef PNEULAB_STORE_BRANCH_H
#define PNEULAB_STORE_BRANCH_H

#include <sqlite3.h>

#include "server/store/store.h"

/* A job's place in the order: by state or name (text), by end (number), then by id. What the order
 * does not use is "" and 0. */
struct place {
  int64_t id;
  int64_t number;
  char *text; /* malloc'd */
};

/* Negative when `a` comes before `b` in an ascending list. */
int place_compare(const struct place *a, const struct place *b);

struct places {
  struct place *list;
  size_t count, room;
  struct place end; /* with `ended`: what comes after it has not been looked at */
  bool ended;
};

void places_clear(struct places *places);

/* Collects, of every range that the query takes in, the first `most` places after `after` (NULL:
 * from the beginning), and sorts them. Where several labels hardly ever meet, a range is looked
 * through for a limited number of rows only; then places->end, which comes after `after`, says how
 * far the list is known. */
enum status branches_collect(sqlite3 *db, const struct list_query *query, const struct place *after,
                             size_t most, struct places *places, struct error *error);

#endif
