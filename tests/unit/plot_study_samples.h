/* Made-up but plausible studies for the tests of the plots. */
#ifndef PNEULAB_TESTS_PLOT_STUDY_SAMPLES_H
#define PNEULAB_TESTS_PLOT_STUDY_SAMPLES_H

#include <jansson.h>

/* A study of `count` fingers whose gap grows from 1 mm in steps of 1 mm and whose sensitivity
 * falls; with the values that a paper gives for the first three and errors of the metrics. */
json_t *plot_sample_study(size_t count);

/* The same with every member of another name instead of another gap: "3C 2 deg" and so on. */
json_t *plot_sample_designs(size_t count);

/* A ranking of `count` designs under "ranking", best first; the scores follow the formula. */
void plot_sample_rank(json_t *study, size_t count);

/* A grid of side x side pressures of a left and a right row, up to 80 kPa, without the members
 * whose right row has more; the body bends by the sum and twists by the difference. With "mirror".
 */
json_t *plot_sample_grid(int side);

/* Makes the members of a study differ in their meshes alone, finer and finer. */
void plot_sample_meshes(json_t *study);

/* Makes the members of a study have 0, 1, 2, ... suckers. */
void plot_sample_suckers(json_t *study);

/* One spatial response: the body curls out of its plane. */
json_t *plot_sample_spatial(double twist_deg);

#endif
