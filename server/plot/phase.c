#include <math.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/hybrid.h"

enum { JUMPS_MOST = 60, GUARDS_MOST = 16 };

/* The states before and after a switch. */
struct jump {
  double time;
  struct point ends[2];
};

static size_t read_jumps(const json_t *result, struct jump jumps[JUMPS_MOST]) {
  const json_t *events = json_object_get(result, "events");
  size_t count = 0;
  for (size_t i = 0; i < json_array_size(events) && count < JUMPS_MOST; i++) {
    const json_t *event = json_array_get(events, i);
    const json_t *ends[2] = {json_object_get(event, "before"), json_object_get(event, "after")};
    jumps[count].time = data_number(event, "time_s");
    bool complete = isfinite(jumps[count].time);
    for (int k = 0; k < 2; k++) {
      struct point *at = &jumps[count].ends[k];
      *at = (struct point){1e3 * data_number(ends[k], "h_m"), data_number(ends[k], "velocity_m_s")};
      complete = complete && isfinite(at->x) && isfinite(at->y);
    }
    count += complete;
  }
  return count;
}

/* The guards that are levels of h, as upright lines. */
static size_t read_guards(const json_t *result, double reach, struct point lines[GUARDS_MOST][2]) {
  const json_t *transitions = json_object_get(json_object_get(result, "model"), "transitions");
  size_t count = 0;
  for (size_t i = 0; i < json_array_size(transitions) && count < GUARDS_MOST; i++) {
    const json_t *when = json_object_get(json_array_get(transitions, i), "when");
    double level = 1e3 * data_number(when, "h_m");
    if (isfinite(level)) {
      lines[count][0] = (struct point){level, -reach};
      lines[count++][1] = (struct point){level, reach};
    }
  }
  return count;
}

static size_t add_guards(struct point lines[GUARDS_MOST][2], size_t guards,
                         struct chart_series *series) {
  for (size_t i = 0; i < guards; i++) {
    series[i] = (struct chart_series){.points = lines[i],
                                      .count = 2,
                                      .guide = true,
                                      .colour = colour_notice,
                                      .width = 1.4,
                                      .dash = DASH_LONG,
                                      .name = i == 0 ? "guard" : NULL};
  }
  return guards;
}

/* The last switch before the first sample of a span, or the first one after its last, if that is
 * what bounds the span; NULL otherwise. */
static const struct jump *bound_of(const struct hybrid *hybrid, size_t span, bool end,
                                   const struct jump jumps[], size_t count) {
  size_t other = end ? span + 1 : span - 1;
  if (other >= hybrid->span_count) {
    return NULL;
  }
  size_t early = end ? span : other;
  double from = hybrid->value[HYBRID_TIME][hybrid->span[early].end - 1];
  double to = hybrid->value[HYBRID_TIME][hybrid->span[early + 1].first];
  const struct jump *found = NULL;
  for (size_t i = 0; i < count; i++) {
    if (jumps[i].time >= from && jumps[i].time <= to && !(end && found)) {
      found = &jumps[i];
    }
  }
  return found;
}

/* The curve of a span from the reset that begins it to the guard that ends it, which lie between
 * samples. */
static enum status read_span(const struct hybrid *hybrid, size_t span, const struct jump jumps[],
                             size_t jump_count, struct point **points, size_t *count,
                             struct error *error) {
  const struct jump *before = bound_of(hybrid, span, false, jumps, jump_count);
  const struct jump *after = bound_of(hybrid, span, true, jumps, jump_count);
  struct point *curve = NULL;
  size_t used = 0;
  enum status status = hybrid_curve(hybrid, HYBRID_H, HYBRID_VELOCITY, hybrid->span[span].first,
                                    hybrid->span[span].end, &curve, &used, error);
  *count = 0;
  *points = status == STATUS_OK ? malloc((used + 2) * sizeof **points) : NULL;
  if (*points) {
    if (before) {
      (*points)[(*count)++] = before->ends[1];
    }
    for (size_t i = 0; i < used; i++) {
      (*points)[(*count)++] = curve[i];
    }
    if (after) {
      (*points)[(*count)++] = after->ends[0];
    } else if (span + 1 < hybrid->span_count) {
      /* What moves on without a reset goes to the first sample of the next mode. */
      size_t next = hybrid->span[span + 1].first;
      (*points)[(*count)++] =
          (struct point){hybrid->value[HYBRID_H][next], hybrid->value[HYBRID_VELOCITY][next]};
    }
  } else if (status == STATUS_OK) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a curve");
  }
  free(curve);
  return status;
}

static enum status add_spans(const struct hybrid *hybrid, const struct jump jumps[],
                             size_t jump_count, struct point *points[HYBRID_SPANS],
                             struct chart_series *series, size_t *count, struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < hybrid->span_count && i < HYBRID_SPANS && status == STATUS_OK; i++) {
    const struct hybrid_span *span = &hybrid->span[i];
    size_t used = 0;
    status = read_span(hybrid, i, jumps, jump_count, &points[i], &used, error);
    series[(*count)++] =
        (struct chart_series){.points = points[i],
                              .count = used,
                              .colour = hybrid_colour(span->mode),
                              .width = 1.8,
                              .name = span->named ? hybrid->mode[span->mode] : NULL};
  }
  return status;
}

enum status draw_phase(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  (void)count;
  struct chart_series series[GUARDS_MOST + HYBRID_SPANS + 2 * JUMPS_MOST];
  struct point lines[GUARDS_MOST][2];
  struct jump jumps[JUMPS_MOST];
  struct point *points[HYBRID_SPANS] = {NULL};
  size_t jump_count = read_jumps(inputs[0].result, jumps), used = 0;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  struct hybrid hybrid;
  enum status status = hybrid_read(inputs[0].result, &hybrid, error);
  if (status == STATUS_OK) {
    double reach = hybrid_reach(&hybrid, HYBRID_VELOCITY);
    used = add_guards(lines, read_guards(inputs[0].result, reach, lines), series);
    status = add_spans(&hybrid, jumps, jump_count, points, series, &used, error);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  for (size_t i = 0; i < jump_count; i++) {
    series[used++] = (struct chart_series){.points = jumps[i].ends,
                                           .count = 2,
                                           .colour = colour_muted,
                                           .width = 1.2,
                                           .dash = DASH_SHORT,
                                           .name = i == 0 ? "reset" : NULL};
    series[used++] = (struct chart_series){.points = jumps[i].ends,
                                           .count = 1,
                                           .colour = colour_notice,
                                           .marker = MARKER_CIRCLE,
                                           .name = i == 0 ? "switch" : NULL};
  }
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  struct chart chart = {.title = "Speed against elongation",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "h (mm)",
                        .y_label = "h' (m/s)",
                        .series = series,
                        .series_count = used,
                        .empty = "No samples were recorded"};
  chart_draw(&chart, canvas);
done:
  for (size_t i = 0; i < HYBRID_SPANS; i++) {
    free(points[i]);
  }
  hybrid_release(&hybrid);
  return status;
}
