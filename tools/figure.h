/* Pictures of the documents that the tools write, and the figures and words in their sources. */
#ifndef PNEULAB_TOOLS_FIGURE_H
#define PNEULAB_TOOLS_FIGURE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include "server/plot/plot.h"

/* Writes a picture of `size` bytes to `path` and frees it. False with the reason on standard
 * error. */
bool figure_save(unsigned char *png, size_t size, const char *path);

/* Draws `plot` from `count` jobs, width x height pixels, into the file `path`. False with the
 * reason on standard error, after the name of the program. */
bool figure_write(const char *program, const char *plot, const struct plot_input *inputs,
                  size_t count, int width, int height, const char *path);

/* Number at `key`, NAN when there is none. Any object may be NULL. */
double figure_number(const json_t *object, const char *key);
/* Text at `key`, "" when there is none. */
const char *figure_text(const json_t *object, const char *key);

#endif
