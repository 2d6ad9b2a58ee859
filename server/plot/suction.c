#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/members.h"

/* A metric of a member; one that has no suckers has neither their number nor their force. */
static double metric_or_zero(const struct member *member, const char *key) {
  double value = member_metric(member, key);
  return isfinite(value) || strncmp(key, "suc", 3) != 0 ? value : 0;
}

/* A metric over the number of suckers: one member for each number, joined by a line, and the
 * others, that have the same number in another way, beside it with their names. */
struct half {
  struct point *line, *others;
  struct chart_label *labels; /* of the others */
  size_t line_count, other_count;
  struct chart_series series[2];
};

static void half_release(struct half *half) {
  free(half->line);
  free(half->others);
  free(half->labels);
}

/* Whether a member is the first with its number of suckers. */
static bool is_first(const struct members *members, size_t index) {
  double count = metric_or_zero(&members->list[index], "sucker_count");
  for (size_t i = 0; i < index; i++) {
    if (!members->list[i].stopped && metric_or_zero(&members->list[i], "sucker_count") == count) {
      return false;
    }
  }
  return true;
}

/* Adds a point to the line where it belongs by x. */
static void insert(struct half *half, struct point p) {
  size_t at = half->line_count++;
  for (; at > 0 && half->line[at - 1].x > p.x; at--) {
    half->line[at] = half->line[at - 1];
  }
  half->line[at] = p;
}

static enum status half_read(const struct members *members, const char *key, size_t place,
                             struct half *half, struct error *error) {
  half->line = calloc(members->count + 1, sizeof *half->line);
  half->others = calloc(members->count + 1, sizeof *half->others);
  half->labels = calloc(members->count + 1, sizeof *half->labels);
  if (!half->line || !half->others || !half->labels) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu members",
                     members->count);
  }
  for (size_t i = 0; i < members->count; i++) {
    const struct member *member = &members->list[i];
    struct point p = {metric_or_zero(member, "sucker_count"), metric_or_zero(member, key)};
    if (!isfinite(p.y) || member->stopped) {
      continue;
    }
    if (is_first(members, i)) {
      insert(half, p);
    } else {
      struct chart_label *label = &half->labels[half->other_count];
      label->at = p;
      snprintf(label->text, sizeof label->text, "%.36s", member->name);
      half->others[half->other_count++] = p;
    }
  }
  enum chart_marker marker = place ? MARKER_SQUARE : MARKER_CIRCLE;
  half->series[0] = (struct chart_series){.points = half->line,
                                          .count = half->line_count,
                                          .colour = colour_series(place),
                                          .width = 2.0,
                                          .marker = marker};
  half->series[1] = (struct chart_series){.points = half->others,
                                          .count = half->other_count,
                                          .colour = colour_series(place),
                                          .marker = marker,
                                          .hollow = true};
  return STATUS_OK;
}

enum status draw_suction(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  static const char *const keys[2] = {"suction_force_N", "bending_angle_deg"};
  static const double shares[2] = {0.5, 0.5};
  (void)count;
  struct members members;
  struct half halves[2] = {{.line = NULL}, {.line = NULL}};
  struct chart charts[2];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = members_read(inputs[0].result, &members, error);
  if (status != STATUS_OK) {
    goto done;
  }
  members_subtitle(&inputs[0], members.count, subtitle);
  members_notice(&members, notice);
  for (size_t k = 0; k < 2; k++) {
    status = half_read(&members, keys[k], k, &halves[k], error);
    if (status != STATUS_OK) {
      goto done;
    }
    charts[k] = (struct chart){.title = "Suction and bending against the number of suckers",
                               .subtitle = subtitle,
                               .notice = notice,
                               .x_label = "Number of suckers",
                               .y_label = k ? "Bending angle (°)" : "Suction force (N)",
                               .whole_x = true,
                               .series = halves[k].series,
                               .series_count = 2,
                               .labels = halves[k].labels,
                               .label_count = halves[k].other_count,
                               .empty = "None of the members has it"};
  }
  chart_draw_stack(charts, shares, 2, canvas);
done:
  half_release(&halves[0]);
  half_release(&halves[1]);
  members_release(&members);
  return status;
}
