#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/hybrid.h"
#include "server/plot/motion.h"

/* Cells and actuators that are drawn: more could not be told apart. */
enum { CELLS_MOST = 7, ACTUATORS_MOST = 6, PANELS = 4, KEY = 40, NAME = 60 };

/* Part of a range below which a move cannot be seen. */
static const double visible = 1.0 / 1500.0;

/* The time that is shown, and how: as it is, or in ms from an instant. */
struct window {
  double from, to, origin, unit;
};

/* A chart of the stack: curves of keys over time. */
struct panel {
  const char *label;
  struct bundle bundle;
  struct window window;
  size_t curves;
  double reach; /* of the background */
};

/* Names of curves; everything drawn borrows them. */
struct words {
  char cells[CELLS_MOST][NAME], pressures[ACTUATORS_MOST][NAME], set_points[ACTUATORS_MOST][NAME];
};

/* Adds the curve of `key` over time, if the samples have it. */
static enum status add_curve(const json_t *result, const char *key, struct chart_series like,
                             struct panel *panel, struct error *error) {
  const struct window *window = &panel->window;
  struct point *points = NULL;
  size_t count = 0;
  double low = INFINITY, high = -INFINITY;
  enum status status = data_samples(result, "time_s", key, &points, &count, error);
  if (status != STATUS_OK || count == 0) {
    free(points);
    return status;
  }
  size_t inside = 0;
  for (size_t i = 0; i < count; i++) {
    struct point p = {(points[i].x - window->origin) / window->unit, points[i].y};
    if (points[i].x >= window->from && points[i].x <= window->to) {
      low = fmin(low, p.y);
      high = fmax(high, p.y);
      points[inside++] = p;
    }
  }
  count = inside;
  double dx = count ? visible * fabs(points[count - 1].x - points[0].x) : 0;
  count = data_thin(points, count, dx, visible * (high - low));
  status = bundle_add(&panel->bundle, like, points, count, error);
  panel->curves++;
  free(points);
  return status;
}

/* The elongations: of the plate, of each cell, and of what it pushes. */
static enum status add_elongations(const json_t *result, struct words *words, struct panel *panel,
                                   struct error *error) {
  struct chart_series like = {.width = 1.6, .name = "plate", .colour = colour_ink};
  enum status status = STATUS_OK;
  char key[KEY];
  for (size_t i = 0; i < CELLS_MOST && status == STATUS_OK; i++) {
    struct chart_series cell = {.width = 1.4,
                                .dash = i % 2 ? DASH_LONG : DASH_SOLID,
                                .colour = colour_series(i),
                                .name = words->cells[i]};
    snprintf(key, sizeof key, "cell_%zu_mm", i + 1);
    snprintf(words->cells[i], NAME, "cell %zu", i + 1);
    status = add_curve(result, key, cell, panel, error);
  }
  if (status == STATUS_OK) {
    like.width = 2.2;
    status = add_curve(result, "h_mm", like, panel, error);
  }
  like = (struct chart_series){
      .width = 1.8, .dash = DASH_SHORT, .name = "load", .colour = colour_notice};
  return status == STATUS_OK ? add_curve(result, "load_h_mm", like, panel, error) : status;
}

static enum status add_speeds(const json_t *result, struct panel *panel, struct error *error) {
  struct chart_series like = {.width = 1.8, .colour = colour_ink};
  enum status status = add_curve(result, "velocity_m_s", like, panel, error);
  like = (struct chart_series){.width = 1.6, .dash = DASH_SHORT, .colour = colour_notice};
  return status == STATUS_OK ? add_curve(result, "load_velocity_m_s", like, panel, error) : status;
}

/* Set-point and pressure of each actuator; only the first has no number. */
static enum status add_pressures(const json_t *result, struct words *words, struct panel *panel,
                                 struct error *error) {
  const json_t *sample = json_array_get(json_object_get(result, "samples"), 0);
  bool several = json_object_get(sample, "pressure_2_kPa") != NULL;
  enum status status = STATUS_OK;
  char key[2][KEY], number[16] = "", suffix[16] = "";
  for (size_t a = 0; a < ACTUATORS_MOST && status == STATUS_OK; a++) {
    snprintf(number, sizeof number, a ? "_%zu" : "", a + 1);
    snprintf(suffix, sizeof suffix, several ? " %zu" : "", a + 1);
    snprintf(key[0], KEY, "set_point%s_kPa", number);
    snprintf(key[1], KEY, "pressure%s_kPa", number);
    snprintf(words->set_points[a], NAME, "set-point%s", suffix);
    snprintf(words->pressures[a], NAME, "chamber%s", suffix);
    struct chart_series like = {.width = 1.4,
                                .dash = DASH_LONG,
                                .colour = colour_series(several ? a : 1),
                                .name = words->set_points[a]};
    status = add_curve(result, key[0], like, panel, error);
    like = (struct chart_series){.width = 1.9,
                                 .colour = several ? colour_series(a) : colour_ink,
                                 .name = words->pressures[a]};
    if (status == STATUS_OK) {
      status = add_curve(result, key[1], like, panel, error);
    }
  }
  return status;
}

static void measure(struct panel *panel) {
  for (size_t s = 0; s < panel->bundle.count; s++) {
    for (size_t i = 0; i < panel->bundle.series[s].count; i++) {
      panel->reach = fmax(panel->reach, 20 * fabs(panel->bundle.series[s].points[i].y));
    }
  }
  panel->reach = panel->reach > 0 ? panel->reach : 1;
}

static enum status read_panels(const json_t *result, struct words *words,
                               struct panel panels[PANELS], struct error *error) {
  struct chart_series angle = {.width = 1.8, .colour = colour_ink};
  enum status status = add_elongations(result, words, &panels[0], error);
  if (status == STATUS_OK) {
    status = add_speeds(result, &panels[1], error);
  }
  if (status == STATUS_OK) {
    status = add_pressures(result, words, &panels[2], error);
  }
  if (status == STATUS_OK) {
    status = add_curve(result, "bending_angle_deg", angle, &panels[3], error);
  }
  for (size_t i = 0; i < PANELS && status == STATUS_OK; i++) {
    measure(&panels[i]);
    if (panels[i].window.unit == 1) {
      status = hybrid_add_switches(result, panels[i].reach, i == 0 ? "snap" : NULL,
                                   &panels[i].bundle, error);
    }
  }
  return status;
}

/* Draws the part of the motion that the window shows. */
static enum status draw_window(struct canvas *canvas, const struct plot_input *input,
                               struct window window, const char *title, const char *subtitle,
                               struct error *error) {
  static const double with_angle[PANELS] = {0.34, 0.2, 0.26, 0.2};
  static const double without[PANELS - 1] = {0.42, 0.26, 0.32};
  struct panel panels[PANELS] = {
      {.label = "h (mm)"}, {.label = "h' (m/s)"}, {.label = "p (kPa)"}, {.label = "Angle (°)"}};
  struct chart charts[PANELS];
  struct words words;
  const json_t *motion = motion_of(input->result);
  char notice[DATA_HEADING];
  data_notice(input->result, notice);
  for (size_t i = 0; i < PANELS; i++) {
    panels[i].window = window;
  }
  enum status status = read_panels(motion, &words, panels, error);
  size_t shown = panels[3].curves > 0 ? PANELS : PANELS - 1;
  for (size_t i = 0; i < shown; i++) {
    charts[i] =
        (struct chart){.title = title,
                       .subtitle = subtitle,
                       .notice = notice,
                       .x_label = window.unit == 1 ? "Time (s)" : "Time from the trigger (ms)",
                       .y_label = panels[i].label,
                       .series = panels[i].bundle.series,
                       .series_count = panels[i].bundle.count,
                       .empty = "No samples were recorded"};
  }
  if (status == STATUS_OK) {
    chart_draw_stack(charts, shown == PANELS ? with_angle : without, shown, canvas);
  }
  for (size_t i = 0; i < PANELS; i++) {
    bundle_release(&panels[i].bundle);
  }
  return status;
}

enum status draw_motion(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  char subtitle[DATA_HEADING];
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  return draw_window(canvas, inputs, (struct window){-INFINITY, INFINITY, 0, 1},
                     "Elongation of plate and cells, speed and pressure", subtitle, error);
}

const json_t *motion_of(const json_t *result) {
  const json_t *motion = json_object_get(result, "motion");
  return json_is_object(motion) ? motion : result;
}

const json_t *motion_fastest_snap(const json_t *result) {
  const json_t *fastest = NULL, *event;
  double speed = 0;
  size_t index;
  json_array_foreach(json_object_get(motion_of(result), "events"), index, event) {
    const char *type = json_string_value(json_object_get(event, "type"));
    double peak = data_number(event, "peak_speed_m_s");
    if (type && strcmp(type, "snap") == 0 && peak > speed &&
        data_number(event, "snap_time_s") > 0 &&
        isfinite(data_number(event, "trigger_time_s") + data_number(event, "peak_time_s"))) {
      speed = peak;
      fastest = event;
    }
  }
  return fastest;
}

enum status draw_snap(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error) {
  const json_t *event = motion_fastest_snap(inputs[0].result);
  char subtitle[DATA_HEADING], speed[TICKS_TEXT], time[TICKS_TEXT];
  double trigger = data_number(event, "trigger_time_s"), peak = data_number(event, "peak_time_s");
  double duration = data_number(event, "snap_time_s");
  /* The slow beginning would take up all of it: the time is that of the peak less some durations.
   */
  double origin = fmax(trigger, peak - 2.5 * duration);
  struct window window = {origin - 0.5 * duration, peak + 5 * duration, trigger, 1e-3};
  (void)count;
  data_subtitle(&inputs[0], subtitle);
  size_t used = strlen(subtitle);
  ticks_number(data_number(event, "peak_speed_m_s"), 3, speed);
  ticks_number(1e3 * duration, 3, time);
  snprintf(subtitle + used, DATA_HEADING - used, "%speak %s m/s, 10 to 90 %% in %s ms",
           used ? " · " : "", speed, time);
  return draw_window(canvas, inputs, window, "The fastest snap", subtitle, error);
}
