/* Designs of the robustness benchmark: a Latin hypercube over the dimensions of a pneu-net. */
#ifndef PNEULAB_TESTS_ROBUST_DESIGN_H
#define PNEULAB_TESTS_ROBUST_DESIGN_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

enum robust_factor {
  ROBUST_HEIGHT,
  ROBUST_WIDTH,
  ROBUST_SIDE_WALL,
  ROBUST_TOP_WALL,
  ROBUST_BOTTOM_LAYER,
  ROBUST_GAP,
  ROBUST_GAP_WALL,
  ROBUST_CAVITY,
  ROBUST_TAPER_TOP,
  ROBUST_TAPER_SIDE,
  ROBUST_CHAMBERS,
  ROBUST_TYPE_BASE, /* configuration of the chambers at the base, and at the tip */
  ROBUST_TYPE_TIP,
  ROBUST_SPLIT, /* share of the chambers that belong to the base */
  ROBUST_MATERIAL,
  ROBUST_FACTORS
};

struct robust_options {
  int count;
  uint64_t seed;
  const char *accuracy; /* of the jobs */
  int steps;            /* recorded pressures */
  bool estimate;        /* with error estimates */
};

/* Fills place[count][ROBUST_FACTORS] with a Latin hypercube in [0, 1): in every column each of
 * `count` equal strata holds one design, at a random place in it. Designs that cannot be built, or
 * whose cavities would be thinner than 4 mm across or 2 mm high at the tip, trade strata of one
 * factor with others until all can be built: the strata stay filled once each. False, with a
 * message on standard error, when that does not succeed or memory runs out. */
bool robust_sample(const struct robust_options *options, double (*place)[ROBUST_FACTORS]);

/* The job of a design: 0 to 60 kPa with contact. A new reference, NULL when memory runs out. */
json_t *robust_job(const struct robust_options *options, int index,
                   const double place[ROBUST_FACTORS]);

#endif
