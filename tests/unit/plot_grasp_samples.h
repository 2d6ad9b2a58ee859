/* Made-up grasps for the tests of the plots. */
#ifndef PNEULAB_TESTS_PLOT_GRASP_SAMPLES_H
#define PNEULAB_TESTS_PLOT_GRASP_SAMPLES_H

#include <jansson.h>

/* The result of a grasp: inflated to 80 kPa, pulled by 150 mm with `peak` N at most, which slips
 * from 24 mm, jumps (a few dynamic steps) at 70 mm and lets go at 131 mm. */
json_t *plot_sample_grasp(double peak);

/* The result of a tip that is pressed against a plate with `most` N at 50 kPa. */
json_t *plot_sample_blocked(double most);

/* Leaves grasp.bin and moments.bin of such a grasp in a folder: a chambered body that winds around
 * a cylinder below it; fingers: 1, or several around the axis of a gripper. */
void plot_sample_frames(const char *directory, int fingers);

#endif
