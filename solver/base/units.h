/* Quantities with units: "50 kPa", "1.5 mm", "2 deg", "9.80665 m/s2", to SI through UDUNITS-2. */
#ifndef PNEULAB_BASE_UNITS_H
#define PNEULAB_BASE_UNITS_H

#include "solver/base/error.h"

/* The unit database. One handle may be used by several threads. */
struct units;

/* Reads the UDUNITS-2 database (about 7 ms) into *units, owned by the caller.
 * STATUS_IO when it cannot be read. */
enum status units_create(struct units **units, struct error *error);
void units_destroy(struct units *units);

/* Reads a quantity that must have the dimension of `unit` ("kPa", "mm", "deg", "kg/m3").
 * text: decimal number, optional space, unit; at most 64 bytes. "deg" is the degree of angle.
 * *value_si: finite, in coherent SI units (m, kg, s, rad); amounts of memory ("2 GiB",
 * "500 MB") in bytes.
 * STATUS_INVALID with a sentence that shows the right form when the number or the unit is
 * missing or malformed, the dimension is another one, the unit has an offset or is
 * logarithmic, or the value is out of range. The error's pointer is left empty. */
enum status units_read(const struct units *units, const char *text, const char *unit,
                       double *value_si, struct error *error);

/* What a unit measures: "a length" of "mm". Static storage. */
const char *units_dimension(const struct units *units, const char *unit);

#endif
