/* Made-up but plausible results of bistable actuators for the tests of the plots. */
#ifndef PNEULAB_TESTS_PLOT_BISTABLE_SAMPLES_H
#define PNEULAB_TESTS_PLOT_BISTABLE_SAMPLES_H

#include <jansson.h>
#include <stdbool.h>

/* A snap whose pressure is a cubic of the elongation with limit points at `trigger_kPa` and below
 * zero, at rest at 0, 9 and 25 mm; with shapes, held forces of 0.8 N/kPa and harmonics, of which
 * n = 9 is lost first, at 0.9 times the trigger pressure. */
json_t *plot_sample_snap(double trigger_kPa);

/* A hybrid model, held at 0 to 50 kPa in steps of 10 and down again, that snaps at `trigger_kPa`;
 * without samples. */
json_t *plot_sample_ladder(double trigger_kPa);

/* An identification of two modes: stiffness falls in the first and stays in the second; every third
 * of nine trials, of 20 s at 10, 20 and 30 kPa, is held out, and measured 1 mm above what is
 * simulated.
 */
json_t *plot_sample_identify(void);

/* Three cells that snap at 1, 2 and 3 s of 4; each adds 10 mm. With `load`: two actuators, an
 * angle, and a load that the plate pushes. */
json_t *plot_sample_motion(bool load);

/* A study whose members are these results, renamed "design 1" and so on. Takes the references. */
json_t *plot_sample_bistable_study(json_t *results[], size_t count);

#endif
