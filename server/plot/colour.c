#include "server/plot/colour.h"

#include <math.h>
#include <string.h>

#define RGB(r, g, b)                                                                               \
  { (r) / 255.0, (g) / 255.0, (b) / 255.0 }

static const struct rgb table[THEME_COUNT][COLOUR_ROLES] =
    {
        [THEME_LIGHT] =
            {
                [COLOUR_INK] = RGB(28, 37, 48),
                [COLOUR_MUTED] = RGB(86, 96, 110),
                [COLOUR_GRID] = RGB(228, 231, 235),
                [COLOUR_NOTICE] = RGB(168, 66, 0),
                [COLOUR_PAPER] = RGB(255, 255, 255),
                [COLOUR_FAINT] = RGB(204, 209, 214),
                [COLOUR_SHADE] = RGB(238, 240, 243),
                [COLOUR_EDGE] = RGB(184, 189, 196),
                [COLOUR_COLUMN] = RGB(89, 153, 199),
                [COLOUR_COLUMN_UP] = RGB(153, 201, 235),
                [COLOUR_BODY] = RGB(115, 158, 199),
                [COLOUR_OUTLINE] = RGB(26, 31, 41),
                [COLOUR_SOFT] = RGB(158, 199, 224),
                [COLOUR_BARE] = RGB(206, 211, 217),
                [COLOUR_OBJECT] = RGB(219, 172, 116),
                [COLOUR_SERIES] = RGB(0, 114, 178),
                RGB(213, 94, 0),
                RGB(0, 158, 115),
                RGB(204, 121, 167),
                RGB(86, 180, 233),
                RGB(230, 159, 0),
                RGB(0, 0, 0),
            },
        [THEME_DARK] =
            {
                [COLOUR_INK] = RGB(231, 235, 240),
                [COLOUR_MUTED] = RGB(164, 175, 188),
                [COLOUR_GRID] = RGB(47, 57, 69),
                [COLOUR_NOTICE] = RGB(255, 176, 140),
                [COLOUR_PAPER] = RGB(26, 33, 42),
                [COLOUR_FAINT] = RGB(78, 90, 105),
                [COLOUR_SHADE] = RGB(38, 47, 58),
                [COLOUR_EDGE] = RGB(88, 101, 117),
                [COLOUR_COLUMN] = RGB(79, 146, 199),
                [COLOUR_COLUMN_UP] = RGB(150, 200, 236),
                [COLOUR_BODY] = RGB(108, 156, 204),
                [COLOUR_OUTLINE] = RGB(12, 16, 22),
                [COLOUR_SOFT] = RGB(84, 132, 164),
                [COLOUR_BARE] = RGB(138, 148, 160),
                [COLOUR_OBJECT] = RGB(203, 156, 104),
                [COLOUR_SERIES] = RGB(70, 152, 226),
                RGB(240, 122, 54),
                RGB(34, 190, 146),
                RGB(222, 150, 190),
                RGB(152, 214, 250),
                RGB(240, 184, 62),
                RGB(238, 241, 245),
            },
};

/* What a value that is none looks like. */
static const struct rgb grey[THEME_COUNT] = {RGB(170, 170, 170), RGB(112, 118, 126)};

static const struct rgb area[] = {
    RGB(68, 1, 84),    RGB(70, 50, 126),  RGB(54, 92, 141),  RGB(39, 127, 142),
    RGB(31, 161, 135), RGB(74, 193, 109), RGB(159, 218, 58), RGB(253, 231, 37),
};

enum { LINE_STOPS = 6 };

static const struct rgb line[THEME_COUNT][LINE_STOPS] = {
    {RGB(62, 0, 92), RGB(50, 66, 150), RGB(0, 114, 158), RGB(0, 136, 110), RGB(110, 141, 44),
     RGB(200, 131, 0)},
    {RGB(142, 96, 196), RGB(106, 130, 222), RGB(58, 162, 206), RGB(52, 188, 150), RGB(150, 208, 84),
     RGB(250, 224, 84)},
};

/* Corners of the plane: nothing and x, then y and both. */
static const struct rgb plane[THEME_COUNT][2][2] = {
    {{RGB(194, 196, 201), RGB(230, 133, 0)}, {RGB(0, 115, 189), RGB(41, 13, 56)}},
    {{RGB(104, 112, 122), RGB(240, 150, 40)}, {RGB(60, 156, 236), RGB(245, 238, 250)}},
};

static struct rgb mix(struct rgb a, struct rgb b, double part) {
  return (struct rgb){a.r + part * (b.r - a.r), a.g + part * (b.g - a.g), a.b + part * (b.b - a.b)};
}

static double clamped(double t) {
  return fmin(fmax(t, 0.0), 1.0);
}

static struct rgb interpolate(const struct rgb *stops, size_t count, double t) {
  t = clamped(t) * (double)(count - 1);
  size_t i = (size_t)t;
  if (i > count - 2) {
    i = count - 2;
  }
  return mix(stops[i], stops[i + 1], t - (double)i);
}

static struct rgb pure(struct colour colour, enum colour_theme theme) {
  if (colour.role < COLOUR_ROLES) {
    return table[theme][colour.role];
  }
  if (isnan(colour.x) || isnan(colour.y)) {
    return grey[theme];
  }
  if (colour.role == COLOUR_MAP_PLANE) {
    const struct rgb(*corner)[2] = plane[theme];
    double x = clamped(colour.x), y = clamped(colour.y);
    return mix(mix(corner[0][0], corner[0][1], x), mix(corner[1][0], corner[1][1], x), y);
  }
  return colour.role == COLOUR_MAP_AREA ? interpolate(area, sizeof area / sizeof *area, colour.x)
                                        : interpolate(line[theme], LINE_STOPS, colour.x);
}

struct rgb colour_rgb(struct colour colour, enum colour_theme theme) {
  return mix(pure(colour, theme), table[theme][COLOUR_PAPER], clamped(colour.fade));
}

int colour_theme_of(const char *word, enum colour_theme *theme) {
  static const char *const words[THEME_COUNT] = {"light", "dark"};
  for (int i = 0; i < THEME_COUNT; i++) {
    if (strcmp(word, words[i]) == 0) {
      *theme = (enum colour_theme)i;
      return 1;
    }
  }
  return 0;
}

struct colour colour_series(size_t index) {
  return (struct colour){.role = COLOUR_SERIES + (enum colour_role)(index % COLOUR_SERIES_COUNT)};
}

struct colour colour_fade(struct colour colour, double part) {
  colour.fade = part;
  return colour;
}

struct colour colour_map_area(double t) {
  return (struct colour){.role = COLOUR_MAP_AREA, .x = t};
}

struct colour colour_map_line(double t) {
  return (struct colour){.role = COLOUR_MAP_LINE, .x = t};
}

struct colour colour_map_plane(double x, double y) {
  return (struct colour){.role = COLOUR_MAP_PLANE, .x = x, .y = y};
}
