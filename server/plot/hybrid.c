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

/* The name of the mode in which a sample is, NULL for none. */
static const char *mode_of(const json_t *sample) {
  static const char *const names[HYBRID_MODES] = {"no cell stretched",    "one cell stretched",
                                                  "two cells stretched",  "three cells stretched",
                                                  "four cells stretched", "five cells stretched",
                                                  "six cells stretched",  "more cells stretched"};
  const json_t *count = json_object_get(sample, "stretched_cells");
  json_int_t cells = json_integer_value(count);
  if (json_is_integer(count) && cells >= 0) {
    return names[cells < HYBRID_MODES ? cells : HYBRID_MODES - 1];
  }
  return json_string_value(json_object_get(sample, "mode"));
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
  return mode_of(sample) != NULL;
}

/* Whether an event is a switch of modes: those of hybrid models are nothing else. */
static bool is_of_mode(const json_t *event) {
  const char *type = json_string_value(json_object_get(event, "type"));
  return !type || strcmp(type, "snap") == 0 || strcmp(type, "return") == 0;
}

/* Whether a switch was made after the time `from` until `to`; *next: of the events, which are in
 * order, the first after that. */
static bool is_switched(const json_t *events, double from, double to, size_t *next) {
  bool found = false;
  for (; *next < json_array_size(events); ++*next) {
    const json_t *event = json_array_get(events, *next);
    double time = data_number(event, "time_s");
    if (time > to) {
      break;
    }
    found = found || (time > from && is_of_mode(event));
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
      extend_span(hybrid, mode_of(sample), events, &next);
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
  *count = 0;
  *points = malloc((end - first + 1) * sizeof **points);
  if (!*points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a curve");
  }
  for (size_t i = first; i < end; i++) {
    (*points)[(*count)++] = (struct point){hybrid->value[x][i], hybrid->value[y][i]};
  }
  *count = data_thin(*points, *count, smallest_move(hybrid, x), smallest_move(hybrid, y));
  return STATUS_OK;
}

double hybrid_reach(const struct hybrid *hybrid, enum hybrid_quantity quantity) {
  double reach = 0;
  for (size_t i = 0; i < hybrid->count; i++) {
    reach = fmax(reach, fabs(hybrid->value[quantity][i]));
  }
  return 20 * (reach > 0 ? reach : 1);
}

enum status hybrid_add_bands(const struct hybrid *hybrid, bool named, struct bundle *bundle,
                             struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0;
       i < hybrid->span_count && hybrid->span_count <= HYBRID_SPANS && status == STATUS_OK; i++) {
    const struct hybrid_span *span = &hybrid->span[i];
    struct chart_series like = {.style = STYLE_SPAN,
                                .guide = true,
                                .colour = hybrid_band(span->mode),
                                .name = named && span->named ? hybrid->mode[span->mode] : NULL};
    status = bundle_add(bundle, like, span->ends, 2, error);
  }
  return status;
}

enum status hybrid_add_switches(const json_t *result, double reach, const char *name,
                                struct bundle *bundle, struct error *error) {
  const json_t *events = json_object_get(result, "events");
  struct chart_series like = {
      .guide = true, .colour = colour_muted, .width = 1.2, .dash = DASH_SHORT, .name = name};
  enum status status = STATUS_OK;
  size_t most = json_array_size(events) > HYBRID_SPANS ? 0 : json_array_size(events);
  for (size_t i = 0; i < most && status == STATUS_OK; i++) {
    const json_t *event = json_array_get(events, i);
    double time = data_number(event, "time_s");
    if (time >= 0 && is_of_mode(event)) {
      const struct point line[2] = {{time, -reach}, {time, reach}};
      status = bundle_add(bundle, like, line, 2, error);
      like.name = NULL;
    }
  }
  return status;
}

enum status hybrid_add_curve(const struct hybrid *hybrid, enum hybrid_quantity quantity,
                             struct chart_series like, struct bundle *bundle, struct error *error) {
  struct point *points = NULL;
  size_t count = 0;
  enum status status =
      hybrid_curve(hybrid, HYBRID_TIME, quantity, 0, hybrid->count, &points, &count, error);
  if (status == STATUS_OK) {
    status = bundle_add(bundle, like, points, count, error);
  }
  free(points);
  return status;
}

struct colour hybrid_colour(size_t mode) {
  return colour_series(mode);
}

struct colour hybrid_band(size_t mode) {
  return colour_fade(colour_series(mode), 0.87);
}
