/* Round numbers for axes. */
#ifndef PNEULAB_PLOT_TICKS_H
#define PNEULAB_PLOT_TICKS_H

#include <stddef.h>

/* Longest text ticks_label and ticks_number write, with its end. */
#define TICKS_TEXT 40

/* What an axis counts in; on the logarithmic scales positions are decimal logarithms. */
enum ticks_scale {
  TICKS_LINEAR,
  TICKS_DECADES, /* powers of ten */
  TICKS_125      /* 1, 2 and 5 times powers of ten */
};

/* The multiples of `step` inside a range: value(i) = (first + i) step, i = 0 .. count-1. On the
 * scale TICKS_125 a step leads from 1 to 2, 5, 10 and so on. */
struct ticks {
  enum ticks_scale scale;
  double first; /* in steps */
  double step;  /* 1, 2 or 5 times a power of ten */
  int count;
  int decimals; /* digits after the point that tell neighbours apart */
};

/* Ticks of [min, max], max > min, about `target` of them (2 to 20), never more than 2 target + 1.
 */
struct ticks ticks_make(double min, double max, int target);

/* The same for an axis whose positions are decimal logarithms. */
struct ticks ticks_make_log(double min, double max, int target);

/* Widens [*min, *max], decimal logarithms, to ticks of the scale that suits `target` of them. */
void ticks_widen_log(double *min, double *max, int target);

/* Widens [*min, *max] to multiples of the step that suits `target` ticks. An empty range (max <=
 * min or not finite) first becomes one around min, or 0 to 1. */
void ticks_widen(double *min, double *max, int target);

/* Position of tick i on the axis. */
double ticks_value(const struct ticks *ticks, int i);

/* Writes the text of tick i with a true minus sign in UTF-8. */
void ticks_label(const struct ticks *ticks, int i, char text[TICKS_TEXT]);

/* Writes a number with `digits` significant digits (1 to 9), without an exponent where a person
 * would not write one, with a true minus sign. */
void ticks_number(double value, int digits, char text[TICKS_TEXT]);

/* Like ticks_number without zeros at the end: "50" and not "50.0". */
void ticks_plain(double value, int digits, char text[TICKS_TEXT]);

#endif
