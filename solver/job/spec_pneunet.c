#include <math.h>
#include <string.h>

#include "solver/job/parameter.h"
#include "solver/job/reader.h"

static enum status read_chambers(const struct reader *reader, const json_t *chambers,
                                 struct pneunet_spec *spec) {
  size_t index;
  json_t *run;
  json_array_foreach(chambers, index, run) {
    const char *config = json_string_value(json_object_get(run, "config"));
    struct chamber_run *added = &spec->runs[spec->run_count++];
    added->config = (enum chamber_config)(CHAMBER_A + (config[0] - 'A'));
    added->count = reader_count(run, "count", 0);
    spec->chamber_count += added->count;
  }
  if (spec->chamber_count > CHAMBERS_MAX) {
    return error_set(reader->error, STATUS_GEOMETRY, "/actuator/chambers",
                     "there are %d chambers\nat most %d are possible", spec->chamber_count,
                     CHAMBERS_MAX);
  }
  return STATUS_OK;
}

/* Number of joints with a gap; the others, between two chambers A, are single walls. */
static int count_gaps(const struct pneunet_spec *spec) {
  int gaps = 0;
  for (int i = 0; i < spec->run_count; i++) {
    bool closed = spec->runs[i].config == CHAMBER_A;
    gaps += closed ? 0 : spec->runs[i].count - 1;
    bool closed_next = i + 1 < spec->run_count && spec->runs[i + 1].config == CHAMBER_A;
    gaps += i + 1 < spec->run_count && !(closed && closed_next);
  }
  return gaps;
}

static double otherwise(double given, double value) {
  return isnan(given) ? value : given;
}

/* length = 2 w + n cavity + gaps (2 w + g) + single walls w, solved for what is not given. When
 * both lengths are given, that of the chamber holds. */
static enum status derive_length(const struct pneunet_given *given, struct pneunet_spec *spec,
                                 struct error *error) {
  int n = spec->chamber_count;
  int gaps = count_gaps(spec);
  double wall = spec->gap_wall;
  double fixed = 2.0 * wall + gaps * (2.0 * wall + spec->chamber_gap) + (n - 1 - gaps) * wall;
  double length = given->length, chamber = given->chamber_length;
  if (isnan(length) && isnan(chamber)) {
    return error_set(error, STATUS_INVALID, "/actuator",
                     "the key \"length\" is missing (\"chamber_length\" can take its place)\na "
                     "length with its unit\n{\"length\": \"118 mm\"}");
  }
  if (isnan(chamber)) {
    spec->length = length;
    spec->cavity_length = (length - fixed) / n;
    if (spec->cavity_length < CAVITY_MINIMUM) {
      return error_set(error, STATUS_GEOMETRY, "/actuator/length",
                       "walls and gaps take %.6g mm of the %.6g mm\nwith %d cavities of 0.1 mm or "
                       "more the length must be at least %.6g mm",
                       fixed * 1e3, length * 1e3, n, (fixed + n * CAVITY_MINIMUM) * 1e3);
    }
    return STATUS_OK;
  }
  spec->cavity_length = chamber - 2.0 * wall;
  spec->length = fixed + n * spec->cavity_length;
  if (spec->cavity_length < CAVITY_MINIMUM) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/chamber_length",
                     "two walls of %.6g mm leave no cavity of 0.1 mm or more in a chamber of %.6g "
                     "mm\nit must be at least %.6g mm long",
                     wall * 1e3, chamber * 1e3, (2.0 * wall + CAVITY_MINIMUM) * 1e3);
  }
  return STATUS_OK;
}

/* Two lengths have to say the same. */
static enum status check_lengths(const struct pneunet_given *given, const struct pneunet_spec *spec,
                                 struct error *error) {
  if (isnan(given->length) || !(fabs(given->length - spec->length) > 1e-6 * given->length)) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_GEOMETRY, "/actuator/chamber_length",
                   "%d chambers of %.6g mm with their gaps make %.6g mm, but the length is %.6g "
                   "mm\ngive only one of \"length\" and \"chamber_length\"",
                   spec->chamber_count, given->chamber_length * 1e3, spec->length * 1e3,
                   given->length * 1e3);
}

static enum status derive_heights(const struct pneunet_given *given, struct pneunet_spec *spec,
                                  struct error *error) {
  spec->height_base = otherwise(given->height, given->height_base);
  spec->height_tip = otherwise(given->height, given->height_tip);
  if (isnan(given->height) && (spec->taper_top != 0.0 || spec->taper_bottom != 0.0)) {
    return error_set(error, STATUS_INVALID,
                     spec->taper_top != 0.0 ? "/actuator/taper/top" : "/actuator/taper/bottom",
                     "heights at base and tip already describe the slope\nleave out the taper of "
                     "top and bottom, or give one height");
  }
  return STATUS_OK;
}

static enum gap_shape read_gap_shape(const char *word) {
  return word[0] == 'U'   ? GAP_U
         : word[0] == 'V' ? GAP_V
         : word[0] == 't' ? GAP_TRAPEZOIDAL
                          : GAP_RECTANGULAR;
}

/* The gaps: their width at the top, their shape below it. */
static enum status derive_gaps(const struct pneunet_given *given, struct pneunet_spec *spec,
                               struct error *error) {
  static const double root_share[] = {
      [GAP_RECTANGULAR] = 1, [GAP_U] = 0.1, [GAP_V] = 0.1, [GAP_TRAPEZOIDAL] = 0.5};
  bool shaped = spec->gap_shape != GAP_RECTANGULAR;
  int gaps = count_gaps(spec);
  spec->chamber_gap = gaps > 0 ? given->chamber_gap : 0.0;
  if (gaps > 0 && !(spec->chamber_gap >= 1e-6)) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/chamber_gap",
                     "chambers of configuration B and C have gaps, and this is none\nat least "
                     "0.001 mm, or configuration A\n\"2 mm\"");
  }
  double root = root_share[spec->gap_shape] * spec->chamber_gap;
  spec->gap_root = shaped && gaps > 0 ? otherwise(given->gap_root, root) : root;
  double round = fmin(0.5 * (spec->chamber_gap - spec->gap_root),
                      fmin(spec->height_base, spec->height_tip) - spec->bottom_layer);
  spec->gap_round = spec->gap_shape == GAP_U ? otherwise(given->gap_round, round) : 0.0;
  return STATUS_OK;
}

enum status pneunet_derive(const struct pneunet_given *given, struct pneunet_spec *spec,
                           struct error *error) {
  spec->width = given->width;
  spec->side_wall = given->side_wall;
  spec->gap_wall = otherwise(given->gap_wall, given->side_wall);
  spec->top_wall = given->top_wall;
  spec->bottom_layer = given->bottom_layer;
  spec->slit = given->slit;
  spec->slit_floor = otherwise(given->slit_floor, given->top_wall);
  spec->has_channel = !isnan(given->channel_width);
  spec->channel_width = otherwise(given->channel_width, 0.0);
  spec->channel_height = otherwise(given->channel_height, 0.0);
  spec->channel_cover = otherwise(given->channel_cover, 0.0);
  double stem =
      spec->has_channel ? 0.5 * spec->channel_width + spec->side_wall : 2.0 * spec->side_wall;
  spec->stem = otherwise(given->stem, stem);
  spec->taper_top = otherwise(given->taper_top, 0.0);
  spec->taper_bottom = otherwise(given->taper_bottom, 0.0);
  spec->taper_left = otherwise(given->taper_left, 0.0);
  spec->taper_right = otherwise(given->taper_right, 0.0);
  enum status status = derive_heights(given, spec, error);
  if (status == STATUS_OK) {
    status = derive_gaps(given, spec, error);
  }
  if (status == STATUS_OK) {
    status = derive_length(given, spec, error);
  }
  return status == STATUS_OK ? pneunet_check(spec, error) : status;
}

#define DIMENSION(group, key, unit, member)                                                        \
  { group, key, unit, offsetof(struct pneunet_given, member) }
const struct pneunet_dimension pneunet_dimensions[PNEUNET_DIMENSIONS] = {
    DIMENSION(NULL, "length", "mm", length),
    DIMENSION(NULL, "chamber_length", "mm", chamber_length),
    DIMENSION(NULL, "width", "mm", width),
    DIMENSION(NULL, "height", "mm", height),
    DIMENSION("height", "base", "mm", height_base),
    DIMENSION("height", "tip", "mm", height_tip),
    DIMENSION(NULL, "chamber_gap", "mm", chamber_gap),
    DIMENSION(NULL, "gap_root", "mm", gap_root),
    DIMENSION(NULL, "gap_round", "mm", gap_round),
    DIMENSION(NULL, "side_wall", "mm", side_wall),
    DIMENSION(NULL, "gap_wall", "mm", gap_wall),
    DIMENSION(NULL, "top_wall", "mm", top_wall),
    DIMENSION(NULL, "bottom_layer", "mm", bottom_layer),
    DIMENSION(NULL, "slit", "mm", slit),
    DIMENSION(NULL, "slit_floor", "mm", slit_floor),
    DIMENSION(NULL, "stem", "mm", stem),
    DIMENSION("channel", "width", "mm", channel_width),
    DIMENSION("channel", "height", "mm", channel_height),
    DIMENSION("channel", "cover", "mm", channel_cover),
    DIMENSION("taper", "top", "deg", taper_top),
    DIMENSION("taper", "bottom", "deg", taper_bottom),
    DIMENSION("taper", "left", "deg", taper_left),
    DIMENSION("taper", "right", "deg", taper_right),
};

static void read_suckers(const struct reader *reader, const json_t *actuator,
                         struct pneunet_spec *spec) {
  size_t index;
  json_t *sucker;
  json_array_foreach(json_object_get(actuator, "suckers"), index, sucker) {
    spec->sucker[spec->sucker_count++] =
        (struct sucker_spec){.position = reader_member(reader, sucker, "position", "mm", 0.0),
                             .diameter = reader_member(reader, sucker, "diameter", "mm", 0.0),
                             .depth = reader_member(reader, sucker, "depth", "mm", 0.0),
                             .wall = reader_member(reader, sucker, "wall", "mm", 0.0)};
  }
  spec->suction_pressure = reader_member(reader, actuator, "suction_pressure", "kPa", 0.0);
}

enum status reader_pneunet(const struct reader *reader, const json_t *actuator,
                           struct pneunet_given *given, struct pneunet_spec *spec) {
  const char *walls = json_string_value(json_object_get(actuator, "tapered_walls"));
  const char *shape = json_string_value(json_object_get(actuator, "gap_shape"));
  *spec = (struct pneunet_spec){.scaled_walls = strcmp(walls, "scaled") == 0,
                                .gap_shape = read_gap_shape(shape)};
  for (int d = 0; d < PNEUNET_DIMENSIONS; d++) {
    const struct pneunet_dimension *dimension = &pneunet_dimensions[d];
    const json_t *object =
        dimension->group ? json_object_get(actuator, dimension->group) : actuator;
    const json_t *member = json_object_get(object, dimension->key);
    double *value = (double *)((char *)given + dimension->offset);
    *value = json_is_string(member) ? reader_quantity(reader, member, dimension->unit) : NAN;
  }
  read_suckers(reader, actuator, spec);
  enum status status = read_chambers(reader, json_object_get(actuator, "chambers"), spec);
  if (status == STATUS_OK) {
    status = pneunet_derive(given, spec, reader->error);
  }
  return status == STATUS_OK ? check_lengths(given, spec, reader->error) : status;
}
