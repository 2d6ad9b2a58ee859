#include "solver/post/packing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { LEVELS = 65535 };

struct packing_range packing_range_empty(void) {
  return (struct packing_range){INFINITY, -INFINITY};
}

struct packing_range packing_range_with(struct packing_range range, const float *row,
                                        size_t count) {
  for (size_t i = 0; i < count; i++) {
    range.low = fmin(range.low, row[i]);
    range.high = fmax(range.high, row[i]);
  }
  return range;
}

static unsigned quantised(float value, struct packing_range range) {
  double span = range.high - range.low;
  double t = span > 0 ? (value - range.low) / span : 0;
  return (unsigned)lround(LEVELS * fmin(fmax(t, 0), 1));
}

unsigned char *packing_row(const float *row, const float *before, const float *earlier,
                           size_t count, struct packing_range range, unsigned char *to) {
  unsigned neighbour = 0;
  for (size_t p = 0; p < count; p++) {
    unsigned value = quantised(row[p], range), expected = neighbour;
    /* what a reader expects who knows all that comes before */
    if (before) {
      expected = quantised(before[p], range);
    }
    if (earlier) {
      expected = 2 * expected - quantised(earlier[p], range);
    }
    unsigned difference = value - expected;
    to[p] = difference & 0xff;
    to[count + p] = difference >> 8 & 0xff;
    neighbour = value;
  }
  return to + 2 * count;
}

/* Puts one number into the four rows of bytes. */
static void put_number(uint32_t number, uint32_t before, size_t place, size_t count,
                       unsigned char *to) {
  uint32_t difference = number - before;
  for (size_t byte = 0; byte < 4; byte++) {
    to[byte * count + place] = difference >> 8 * byte & 0xff;
  }
}

unsigned char *packing_numbers(const uint32_t *number, size_t count, unsigned char *to) {
  for (size_t i = 0; i < count; i++) {
    put_number(number[i], i > 0 ? number[i - 1] : 0, i, count, to);
  }
  return to + 4 * count;
}

unsigned char *packing_quads(const struct skin *skin, unsigned char *to) {
  size_t count = 16 * (size_t)skin->face_count, place = 0;
  uint32_t last = 0;
  for (int f = 0; f < skin->face_count; f++) {
    int quads[4][4];
    skin_face_quads(skin, f, quads);
    for (int n = 0; n < 16; n++) {
      uint32_t corner = (uint32_t)quads[n / 4][n % 4];
      put_number(corner, last, place++, count, to);
      last = corner;
    }
  }
  return to + 4 * count;
}

static void write_parts(FILE *file, const char *text, const unsigned char *packed, size_t size) {
  size_t length = strlen(text);
  unsigned char bytes[4];
  for (size_t i = 0; i < sizeof bytes; i++) {
    bytes[i] = (unsigned char)(length >> 8 * i & 0xff);
  }
  fwrite("PNLSURF1", 1, 8, file);
  fwrite(bytes, 1, sizeof bytes, file);
  fwrite(text, 1, length, file);
  fwrite(packed, 1, size, file);
}

enum status packing_write(FILE *file, json_t *head, const unsigned char *stream, size_t size) {
  uLongf packed_size = compressBound((uLong)size);
  char *text = head ? json_dumps(head, JSON_COMPACT | JSON_REAL_PRECISION(7)) : NULL;
  unsigned char *packed = malloc(packed_size);
  enum status status = text && packed ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK && compress2(packed, &packed_size, stream, (uLong)size, 4) != Z_OK) {
    status = STATUS_NO_MEMORY;
  }
  if (status == STATUS_OK) {
    write_parts(file, text, packed, packed_size);
  }
  json_decref(head);
  free(text);
  free(packed);
  return status;
}
