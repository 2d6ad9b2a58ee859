/* Plots: every picture is decoded again and its points looked up, so that what is asserted is what
 * a reader sees. With PLOT_TEST_DIR set, the pictures are left there to look at. */
#ifndef PNEULAB_TESTS_PLOT_PICTURES_H
#define PNEULAB_TESTS_PLOT_PICTURES_H

#include <png.h>
#include "server/plot/plot.h"

/* rgb is the caller's to free. */
struct picture {
  png_image image;
  unsigned char *rgb;
};

/* Decodes a picture and keeps it under `name` (NULL: not). */
struct picture picture_decode(const unsigned char *png, size_t size, const char *name);

/* Draws, decodes and keeps a picture under `name` (NULL: not kept); fails the test when it cannot
 * be drawn. */
struct picture picture_draw(const char *plot, const struct plot_input *inputs, size_t count,
                            int width, int height, const char *name);

/* Asserts that a plot is refused with a sentence; returns with what. */
enum status picture_refuse(const char *plot, const struct plot_input *inputs, size_t count,
                           int width, int height);

/* Draws `plot` of one result at several sizes, from tiny to wide; a title has to be there. */
void picture_at_all_sizes(const char *plot, const json_t *result, const char *name);

/* Draws `plot` of one result with 800 x 600 pixels; metric may be NULL. */
struct picture picture_of(const char *plot, const json_t *result, const char *metric);

/* Asserts that `plot` of one result is refused with a sentence; returns with what. */
enum status picture_refuse_one(const char *plot, const json_t *result, const char *metric);

/* Pixels of a colour in a picture of one result that is drawn for this. */
size_t picture_pixels(const char *plot, const json_t *result, int r, int g, int b);

/* The names that a result offers, in one text. */
const char *picture_offered(const char *kind, const json_t *result, char text[300]);

/* Pixels within a small distance of a colour. */
size_t picture_count(const struct picture *picture, int r, int g, int b);

/* Mean y of the pixels of a colour in columns from <= x < to; NaN when there are none. */
double picture_mean_y(const struct picture *picture, int from, int to, int r, int g, int b);

#endif
