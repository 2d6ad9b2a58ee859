#include "server/plot/place.h"

#include <math.h>
#include <stdlib.h>

/* Grows an array to hold one more item; false when memory ran out. */
static bool grow(void **items, size_t *room, size_t count, size_t item_size) {
  if (count < *room) {
    return true;
  }
  size_t wanted = *room ? 2 * *room : 64;
  void *grown = realloc(*items, wanted * item_size);
  if (!grown) {
    return false;
  }
  *items = grown;
  *room = wanted;
  return true;
}

void place_release(struct place *place) {
  free(place->boxes);
  free(place->segments);
  *place = (struct place){0};
}

void place_add_box(struct place *place, struct box box) {
  void *items = place->boxes;
  if (grow(&items, &place->box_room, place->box_count, sizeof box)) {
    place->boxes = items;
    place->boxes[place->box_count++] = box;
  }
}

void place_add_segment(struct place *place, struct place_segment segment) {
  void *items = place->segments;
  if (grow(&items, &place->segment_room, place->segment_count, sizeof segment)) {
    place->segments = items;
    place->segments[place->segment_count++] = segment;
  }
}

static bool boxes_meet(struct box a, struct box b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/* Narrows the part [*from, *to] of a segment to one half plane: start + t delta <= limit. */
static void clip(double start, double delta, double limit, double *from, double *to) {
  if (delta == 0.0) {
    if (start > limit) {
      *to = -1.0;
    }
  } else if (delta > 0.0) {
    *to = fmin(*to, (limit - start) / delta);
  } else {
    *from = fmax(*from, (limit - start) / delta);
  }
}

static bool segment_meets(struct place_segment s, struct box b) {
  double from = 0.0, to = 1.0;
  double dx = s.x1 - s.x0, dy = s.y1 - s.y0;
  clip(s.x0, dx, b.x + b.width, &from, &to);
  clip(-s.x0, -dx, -b.x, &from, &to);
  clip(s.y0, dy, b.y + b.height, &from, &to);
  clip(-s.y0, -dy, -b.y, &from, &to);
  return from <= to;
}

bool place_is_free(const struct place *place, struct box box, double margin) {
  struct box grown = {box.x - margin, box.y - margin, box.width + 2 * margin,
                      box.height + 2 * margin};
  const struct box *bounds = &place->bounds;
  double slack = 0.01;
  if (grown.x < bounds->x - slack || grown.y < bounds->y - slack ||
      grown.x + grown.width > bounds->x + bounds->width + slack ||
      grown.y + grown.height > bounds->y + bounds->height + slack) {
    return false;
  }
  for (size_t i = 0; i < place->box_count; i++) {
    if (boxes_meet(grown, place->boxes[i])) {
      return false;
    }
  }
  for (size_t i = 0; i < place->segment_count; i++) {
    if (segment_meets(place->segments[i], grown)) {
      return false;
    }
  }
  return true;
}

bool place_find(const struct place *place, double width, double height, double margin,
                struct box *found) {
  /* positions as fractions of the free width and height: corners, edges, then the inside */
  static const double corners[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
  enum { STEPS = 12 };
  double free_x = place->bounds.width - width - 2 * margin;
  double free_y = place->bounds.height - height - 2 * margin;
  if (free_x < 0 || free_y < 0) {
    return false;
  }
  for (int i = 0; i < 4 + (STEPS + 1) * (STEPS + 1); i++) {
    double fx = i < 4 ? corners[i][0] : (double)((i - 4) % (STEPS + 1)) / STEPS;
    double fy = i < 4 ? corners[i][1] : (double)((i - 4) / (STEPS + 1)) / STEPS;
    struct box box = {place->bounds.x + margin + fx * free_x,
                      place->bounds.y + margin + fy * free_y, width, height};
    if (place_is_free(place, box, margin)) {
      *found = box;
      return true;
    }
  }
  return false;
}

bool place_find_beside(const struct place *place, double x, double y, double width, double height,
                       double distance, struct box *found) {
  /* where the box lies from the point: -1 left or above, 0 centred, 1 right or below */
  static const int sides[8][2] = {{1, -1}, {1, 0},  {1, 1},  {-1, -1},
                                  {-1, 0}, {-1, 1}, {0, -1}, {0, 1}};
  for (size_t i = 0; i < 8; i++) {
    int sx = sides[i][0], sy = sides[i][1];
    double reach = sx && sy ? 0.7 * distance : distance;
    struct box box = {x + sx * reach + (sx - 1) * 0.5 * width,
                      y + sy * reach + (sy - 1) * 0.5 * height, width, height};
    if (place_is_free(place, box, 1.0)) {
      *found = box;
      return true;
    }
  }
  return false;
}
