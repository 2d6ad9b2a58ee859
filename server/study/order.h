/* The order in which the members of a study are solved. */
#ifndef PNEULAB_STUDY_ORDER_H
#define PNEULAB_STUDY_ORDER_H

#include "server/study/columns.h"
#include "solver/explore/chain.h"

/* Puts the members into chains of neighbours (solver/explore/chain.h): light ones as they come.
 * Whole numbers without a unit count things, of which another number makes another mesh: they part
 * designs as words do. place[m] is that of member m, order[] the members chain by chain; both are
 * arrays of study->count (and one more), the caller's to free, also after a failure.
 * STATUS_NO_MEMORY. */
enum status order_members(struct columns *columns, const struct study *study,
                          struct chain_place **place, size_t **order, struct error *error);

#endif
