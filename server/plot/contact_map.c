/* Contact pressure on the outer surface of the undeformed body, its sides folded out. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/axes.h"
#include "server/plot/contact.h"
#include "server/plot/data.h"
#include "server/plot/draw.h"

/* As they lie when one looks at the bottom with x to the right. */
enum side { SIDE_RIGHT, SIDE_BOTTOM, SIDE_LEFT, SIDE_TOP, SIDES, SIDE_NONE = SIDES };

/* A face belongs to a side when its normal is within 26 degrees of that of the side. */
static const double ALIGNED = 0.9;

/* Less than this part of the scale is no contact that a side would have to be shown for. */
static const double TOUCHED = 0.01;

struct strip {
  const char *name;
  bool shown;
  double low, high; /* mm, of the coordinate across */
  bool downwards;   /* the coordinate grows towards the bottom of the sheet */
};

struct map {
  struct frames frames;
  struct contact_scale scale;
  const struct frames_shot *shot;
  const struct frames_body *body;
  enum side *side; /* of each quadrilateral */
  struct strip strip[SIDES];
  double from, to; /* mm along the body */
};

/* ---- what is shown ----------------------------------------------------------------------- */

static double across_of(enum side side, struct skin_point p) {
  return side == SIDE_BOTTOM || side == SIDE_TOP ? p.y : p.z;
}

static enum side side_of(const struct frames_body *body, size_t quad) {
  const size_t *q = body->quads[quad];
  struct skin_point a = body->rest[q[0]], b = body->rest[q[1]];
  struct skin_point c = body->rest[q[2]], d = body->rest[q[3]];
  struct skin_point e = {c.x - a.x, c.y - a.y, c.z - a.z}, g = {d.x - b.x, d.y - b.y, d.z - b.z};
  double n[3] = {e.y * g.z - e.z * g.y, e.z * g.x - e.x * g.z, e.x * g.y - e.y * g.x};
  double least = ALIGNED * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return least == 0      ? SIDE_NONE
         : n[2] < -least ? SIDE_BOTTOM
         : n[2] > least  ? SIDE_TOP
         : n[1] < -least ? SIDE_RIGHT
         : n[1] > least  ? SIDE_LEFT
                         : SIDE_NONE;
}

/* The shot with the contact that says most: at the peak, else the last one with any. */
static const struct frames_shot *choose_shot(const struct frames *f) {
  static const char *const moments[] = {"peak", "held", "inflated"};
  for (size_t m = 0; m < sizeof moments / sizeof *moments; m++) {
    const struct frames_shot *shot = frames_moment(f, moments[m]);
    if (shot) {
      return shot;
    }
  }
  return &f->shots[f->shot_count - 1];
}

/* The body that is pressed hardest. */
static const struct frames_body *choose_body(const struct frames *f,
                                             const struct frames_shot *shot) {
  const struct frames_body *chosen = f->bodies;
  double most = 0;
  for (size_t b = 0; b < f->body_count; b++) {
    for (size_t p = 0; p < f->bodies[b].point_count; p++) {
      if (shot->contact[f->bodies[b].first + p] > most) {
        most = shot->contact[f->bodies[b].first + p];
        chosen = &f->bodies[b];
      }
    }
  }
  return chosen;
}

/* Sides that are touched are shown, and the bottom in any case. */
static void find_strips(struct map *map) {
  static const char *const names[SIDES] = {"right side", "bottom", "left side", "top"};
  const struct frames_body *body = map->body;
  const double *contact = map->shot->contact + body->first;
  for (int s = 0; s < SIDES; s++) {
    map->strip[s] = (struct strip){.name = names[s],
                                   .shown = s == SIDE_BOTTOM,
                                   .low = INFINITY,
                                   .high = -INFINITY,
                                   .downwards = s != SIDE_RIGHT};
  }
  for (size_t i = 0; i < body->quad_count; i++) {
    map->side[i] = side_of(body, i);
    for (size_t k = 0; k < 4 && map->side[i] != SIDE_NONE; k++) {
      size_t p = body->quads[i][k];
      struct strip *strip = &map->strip[map->side[i]];
      double at = across_of(map->side[i], body->rest[p]);
      strip->low = fmin(strip->low, at);
      strip->high = fmax(strip->high, at);
      strip->shown = strip->shown || contact[p] > TOUCHED * map->scale.top;
      map->from = fmin(map->from, body->rest[p].x);
      map->to = fmax(map->to, body->rest[p].x);
    }
  }
  for (int s = 0; s < SIDES; s++) {
    map->strip[s].shown = map->strip[s].shown && map->strip[s].high > map->strip[s].low;
  }
}

static enum status map_make(const char *directory, enum colour_theme theme, struct map *map,
                            struct error *error) {
  enum status status = frames_read(directory, &map->frames, error);
  if (status == STATUS_OK) {
    status = contact_scale_make(&map->frames, theme, &map->scale, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  map->shot = choose_shot(&map->frames);
  map->body = choose_body(&map->frames, map->shot);
  map->side = malloc((map->body->quad_count + 1) * sizeof *map->side);
  if (!map->side) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the contact pressure");
  }
  map->from = INFINITY;
  map->to = -INFINITY;
  find_strips(map);
  return STATUS_OK;
}

static void map_release(struct map *map) {
  free(map->side);
  frames_release(&map->frames);
}

/* ---- drawing ----------------------------------------------------------------------------- */

static void fill_strip(const struct map *map, enum side side, double scale, struct raster *raster) {
  const struct frames_body *body = map->body;
  const struct strip *strip = &map->strip[side];
  const double *contact = map->shot->contact + body->first;
  for (size_t i = 0; i < body->quad_count; i++) {
    struct raster_vertex corner[4];
    for (size_t k = 0; k < 4 && map->side[i] == side; k++) {
      size_t p = body->quads[i][k];
      double at = across_of(side, body->rest[p]);
      corner[k] = (struct raster_vertex){
          .x = scale * (body->rest[p].x - map->from),
          .y = scale * (strip->downwards ? at - strip->low : strip->high - at),
          .value = contact_scale_at(&map->scale, contact[p])};
    }
    if (map->side[i] == side) {
      struct raster_vertex second[3] = {corner[0], corner[2], corner[3]};
      raster_triangle(raster, corner, map->scale.shades, 1);
      raster_triangle(raster, second, map->scale.shades, 1);
    }
  }
}

static bool draw_strip(const struct map *map, enum side side, struct canvas *canvas,
                       struct box area) {
  struct raster *raster = raster_create((int)ceil(area.width), (int)ceil(area.height), 2);
  struct text_style style = chart_style_tick();
  double u = canvas->unit;
  if (!raster) {
    return false;
  }
  double scale = area.width / (map->to - map->from) * raster->factor;
  fill_strip(map, side, scale, raster);
  bool good = raster_paint(raster, canvas->cr, round(area.x), round(area.y), 1);
  raster_destroy(raster);
  style.colour = colour_ink;
  style.max_width = area.x - 14 * u;
  canvas_text(canvas, area.x - 8 * u, area.y + area.height / 2, 1, 0.5, map->strip[side].name,
              &style);
  return good;
}

/* mm that all strips take across, and their number. */
static double total_height(const struct map *map, size_t *count) {
  double sum = 0;
  *count = 0;
  for (int s = 0; s < SIDES; s++) {
    sum += map->strip[s].shown ? map->strip[s].high - map->strip[s].low : 0;
    *count += map->strip[s].shown;
  }
  return sum;
}

/* The strips at one scale along and across the body. */
static enum status draw_strips(const struct map *map, struct canvas *canvas, struct box area,
                               struct error *error) {
  double u = canvas->unit, left = 84 * u, bottom = 58 * u, gap = 8 * u;
  double bar = chart_bar_room(canvas, &map->scale.bar);
  size_t count;
  double high = total_height(map, &count), length = fmax(map->to - map->from, 1e-6);
  double room = area.height - bottom - gap * (double)(count - 1) - 4 * u;
  double scale = fmin((area.width - left - bar - 8 * u) / length, room / fmax(high, 1e-6));
  if (!(scale * length >= 2) || !(scale * high >= 2)) {
    return error_set(error, STATUS_INVALID, NULL, "the picture is too small for the contact map");
  }
  double used = high * scale + gap * (double)(count - 1);
  struct box strip = {area.x + left, area.y + fmax((room - used) / 3, 0), scale * length, 0};
  struct text_style style = chart_style_label();
  double words, line;
  canvas_measure(canvas, map->scale.bar.label, &style, &words, &line);
  struct box whole = {area.x, strip.y, area.width, fmax(used, fmin(words + 8 * u, room))};
  for (int s = 0; s < SIDES; s++) {
    if (map->strip[s].shown) {
      strip.height = scale * (map->strip[s].high - map->strip[s].low);
      if (!draw_strip(map, (enum side)s, canvas, strip)) {
        return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the contact pressure");
      }
      strip.y += strip.height + gap;
    }
  }
  struct axes axes = {.x_label = "Along the undeformed body (mm)"};
  strip.height = 0;
  struct frame frame = {.area = strip, .x_min = map->from, .x_max = map->to, .y_max = 1};
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, strip.x, strip.y, strip.x + strip.width, strip.y, 1);
  axes_draw_x(canvas, &axes, &frame);
  chart_bar(canvas, &map->scale.bar, whole);
  return STATUS_OK;
}

/* "at the peak: 12.1 N after 42 mm, finger 2 of 3" */
static void describe(const struct map *map, const struct plot_input *input,
                     char text[DATA_HEADING]) {
  char force[TICKS_TEXT], way[TICKS_TEXT], pressure[TICKS_TEXT];
  double moved = data_number(map->shot->head, "displacement_mm");
  ticks_number(data_number(map->shot->head, "grasp_force_N"), 3, force);
  ticks_plain(moved, 3, way);
  ticks_plain(data_number(map->shot->head, "pressure_kPa"), 3, pressure);
  data_subtitle(input, text);
  size_t used = strlen(text);
  snprintf(text + used, DATA_HEADING - used, "%sat %s kPa, %s N", used ? " · " : "", pressure,
           force);
  used = strlen(text);
  if (moved > 0) {
    snprintf(text + used, DATA_HEADING - used, " after %s mm", way);
    used = strlen(text);
  }
  if (map->frames.body_count > 1) {
    snprintf(text + used, DATA_HEADING - used, ", finger %zu of %zu",
             (size_t)(map->body - map->frames.bodies) + 1, map->frames.body_count);
  }
}

enum status draw_contact_map(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error) {
  struct map map = {.body = NULL};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  (void)count;
  enum status status = map_make(inputs[0].artifacts_dir, canvas->theme, &map, error);
  if (status == STATUS_OK) {
    double u = canvas->unit, left = 24 * u;
    describe(&map, &inputs[0], subtitle);
    data_notice(inputs[0].result, notice);
    double top = chart_heading_height(canvas, subtitle, notice);
    chart_heading(canvas, left, "Contact pressure on the body, unrolled", subtitle, notice);
    status = draw_strips(
        &map, canvas,
        (struct box){8 * u, top + 6 * u, canvas->width - 16 * u, canvas->height - top - 12 * u},
        error);
  }
  map_release(&map);
  return status;
}
