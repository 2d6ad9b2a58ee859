/* Tables as CSV (RFC 4180: commas, CRLF, quotes where a text needs them). */
#ifndef PNEULAB_POST_CSV_H
#define PNEULAB_POST_CSV_H

#include <jansson.h>
#include <stdio.h>

/* One row an object of the array `rows`, after a header with the keys of all of them in the
 * order they first appear. Numbers have up to 15 digits; what an object lacks is empty.
 * Failures of writing are left to the caller's ferror. */
void csv_write_objects(FILE *file, const json_t *rows);

/* The midlines of a result document, one row a point: pressure_kPa, point (counted from 0 at the
 * base), arc_length_mm (along the deformed line, from the base), x_mm, y_mm, z_mm. */
void csv_write_midlines(FILE *file, const json_t *midlines);

#endif
