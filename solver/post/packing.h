/* The parts of surface.bin (see recording.h) and of files like it: a mark, a header in JSON, and a
 * zlib stream of corners and rows. */
#ifndef PNEULAB_POST_PACKING_H
#define PNEULAB_POST_PACKING_H

#include <jansson.h>
#include <stdint.h>
#include <stdio.h>
#include "solver/post/skin.h"

/* What the numbers 0 and 65535 of a row stand for. */
struct packing_range {
  double low, high;
};

/* A range without values, and the one with those of a row besides. */
struct packing_range packing_range_empty(void);
struct packing_range packing_range_with(struct packing_range range, const float *row, size_t count);

/* Writes a row of `count` values as 2 x count bytes; before, earlier: the rows of the two states
 * before, NULL where there is none (an earlier one has one before it). Returns the end. */
unsigned char *packing_row(const float *row, const float *before, const float *earlier,
                           size_t count, struct packing_range range, unsigned char *to);

/* Writes numbers as 4 x count bytes. Returns the end. */
unsigned char *packing_numbers(const uint32_t *number, size_t count, unsigned char *to);

/* Writes the corners of the quadrilaterals of a skin, 64 bytes a face. Returns the end. */
unsigned char *packing_quads(const struct skin *skin, unsigned char *to);

/* Writes the file: mark, header and the compressed stream. Takes over `head`. Failures of writing
 * are left to the caller's ferror; STATUS_NO_MEMORY, also for a head that is NULL. */
enum status packing_write(FILE *file, json_t *head, const unsigned char *stream, size_t size);

#endif
