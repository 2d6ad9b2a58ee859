/* Made-up but plausible results for the tests of the plots. */
#ifndef PNEULAB_TESTS_PLOT_SAMPLES_H
#define PNEULAB_TESTS_PLOT_SAMPLES_H

#include <jansson.h>

/* The result of a finger of 118 mm that bends by `slope` degrees a kPa, a little more once its
 * chambers touch at 17 kPa, with `steps` recorded pressures up to `top_kPa` and the one at 0. */
json_t *plot_sample_result(double slope, double top_kPa, int steps);

/* The boundary of such a finger with `chambers` hollow chambers, at rest and bent by `degrees`. */
json_t *plot_sample_surface(int chambers, double degrees, double top_kPa);

#endif
