/* A grasp from its approach to its release: pressure, force and contact one below the other. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/grasp.h"

enum { PANELS = 3, SPANS_MOST = 24, WORD = 40 };

/* A stretch of one stage. */
struct span {
  char stage[WORD];
  struct point ends[2];
};

struct timeline {
  const char *x_key; /* NULL: the samples are counted */
  struct span span[SPANS_MOST];
  size_t span_count;
};

/* Time tells most, unless much of the grasp happens at one time. */
static bool has_time(const json_t *samples) {
  size_t count = json_array_size(samples), moves = 0;
  double last = -INFINITY;
  bool forward = count > 1;
  for (size_t i = 0; i < count; i++) {
    double time = data_number(json_array_get(samples, i), "time_s");
    forward = forward && time >= last;
    moves += time > last;
    last = time;
  }
  return forward && 2 * moves > count;
}

static void find_spans(const json_t *samples, struct timeline *line) {
  double last = 0;
  for (size_t i = 0; i < json_array_size(samples); i++) {
    const json_t *sample = json_array_get(samples, i);
    const char *stage = json_string_value(json_object_get(sample, "stage"));
    double x = line->x_key ? data_number(sample, line->x_key) : (double)i;
    struct span *span = line->span_count > 0 ? &line->span[line->span_count - 1] : NULL;
    stage = stage ? stage : "";
    if ((!span || strncmp(span->stage, stage, WORD - 1) != 0) && line->span_count < SPANS_MOST) {
      /* a step belongs to the stage of its end */
      span = &line->span[line->span_count++];
      snprintf(span->stage, WORD, "%s", stage);
      span->ends[0].x = i > 0 ? last : x;
    }
    if (span) {
      span->ends[1].x = x;
    }
    last = x;
  }
}

static bool is_first(const struct timeline *line, size_t place) {
  bool first = line->span[place].stage[0] != '\0';
  for (size_t i = 0; i < place; i++) {
    first = first && strcmp(line->span[i].stage, line->span[place].stage) != 0;
  }
  return first;
}

static struct colour band_of(const char *stage) {
  static const char *const stages[] = {"approach", "inflation",  "pull",   "release",
                                       "gravity",  "letting go", "suction"};
  size_t place = 0;
  while (place < sizeof stages / sizeof *stages && strcmp(stages[place], stage) != 0) {
    place++;
  }
  return colour_fade(colour_series(place + 2), 0.84);
}

static enum status add_bands(const struct timeline *line, bool named, struct bundle *bundle,
                             struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < line->span_count && status == STATUS_OK; i++) {
    const struct span *span = &line->span[i];
    struct chart_series like = {.style = STYLE_SPAN,
                                .guide = true,
                                .colour = band_of(span->stage),
                                .name = named && is_first(line, i) ? span->stage : NULL};
    status = bundle_add(bundle, like, span->ends, 2, error);
  }
  return status;
}

static enum status add_panel(const json_t *result, const struct timeline *line, const char *key,
                             bool named, struct bundle *bundle, struct error *error) {
  struct grasp_curve curve;
  struct chart_series like = {.colour = colour_series(0), .width = 2.0};
  enum status status = grasp_curve_read(result, NULL, line->x_key, key, &curve, error);
  if (status == STATUS_OK) {
    status = add_bands(line, named, bundle, error);
  }
  if (status == STATUS_OK && curve.count > 0) {
    status = grasp_curve_add(bundle, &curve, like, error);
  }
  for (size_t i = 0; i < bundle->count && !named; i++) {
    bundle->series[i].name = NULL;
  }
  grasp_curve_release(&curve);
  return status;
}

enum status draw_stages(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  static const char *const keys[PANELS] = {"grasp_force_N", "pressure_kPa", "contact_area_mm2"};
  static const char *const labels[PANELS] = {"Grasp force (N)", "Pressure (kPa)", "Contact (mm²)"};
  static const double shares[PANELS] = {0.44, 0.28, 0.28};
  const json_t *result = inputs[0].result, *samples = json_object_get(result, "samples");
  struct timeline *line = calloc(1, sizeof *line);
  struct bundle bundles[PANELS] = {{.series = NULL}};
  struct chart charts[PANELS];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status =
      line ? STATUS_OK : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out");
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  if (status == STATUS_OK) {
    line->x_key = has_time(samples) ? "time_s" : NULL;
    find_spans(samples, line);
  }
  for (size_t i = 0; i < PANELS && status == STATUS_OK; i++) {
    status = add_panel(result, line, keys[i], i == 0, &bundles[i], error);
    charts[i] = (struct chart){.title = "The grasp from stage to stage",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = line->x_key ? "Time (s)" : "Recorded state",
                               .y_label = labels[i],
                               .series = bundles[i].series,
                               .series_count = bundles[i].count,
                               .empty = "No samples were recorded"};
  }
  if (status == STATUS_OK) {
    chart_draw_stack(charts, shares, PANELS, canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&bundles[i]);
  }
  free(line);
  return status;
}
