#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/draw.h"
#include "server/plot/extension.h"
#include "server/plot/grasp.h"
#include "server/plot/members.h"
#include "server/plot/profile.h"
#include "server/plot/quantity.h"

/* A quantity of the samples that is drawn against pressure, a curve a member. */
struct subject {
  const char *key, *title;
  bool sensitivity; /* the legend says slope and R² instead of the last value */
};

/* Curves of one study. More than DRAW_OVERLAY_LIMIT of them cannot be told apart: the others are
 * thin grey lines with one line in the legend. */
struct family {
  struct members members;
  struct chart_series *series; /* the grey ones, the others, the ends of those that stopped */
  struct point **points;       /* of each member */
  char (*details)[80];         /* of each member */
  struct point *ends;
  size_t series_count, end_count;
  char rest[60];
};

static void family_release(struct family *family) {
  for (size_t i = 0; family->points && i < family->members.count; i++) {
    free(family->points[i]);
  }
  free(family->series);
  free(family->points);
  free(family->details);
  free(family->ends);
  members_release(&family->members);
}

static enum status family_create(const json_t *result, struct family *family, struct error *error) {
  enum status status = members_read(result, &family->members, error);
  size_t count = family->members.count + 1;
  if (status != STATUS_OK) {
    return status;
  }
  family->series = calloc(count + 1, sizeof *family->series);
  family->points = calloc(count, sizeof *family->points);
  family->details = calloc(count, sizeof *family->details);
  family->ends = calloc(count, sizeof *family->ends);
  if (!family->series || !family->points || !family->details || !family->ends) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu curves", count);
  }
  return STATUS_OK;
}

/* What the legend says of a member: "1.45 °/kPa, R² 0.987", or its last value. */
static void describe(const struct member *member, const struct subject *subject,
                     const struct point *last, char *text, size_t size) {
  char number[TICKS_TEXT], second[TICKS_TEXT], unit[32];
  if (!subject->sensitivity) {
    quantity_unit(subject->key, unit, sizeof unit);
    ticks_number(last->y, 3, number);
    snprintf(text, size, "%s%s%s", number, unit[0] == '%' ? " " : "", unit);
    return;
  }
  double slope = member_metric(member, "sensitivity_deg_per_kPa");
  double r_squared = member_metric(member, "r_squared");
  ticks_number(slope, 3, number);
  ticks_number(r_squared, 3, second);
  snprintf(text, size, isfinite(slope) ? "%s °/kPa%s%s" : "", number,
           isfinite(r_squared) ? ", R² " : "", isfinite(r_squared) ? second : "");
}

/* Reads the curve of every member into `counts` points each. */
static enum status read_curves(struct family *family, const struct subject *subject, size_t *counts,
                               struct error *error) {
  for (size_t i = 0; i < family->members.count; i++) {
    const struct member *member = &family->members.list[i];
    enum status status = data_samples(member->object, "pressure_kPa", subject->key,
                                      &family->points[i], &counts[i], error);
    if (status != STATUS_OK) {
      return status;
    }
    if (counts[i] > 0) {
      const struct point *last = &family->points[i][counts[i] - 1];
      describe(member, subject, last, family->details[i], sizeof family->details[i]);
      if (member->stopped) {
        family->ends[family->end_count++] = *last;
      }
    }
  }
  return STATUS_OK;
}

static struct chart_series named_curve(const struct family *family, size_t member, size_t count,
                                       size_t place) {
  return (struct chart_series){.points = family->points[member],
                               .count = count,
                               .colour = colour_series(place),
                               .width = 2.0,
                               .marker =
                                   (enum chart_marker)(MARKER_CIRCLE + place % (MARKER_COUNT - 1)),
                               .dash = (enum chart_dash)(place % DASH_COUNT),
                               .name = family->members.list[member].name,
                               .detail = family->details[member]};
}

/* Makes the series. Of too many, some evenly spread over the study are named. The grey ones come
 * first, so that they lie below; their line in the legend is last. */
static void make_series(struct family *family, const size_t *counts) {
  size_t drawn = 0, named = 0, first = 0, seen = 0;
  for (size_t i = 0; i < family->members.count; i++) {
    drawn += counts[i] > 0;
  }
  size_t limit = drawn > DRAW_OVERLAY_LIMIT ? DRAW_OVERLAY_LIMIT - 1 : DRAW_OVERLAY_LIMIT;
  snprintf(family->rest, sizeof family->rest, "%zu more", drawn - (drawn > limit ? limit : drawn));
  size_t grey = drawn > limit ? drawn - limit : 0;
  for (size_t i = 0; i < family->members.count; i++) {
    if (counts[i] == 0) {
      continue;
    }
    seen++;
    if (grey == 0 || seen * limit / drawn != (seen - 1) * limit / drawn) {
      family->series[grey + named] = named_curve(family, i, counts[i], named);
      named++;
    } else {
      family->series[first++] = (struct chart_series){.points = family->points[i],
                                                      .count = counts[i],
                                                      .colour = {.role = COLOUR_EDGE},
                                                      .width = 1.2};
    }
  }
  family->series_count = grey + named;
  if (grey > 0) {
    /* drawn twice, to have a line of the legend after those of the others */
    family->series[family->series_count] = family->series[0];
    family->series[family->series_count++].name = family->rest;
  }
}

static enum status draw_family(struct canvas *canvas, const struct plot_input *input,
                               const struct subject *subject, struct error *error) {
  struct family family = {.series = NULL};
  size_t *counts = NULL;
  enum status status = family_create(input->result, &family, error);
  if (status != STATUS_OK) {
    goto done;
  }
  counts = calloc(family.members.count + 1, sizeof *counts);
  status = counts ? read_curves(&family, subject, counts, error)
                  : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a study");
  if (status != STATUS_OK) {
    goto done;
  }
  make_series(&family, counts);
  if (family.end_count > 0) {
    family.series[family.series_count++] = (struct chart_series){.points = family.ends,
                                                                 .count = family.end_count,
                                                                 .colour = colour_notice,
                                                                 .marker = MARKER_CROSS,
                                                                 .name = "stopped early"};
  }
  char subtitle[DATA_HEADING], notice[DATA_HEADING], label[120];
  members_subtitle(input, family.members.count, subtitle);
  members_notice(&family.members, notice);
  quantity_label(subject->key, label, sizeof label);
  struct chart chart = {.title = subject->title,
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Pressure (kPa)",
                        .y_label = label,
                        .from_zero = true,
                        .series = family.series,
                        .series_count = family.series_count,
                        .empty = "None of the members has samples"};
  chart_draw(&chart, canvas);
done:
  free(counts);
  family_release(&family);
  return status;
}

/* The members that are bistable actuators, at most DRAW_OVERLAY_LIMIT of them. */
static size_t find_bistable(const struct members *members,
                            struct extension_source sources[DRAW_OVERLAY_LIMIT]) {
  size_t count = 0;
  for (size_t i = 0; i < members->count && count < DRAW_OVERLAY_LIMIT; i++) {
    const struct member *member = &members->list[i];
    if (extension_is_of(member->object)) {
      sources[count++] = (struct extension_source){member->object, member->name};
    }
  }
  return count;
}

/* The members that are grasps, in the same way. */
static size_t find_grasps(const struct members *members,
                          struct profile_source sources[DRAW_OVERLAY_LIMIT]) {
  size_t count = 0;
  for (size_t i = 0; i < members->count && count < DRAW_OVERLAY_LIMIT; i++) {
    const struct member *member = &members->list[i];
    if (grasp_is_of(member->object)) {
      sources[count++] = (struct profile_source){member->object, member->name};
    }
  }
  return count;
}

enum status draw_curves(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  static const struct subject subject = {"bending_angle_deg", "Bending angle against pressure",
                                         true};
  struct extension_source sources[DRAW_OVERLAY_LIMIT];
  struct profile_source grasps[DRAW_OVERLAY_LIMIT];
  struct members members;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = members_read(inputs[0].result, &members, error);
  size_t bistable = status == STATUS_OK ? find_bistable(&members, sources) : 0;
  size_t grasp = status == STATUS_OK ? find_grasps(&members, grasps) : 0;
  (void)count;
  if (bistable + grasp > 0) {
    members_subtitle(&inputs[0], members.count, subtitle);
    members_notice(&members, notice);
  }
  if (bistable > 0) {
    status = extension_draw(canvas, sources, bistable,
                            &(struct extension_heading){subtitle, notice}, error);
  } else if (grasp > 0) {
    status =
        profile_draw(canvas, grasps, grasp, &(struct profile_heading){subtitle, notice}, error);
  } else if (status == STATUS_OK) {
    status = draw_family(canvas, inputs, &subject, error);
  }
  members_release(&members);
  return status;
}

enum status draw_contraction(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error) {
  static const struct subject subject = {"contraction_pct", "Contraction against pressure", false};
  (void)count;
  return draw_family(canvas, inputs, &subject, error);
}

enum status draw_twist(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error) {
  static const struct subject subject = {"twist_angle_deg", "Twist angle against pressure", false};
  (void)count;
  return draw_family(canvas, inputs, &subject, error);
}
