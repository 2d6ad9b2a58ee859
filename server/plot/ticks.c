#include "server/plot/ticks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double nice_step(double span, int target) {
  double raw = span / (double)target;
  double power = pow(10.0, floor(log10(raw)));
  double ratio = raw / power;
  double step = ratio < 1.5 ? 1.0 : ratio < 3.5 ? 2.0 : ratio < 7.5 ? 5.0 : 10.0;
  return step * power;
}

struct ticks ticks_make(double min, double max, int target) {
  struct ticks ticks = {.step = nice_step(max - min, target)};
  /* a bound that is a multiple but for rounding still gets its tick */
  double slack = 1e-6;
  ticks.first = ceil(min / ticks.step - slack);
  ticks.count = (int)(floor(max / ticks.step + slack) - ticks.first) + 1;
  int exponent = (int)floor(log10(ticks.step) + 1e-9);
  ticks.decimals = exponent < 0 ? -exponent : 0;
  return ticks;
}

void ticks_widen(double *min, double *max, int target) {
  if (!isfinite(*min) || !isfinite(*max)) {
    *min = 0.0;
    *max = 1.0;
  } else if (*max - *min <= 1e-9 * fmax(fabs(*min), fabs(*max)) || *max <= *min) {
    double half = *min == 0.0 ? 0.5 : 0.25 * fabs(*min);
    *max = *min + half;
    *min = *min - half;
  }
  double step = nice_step(*max - *min, target);
  *min = floor(*min / step + 1e-6) * step;
  *max = ceil(*max / step - 1e-6) * step;
}

double ticks_value(const struct ticks *ticks, int i) {
  return (ticks->first + (double)i) * ticks->step;
}

/* Replaces the hyphen in front of a number (and of an exponent) by U+2212. */
static void true_minus(const char *plain, char text[TICKS_TEXT]) {
  size_t out = 0;
  for (const char *c = plain; *c && out + 4 < TICKS_TEXT; c++) {
    if (*c == '-') {
      memcpy(text + out, "\u2212", 3);
      out += 3;
    } else {
      text[out++] = *c;
    }
  }
  text[out] = '\0';
}

void ticks_label(const struct ticks *ticks, int i, char text[TICKS_TEXT]) {
  double value = ticks_value(ticks, i);
  char plain[TICKS_TEXT];
  if (fabs(value) >= 1e6 || ticks->decimals > 6) {
    snprintf(plain, sizeof plain, "%.4g", value);
  } else {
    snprintf(plain, sizeof plain, "%.*f", ticks->decimals, value == 0.0 ? 0.0 : value);
  }
  true_minus(plain, text);
}

void ticks_number(double value, int digits, char text[TICKS_TEXT]) {
  char plain[TICKS_TEXT];
  double size = fabs(value);
  if (!isfinite(value)) {
    snprintf(plain, sizeof plain, "n/a");
  } else if (size != 0.0 && (size < 1e-4 || size >= 1e7)) {
    snprintf(plain, sizeof plain, "%.*e", digits - 1, value);
  } else {
    int before = size >= 1.0 ? (int)floor(log10(size)) + 1 : 0;
    int decimals = size == 0.0 ? 0 : digits - before;
    if (size < 1.0 && size > 0.0) {
      decimals = digits - 1 - (int)floor(log10(size));
    }
    snprintf(plain, sizeof plain, "%.*f", decimals > 0 ? decimals : 0, value);
  }
  true_minus(plain, text);
}

void ticks_plain(double value, int digits, char text[TICKS_TEXT]) {
  ticks_number(value, digits, text);
  if (strchr(text, '.') && !strchr(text, 'e')) {
    size_t length = strlen(text);
    while (text[length - 1] == '0') {
      length--;
    }
    text[text[length - 1] == '.' ? length - 1 : length] = '\0';
  }
}
