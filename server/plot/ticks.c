#include "server/plot/ticks.h"

#include <math.h>
#include <stdbool.h>
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

/* ---- logarithmic scales ---- */

/* Position of the k-th of ..., 1, 2, 5, 10, 20, ...; k = 0 is 1. */
static double position_125(double k) {
  static const double digits[3] = {0, 0.301029995663981195, 0.698970004336018805};
  double decade = floor(k / 3);
  return decade + digits[(int)(k - 3 * decade)];
}

/* Whether powers of ten alone are enough. */
static bool wide(double min, double max, int target) {
  return 3 * (max - min) > 1.5 * target;
}

void ticks_widen_log(double *min, double *max, int target) {
  if (!isfinite(*min) || !isfinite(*max)) {
    *min = -1;
    *max = 0;
  }
  bool decades = wide(*min, *max, target);
  double low = 3 * floor(*min), high = 3 * ceil(*max), step = decades ? 3 : 1;
  while (position_125(low + step) <= *min + 1e-9) {
    low += step;
  }
  while (position_125(high - step) >= *max - 1e-9) {
    high -= step;
  }
  if (high <= low) {
    low -= step;
    high = low + 2 * step;
  }
  *min = position_125(low);
  *max = position_125(high);
}

struct ticks ticks_make_log(double min, double max, int target) {
  double slack = 1e-6;
  if (wide(min, max, target)) {
    struct ticks ticks = {.scale = TICKS_DECADES, .step = ceil((max - min) / target - slack)};
    ticks.first = ceil(min / ticks.step - slack);
    ticks.count = (int)(floor(max / ticks.step + slack) - ticks.first) + 1;
    return ticks;
  }
  struct ticks ticks = {.scale = TICKS_125, .step = 1, .first = 3 * floor(min)};
  while (position_125(ticks.first) < min - slack) {
    ticks.first += 1;
  }
  while (position_125(ticks.first + ticks.count) <= max + slack) {
    ticks.count++;
  }
  return ticks;
}

double ticks_value(const struct ticks *ticks, int i) {
  double steps = ticks->first + (double)i;
  return ticks->scale == TICKS_125 ? position_125(steps) : steps * ticks->step;
}

/* "10" with the exponent raised, in UTF-8. */
static void power_label(int exponent, char text[TICKS_TEXT]) {
  static const char *const raised[10] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                         "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  char digits[12];
  snprintf(digits, sizeof digits, "%d", exponent < 0 ? -exponent : exponent);
  int used = snprintf(text, TICKS_TEXT, "10%s", exponent < 0 ? "\u207b" : "");
  for (const char *c = digits; *c; c++) {
    used += snprintf(text + used, (size_t)(TICKS_TEXT - used), "%s", raised[*c - '0']);
  }
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

/* Whether all ticks of a logarithmic scale are short enough to be written out. */
static bool written_out(const struct ticks *ticks) {
  double low = ticks_value(ticks, 0), high = ticks_value(ticks, ticks->count - 1);
  return ticks->scale == TICKS_125 && low > -3.5 && high < 5.5;
}

void ticks_label(const struct ticks *ticks, int i, char text[TICKS_TEXT]) {
  double value = ticks_value(ticks, i);
  char plain[TICKS_TEXT];
  if (ticks->scale != TICKS_LINEAR && !written_out(ticks)) {
    double exponent = floor(value + 1e-6), digit = round(pow(10, value - exponent));
    power_label((int)exponent, text);
    if (digit > 1) {
      char power[TICKS_TEXT];
      memcpy(power, text, sizeof power);
      snprintf(text, TICKS_TEXT, "%d\u00b7%.22s", (int)digit, power);
    }
    return;
  }
  if (ticks->scale == TICKS_125 && value > 3.9) {
    /* thousands apart by a narrow space */
    snprintf(text, TICKS_TEXT, "%.0f\u202f000", pow(10, value - 3));
    return;
  }
  if (ticks->scale == TICKS_125) {
    snprintf(plain, sizeof plain, "%.6g", pow(10, value));
  } else if (fabs(value) >= 1e6 || ticks->decimals > 6) {
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
