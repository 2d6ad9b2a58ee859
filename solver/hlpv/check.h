/* Sizes of the states of a model, and what about it deserves a warning. */
#ifndef PNEULAB_HLPV_CHECK_H
#define PNEULAB_HLPV_CHECK_H

#include "solver/hlpv/integrator.h"
#include "solver/hlpv/record.h"

/* What the states will be about as large as, from levels, resets, start and set-points. All are
 * positive. */
void check_sizes(const struct hlpv_spec *spec, double size[HLPV_STATES]);

/* Warns of a gamma that looks like one with another unit of pressure. */
void check_model(struct recorder *recorder);

/* Warns of set-points from `time` to `stop` that leave the range of the mode, or at which its
 * coefficients make it unstable; once for each mode and kind. */
void check_coefficients(struct recorder *recorder, int mode, double time,
                        const struct set_point *set_point, double stop);

#endif
