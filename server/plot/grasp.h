/* What the results of grasps have to draw, read without trusting them. */
#ifndef PNEULAB_PLOT_GRASP_H
#define PNEULAB_PLOT_GRASP_H

#include "server/plot/bundle.h"
#include "server/plot/data.h"

/* Samples of one stage, or of all. */
struct grasp_curve {
  struct point *points;
  bool *dynamic; /* of each point: the step to it was one in time */
  size_t count;
};

/* Whether a result, or a member of a study, has samples of a grasp. */
bool grasp_is_of(const json_t *result);

/* Whether a grasp has samples of a stage: "approach", "inflation", "pull", "release". */
bool grasp_has_stage(const json_t *result, const char *stage);

/* Reads the samples of a stage (NULL: of all), with the one before it, where it begins, that have
 * both numbers, in order; x_key NULL: x is their number. *curve is the caller's to release in
 * either case. STATUS_NO_MEMORY. */
enum status grasp_curve_read(const json_t *result, const char *stage, const char *x_key,
                             const char *y_key, struct grasp_curve *curve, struct error *error);
void grasp_curve_release(struct grasp_curve *curve);

/* The point with the largest y, 0 for an empty curve. */
size_t grasp_curve_peak(const struct grasp_curve *curve);

/* Adds a curve to a chart and, above it in the colour of the second series, its dynamic parts,
 * which the legend names once. like: of the curve; its markers are left out. STATUS_NO_MEMORY. */
enum status grasp_curve_add(struct bundle *bundle, const struct grasp_curve *curve,
                            struct chart_series like, struct error *error);

#endif
