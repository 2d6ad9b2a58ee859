/* Names and units of what results hold, as a reader of a plot expects them. */
#ifndef PNEULAB_PLOT_QUANTITY_H
#define PNEULAB_PLOT_QUANTITY_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* Writes the label of an axis for a key of a result, whose end is its unit: "Suction force (N)" for
 * suction_force_N. A key without a known unit becomes words alone. */
void quantity_label(const char *key, char *text, size_t size);

/* Writes the label without the unit. */
void quantity_name(const char *key, char *text, size_t size);

/* Writes the unit of a key ("" for none): "°/kPa" for sensitivity_deg_per_kPa. */
void quantity_unit(const char *key, char *text, size_t size);

/* Longest unit of quantity_read, with its end. */
enum { QUANTITY_UNIT = 16 };

/* Reads a value as a job gives it: a number, or a text that starts with one. What follows the
 * number is written into unit ("deg" as "°"). False when it is neither, when the number is above
 * 1e9 in size or the unit is longer than QUANTITY_UNIT. */
bool quantity_read(const json_t *value, double *number, char unit[QUANTITY_UNIT]);

/* Reads a pressure as a job gives it, in kPa; NaN when it is none. */
double quantity_pressure_kPa(const json_t *value);

#endif
