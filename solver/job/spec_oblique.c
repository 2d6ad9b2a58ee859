#include <math.h>
#include <string.h>

#include "solver/job/reader.h"

static const double right_angle = 0.5 * M_PI;

static void read_channel(const struct reader *reader, const json_t *channel,
                         struct oblique_spec *spec) {
  spec->has_channel = channel != NULL;
  spec->channel_width = reader_member(reader, channel, "width", "mm", 0.0);
  spec->channel_height = reader_member(reader, channel, "height", "mm", 0.0);
  spec->channel_cover = reader_member(reader, channel, "cover", "mm", 0.0);
}

enum status reader_oblique(const struct reader *reader, const json_t *actuator,
                           struct oblique_spec *spec) {
  *spec = (struct oblique_spec){.length = reader_member(reader, actuator, "length", "mm", 0.0)};
  spec->width = reader_member(reader, actuator, "width", "mm", 0.0);
  spec->height = reader_member(reader, actuator, "height", "mm", 0.0);
  spec->cavity = reader_member(reader, actuator, "chamber_thickness", "mm", 0.0);
  spec->chamber_gap = reader_member(reader, actuator, "chamber_gap", "mm", 0.0);
  spec->side_wall = reader_member(reader, actuator, "side_wall", "mm", 0.0);
  spec->gap_wall = reader_member(reader, actuator, "gap_wall", "mm", spec->side_wall);
  spec->centre_wall = reader_member(reader, actuator, "centre_wall", "mm", spec->gap_wall);
  spec->top_wall = reader_member(reader, actuator, "top_wall", "mm", 0.0);
  spec->bottom_layer = reader_member(reader, actuator, "bottom_layer", "mm", 0.0);
  spec->end = reader_member(reader, actuator, "solid_end", "mm", spec->side_wall);
  spec->spine = json_is_true(json_object_get(actuator, "spine"));
  spec->chamber_count = reader_count(actuator, "chambers", 0);
  double angle = reader_member(reader, actuator, "chamber_angle", "deg", 0.0);
  const char *from = json_string_value(json_object_get(actuator, "angle_from"));
  spec->angle = strcmp(from, "long-axis") == 0 ? right_angle - angle : angle;
  read_channel(reader, json_object_get(actuator, "channel"), spec);
  return oblique_fit(spec->chamber_count > 0, spec, reader->error);
}
