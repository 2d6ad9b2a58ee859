#include <math.h>
#include <string.h>

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
                     "there are %d chambers: at most %d are possible", spec->chamber_count,
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

/* length = 2 w + n cavity + gaps (2 w + g) + single walls w, solved for what is not given. */
static enum status read_length(const struct reader *reader, const json_t *actuator,
                               struct pneunet_spec *spec) {
  int n = spec->chamber_count;
  int gaps = count_gaps(spec);
  double wall = spec->gap_wall;
  double fixed = 2.0 * wall + gaps * (2.0 * wall + spec->chamber_gap) + (n - 1 - gaps) * wall;
  double length = reader_member(reader, actuator, "length", "mm", 0.0);
  double chamber = reader_member(reader, actuator, "chamber_length", "mm", 0.0);
  if (length == 0.0 && chamber == 0.0) {
    return error_set(reader->error, STATUS_INVALID, "/actuator",
                     "the key \"length\" is missing (\"chamber_length\" can take its place); for "
                     "example \"length\": \"118 mm\"");
  }
  if (chamber == 0.0) {
    spec->length = length;
    spec->cavity_length = (length - fixed) / n;
    if (spec->cavity_length < CAVITY_MINIMUM) {
      return error_set(reader->error, STATUS_GEOMETRY, "/actuator/length",
                       "walls and gaps take %.6g mm of the %.6g mm: with %d cavities of 0.1 mm or "
                       "more the length must be at least %.6g mm",
                       fixed * 1e3, length * 1e3, n, (fixed + n * CAVITY_MINIMUM) * 1e3);
    }
    return STATUS_OK;
  }
  spec->cavity_length = chamber - 2.0 * wall;
  spec->length = fixed + n * spec->cavity_length;
  if (spec->cavity_length < CAVITY_MINIMUM) {
    return error_set(reader->error, STATUS_GEOMETRY, "/actuator/chamber_length",
                     "two walls of %.6g mm leave no cavity of 0.1 mm or more in a chamber of "
                     "%.6g mm: it must be at least %.6g mm long",
                     wall * 1e3, chamber * 1e3, (2.0 * wall + CAVITY_MINIMUM) * 1e3);
  }
  if (length != 0.0 && fabs(length - spec->length) > 1e-6 * length) {
    return error_set(reader->error, STATUS_GEOMETRY, "/actuator/chamber_length",
                     "%d chambers of %.6g mm with their gaps make %.6g mm, but the length is "
                     "%.6g mm: give only one of \"length\" and \"chamber_length\"",
                     n, chamber * 1e3, spec->length * 1e3, length * 1e3);
  }
  return STATUS_OK;
}

static enum status read_height(const struct reader *reader, const json_t *actuator,
                               struct pneunet_spec *spec) {
  const json_t *height = json_object_get(actuator, "height");
  if (json_is_string(height)) {
    spec->height_base = spec->height_tip = reader_quantity(reader, height, "mm");
    return STATUS_OK;
  }
  spec->height_base = reader_member(reader, height, "base", "mm", 0.0);
  spec->height_tip = reader_member(reader, height, "tip", "mm", 0.0);
  if (spec->taper_top != 0.0 || spec->taper_bottom != 0.0) {
    return error_set(reader->error, STATUS_INVALID,
                     spec->taper_top != 0.0 ? "/actuator/taper/top" : "/actuator/taper/bottom",
                     "heights at base and tip already describe the slope: leave out the taper of "
                     "top and bottom, or give one height");
  }
  return STATUS_OK;
}

static void read_channel(const struct reader *reader, const json_t *actuator,
                         struct pneunet_spec *spec) {
  const json_t *channel = json_object_get(actuator, "channel");
  spec->has_channel = channel != NULL;
  spec->channel_width = reader_member(reader, channel, "width", "mm", 0.0);
  spec->channel_height = reader_member(reader, channel, "height", "mm", 0.0);
  spec->channel_cover = reader_member(reader, channel, "cover", "mm", 0.0);
}

enum status reader_pneunet(const struct reader *reader, const json_t *actuator,
                           struct pneunet_spec *spec) {
  *spec = (struct pneunet_spec){.run_count = 0};
  spec->width = reader_member(reader, actuator, "width", "mm", 0.0);
  spec->side_wall = reader_member(reader, actuator, "side_wall", "mm", 0.0);
  spec->gap_wall = reader_member(reader, actuator, "gap_wall", "mm", spec->side_wall);
  spec->top_wall = reader_member(reader, actuator, "top_wall", "mm", 0.0);
  spec->bottom_layer = reader_member(reader, actuator, "bottom_layer", "mm", 0.0);
  spec->slit = reader_member(reader, actuator, "slit", "mm", 0.0);
  spec->slit_floor = reader_member(reader, actuator, "slit_floor", "mm", spec->top_wall);
  read_channel(reader, actuator, spec);
  double stem =
      spec->has_channel ? 0.5 * spec->channel_width + spec->side_wall : 2.0 * spec->side_wall;
  spec->stem = reader_member(reader, actuator, "stem", "mm", stem);
  const json_t *taper = json_object_get(actuator, "taper");
  spec->taper_top = reader_member(reader, taper, "top", "deg", 0.0);
  spec->taper_bottom = reader_member(reader, taper, "bottom", "deg", 0.0);
  spec->taper_left = reader_member(reader, taper, "left", "deg", 0.0);
  spec->taper_right = reader_member(reader, taper, "right", "deg", 0.0);
  enum status status = read_chambers(reader, json_object_get(actuator, "chambers"), spec);
  if (status != STATUS_OK) {
    return status;
  }
  int gaps = count_gaps(spec);
  spec->chamber_gap = gaps > 0 ? reader_member(reader, actuator, "chamber_gap", "mm", 0.0) : 0.0;
  if (gaps > 0 && spec->chamber_gap < 1e-6) {
    return error_set(reader->error, STATUS_GEOMETRY, "/actuator/chamber_gap",
                     "chambers of configuration B and C need a gap of at least 0.001 mm: write for "
                     "example \"2 mm\", or use configuration A");
  }
  status = read_height(reader, actuator, spec);
  if (status == STATUS_OK) {
    status = read_length(reader, actuator, spec);
  }
  return status == STATUS_OK ? pneunet_check(spec, reader->error) : status;
}
