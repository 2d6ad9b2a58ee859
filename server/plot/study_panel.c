#include "server/plot/study_panel.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "server/plot/legend.h"

void study_panel_count(size_t count, char text[TICKS_TEXT]) {
  if (count < 10000) {
    snprintf(text, TICKS_TEXT, "%zu", count);
  } else {
    snprintf(text, TICKS_TEXT, "%zu\u202f%03zu", count / 1000, count % 1000);
  }
}

void study_panel_add(struct study_panel *panel, const char *format, ...) {
  size_t used = strlen(panel->subtitle);
  used += (size_t)snprintf(panel->subtitle + used, STUDY_HEADING - used, "%s", used ? " · " : "");
  if (used < STUDY_HEADING) {
    va_list list;
    va_start(list, format);
    vsnprintf(panel->subtitle + used, STUDY_HEADING - used, format, list);
    va_end(list);
  }
}

/* The reason that most failed members give; *count: how many. */
static const char *frequent_reason(const struct study_table *table, size_t *count) {
  enum { KINDS = 16 };
  const char *reasons[KINDS];
  size_t counts[KINDS] = {0}, kinds = 0, best = 0;
  for (size_t row = 0; row < table->members; row++) {
    size_t k = 0;
    if (!study_row_failed(table, row)) {
      continue;
    }
    while (k < kinds && strcmp(reasons[k], table->reason[row]) != 0) {
      k++;
    }
    if (k == kinds && kinds < KINDS) {
      reasons[kinds++] = table->reason[row];
    }
    if (k < kinds) {
      counts[k]++;
      best = counts[k] > counts[best] ? k : best;
    }
  }
  *count = counts[best];
  return kinds > 0 ? reasons[best] : "";
}

/* What became of the members. */
struct tally {
  size_t solved, failed, open;
};

static struct tally count_members(const struct study_table *table) {
  struct tally tally = {0};
  for (size_t row = 0; row < table->members; row++) {
    tally.solved += study_row_counts(table, row);
    tally.failed += study_row_failed(table, row);
  }
  size_t wanted = table->wanted > table->members ? table->wanted : table->members;
  tally.open = wanted - tally.solved - tally.failed;
  return tally;
}

void study_panel_words(struct study_panel *panel, const struct study_table *table) {
  struct tally tally = count_members(table);
  char members[TICKS_TEXT], failed[TICKS_TEXT], open[TICKS_TEXT];
  size_t of_reason;
  study_panel_count(tally.solved + tally.failed + tally.open, members);
  study_panel_count(tally.failed, failed);
  study_panel_count(tally.open, open);
  panel->subtitle[0] = panel->notice[0] = '\0';
  if (table->study_id > 0) {
    study_panel_add(panel, "study %lld", (long long)table->study_id);
  }
  if (table->name && *table->name) {
    study_panel_add(panel, "%.200s", table->name);
  }
  study_panel_add(panel, "%.60s, %s member%s", table->sampling ? table->sampling : "list", members,
                  tally.solved + tally.failed + tally.open == 1 ? "" : "s");
  if (tally.open > 0) {
    study_panel_add(panel, "%s not solved yet", open);
  }
  if (tally.failed > 0) {
    const char *reason = frequent_reason(table, &of_reason);
    size_t used =
        (size_t)snprintf(panel->notice, STUDY_HEADING, "%s of %s failed", failed, members);
    if (*reason) {
      char number[TICKS_TEXT];
      study_panel_count(of_reason, number);
      const char *how = of_reason < tally.failed ? "most often: " : "";
      snprintf(panel->notice + used, STUDY_HEADING - used, ": %s%.160s", how, reason);
    }
  }
}

/* Finds the area below `top` and the final ranges. */
static void lay_out(struct study_panel *panel, struct canvas *canvas, double top) {
  double u = canvas->unit;
  struct frame data = panel->frame;
  double right =
      canvas->width - (panel->bar.label ? 8 * u + chart_bar_room(canvas, &panel->bar) : 26 * u);
  struct box area = {74 * u, top, 0, 0};
  /* numbers need room, which depends on the range, which depends on the room */
  for (int pass = 0; pass < 2; pass++) {
    area.width = fmax(right - area.x, 20 * u);
    area.height =
        fmax(canvas->height - axes_bottom_room(canvas, &panel->axes, area.width) - top, 20 * u);
    panel->frame = data;
    panel->frame.area = area;
    if (!panel->tight) {
      axes_widen(canvas, &panel->axes, &panel->frame);
    }
    area.x = round(axes_left_room(canvas, &panel->axes, &panel->frame));
  }
  panel->frame.area.x = area.x;
  panel->frame.area.width = fmax(right - area.x, 20 * u);
}

/* The legend above the chart, in as few columns as make it one line. */
static struct legend measure_key(const struct study_panel *panel, struct canvas *canvas,
                                 const struct chart *key) {
  enum { COLUMNS_MOST = 6 };
  double width = canvas->width - 32 * canvas->unit, height = 0.3 * canvas->height;
  struct legend best = legend_measure(canvas, key, 1, width, height);
  for (size_t columns = 2; columns <= COLUMNS_MOST && columns <= panel->key_count; columns++) {
    struct legend legend = legend_measure(canvas, key, columns, width, height);
    best = legend.complete && (legend.rows < best.rows || !best.complete) ? legend : best;
  }
  return best;
}

void study_panel_begin(struct study_panel *panel, struct canvas *canvas) {
  double u = canvas->unit;
  const struct chart key = {.series = panel->key, .series_count = panel->key_count};
  double top = chart_heading_height(canvas, panel->subtitle, panel->notice);
  struct legend legend = measure_key(panel, canvas, &key);
  lay_out(panel, canvas, top + (legend.rows > 0 ? legend.box.height : 0));
  struct box *area = &panel->frame.area;
  legend.box.x = fmin(area->x - 7 * u, canvas->width - 8 * u - legend.box.width);
  legend.box.y = top - 5 * u;
  axes_draw(canvas, &panel->axes, &panel->frame, false);
  if (legend.rows > 0) {
    legend_draw(canvas, &key, &legend);
  }
  if (panel->bar.label) {
    double right = area->x + area->width + chart_bar_room(canvas, &panel->bar);
    chart_bar(canvas, &panel->bar, (struct box){area->x, area->y, right - area->x, area->height});
  }
  chart_heading(canvas, fmin(area->x, 0.2 * canvas->width), panel->title, panel->subtitle,
                panel->notice);
}

void study_panel_rim(const struct study_panel *panel, struct canvas *canvas) {
  const struct box *a = &panel->frame.area;
  double bottom = a->y + a->height;
  canvas_set_colour(canvas, colour_muted);
  canvas_line(canvas, a->x, a->y, a->x, bottom, 1);
  canvas_line(canvas, a->x, bottom, a->x + a->width, bottom, 1);
}

void study_panel_empty(const struct study_panel *panel, struct canvas *canvas, const char *why) {
  struct text_style style = chart_style_label();
  style.colour = colour_muted;
  style.max_width = 0.9 * canvas->width;
  chart_heading(canvas, 16 * canvas->unit, panel->title, panel->subtitle, panel->notice);
  canvas_text(canvas, canvas->width / 2.0, canvas->height / 2.0, 0.5, 0.5, why, &style);
}

void study_panel_failed(const struct study_panel *panel, struct canvas *canvas,
                        const struct study_axis *x) {
  double u = canvas->unit, bottom = panel->frame.area.y + panel->frame.area.height;
  bool drawn[SHEET_SIDE_MAX / 2 + 1] = {false};
  canvas_set_colour(canvas, colour_notice);
  cairo_set_line_width(canvas->cr, 1.6 * u);
  for (size_t row = 0; row < x->table->members; row++) {
    double at = study_row_failed(x->table, row) ? study_axis_at(x, row) : NAN;
    double px = round(frame_pixel(&panel->frame, (struct point){at, 0}).x);
    if (!(px >= 0 && px < canvas->width) || drawn[(int)px / 2]) {
      continue;
    }
    drawn[(int)px / 2] = true;
    double r = 3.2 * u, y = bottom - r - 3 * u;
    cairo_move_to(canvas->cr, px - r, y - r);
    cairo_line_to(canvas->cr, px + r, y + r);
    cairo_move_to(canvas->cr, px - r, y + r);
    cairo_line_to(canvas->cr, px + r, y - r);
  }
  cairo_stroke(canvas->cr);
}

struct chart_series study_panel_failed_key(const struct study_table *table) {
  static const struct point dummy = {0, 0};
  struct tally tally = count_members(table);
  return (struct chart_series){.points = &dummy,
                               .count = 1,
                               .colour = colour_notice,
                               .marker = MARKER_CROSS,
                               .name = tally.failed > 0 ? "failed, on the axis" : NULL};
}

struct colour_bar study_panel_bar(const struct study_axis *axis, struct colour (*map)(double),
                                  char label[STUDY_LABEL]) {
  if (!axis->table || axis->column->categorical || !(axis->low <= axis->high)) {
    return (struct colour_bar){0};
  }
  study_axis_label(axis, label);
  double low = axis->low, high = axis->high;
  (axis->logarithmic ? ticks_widen_log : ticks_widen)(&low, &high, 8);
  return (struct colour_bar){
      .label = label, .map = map, .min = low, .max = high, .logarithmic = axis->logarithmic};
}
