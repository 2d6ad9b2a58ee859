#include "server/plot/extension.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/ladder.h"
#include "server/plot/snap.h"

enum { PANELS = 2, DETAIL = 80 };

bool extension_is_of(const json_t *result) {
  return json_array_size(json_object_get(result, "holds")) >= 2 ||
         json_array_size(json_object_get(result, "paths")) > 0;
}

static bool has_ratio(const struct extension_source *sources, size_t count) {
  for (size_t i = 0; i < count; i++) {
    const json_t *metrics = json_object_get(sources[i].result, "metrics");
    if (extension_is_of(sources[i].result) && isnan(data_number(metrics, "extension_ratio"))) {
      return false;
    }
  }
  return true;
}

/* "snaps at 34.7 kPa" */
static void describe(const json_t *result, char text[DETAIL]) {
  char number[TICKS_TEXT];
  double trigger = data_number(json_object_get(result, "metrics"), "trigger_pressure_kPa");
  ticks_number(trigger, 3, number);
  snprintf(text, DETAIL, isfinite(trigger) ? "snaps at %s kPa" : "%s", number);
}

/* Adds the elongation of a hybrid model at the end of its set-points: rising ones have full
 * markers, falling ones open ones. Set-points that go up and down at every step are markers alone.
 */
static enum status add_ladder(struct bundle *bundle, const json_t *result, const char *key,
                              struct chart_series like, struct error *error) {
  struct ladder ladder;
  enum status status = ladder_read(result, key, &ladder, error);
  bool joined = 2 * ladder.run_count <= ladder.count;
  for (size_t i = 0; i < ladder.run_count && status == STATUS_OK; i++) {
    const struct ladder_run *run = &ladder.run[i];
    like.width = joined ? (run->falling ? 1.4 : 2.0) : 0;
    like.hollow = run->falling;
    /* The end of the last run is where this one starts: it is marked already. */
    size_t first = joined || i == 0 ? run->first : run->first + 1;
    status = bundle_add(bundle, like, ladder.points + first, run->last - first + 1, error);
    like.name = NULL;
  }
  ladder_release(&ladder);
  return status;
}

/* Adds the equilibrium paths under pressure. */
static enum status add_paths(struct bundle *bundle, const json_t *result, const char *key,
                             struct chart_series like, struct error *error) {
  const struct snap_look look = {.x_key = "pressure_kPa",
                                 .y_key = key,
                                 .colour = like.colour,
                                 .stable_name = like.name,
                                 .width = 2.2};
  bool named[2] = {false, false};
  enum status status = STATUS_OK;
  size_t index, before = bundle->count;
  const json_t *path;
  json_array_foreach(json_object_get(result, "paths"), index, path) {
    if (status == STATUS_OK && snap_load_of(path) == SNAP_PRESSURE) {
      status = snap_add_path(bundle, path, &look, named, error);
    }
  }
  for (size_t i = before; i < bundle->count; i++) {
    bundle->series[i].detail = bundle->series[i].name ? like.detail : NULL;
  }
  return status;
}

/* Adds the forces at the natural length: of held states, or gamma p of a hybrid model. */
static enum status add_forces(struct bundle *bundle, const json_t *result, struct chart_series like,
                              struct error *error) {
  bool hybrid = json_array_size(json_object_get(result, "holds")) > 0;
  const json_t *list = json_object_get(result, hybrid ? "holds" : "held");
  struct point *points = malloc((json_array_size(list) + 1) * sizeof *points);
  size_t count = 0, index;
  const json_t *entry;
  if (!points) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for forces");
  }
  json_array_foreach(list, index, entry) {
    struct point p = {data_number(entry, hybrid ? "steady_pressure_kPa" : "pressure_kPa"),
                      data_number(entry, hybrid ? "steady_force_N" : "force_N")};
    bool further = count == 0 || p.x > points[count - 1].x;
    if (isfinite(p.x) && isfinite(p.y) && (further || !hybrid)) {
      points[count++] = p;
    }
  }
  enum status status = count ? bundle_add(bundle, like, points, count, error) : STATUS_OK;
  free(points);
  return status;
}

/* Actuators that agree lie above each other: dashes let the ones below be seen. */
static struct chart_series look_of(size_t place, const char *name, const char *detail) {
  return (struct chart_series){.colour = colour_series(place),
                               .width = 2.0,
                               .dash = (enum chart_dash)(place % DASH_COUNT),
                               .marker =
                                   (enum chart_marker)(MARKER_CIRCLE + place % (MARKER_CROSS - 1)),
                               .name = name,
                               .detail = detail};
}

static enum status read_all(const struct extension_source *sources, size_t count, const char *key,
                            char (*details)[DETAIL], struct bundle bundles[PANELS],
                            struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    const json_t *result = sources[i].result;
    bool hybrid = json_array_size(json_object_get(result, "holds")) > 0;
    char path_key[40];
    describe(result, details[i]);
    snprintf(path_key, sizeof path_key, "%s%s", hybrid ? "end_" : "", key);
    struct chart_series like = look_of(i, sources[i].name, details[i]);
    status = (hybrid ? add_ladder : add_paths)(&bundles[0], result, path_key, like, error);
    like.marker = MARKER_NONE;
    like.name = like.detail = NULL;
    if (status == STATUS_OK) {
      status = add_forces(&bundles[1], result, like, error);
    }
  }
  return status;
}

enum status extension_draw(struct canvas *canvas, const struct extension_source *sources,
                           size_t count, const struct extension_heading *heading,
                           struct error *error) {
  static const double shares[PANELS] = {0.62, 0.38};
  struct bundle bundles[PANELS] = {{.series = NULL}};
  bool ratio = has_ratio(sources, count);
  char(*details)[DETAIL] = calloc(count + 1, sizeof *details);
  enum status status =
      details
          ? read_all(sources, count, ratio ? "extension_ratio" : "h_mm", details, bundles, error)
          : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu curves", count);
  bool forces = bundles[1].count > 0;
  struct chart charts[PANELS];
  for (size_t i = 0; i < PANELS; i++) {
    charts[i] = (struct chart){.title = forces ? "Extension and force against pressure"
                                               : "Extension against pressure",
                               .subtitle = heading->subtitle,
                               .notice = heading->notice,
                               .x_label = "Pressure (kPa)",
                               .y_label = i       ? "Force, held (N)"
                                          : ratio ? "Extension ratio"
                                                  : "Elongation (mm)",
                               .from_zero = true,
                               .series = bundles[i].series,
                               .series_count = bundles[i].count,
                               .empty = "No states under pressure were recorded"};
  }
  if (status == STATUS_OK && forces) {
    chart_draw_stack(charts, shares, PANELS, canvas);
  } else if (status == STATUS_OK) {
    chart_draw(charts, canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&bundles[i]);
  }
  free(details);
  return status;
}
