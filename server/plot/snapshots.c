/* A grasp at its marked moments, in one view and at one scale. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/contact.h"
#include "server/plot/data.h"
#include "server/plot/draw.h"

enum { SHOTS = 4, WORDS = 120 };

/* How much of the object shows beside the body: parts of the body's size. */
static const double OBJECT_REACH = 0.35;

/* How much of what is behind it the object lets through. */
static const double OBJECT_GLASS = 0.5;

/* One moment, ready to be drawn. */
struct scene {
  const struct frames_shot *shot;
  struct skin_point *fingers; /* the points of all fingers, one after another */
  double *values;             /* shades, of the same */
  struct skin_point *object;
  struct solid_box box;
};

struct album {
  struct frames frames;
  struct contact_scale scale;
  struct solid_view view; /* its scale and place are those of no scene */
  struct scene scene[SHOTS];
  size_t count;
  struct solid_edge **edges; /* of each body */
  struct solid_edge *object_edges;
};

/* Number of points of the fingers before this one. */
static size_t finger_first(const struct frames *f, size_t finger) {
  size_t first = 0;
  for (size_t k = 0; k < finger; k++) {
    first += f->bodies[f->fingers[k].body].point_count;
  }
  return first;
}

static struct solid finger_of(const struct frames *f, const struct scene *scene, size_t finger) {
  const struct frames_body *body = &f->bodies[f->fingers[finger].body];
  return (struct solid){scene->fingers + finger_first(f, finger), body->point_count,
                        (const size_t(*)[4])body->quads, body->quad_count, true};
}

static struct solid object_of(const struct frames *f, const struct scene *scene) {
  return (struct solid){scene->object, f->object_point_count, (const size_t(*)[4])f->object_quads,
                        f->object_quad_count, true};
}

/* ---- what is shown ----------------------------------------------------------------------- */

/* The part of a box that is within reach of another one. */
static struct solid_box nearby(struct solid_box box, const struct solid_box *body) {
  double reach = OBJECT_REACH * fmax(body->right - body->left, body->top - body->bottom);
  box.left = fmin(fmax(box.left, body->left - reach), body->left);
  box.right = fmax(fmin(box.right, body->right + reach), body->right);
  box.bottom = fmin(fmax(box.bottom, body->bottom - reach), body->bottom);
  box.top = fmax(fmin(box.top, body->top + reach), body->top);
  return box;
}

static enum status scene_make(const struct frames *f, const struct contact_scale *scale,
                              struct scene *scene, struct error *error) {
  size_t points = finger_first(f, f->finger_count);
  scene->fingers = malloc((points + 1) * sizeof *scene->fingers);
  scene->values = malloc((points + 1) * sizeof *scene->values);
  scene->object = malloc((f->object_point_count + 1) * sizeof *scene->object);
  if (!scene->fingers || !scene->values || !scene->object) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the moments of a grasp");
  }
  for (size_t k = 0; k < f->finger_count; k++) {
    const struct frames_body *own = &f->bodies[f->fingers[k].body];
    size_t from = own->first, to = finger_first(f, k);
    for (size_t p = 0; p < own->point_count; p++) {
      scene->fingers[to + p] = frames_moved(&f->fingers[k].pose, scene->shot->place[from + p]);
      scene->values[to + p] = contact_scale_at(scale, scene->shot->contact[from + p]);
    }
  }
  for (size_t p = 0; p < f->object_point_count; p++) {
    scene->object[p] = frames_moved(&scene->shot->pose, f->object[p]);
  }
  return STATUS_OK;
}

static void scene_bound(const struct frames *f, const struct solid_view *view,
                        struct scene *scene) {
  struct solid_box body = solid_box_empty(), object = solid_box_empty();
  for (size_t k = 0; k < f->finger_count; k++) {
    struct solid finger = finger_of(f, scene, k);
    solid_box_widen(&body, view, &finger);
  }
  struct solid held = object_of(f, scene);
  solid_box_widen(&object, view, &held);
  scene->box = f->object_point_count > 0 ? nearby(object, &body) : body;
}

/* The side from which most of the pressure is seen; the first of them where that is alike. */
static void choose_view(struct album *album) {
  static const struct skin_point sides[] = {{0.42, -1, 0.42}, {0.42, -1, -0.7}, {-0.7, -1, 0.42},
                                            {-0.7, -1, -0.7}, {0.42, 1, 0.42},  {0.42, 1, -0.7},
                                            {-0.7, 1, 0.42},  {-0.7, 1, -0.7}};
  double most = -1;
  for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
    struct solid_view view = solid_view_from(sides[s]);
    double seen = 0;
    for (size_t i = 0; i < album->count; i++) {
      const struct scene *scene = &album->scene[i];
      for (size_t k = 0; k < album->frames.finger_count; k++) {
        struct solid finger = finger_of(&album->frames, scene, k);
        seen += solid_seen(&finger, scene->values + finger_first(&album->frames, k), &view);
      }
    }
    if (seen > 1.001 * most) {
      most = seen;
      album->view = view;
    }
  }
  for (size_t i = 0; i < album->count; i++) {
    scene_bound(&album->frames, &album->view, &album->scene[i]);
  }
}

static enum status find_edges(struct album *album, struct error *error) {
  const struct frames *f = &album->frames;
  struct solid object = object_of(f, album->scene);
  album->object_edges = solid_edges(&object);
  album->edges = calloc(f->body_count, sizeof *album->edges);
  bool good = album->object_edges && album->edges;
  for (size_t b = 0; b < f->body_count && good; b++) {
    const struct frames_body *body = &f->bodies[b];
    struct solid solid = {body->rest, body->point_count, (const size_t(*)[4])body->quads,
                          body->quad_count, true};
    album->edges[b] = solid_edges(&solid);
    good = album->edges[b];
  }
  return good ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for the edges of a grasp");
}

static enum status album_make(const char *directory, enum colour_theme theme, struct album *album,
                              struct error *error) {
  static const char *const moments[SHOTS] = {"before", "inflated", "peak", "held"};
  enum status status = frames_read(directory, &album->frames, error);
  if (status == STATUS_OK) {
    status = contact_scale_make(&album->frames, theme, &album->scale, error);
  }
  for (size_t m = 0; m < SHOTS && status == STATUS_OK; m++) {
    const struct frames_shot *shot = frames_moment(&album->frames, moments[m]);
    bool known = !shot;
    for (size_t i = 0; i < album->count; i++) {
      known = known || album->scene[i].shot == shot;
    }
    if (!known) {
      album->scene[album->count] = (struct scene){.shot = shot};
      status = scene_make(&album->frames, &album->scale, &album->scene[album->count++], error);
    }
  }
  if (status == STATUS_OK && album->count == 0) {
    return error_set(error, STATUS_SYNTAX, NULL, "moments.bin is damaged: it marks no moments");
  }
  if (status == STATUS_OK) {
    choose_view(album);
    status = find_edges(album, error);
  }
  return status;
}

static void album_release(struct album *album) {
  for (size_t i = 0; i < album->count; i++) {
    free(album->scene[i].fingers);
    free(album->scene[i].values);
    free(album->scene[i].object);
  }
  for (size_t b = 0; album->edges && b < album->frames.body_count; b++) {
    free(album->edges[b]);
  }
  free(album->edges);
  free(album->object_edges);
  frames_release(&album->frames);
}

/* ---- drawing ----------------------------------------------------------------------------- */

/* "peak 12.1 N at 42 mm" */
static void name_shot(const struct frames_shot *shot, char text[WORDS]) {
  char force[TICKS_TEXT], way[TICKS_TEXT], pressure[TICKS_TEXT];
  const json_t *names = json_object_get(shot->head, "moments");
  double moved = data_number(shot->head, "displacement_mm");
  size_t used = 0;
  ticks_number(data_number(shot->head, "grasp_force_N"), 3, force);
  ticks_plain(data_number(shot->head, "pressure_kPa"), 3, pressure);
  ticks_plain(moved, 3, way);
  text[0] = '\0';
  for (size_t i = 0; i < json_array_size(names) && used < WORDS - 1; i++) {
    const char *name = json_string_value(json_array_get(names, i));
    bool second = used > 0;
    name = name ? name : "";
    const char *between = second ? ", " : "";
    if (strcmp(name, "inflated") == 0) {
      snprintf(text + used, WORDS - used, "%sinflated to %s kPa", between, pressure);
    } else if (strcmp(name, "peak") == 0) {
      snprintf(text + used, WORDS - used, moved > 0 ? "%speak %s N at %s mm" : "%speak %s N",
               between, force, way);
    } else if (strcmp(name, "held") == 0) {
      snprintf(text + used, WORDS - used, "%sin touch to %s mm", between, way);
    } else {
      snprintf(text + used, WORDS - used, "%s%.20s", between, name);
    }
    used = strlen(text);
  }
}

static void draw_fingers(const struct album *album, const struct scene *scene,
                         const struct canvas *canvas, const struct solid_view *view,
                         struct raster *raster) {
  struct rgb ink = colour_rgb((struct colour){.role = COLOUR_OUTLINE}, canvas->theme);
  double line = fmax(0.8 * canvas->unit * raster->factor, 1.0);
  for (size_t k = 0; k < album->frames.finger_count; k++) {
    struct solid finger = finger_of(&album->frames, scene, k);
    solid_fill(&finger, scene->values + finger_first(&album->frames, k), album->scale.shades, 0.72,
               view, raster);
    solid_outline(&finger, album->edges[album->frames.fingers[k].body], ink, line, view, raster);
  }
}

static void draw_object(const struct album *album, const struct scene *scene,
                        const struct canvas *canvas, const struct solid_view *view,
                        struct raster *raster) {
  struct solid object = object_of(&album->frames, scene);
  struct rgb ink = colour_rgb((struct colour){.role = COLOUR_OUTLINE}, canvas->theme);
  struct rgb shades[RASTER_SHADES];
  for (int i = 0; i < RASTER_SHADES; i++) {
    shades[i] = colour_rgb((struct colour){.role = COLOUR_OBJECT}, canvas->theme);
  }
  solid_fill(&object, NULL, shades, 0.66, view, raster);
  solid_outline(&object, album->object_edges, ink, fmax(0.8 * canvas->unit * raster->factor, 1.0),
                view, raster);
}

/* Where a finger touches the object, whatever of the object is before it. */
static void draw_touch(const struct album *album, const struct scene *scene,
                       const struct solid_view *view, struct raster *raster) {
  raster->lowest = 1;
  for (size_t k = 0; k < album->frames.finger_count; k++) {
    struct solid finger = finger_of(&album->frames, scene, k);
    solid_fill(&finger, scene->values + finger_first(&album->frames, k), album->scale.shades, 0.72,
               view, raster);
  }
}

/* NULL when memory ran out. */
static struct raster *layer_create(struct box area) {
  return raster_create((int)area.width, (int)area.height, 2);
}

/* The object is drawn through glass: once without it, over that once with it, half as strong, and
 * over that what it touches. */
static bool draw_scene(const struct album *album, const struct scene *scene, struct canvas *canvas,
                       struct box area, double scale) {
  struct raster *raster = layer_create(area), *touch = layer_create(area);
  double x = round(area.x), y = round(area.y);
  bool good = raster && touch;
  if (good) {
    struct solid_view view = album->view;
    solid_view_centre(&view, &scene->box, scale * raster->factor, raster);
    draw_fingers(album, scene, canvas, &view, raster);
    good = raster_paint(raster, canvas->cr, x, y, 1);
    if (album->frames.object_quad_count > 0) {
      draw_object(album, scene, canvas, &view, raster);
      draw_touch(album, scene, &view, touch);
      good = good && raster_paint(raster, canvas->cr, x, y, OBJECT_GLASS) &&
             raster_paint(touch, canvas->cr, x, y, 1);
    }
  }
  raster_destroy(raster);
  raster_destroy(touch);
  return good;
}

/* The largest scale, pixels per mm, at which every scene fits into a panel of this size. */
static double find_scale(const struct album *album, double width, double height) {
  double scale = INFINITY;
  for (size_t i = 0; i < album->count; i++) {
    const struct solid_box *box = &album->scene[i].box;
    scale = fmin(scale, width / fmax(box->right - box->left, 1e-6));
    scale = fmin(scale, height / fmax(box->top - box->bottom, 1e-6));
  }
  return 0.96 * scale;
}

static enum status draw_album(const struct album *album, struct canvas *canvas, struct box area,
                              struct error *error) {
  double u = canvas->unit, strip = 34 * u, words = 22 * u, gap = 14 * u;
  struct box inner = {area.x, area.y, area.width - chart_bar_room(canvas, &album->scale.bar) - gap,
                      area.height - strip};
  size_t columns = album->count < 2 || inner.height > 1.4 * inner.width ? 1 : 2;
  columns = inner.width > 2.4 * inner.height ? album->count : columns;
  size_t rows = (album->count + columns - 1) / columns;
  double width = floor(inner.width / (double)columns - gap);
  double height = floor(inner.height / (double)rows - words);
  width = fmax(width, 8);
  height = fmax(height, 8);
  double scale = find_scale(album, width, height);
  for (size_t i = 0; i < album->count; i++) {
    double x = inner.x + (double)(i % columns) * (width + gap);
    double y = inner.y + (double)(i / columns) * (height + words);
    struct text_style style = chart_style_tick();
    char text[WORDS];
    name_shot(album->scene[i].shot, text);
    style.colour = colour_ink;
    style.max_width = width;
    canvas_text(canvas, x, y, 0, 0, text, &style);
    if (!draw_scene(album, &album->scene[i], canvas, (struct box){x, y + words, width, height},
                    scale)) {
      return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while drawing a grasp");
    }
  }
  double base = area.y + area.height - strip / 2;
  double x = contact_ruler(canvas, area.x, base, scale, 0.2 * inner.width) + 24 * u;
  x = contact_key(canvas, x, base, (struct colour){.role = COLOUR_BARE}, "no contact") + 20 * u;
  if (album->frames.object_quad_count > 0) {
    contact_key(canvas, x, base, (struct colour){.role = COLOUR_OBJECT, .fade = 0.3}, "object");
  }
  inner.width = area.width;
  chart_bar(canvas, &album->scale.bar, inner);
  return STATUS_OK;
}

enum status draw_snapshots(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error) {
  struct album album = {.count = 0};
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  (void)count;
  enum status status = album_make(inputs[0].artifacts_dir, canvas->theme, &album, error);
  if (status == STATUS_OK) {
    double u = canvas->unit, left = 24 * u;
    data_subtitle(&inputs[0], subtitle);
    data_notice(inputs[0].result, notice);
    double top = chart_heading_height(canvas, subtitle, notice);
    chart_heading(canvas, left, "The grasp at its moments", subtitle, notice);
    status = draw_album(
        &album, canvas,
        (struct box){left, top, canvas->width - left - 8 * u, canvas->height - top - 6 * u}, error);
  }
  album_release(&album);
  return status;
}
