/* Reading result documents without trusting them: whatever is missing, of another type or absurd
 * is left out. */
#ifndef PNEULAB_PLOT_DATA_H
#define PNEULAB_PLOT_DATA_H

#include "server/plot/chart.h"
#include "server/plot/plot.h"

enum { DATA_HEADING = 1200 };

/* The number at `key`, or NaN when there is none or its size is above 1e9: no quantity drawn here
 * comes near, and axes stay finite. object may be NULL or anything. */
double data_number(const json_t *object, const char *key);
/* The same for an element of an array. */
double data_element(const json_t *array, size_t index);

/* Pairs (x_key, y_key) of the recorded samples that have both, in order. Allocates *points (free
 * it), NULL when there are none. Error: STATUS_NO_MEMORY. */
enum status data_samples(const json_t *result, const char *x_key, const char *y_key,
                         struct point **points, size_t *count, struct error *error);

/* Drops points of a curve that are within dx and dy of the last one that stays, but for corners and
 * the end. Returns how many stay. */
size_t data_thin(struct point *points, size_t count, double dx, double dy);

/* "job 42 · name" */
void data_subtitle(const struct plot_input *input, char text[DATA_HEADING]);

/* What a reader must know about a result that is not complete ("Stopped early at 31.5 kPa: step
 * below minimum"), or "". */
void data_notice(const json_t *result, char text[DATA_HEADING]);

/* The job's name for a legend: "42 · name". */
void data_name(const struct plot_input *input, char text[DATA_HEADING]);

#endif
