#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/members.h"
#include "server/plot/metric.h"
#include "server/plot/quantity.h"

/* Most columns side by side: the words of more could not be read. */
enum { COLUMNS_MOST = 120, GROUPS_MOST = 8 };

/* The metric of all members over x, apart by the value of a second parameter. */
struct sheet {
  const struct members *members;
  const char *key;
  const char *x_pointer;     /* parameter on the axis; NULL: members side by side */
  const char *group_pointer; /* second parameter, or NULL */
  const char *group_name;    /* of that parameter */
  char x_name[120], x_label[160];
  size_t group_count;
  char groups[GROUPS_MOST][80]; /* names, "" when there is one group */
  /* one place a member and group: group g starts at g times the number of members */
  struct point *points;
  double *errors;
  struct point *published;
  struct point *stopped;
  const char **names; /* of the columns */
  struct chart_series series[2 * GROUPS_MOST + 1];
  size_t series_count;
};

/* Whether the members differ in their pressures: slopes against pressure are then no comparison. */
static bool varies_pressure(const json_t *result) {
  static const char pressure[] = "/load/pressure";
  json_t *first = json_array_get(json_object_get(result, "members"), 0), *value;
  const char *pointer;
  json_object_foreach(json_object_get(first, "values"), pointer, value) {
    if (strncmp(pointer, pressure, strlen(pressure)) == 0) {
      return true;
    }
  }
  return false;
}

const char *metric_choose(const json_t *result, const char *asked) {
  static const char *const usual[] = {
      "grasp_force_peak_N", "blocked_force_N", "sensitivity_deg_per_kPa", "bending_angle_deg",
      "twist_angle_deg",    "contraction_pct", "trigger_pressure_kPa",    "extension_ratio"};
  enum { USUAL = sizeof usual / sizeof *usual, SENSITIVITY = 2 };
  const json_t *members = json_object_get(result, "members");
  const json_t *first = json_array_get(json_object_get(result, "published"), 0);
  const char *published = json_string_value(json_object_get(first, "metric"));
  const char *choices[1 + USUAL] = {asked ? asked : published};
  memcpy(choices + 1, usual, sizeof usual);
  if (varies_pressure(result)) {
    choices[1 + SENSITIVITY] = NULL;
  }
  for (size_t c = 0; c < (asked ? 1 : 1 + USUAL); c++) {
    for (size_t i = 0; choices[c] && i < json_array_size(members); i++) {
      const json_t *metrics = json_object_get(json_array_get(members, i), "metrics");
      if (isfinite(data_number(metrics, choices[c]))) {
        return choices[c];
      }
    }
  }
  return NULL;
}

static const json_t *value_at(const struct member *member, const char *pointer) {
  return json_object_get(json_object_get(member->object, "values"), pointer);
}

/* Whether every member gives the parameter as a number in the same unit, and not all the same. */
static bool is_numeric(const struct members *members, const char *pointer,
                       char unit[QUANTITY_UNIT]) {
  double first = NAN, number;
  bool differ = false;
  for (size_t i = 0; i < members->count; i++) {
    char own[QUANTITY_UNIT];
    if (!quantity_read(value_at(&members->list[i], pointer), &number, own)) {
      return false;
    }
    if (i == 0) {
      first = number;
      memcpy(unit, own, sizeof own);
    }
    differ = differ || number != first;
    if (strcmp(unit, own) != 0) {
      return false;
    }
  }
  return differ;
}

/* Chooses the axis: a numeric parameter when there are one or two, a second one making groups. */
static void choose_axis(struct sheet *sheet, const json_t *result) {
  const json_t *parameters = json_object_get(result, "parameters");
  size_t count = json_array_size(parameters);
  char unit[QUANTITY_UNIT] = "";
  for (size_t i = 0; i < count && count <= 2 && !sheet->x_pointer; i++) {
    const json_t *parameter = json_array_get(parameters, i);
    const char *pointer = json_string_value(json_object_get(parameter, "pointer"));
    const char *name = json_string_value(json_object_get(parameter, "name"));
    if (pointer && is_numeric(sheet->members, pointer, unit)) {
      const json_t *other = json_array_get(parameters, 1 - i);
      sheet->x_pointer = pointer;
      sheet->group_pointer =
          count == 2 ? json_string_value(json_object_get(other, "pointer")) : NULL;
      sheet->group_name = json_string_value(json_object_get(other, "name"));
      snprintf(sheet->x_name, sizeof sheet->x_name, "%.100s", name ? name : pointer);
      snprintf(sheet->x_label, sizeof sheet->x_label, *unit ? "%.100s (%s)" : "%.100s",
               name ? name : pointer, unit);
      if (sheet->x_label[0] >= 'a' && sheet->x_label[0] <= 'z') {
        sheet->x_label[0] = (char)(sheet->x_label[0] - 'a' + 'A');
      }
    }
  }
}

/* The group of a member, made when it is new; GROUPS_MOST when there are too many. */
static size_t find_group(struct sheet *sheet, const struct member *member) {
  char name[80] = "", number[TICKS_TEXT] = "";
  const json_t *value = sheet->group_pointer ? value_at(member, sheet->group_pointer) : NULL;
  const char *text = json_string_value(value);
  if (json_is_number(value)) {
    ticks_plain(json_number_value(value), 4, number);
    text = number;
  } else if (value && !text) {
    text = json_is_true(value) ? "yes" : "no";
  }
  if (text) {
    snprintf(name, sizeof name, "%.40s %.30s", sheet->group_name ? sheet->group_name : "", text);
  }
  for (size_t g = 0; g < sheet->group_count; g++) {
    if (strcmp(sheet->groups[g], name) == 0) {
      return g;
    }
  }
  if (sheet->group_count < GROUPS_MOST) {
    memcpy(sheet->groups[sheet->group_count], name, sizeof name);
    return sheet->group_count++;
  }
  return GROUPS_MOST;
}

/* The published value of a member, NaN for none. */
static double published_value(const json_t *result, const char *key, size_t member) {
  const json_t *list = json_object_get(result, "published");
  for (size_t i = 0; i < json_array_size(list); i++) {
    const json_t *entry = json_array_get(list, i);
    const char *metric = json_string_value(json_object_get(entry, "metric"));
    if (metric && strcmp(metric, key) == 0 && data_number(entry, "member") == (double)member) {
      return data_number(entry, "value");
    }
  }
  return NAN;
}

/* Puts a point with its error bar where it belongs by x. */
static size_t insert(struct point *points, double *errors, size_t count, struct point p,
                     double error) {
  size_t at = count;
  for (; at > 0 && points[at - 1].x > p.x; at--) {
    points[at] = points[at - 1];
    if (errors) {
      errors[at] = errors[at - 1];
    }
  }
  points[at] = p;
  if (errors) {
    errors[at] = error;
  }
  return count + 1;
}

/* Adds the series of one group from its counts. */
static void add_group(struct sheet *sheet, size_t group, size_t count, size_t published) {
  size_t start = group * sheet->members->count;
  bool columns = !sheet->x_pointer, alone = sheet->group_count == 1;
  struct chart_series computed = {.points = sheet->points + start,
                                  .count = count,
                                  .style = columns ? STYLE_COLUMNS : STYLE_LINE,
                                  .colour = columns ? colour_column : colour_series(group),
                                  .width = columns ? 0.62 : 2.0,
                                  .marker = columns ? MARKER_NONE
                                                    : (enum chart_marker)(MARKER_CIRCLE + group),
                                  .dash = (enum chart_dash)(group % DASH_COUNT),
                                  .errors = sheet->errors + start,
                                  .name = alone ? "computed" : sheet->groups[group]};
  struct chart_series paper = {.points = sheet->published + start,
                               .count = published,
                               .colour = alone ? colour_series(1) : colour_series(group),
                               .marker = alone ? MARKER_DIAMOND
                                               : (enum chart_marker)(MARKER_CIRCLE + group % 4),
                               .hollow = true,
                               .name = "published"};
  /* a single kind of mark needs no words, nor does any group but the first say "published" */
  computed.name = alone && published == 0 ? NULL : computed.name;
  paper.name = group == 0 ? paper.name : NULL;
  sheet->series[2 * group] = computed;
  sheet->series[2 * group + 1] = paper;
}

static void fill(struct sheet *sheet, const json_t *result) {
  size_t count[GROUPS_MOST] = {0}, published[GROUPS_MOST] = {0}, stopped = 0;
  char error_key[140], unit[QUANTITY_UNIT];
  snprintf(error_key, sizeof error_key, "%.120s_error", sheet->key);
  for (size_t i = 0; i < sheet->members->count; i++) {
    const struct member *member = &sheet->members->list[i];
    struct point p = {(double)i, member_metric(member, sheet->key)};
    size_t group = find_group(sheet, member);
    sheet->names[i] = member->name;
    if (group == GROUPS_MOST || (!sheet->x_pointer && i >= COLUMNS_MOST)) {
      continue;
    }
    if (sheet->x_pointer) {
      quantity_read(value_at(member, sheet->x_pointer), &p.x, unit);
    }
    size_t start = group * sheet->members->count;
    if (isfinite(p.y) && member->stopped) {
      sheet->stopped[stopped++] = p;
    } else if (isfinite(p.y)) {
      count[group] = insert(sheet->points + start, sheet->errors + start, count[group], p,
                            member_metric(member, error_key));
    }
    p.y = published_value(result, sheet->key, i);
    if (isfinite(p.y)) {
      published[group] = insert(sheet->published + start, NULL, published[group], p, 0);
    }
  }
  for (size_t g = 0; g < sheet->group_count; g++) {
    add_group(sheet, g, count[g], published[g]);
  }
  sheet->series_count = 2 * sheet->group_count;
  sheet->series[sheet->series_count++] = (struct chart_series){.points = sheet->stopped,
                                                               .count = stopped,
                                                               .colour = colour_notice,
                                                               .marker = MARKER_CROSS,
                                                               .name = "stopped early"};
}

static void draw_sheet(struct canvas *canvas, const struct sheet *sheet,
                       const struct plot_input *input) {
  char subtitle[DATA_HEADING], notice[DATA_HEADING], y_label[160], name[100], title[300];
  size_t count = sheet->members->count;
  bool columns = !sheet->x_pointer;
  members_subtitle(input, count, subtitle);
  members_notice(sheet->members, notice);
  if (columns && count > COLUMNS_MOST) {
    size_t used = strlen(subtitle);
    snprintf(subtitle + used, sizeof subtitle - used, ", the first %d", COLUMNS_MOST);
  }
  quantity_label(sheet->key, y_label, sizeof y_label);
  quantity_name(sheet->key, name, sizeof name);
  snprintf(title, sizeof title, columns ? "%s of the members" : "%s against %s", name,
           sheet->x_name);
  struct chart chart = {.title = title,
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = columns ? NULL : sheet->x_label,
                        .y_label = y_label,
                        .loose_x = true,
                        .x_names = columns ? sheet->names : NULL,
                        .x_name_count = count < COLUMNS_MOST ? count : COLUMNS_MOST,
                        .series = sheet->series,
                        .series_count = sheet->series_count,
                        .empty = "None of the members has this metric"};
  chart_draw(&chart, canvas);
}

enum status draw_metric(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result;
  struct members members;
  enum status status = members_read(result, &members, error);
  struct sheet *sheet = calloc(1, sizeof *sheet);
  size_t room = (members.count + 1) * GROUPS_MOST;
  if (status != STATUS_OK) {
    goto done;
  }
  if (sheet) {
    sheet->members = &members;
    sheet->key = metric_choose(result, inputs[0].metric);
    sheet->points = calloc(room, sizeof *sheet->points);
    sheet->errors = calloc(room, sizeof *sheet->errors);
    sheet->published = calloc(room, sizeof *sheet->published);
    sheet->stopped = calloc(room, sizeof *sheet->stopped);
    sheet->names = calloc(room, sizeof *sheet->names);
  }
  if (!sheet || !sheet->points || !sheet->errors || !sheet->published || !sheet->stopped ||
      !sheet->names) {
    status =
        error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu members", members.count);
    goto done;
  }
  choose_axis(sheet, result);
  fill(sheet, result);
  draw_sheet(canvas, sheet, &inputs[0]);
done:
  if (sheet) {
    free(sheet->points);
    free(sheet->errors);
    free(sheet->published);
    free(sheet->stopped);
    free(sheet->names);
  }
  free(sheet);
  members_release(&members);
  return status;
}
