/* Made-up studies with everything that can be drawn of them. */
#ifndef PNEULAB_TESTS_STUDY_PLOT_SAMPLES_H
#define PNEULAB_TESTS_STUDY_PLOT_SAMPLES_H

#include "server/plot/study_plot.h"

/* A study and its analyses; input points into it. */
struct study_sample {
  struct study_table table;
  struct study_plot_input input;
  void *memory[64]; /* freed at the end */
  size_t memory_count;
};

/* `members` designs of five parameters (wall and gap in mm, a logarithmic stiffness in kPa, a shape
 * in words, a number of chambers), spread by a sequence, with three metrics. failed: so many of
 * every hundred failed, for two reasons. The caller calls study_sample_destroy. */
struct study_sample *study_sample_spread(size_t members, int failed);

/* A grid of columns x rows over wall and gap. */
struct study_sample *study_sample_grid(size_t columns, size_t rows, int failed);

/* An optimisation of `members` evaluations. */
struct study_sample *study_sample_course(size_t members);

/* Gives all columns and members this name. */
void study_sample_rename(struct study_sample *sample, const char *name);

void study_sample_destroy(struct study_sample *sample);

#endif
