#include "server/plot/hybrid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"

/* Part of a range below which a move cannot be seen. */
#define VISIBLE (1.0 / 1500.0)

static const char *const keys[HYBRID_QUANTITIES] = {"time_s", "set_point_kPa", "h_mm",
                                                    "velocity_m_s", "pressure_kPa"};

static size_t find_mode(struct hybrid *hybrid, const char *name) {
  for (size_t i = 0; i < hybrid->mode_count; i++) {
    if (strcmp(hybrid->mode[i], name) == 0) {
      return i;
    }
  }
  if (hybrid->mode_count < HYBRID_MODES) {
    hybrid->mode[hybrid->mode_count++] = name;
  }
  return hybrid->mode_count - 1;
}

/* Reads a sample behind those that are there; false when it is not complete. */
static bool read_sample(const json_t *sample, struct hybrid *hybrid) {
  for (int q = 0; q < HYBRID_QUANTITIES; q++) {
    double value = data_number(sample, keys[q]);
    if (!isfinite(value)) {
      return false;
    }
    hybrid->value[q][hybrid->count] = value;
  }
  return json_is_string(json_object_get(sample, "mode"));
}

/* Whether a switch was made after the time `from` until `to`; *next: of the events, which are in
 * order, the first after that. */
static bool is_switched(const json_t *events, double from, double to, size_t *next) {
  bool found = false;
  for (; *next < json_array_size(events); ++*next) {
    double time = data_number(json_array_get(events, *next), "time_s");
    if (time > to) {
      break;
    }
    found = found || time > from;
  }
  return found;
}

static void extend_span(struct hybrid *hybrid, const char *mode_name, const json_t *events,
                        size_t *next) {
  size_t known = hybrid->mode_count, mode = find_mode(hybrid, mode_name), at = hybrid->count;
  struct hybrid_span *last = hybrid->span_count ? &hybrid->span[hybrid->span_count - 1] : NULL;
  double time = hybrid->value[HYBRID_TIME][at];
  bool switched = false;
  if (last) {
    switched = is_switched(events, hybrid->value[HYBRID_TIME][at - 1], time, next);
    last->ends[1].x = time;
  }
  if (!last || last->mode != mode || switched) {
    last = &hybrid->span[hybrid->span_count++];
    *last = (struct hybrid_span){.first = at,
                                 .mode = mode,
                                 .named = hybrid->mode_count > known,
                                 .ends = {{time, 0}, {time, 0}}};
  }
  last->end = at + 1;
}

enum status hybrid_read(const json_t *result, struct hybrid *hybrid, struct error *error) {
  const json_t *samples = json_object_get(result, "samples");
  const json_t *events = json_object_get(result, "events");
  size_t most = json_array_size(samples), next = 0, index;
  const json_t *sample;
  *hybrid = (struct hybrid){.count = 0};
  bool room = true;
  for (int q = 0; q < HYBRID_QUANTITIES; q++) {
    hybrid->value[q] = malloc((most + 1) * sizeof *hybrid->value[q]);
    room = room && hybrid->value[q];
  }
  hybrid->span = malloc((most + 1) * sizeof *hybrid->span);
  if (!room || !hybrid->span) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while reading %zu samples",
                     most);
  }
  json_array_foreach(samples, index, sample) {
    if (read_sample(sample, hybrid)) {
      extend_span(hybrid, json_string_value(json_object_get(sample, "mode")), events, &next);
      hybrid->count++;
    }
  }
  return STATUS_OK;
}

void hybrid_release(struct hybrid *hybrid) {
  for (int q = 0; q < HYBRID_QUANTITIES; q++) {
    free(hybrid->value[q]);
  }
  free(hybrid->span);
  *hybrid = (struct hybrid){.count = 0};
}

static double smallest_move(const struct hybrid *hybrid, enum hybrid_quantity q) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < hybrid->count; i++) {
    low = fmin(low, hybrid->value[q][i]);
    high = fmax(high, hybrid->value[q][i]);
  }
  return VISIBLE * (high - low);
}

enum status hybrid_curve(const struct hybrid *hybrid, enum hybrid_quantity x,
                         enum hybrid_quantity y, size_t first, size_t end, struct point **points,
                         size_t *count, struct error *error) {
  double dx = smallest_move(hybrid, x), dy = smallest_move(hybrid, y);
  size_t kept = first;
  *count = 0;
  *points = malloc((end - first + 1) * sizeof **points);
  if (!*points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a curve");
  }
  for (size_t i = first; i < end; i++) {
    struct point p = {hybrid->value[x][i], hybrid->value[y][i]};
    struct point last = *count ? (*points)[*count - 1] : p;
    bool far = fabs(p.x - last.x) > dx || fabs(p.y - last.y) > dy;
    /* The point before a move is its corner. */
    if (*count > 0 && far && kept + 1 < i) {
      (*points)[(*count)++] = (struct point){hybrid->value[x][i - 1], hybrid->value[y][i - 1]};
    }
    if (*count == 0 || far || i + 1 == end) {
      (*points)[(*count)++] = p;
      kept = i;
    }
  }
  return STATUS_OK;
}

double hybrid_reach(const struct hybrid *hybrid, enum hybrid_quantity quantity) {
  double reach = 0;
  for (size_t i = 0; i < hybrid->count; i++) {
    reach = fmax(reach, fabs(hybrid->value[quantity][i]));
  }
  return 20 * (reach > 0 ? reach : 1);
}

struct colour hybrid_colour(size_t mode) {
  return colour_series(mode);
}

struct colour hybrid_band(size_t mode) {
  struct colour c = colour_series(mode);
  const double part = 0.13;
  return (struct colour){1 - part * (1 - c.r), 1 - part * (1 - c.g), 1 - part * (1 - c.b)};
}
