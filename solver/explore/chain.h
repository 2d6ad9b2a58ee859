/* Chains of designs: the members of a study in an order in which each is near the one before, so
 * that the solve of one can start from the states of its predecessor. */
#ifndef PNEULAB_EXPLORE_CHAIN_H
#define PNEULAB_EXPLORE_CHAIN_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"

enum {
  CHAIN_LENGTH_MAX = 64, /* members of a chain, light ones */
  CHAIN_LENGTH_HEAVY =
      64 /* others: the more of a chain are solved, the more they tell of the next */
};

/* Where a member stands. */
struct chain_place {
  size_t chain;    /* 0, 1, ... */
  size_t position; /* in its chain: 0, 1, ... */
};

/* A dimension in which designs differ. */
struct chain_dimension {
  bool categorical; /* its values are words or counts: two of them are as far apart as can be */
  bool logarithmic; /* distances are those of the logarithms of its (positive) values */
};

/* Most members of a chain in a study of `members`: light ones take milliseconds, so that starting a
 * process costs most; of others there are at least four chains, for workers to share. */
size_t chain_length(size_t members, bool light);

/* Gives each design its place. value[members x dimensions], NAN where a design has none; every
 * dimension is scaled to 0 .. 1 by its extremes. The order is the greedy walk (Rosenkrantz, Stearns
 * and Lewis 1977) from the first design to the nearest one not yet visited, of equals the first;
 * then stretches of it are turned round while that makes it shorter (Croes 1958). Two words are as
 * far apart as all other dimensions together. It is cut into chains of at most `length`: where a
 * word changes, unless the chain has less than a quarter of the length then, or else after the
 * longest leg of its second half. The longest chain is the first one. Without dimensions it is the
 * order of the members. The same values give the same chains, whatever the machine does meanwhile;
 * takes some ten times members^2 x dimensions operations. STATUS_OK or STATUS_NO_MEMORY.
 */
enum status chain_order(const double *value, const struct chain_dimension *dimension,
                        size_t members, size_t dimensions, size_t length, struct chain_place *place,
                        struct error *error);

#endif
