#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/plot/bundle.h"
#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/snap.h"

enum { PATHS_MOST = 3, HARMONICS_MOST = 64 };

/* What the states of one path, in order, say of the harmonics. */
struct garland {
  const json_t *list; /* of the document: states of all paths */
  const char *path;
  double sense; /* of its pressures: 1 when they rise from the first state on, -1 when they fall */
  size_t harmonics;
  double reached_kPa;              /* last state before the axisymmetric limit, or of all */
  double lost_kPa[HARMONICS_MOST]; /* middle of the step in which it is lost; NaN: it is not */
  double half_width_kPa[HARMONICS_MOST]; /* of that step */
};

static bool is_lost(const json_t *state, size_t harmonic) {
  return data_element(json_object_get(state, "negative"), harmonic) > 0;
}

/* Whether a state is of the path; its pressure. */
static bool is_of_path(const struct garland *g, const json_t *state, double *pressure) {
  const char *path = json_string_value(json_object_get(state, "path"));
  *pressure = data_number(state, "pressure_kPa");
  return path && strcmp(path, g->path) == 0 && isfinite(*pressure);
}

static double find_sense(const struct garland *g) {
  double first = NAN, pressure;
  size_t index;
  const json_t *state;
  json_array_foreach(g->list, index, state) {
    if (is_of_path(g, state, &pressure)) {
      if (pressure != first && isfinite(first)) {
        return pressure > first ? 1 : -1;
      }
      first = pressure;
    }
  }
  return 1;
}

/* Goes along the path until the axisymmetric harmonic itself is lost: beyond its limit point the
 * pressure turns back, and nothing there is reached by inflating. */
static void read_garland(struct garland *g) {
  double before = NAN, pressure;
  size_t index;
  const json_t *state;
  for (size_t n = 0; n < HARMONICS_MOST; n++) {
    g->lost_kPa[n] = NAN;
  }
  g->sense = find_sense(g);
  g->reached_kPa = NAN;
  json_array_foreach(g->list, index, state) {
    size_t count = json_array_size(json_object_get(state, "negative"));
    if (!is_of_path(g, state, &pressure)) {
      continue;
    }
    count = count < HARMONICS_MOST ? count : HARMONICS_MOST;
    g->harmonics = count > g->harmonics ? count : g->harmonics;
    double from = isfinite(before) ? before : pressure;
    if (g->sense * pressure < g->sense * from && !is_lost(state, 0)) {
      return; /* past a limit point between the states */
    }
    for (size_t n = 0; n < count; n++) {
      if (isnan(g->lost_kPa[n]) && is_lost(state, n)) {
        /* beyond the limit point the pressure has turned back */
        double to = g->sense * fmax(g->sense * from, g->sense * pressure);
        g->lost_kPa[n] = (from + to) / 2;
        g->half_width_kPa[n] = fabs(to - from) / 2;
      }
    }
    if (!isnan(g->lost_kPa[0])) {
      return;
    }
    before = g->reached_kPa = pressure;
  }
}

/* The axisymmetric harmonic is lost at the first limit point. */
static void add_limit(const json_t *result, struct garland *g) {
  const json_t *event;
  size_t index;
  json_array_foreach(json_object_get(result, "events"), index, event) {
    const char *type = json_string_value(json_object_get(event, "type"));
    double pressure;
    if (type && strcmp(type, "limit point") == 0 && is_of_path(g, event, &pressure)) {
      g->lost_kPa[0] = pressure;
      g->half_width_kPa[0] = 0;
      return;
    }
  }
}

/* Adds the pressures at which harmonics are lost, and those up to which they are not. */
static enum status add_garland(const struct garland *g, size_t place, const char *kept_name,
                               struct bundle *bundle, struct error *error) {
  double errors[HARMONICS_MOST];
  struct point lost[HARMONICS_MOST], kept[HARMONICS_MOST];
  size_t lost_count = 0, kept_count = 0;
  for (size_t n = 0; n < g->harmonics; n++) {
    if (isfinite(g->lost_kPa[n])) {
      errors[lost_count] = g->half_width_kPa[n];
      lost[lost_count++] = (struct point){(double)n, g->lost_kPa[n]};
    } else if (isfinite(g->reached_kPa)) {
      kept[kept_count++] = (struct point){(double)n, g->reached_kPa};
    }
  }
  struct chart_series like = {.colour = colour_series(place),
                              .marker = place ? MARKER_SQUARE : MARKER_CIRCLE,
                              .errors = errors,
                              .name = g->path};
  enum status status = bundle_add(bundle, like, lost, lost_count, error);
  like.hollow = true;
  like.errors = NULL;
  like.name = kept_name;
  return status == STATUS_OK ? bundle_add(bundle, like, kept, kept_count, error) : status;
}

/* The names of the paths under pressure whose harmonics were tested. */
static size_t find_paths(const json_t *result, struct garland garlands[PATHS_MOST]) {
  const json_t *list = json_object_get(result, "harmonics");
  size_t count = 0, index;
  const json_t *state;
  json_array_foreach(list, index, state) {
    const char *path = json_string_value(json_object_get(state, "path"));
    size_t k = 0;
    while (path && k < count && strcmp(garlands[k].path, path) != 0) {
      k++;
    }
    const json_t *followed = snap_path(result, path);
    bool by_force = followed && snap_load_of(followed) == SNAP_FORCE;
    if (path && k == count && count < PATHS_MOST && !by_force) {
      garlands[count++] = (struct garland){.list = list, .path = path};
    }
  }
  return count;
}

/* Says which harmonic is lost first, and where. */
static bool label_first(const struct garland *g, struct chart_label *label) {
  size_t first = HARMONICS_MOST;
  char number[TICKS_TEXT];
  for (size_t n = 0; n < g->harmonics; n++) {
    if (isfinite(g->lost_kPa[n]) &&
        (first == HARMONICS_MOST || g->sense * g->lost_kPa[n] < g->sense * g->lost_kPa[first])) {
      first = n;
    }
  }
  if (first == HARMONICS_MOST) {
    return false;
  }
  size_t last = first;
  while (last + 1 < g->harmonics && g->lost_kPa[last + 1] == g->lost_kPa[first]) {
    last++; /* in the same step */
  }
  ticks_number(g->lost_kPa[first], 3, number);
  label->at = (struct point){(double)first, g->lost_kPa[first]};
  if (last > first) {
    snprintf(label->text, sizeof label->text, "n = %d to %d at %.16s kPa", (int)first, (int)last,
             number);
  } else {
    snprintf(label->text, sizeof label->text, "n = %d at %.16s kPa", (int)first, number);
  }
  return true;
}

enum status draw_stability(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error) {
  const json_t *result = inputs[0].result;
  struct garland garlands[PATHS_MOST];
  struct bundle bundle = {.series = NULL};
  struct chart_label labels[PATHS_MOST];
  char names[PATHS_MOST][120];
  size_t label_count = 0;
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  enum status status = STATUS_OK;
  size_t paths = find_paths(result, garlands);
  (void)count;
  for (size_t i = 0; i < paths && status == STATUS_OK; i++) {
    read_garland(&garlands[i]);
    add_limit(result, &garlands[i]);
    label_count += label_first(&garlands[i], &labels[label_count]);
    snprintf(names[i], sizeof names[i], "%.60s, not lost up to here", garlands[i].path);
    status = add_garland(&garlands[i], i, names[i], &bundle, error);
  }
  data_subtitle(&inputs[0], subtitle);
  data_notice(result, notice);
  struct chart chart = {.title = "Pressure at which the shape stops being axisymmetric",
                        .subtitle = subtitle,
                        .notice = notice,
                        .x_label = "Circumferential harmonic n (0: axisymmetric)",
                        .y_label = "Pressure (kPa)",
                        .from_zero = true,
                        .whole_x = true,
                        .series = bundle.series,
                        .series_count = bundle.count,
                        .labels = labels,
                        .label_count = label_count,
                        .empty = "No harmonics were tested"};
  if (status == STATUS_OK) {
    chart_draw(&chart, canvas);
  }
  bundle_release(&bundle);
  return status;
}
