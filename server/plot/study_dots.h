/* The members of a study as dots, coloured by a further column. */
#ifndef PNEULAB_PLOT_STUDY_DOTS_H
#define PNEULAB_PLOT_STUDY_DOTS_H

#include "server/plot/study_panel.h"

enum { STUDY_DOTS_WORDS = COLOUR_SERIES_COUNT };

/* How a column becomes colours: a bar for numbers, for words a colour and a line of the key each.
 */
struct study_dots {
  struct study_axis by; /* by.table NULL: one colour */
  struct colour_bar bar;
  char label[STUDY_LABEL];
  struct chart_series key[STUDY_DOTS_WORDS + 2];
  size_t key_count;
};

/* Fills *dots; the key ends with the failed members when there are any and `failed` asks for it.
 * *dots must not move afterwards. */
void study_dots_make(const struct study_table *table, const struct study_axis *by, bool failed,
                     struct study_dots *dots);

/* Colour of a row. */
struct colour study_dots_colour(const struct study_dots *dots, size_t row);

/* Draws all rows that have both coordinates: few of them with rims, of words with a mark each, many
 * as a cloud. STATUS_NO_MEMORY. */
enum status study_dots_draw(const struct study_dots *dots, struct canvas *canvas,
                            const struct frame *frame, const struct study_axis *x,
                            const struct study_axis *y, struct error *error);

#endif
