#include "server/plot/axes.h"

#include <math.h>

/* Design units: tick mark, distance of the numbers, height of a label with its distance, edge;
 * distances of ticks; places from this width on have their words shortened instead of turned. */
enum { TICK = 4, NUMBER_GAP = 5, LABEL = 32, MARGIN = 16 };
enum { X_SPACING = 90, X_NARROW = 55, Y_SPACING = 60, WIDE = 130 };

/* Words that are too long for their places stand on this slant. */
static const double SLANT = -0.6;

static int x_target(const struct canvas *canvas, double width) {
  double spacing = width < 300 * canvas->unit ? X_NARROW : X_SPACING;
  return axes_tick_target(canvas, width, spacing);
}

int axes_tick_target(const struct canvas *canvas, double length, double spacing) {
  int target = (int)(length / (spacing * canvas->unit));
  return target < 2 ? 2 : target > 12 ? 12 : target;
}

double axes_widest_tick(struct canvas *canvas, const struct ticks *ticks) {
  double widest = 0;
  struct text_style style = chart_style_tick();
  for (int i = 0; i < ticks->count; i++) {
    char text[TICKS_TEXT];
    double width, height;
    ticks_label(ticks, i, text);
    canvas_measure(canvas, text, &style, &width, &height);
    widest = fmax(widest, width);
  }
  return widest;
}

static struct ticks make_ticks(bool logarithmic, double from, double to, int target) {
  double min = fmin(from, to), max = fmax(from, to);
  return logarithmic ? ticks_make_log(min, max, target) : ticks_make(min, max, target);
}

static struct ticks x_ticks(const struct canvas *canvas, const struct axes *axes,
                            const struct frame *frame) {
  struct ticks ticks =
      make_ticks(axes->log_x, frame->x_min, frame->x_max, x_target(canvas, frame->area.width));
  if (axes->whole_x && ticks.step < 1) {
    ticks = (struct ticks){.first = ceil(frame->x_min), .step = 1};
    ticks.count = (int)(floor(frame->x_max) - ticks.first) + 1;
  }
  return ticks;
}

static struct ticks y_ticks(const struct canvas *canvas, const struct axes *axes,
                            const struct frame *frame) {
  return make_ticks(axes->log_y, frame->y_min, frame->y_max,
                    axes_tick_target(canvas, frame->area.height, Y_SPACING));
}

/* Width of the longest word beside the y axis, at most a quarter of the sheet. */
static double widest_name(struct canvas *canvas, const struct axes *axes) {
  struct text_style style = chart_style_tick();
  double widest = 0, width, height;
  for (size_t i = 0; i < axes->y_name_count; i++) {
    canvas_measure(canvas, axes->y_names[i], &style, &width, &height);
    widest = fmax(widest, width);
  }
  return fmin(widest, 0.25 * canvas->width);
}

double axes_left_room(struct canvas *canvas, const struct axes *axes, const struct frame *frame) {
  if (axes->no_y_text) {
    return MARGIN * canvas->unit;
  }
  double label = axes->y_label ? LABEL : LABEL - 20;
  if (axes->y_names) {
    return (MARGIN + label) * canvas->unit + widest_name(canvas, axes);
  }
  struct ticks ticks = y_ticks(canvas, axes, frame);
  return (MARGIN + label) * canvas->unit + axes_widest_tick(canvas, &ticks);
}

/* Whether the words fit side by side; *widest becomes the width of the longest, at most `most`. */
static bool names_fit(struct canvas *canvas, const struct axes *axes, double width, double most,
                      double *widest) {
  struct text_style style = chart_style_tick();
  double place = width / (double)axes->x_name_count, height;
  *widest = 0;
  for (size_t i = 0; i < axes->x_name_count; i++) {
    double own;
    canvas_measure(canvas, axes->x_names[i], &style, &own, &height);
    *widest = fmax(*widest, own);
  }
  bool fit = *widest < place - 8 * canvas->unit;
  *widest = fmin(*widest, most);
  return fit;
}

/* How words stand under the axis. */
struct words {
  double slant;  /* radians: 0 beside each other, SLANT, or upright when they are close */
  double most;   /* longest word in pixels */
  size_t stride; /* every so many-th is written */
  double room;   /* height in pixels beyond that of level words */
};

static struct words lay_words(struct canvas *canvas, const struct axes *axes, double width) {
  struct text_style style = chart_style_tick();
  struct words words = {.most = 0.26 * canvas->height, .stride = 1};
  double line, other, widest, place = width / (double)axes->x_name_count;
  canvas_measure(canvas, "Xg", &style, &other, &line);
  bool fit = names_fit(canvas, axes, width, words.most, &widest);
  if (fit || place > WIDE * canvas->unit) {
    words.most = place - 8 * canvas->unit;
    return words;
  }
  words.slant = place * sin(-SLANT) > line ? SLANT : -G_PI / 2;
  while ((double)words.stride * place < line) {
    words.stride++;
  }
  words.room = widest * sin(-words.slant) + (line * cos(words.slant) - line) / 2;
  return words;
}

double axes_bottom_room(struct canvas *canvas, const struct axes *axes, double width) {
  double u = canvas->unit;
  if (axes->no_x_text) {
    return 22 * u;
  }
  double room = (axes->x_label ? 60 : 36) * u;
  if (axes->x_names && axes->x_name_count > 0) {
    room += lay_words(canvas, axes, width).room;
  }
  return room;
}

/* Widens twice: a wider range may have coarser ticks. */
static void widen(bool logarithmic, double *min, double *max, int target) {
  for (int pass = 0; pass < 2; pass++) {
    (logarithmic ? ticks_widen_log : ticks_widen)(min, max, target);
  }
}

/* Widens the y range. A low chart has few ticks, to whose multiples a range may have to grow much:
 * then it ends between them. */
static void widen_upwards(const struct axes *axes, struct frame *frame, int target) {
  static const double least_fill = 0.55;
  double low = frame->y_min, high = frame->y_max;
  widen(axes->log_y, &frame->y_min, &frame->y_max, target);
  if (!axes->log_y && high > low && high - low < least_fill * (frame->y_max - frame->y_min)) {
    frame->y_min = low;
    frame->y_max = high;
    widen(false, &frame->y_min, &frame->y_max, 3 * target);
  }
}

void axes_widen(const struct canvas *canvas, const struct axes *axes, struct frame *frame) {
  int across = x_target(canvas, frame->area.width);
  int upwards = axes_tick_target(canvas, frame->area.height, Y_SPACING);
  if (axes->x_names) {
    double names = (double)(axes->x_name_count > 0 ? axes->x_name_count : 1);
    double spare = 0.6 + 0.4 * fmax(4 - names, 0); /* one column alone need not fill the sheet */
    frame->x_min = -spare;
    frame->x_max = names - 1 + spare;
  } else if (axes->whole_x && frame->x_max - frame->x_min < 40) {
    frame->x_min = floor(frame->x_min) - 0.5;
    frame->x_max = ceil(frame->x_max) + 0.5;
  } else {
    widen(axes->log_x, &frame->x_min, &frame->x_max, across);
  }
  if (axes->y_names) {
    frame->y_min = -0.6;
    frame->y_max = (double)axes->y_name_count - 0.4;
  } else {
    widen_upwards(axes, frame, upwards);
  }
}

static void draw_x_numbers(struct canvas *canvas, const struct axes *axes,
                           const struct frame *frame) {
  double u = canvas->unit, bottom = frame->area.y + frame->area.height;
  struct ticks ticks = x_ticks(canvas, axes, frame);
  struct text_style style = chart_style_tick();
  for (int i = 0; i < ticks.count; i++) {
    double x = frame_pixel(frame, (struct point){ticks_value(&ticks, i), frame->y_min}).x;
    canvas_set_colour(canvas, colour_grid);
    canvas_line(canvas, x, frame->area.y, x, bottom, 1);
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, x, bottom, x, bottom + TICK * u, 1);
    if (!axes->no_x_text) {
      char text[TICKS_TEXT];
      ticks_label(&ticks, i, text);
      canvas_text(canvas, x, bottom + (TICK + 4) * u, 0.5, 0, text, &style);
    }
  }
}

static void draw_x_names(struct canvas *canvas, const struct axes *axes,
                         const struct frame *frame) {
  double u = canvas->unit, bottom = frame->area.y + frame->area.height;
  struct text_style style = chart_style_tick();
  struct words words = lay_words(canvas, axes, frame->area.width);
  for (size_t i = 0; i < axes->x_name_count; i++) {
    double x = frame_pixel(frame, (struct point){(double)i, frame->y_min}).x;
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, x, bottom, x, bottom + TICK * u, 1);
    if (axes->no_x_text || i % words.stride != 0) {
      continue;
    }
    if (words.slant == 0) {
      style.max_width = words.most;
      canvas_text(canvas, x, bottom + (TICK + 4) * u, 0.5, 0, axes->x_names[i], &style);
      continue;
    }
    /* no longer than what is left of the sheet on the left */
    style.max_width = fmin(words.most, (x - 4 * u) / fmax(cos(words.slant), 1e-6));
    double aside = words.slant == SLANT ? 4 * u : 0;
    canvas_text_turned(canvas, x + aside, bottom + (TICK + 4) * u, words.slant, 1,
                       words.slant == SLANT ? 0.3 : 0.5, axes->x_names[i], &style);
  }
}

static void draw_y_numbers(struct canvas *canvas, const struct axes *axes,
                           const struct frame *frame) {
  double u = canvas->unit, left = frame->area.x;
  struct ticks ticks = y_ticks(canvas, axes, frame);
  struct text_style style = chart_style_tick();
  for (int i = 0; i < ticks.count; i++) {
    double y = frame_pixel(frame, (struct point){frame->x_min, ticks_value(&ticks, i)}).y;
    canvas_set_colour(canvas, colour_grid);
    canvas_line(canvas, left, y, left + frame->area.width, y, 1);
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, left - TICK * u, y, left, y, 1);
    if (!axes->no_y_text) {
      char text[TICKS_TEXT];
      ticks_label(&ticks, i, text);
      canvas_text(canvas, left - (TICK + NUMBER_GAP) * u, y, 1, 0.5, text, &style);
    }
  }
}

/* Words at their places, of many every so many-th. */
static void draw_y_names(struct canvas *canvas, const struct axes *axes,
                         const struct frame *frame) {
  double u = canvas->unit, left = frame->area.x, width, line;
  struct text_style style = chart_style_tick();
  style.max_width = widest_name(canvas, axes) + 1;
  canvas_measure(canvas, "Xg", &style, &width, &line);
  double place = frame->area.height / (double)axes->y_name_count;
  size_t stride = (size_t)fmax(ceil(line / place), 1);
  for (size_t i = 0; i < axes->y_name_count; i++) {
    double y = frame_pixel(frame, (struct point){frame->x_min, (double)i}).y;
    canvas_set_colour(canvas, colour_muted);
    canvas_line(canvas, left - TICK * u, y, left, y, 1);
    if (!axes->no_y_text && i % stride == 0) {
      canvas_text(canvas, left - (TICK + NUMBER_GAP) * u, y, 1, 0.5, axes->y_names[i], &style);
    }
  }
}

static void draw_x_label(struct canvas *canvas, const struct axes *axes,
                         const struct frame *frame) {
  const struct box *a = &frame->area;
  struct text_style label = chart_style_label();
  if (axes->x_label && !axes->no_x_text) {
    double room = axes_bottom_room(canvas, axes, a->width);
    label.max_width = a->width;
    canvas_text(canvas, a->x + a->width / 2, a->y + a->height + room - MARGIN * canvas->unit, 0.5,
                1, axes->x_label, &label);
  }
}

void axes_draw_x(struct canvas *canvas, const struct axes *axes, const struct frame *frame) {
  if (axes->x_names) {
    draw_x_names(canvas, axes, frame);
  } else {
    draw_x_numbers(canvas, axes, frame);
  }
  draw_x_label(canvas, axes, frame);
}

void axes_draw(struct canvas *canvas, const struct axes *axes, const struct frame *frame,
               bool empty) {
  const struct box *a = &frame->area;
  double bottom = a->y + a->height, right = a->x + a->width;
  if (empty) {
    draw_x_label(canvas, axes, frame);
  } else {
    axes_draw_x(canvas, axes, frame);
    (axes->y_names ? draw_y_names : draw_y_numbers)(canvas, axes, frame);
  }
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, a->x, a->y, a->x, bottom, 1);
  canvas_line(canvas, a->x, bottom, right, bottom, 1);
  if (axes->y_label && !axes->no_y_text) {
    struct text_style label = chart_style_label();
    double room = axes_left_room(canvas, axes, frame);
    label.max_width = a->height;
    canvas_text_upwards(canvas, a->x - room + (MARGIN + 6) * canvas->unit, a->y + a->height / 2,
                        axes->y_label, &label);
  }
}
