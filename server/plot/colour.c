#include "server/plot/colour.h"

#include <math.h>

#define RGB(r, g, b)                                                                               \
  { (r) / 255.0, (g) / 255.0, (b) / 255.0 }

const struct colour colour_ink = RGB(28, 37, 48);
const struct colour colour_muted = RGB(86, 96, 110);
const struct colour colour_grid = RGB(228, 231, 235);
const struct colour colour_notice = RGB(168, 66, 0);
const struct colour colour_paper = RGB(255, 255, 255);

struct colour colour_series(size_t index) {
  static const struct colour okabe_ito[COLOUR_SERIES_COUNT] = {
      RGB(0, 114, 178),  RGB(213, 94, 0),  RGB(0, 158, 115), RGB(204, 121, 167),
      RGB(86, 180, 233), RGB(230, 159, 0), RGB(0, 0, 0),
  };
  return okabe_ito[index % COLOUR_SERIES_COUNT];
}

static struct colour interpolate(const struct colour *stops, size_t count, double t) {
  if (isnan(t)) {
    return (struct colour)RGB(170, 170, 170);
  }
  t = fmin(fmax(t, 0.0), 1.0) * (double)(count - 1);
  size_t i = (size_t)t;
  if (i > count - 2) {
    i = count - 2;
  }
  double f = t - (double)i;
  return (struct colour){stops[i].r + f * (stops[i + 1].r - stops[i].r),
                         stops[i].g + f * (stops[i + 1].g - stops[i].g),
                         stops[i].b + f * (stops[i + 1].b - stops[i].b)};
}

struct colour colour_map_area(double t) {
  static const struct colour stops[] = {
      RGB(68, 1, 84),    RGB(70, 50, 126),  RGB(54, 92, 141),  RGB(39, 127, 142),
      RGB(31, 161, 135), RGB(74, 193, 109), RGB(159, 218, 58), RGB(253, 231, 37),
  };
  return interpolate(stops, sizeof stops / sizeof *stops, t);
}

struct colour colour_map_line(double t) {
  static const struct colour stops[] = {
      RGB(62, 0, 92),   RGB(50, 66, 150),  RGB(0, 114, 158),
      RGB(0, 136, 110), RGB(110, 141, 44), RGB(200, 131, 0),
  };
  return interpolate(stops, sizeof stops / sizeof *stops, t);
}
