/* Which dimensions of a body with oblique chambers exclude each other. Lengths in messages are in
 * mm. */
#include <math.h>

#include "solver/job/reader.h"

/* What a length may miss by rounding, relative. */
static const double rounding = 1e-9;

static double to_mm(double metres) {
  return metres * 1e3;
}

static double to_deg(double radians) {
  return radians * 180.0 / M_PI;
}

static enum status check_width(const struct oblique_spec *s, struct error *error) {
  double cavity = 0.5 * (s->width - s->centre_wall) - s->side_wall;
  bool centre = s->centre_wall > 2.0 * s->side_wall;
  if (cavity < CAVITY_MINIMUM) {
    double room = centre ? s->width - 2.0 * (s->side_wall + CAVITY_MINIMUM)
                         : 0.5 * (s->width - s->centre_wall) - CAVITY_MINIMUM;
    return error_set(error, STATUS_GEOMETRY,
                     centre ? "/actuator/centre_wall" : "/actuator/side_wall",
                     "two side walls of %.6g mm and a centre wall of %.6g mm leave no cavities of "
                     "0.1 mm in a width of %.6g mm\na %s wall can be at most %.6g mm thick",
                     to_mm(s->side_wall), to_mm(s->centre_wall), to_mm(s->width),
                     centre ? "centre" : "side", to_mm(fmax(room, 0.0)));
  }
  if (s->has_channel && s->channel_width > cavity) {
    return error_set(
        error, STATUS_GEOMETRY, "/actuator/channel/width",
        "the channel of a row is %.6g mm wide\nat most as much as its cavities, %.6g mm",
        to_mm(s->channel_width), to_mm(cavity));
  }
  return STATUS_OK;
}

static enum status check_height(const struct oblique_spec *s, struct error *error) {
  double need = s->bottom_layer + s->top_wall + CAVITY_MINIMUM;
  if (s->height < need) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/height",
                     "a height of %.6g mm is too small for bottom layer, top wall and a cavity of "
                     "0.1 mm\nat least %.6g mm",
                     to_mm(s->height), to_mm(need));
  }
  if (s->has_channel && s->channel_cover + s->channel_height >= s->bottom_layer) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/channel/height",
                     "a channel of %.6g mm under a cover of %.6g mm leaves no floor in a bottom "
                     "layer of %.6g mm\nthe channel must be lower than %.6g mm",
                     to_mm(s->channel_height), to_mm(s->channel_cover), to_mm(s->bottom_layer),
                     to_mm(fmax(s->bottom_layer - s->channel_cover, 0.0)));
  }
  return STATUS_OK;
}

/* Length along the body of `count` chambers of walls at `angle` with their gaps, from where the
 * first one starts in the middle to where the last one ends at the side. */
static double occupied(const struct oblique_spec *s, double angle, int count) {
  double normal = count * (s->cavity + 2.0 * s->gap_wall) + (count - 1) * s->chamber_gap;
  return normal / cos(angle) + 0.5 * s->width * tan(angle);
}

/* Chambers that fit beside the solid ends. */
static int capacity(const struct oblique_spec *s) {
  double pitch = (s->cavity + 2.0 * s->gap_wall + s->chamber_gap) / cos(s->angle);
  double room = s->length - 2.0 * s->end - occupied(s, s->angle, 1);
  return room < -rounding * s->length ? 0 : 1 + (int)fmin(room / pitch + 1e-6, 1e6);
}

/* Not even one chamber fits: because of the angle if it does at 0. */
static enum status refuse_angle(const struct oblique_spec *s, struct error *error) {
  double room = s->length - 2.0 * s->end, low = 0, high = s->angle;
  if (occupied(s, 0.0, 1) > room) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/length",
                     "two solid ends of %.6g mm and one chamber of %.6g mm do not fit into a "
                     "length of %.6g mm\nit must be at least %.6g mm",
                     to_mm(s->end), to_mm(occupied(s, 0.0, 1)), to_mm(s->length),
                     to_mm(2.0 * s->end + occupied(s, 0.0, 1)));
  }
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    *(occupied(s, middle, 1) > room ? &high : &low) = middle;
  }
  return error_set(error, STATUS_GEOMETRY, "/actuator/chamber_angle",
                   "walls at %.6g deg to the cross-section leave no chamber: the first one would "
                   "take %.6g mm of a length of %.6g mm, where the solid ends leave %.6g mm\nthe "
                   "limit is %.4f deg from the cross-section\n\"%.0f deg\"",
                   to_deg(s->angle), to_mm(occupied(s, s->angle, 1)), to_mm(s->length), to_mm(room),
                   to_deg(low), floor(to_deg(low)));
}

static enum status check_angle(const struct oblique_spec *s, struct error *error) {
  if (s->angle <= OBLIQUE_ANGLE_MAX * (1.0 + rounding)) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_GEOMETRY, "/actuator/chamber_angle",
                   "walls at %.6g deg to the cross-section run along the body, and the rows meet "
                   "only far out\nat most %.6g deg from the cross-section or at least %.6g deg "
                   "from the long axis\n\"45 deg\"",
                   to_deg(s->angle), to_deg(OBLIQUE_ANGLE_MAX), 90.0 - to_deg(OBLIQUE_ANGLE_MAX));
}

enum status oblique_fit(bool chambers_given, struct oblique_spec *s, struct error *error) {
  enum status status = check_angle(s, error);
  if (status == STATUS_OK) {
    status = check_width(s, error);
  }
  if (status == STATUS_OK) {
    status = check_height(s, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  int most = capacity(s);
  if (most < 1) {
    return refuse_angle(s, error);
  }
  if (!chambers_given) {
    s->chamber_count = most;
  } else if (s->chamber_count > most) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/chambers",
                     "%d chambers at %.6g deg to the cross-section take %.6g mm and overlap the "
                     "solid ends of %.6g mm in a length of %.6g mm\nat most %d fit",
                     s->chamber_count, to_deg(s->angle),
                     to_mm(occupied(s, s->angle, s->chamber_count)), to_mm(s->end),
                     to_mm(s->length), most);
  }
  if (s->chamber_count > CHAMBERS_MAX) {
    return error_set(
        error, STATUS_GEOMETRY, "/actuator/chambers",
        "%d chambers of each row would fit\nat most %d, so give their number\n{\"chambers\": 24}",
        s->chamber_count, CHAMBERS_MAX);
  }
  s->end = 0.5 * (s->length - occupied(s, s->angle, s->chamber_count));
  return STATUS_OK;
}
