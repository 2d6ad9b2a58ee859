#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/snap.h"

enum { PANELS = 2, LABELS_MOST = 12, KINDS = 5, PATHS_MOST = 4 };

/* How an event is marked. */
struct kind {
  const char *type, *name;
  enum chart_marker marker;
  struct colour colour;
  bool hollow;
};

static const struct kind kinds[KINDS] = {
    {"limit point", "limit point", MARKER_DIAMOND, {.role = COLOUR_SERIES + 1}, false},
    {"stable state", "at rest without load", MARKER_CIRCLE, {.role = COLOUR_SERIES + 2}, false},
    {"loss of axisymmetry",
     "loss of axisymmetry",
     MARKER_TRIANGLE,
     {.role = COLOUR_SERIES + 3},
     false},
    {"contact", "walls touch", MARKER_SQUARE, {.role = COLOUR_INK}, true},
    {"yield", "PET yields", MARKER_CROSS, {.role = COLOUR_NOTICE}, false},
};

/* One of the two charts: pressure or force against elongation. */
struct sheet {
  enum snap_load load;
  const char *y_key, *y_label, *unit;
  struct bundle bundle;
  struct chart_label labels[LABELS_MOST];
  size_t label_count, paths;
  size_t first; /* labels of trigger and release, which come first */
};

/* Writes beside an event what it is at. Trigger and release are called so. */
static void label_event(const json_t *metrics, const char *type, struct point at,
                        struct sheet *sheet) {
  char number[TICKS_TEXT];
  for (size_t i = 0; i < sheet->label_count; i++) {
    const struct point *other = &sheet->labels[i].at;
    if (fabs(other->x - at.x) < 0.02 && fabs(other->y - at.y) < 0.02) {
      return; /* where two paths meet */
    }
  }
  if (sheet->label_count == LABELS_MOST) {
    return;
  }
  struct chart_label *label = &sheet->labels[sheet->label_count];
  label->at = at;
  if (strcmp(type, "limit point") == 0) {
    double trigger = data_number(metrics, "trigger_pressure_kPa");
    double release = data_number(metrics, "release_pressure_kPa");
    bool pressure = sheet->load == SNAP_PRESSURE;
    const char *word = pressure && fabs(at.y - trigger) <= 1e-3 * fabs(trigger)   ? "trigger "
                       : pressure && fabs(at.y - release) <= 1e-3 * fabs(release) ? "release "
                                                                                  : "";
    ticks_number(at.y, 3, number);
    snprintf(label->text, sizeof label->text, "%s%s %s", word, number, sheet->unit);
    sheet->label_count++;
    if (*word) {
      /* what matters most has the first choice of a place */
      struct chart_label other = sheet->labels[sheet->first];
      sheet->labels[sheet->first++] = *label;
      *label = other;
    }
  } else if (strcmp(type, "stable state") == 0) {
    ticks_number(fabs(at.x) < 5e-3 ? 0 : at.x, 3, number);
    snprintf(label->text, sizeof label->text, "%s mm", number);
    sheet->label_count++;
  }
}

/* Adds the markers of one kind of event. */
static enum status add_events(const json_t *result, const struct kind *kind, bool shown,
                              struct sheet *sheet, struct error *error) {
  const json_t *events = json_object_get(result, "events");
  struct chart_series like = {.colour = kind->colour,
                              .marker = kind->marker,
                              .hollow = kind->hollow,
                              .name = shown ? NULL : kind->name};
  enum status status = STATUS_OK;
  size_t index;
  const json_t *event;
  json_array_foreach(events, index, event) {
    const char *type = json_string_value(json_object_get(event, "type"));
    const json_t *path = snap_path(result, json_string_value(json_object_get(event, "path")));
    struct point at = {data_number(event, "h_mm"), data_number(event, sheet->y_key)};
    if (!type || strcmp(type, kind->type) != 0 || !path || snap_load_of(path) != sheet->load ||
        !isfinite(at.x) || !isfinite(at.y) || status != STATUS_OK) {
      continue;
    }
    status = bundle_add(&sheet->bundle, like, &at, 1, error);
    like.name = NULL;
    label_event(json_object_get(result, "metrics"), type, at, sheet);
  }
  return status;
}

/* The paths under the load of a chart. */
static size_t find_paths(const json_t *result, enum snap_load load,
                         const json_t *found[PATHS_MOST]) {
  size_t index, count = 0;
  const json_t *path;
  json_array_foreach(json_object_get(result, "paths"), index, path) {
    if (snap_load_of(path) == load && count < PATHS_MOST &&
        json_array_size(json_object_get(path, "points")) > 1) {
      found[count++] = path;
    }
  }
  return count;
}

/* Adds the paths of one chart. Those after the first run along parts of it: they lie below, wide
 * and light. */
static enum status add_paths(const json_t *const paths[], bool words, struct sheet *sheet,
                             struct error *error) {
  static const size_t lighter[PATHS_MOST] = {0, 4, 5, 3};
  enum status status = STATUS_OK;
  for (size_t i = sheet->paths; i-- > 0 && status == STATUS_OK;) {
    const char *name = json_string_value(json_object_get(paths[i], "name"));
    struct snap_look look = {.x_key = "h_mm",
                             .y_key = sheet->y_key,
                             .colour =
                                 i ? colour_fade(colour_series(lighter[i]), 0.6) : colour_series(0),
                             .stable_name = i       ? name
                                            : words ? "stable"
                                                    : NULL,
                             .unstable_name = i || !words ? NULL : "unstable",
                             .width = i ? 6 : 2.2};
    bool named[2] = {false, false};
    status = snap_add_path(&sheet->bundle, paths[i], &look, named, error);
    if (i > 0 && status == STATUS_OK) {
      /* where the first path did not come, the line is missing */
      look = (struct snap_look){
          .x_key = "h_mm", .y_key = sheet->y_key, .colour = colour_series(0), .width = 1.6};
      status = snap_add_path(&sheet->bundle, paths[i], &look, named, error);
    }
  }
  return status;
}

/* Reads the paths and events of one chart. shown: the kinds of events that a legend names already.
 */
static enum status read_sheet(const json_t *result, bool shown[KINDS], struct sheet *sheet,
                              struct error *error) {
  const json_t *paths[PATHS_MOST];
  bool words = sheet->load == SNAP_PRESSURE || !shown[0];
  sheet->paths = find_paths(result, sheet->load, paths);
  enum status status = add_paths(paths, words, sheet, error);
  for (size_t k = 0; k < KINDS && status == STATUS_OK; k++) {
    size_t before = sheet->bundle.count;
    status = add_events(result, &kinds[k], shown[k], sheet, error);
    shown[k] = shown[k] || sheet->bundle.count > before;
  }
  return status == STATUS_OK && sheet->paths > 0 ? bundle_add_zero(&sheet->bundle, error) : status;
}

enum status draw_snap_path(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error) {
  static const double shares[PANELS] = {0.5, 0.5};
  static const char *const empty[PANELS] = {"No path under pressure", "No path under axial force"};
  struct sheet sheets[PANELS] = {
      {.load = SNAP_PRESSURE, .y_key = "pressure_kPa", .y_label = "Pressure (kPa)", .unit = "kPa"},
      {.load = SNAP_FORCE, .y_key = "force_N", .y_label = "Axial force (N)", .unit = "N"}};
  struct chart charts[PANELS];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  bool shown[KINDS] = {false};
  enum status status = STATUS_OK;
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  for (size_t i = 0; i < PANELS && status == STATUS_OK; i++) {
    status = read_sheet(inputs[0].result, shown, &sheets[i], error);
    charts[i] = (struct chart){.title = i == 0 ? "Equilibrium under pressure and under axial force"
                                               : "Equilibrium under axial force",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Elongation from the compressed state (mm)",
                               .y_label = sheets[i].y_label,
                               .series = sheets[i].bundle.series,
                               .series_count = sheets[i].bundle.count,
                               .labels = sheets[i].labels,
                               .label_count = sheets[i].label_count,
                               .empty = empty[i]};
  }
  if (status == STATUS_OK && sheets[1].paths == 0) {
    charts[0].title = "Equilibrium under pressure";
  }
  if (status == STATUS_OK && sheets[0].paths > 0 && sheets[1].paths > 0) {
    chart_draw_stack(charts, shares, PANELS, canvas);
  } else if (status == STATUS_OK) {
    chart_draw(&charts[sheets[0].paths == 0], canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&sheets[i].bundle);
  }
  return status;
}
