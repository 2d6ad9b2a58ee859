/* Which dimensions of a pneu-net exclude each other. Lengths in messages are in mm. */
#include <math.h>

#include "solver/job/reader.h"

static double to_mm(double metres) {
  return metres * 1e3;
}

static double to_deg(double radians) {
  return radians * 180.0 / acos(-1.0);
}

static bool has_config(const struct pneunet_spec *s, enum chamber_config config) {
  for (int i = 0; i < s->run_count; i++) {
    if (s->runs[i].config == config) {
      return true;
    }
  }
  return false;
}

/* Everything below the side of one half of the tip must fit into it: half a cavity and a wall,
 * half a channel with a wall, a stem. */
struct lateral_need {
  double half_width;
  const char *what;
};

static struct lateral_need lateral_need(const struct pneunet_spec *s) {
  if (s->scaled_walls) {
    double cavity = s->width - 2.0 * s->side_wall;
    return (struct lateral_need){0.5 * s->width * CAVITY_MINIMUM / cavity, "the scaled cavities"};
  }
  struct lateral_need need = {s->side_wall + 0.5 * CAVITY_MINIMUM, "the side wall and a cavity"};
  double channel = 0.5 * s->channel_width + s->side_wall;
  if (s->has_channel && channel > need.half_width) {
    need = (struct lateral_need){channel, "the side wall and the channel"};
  }
  if (has_config(s, CHAMBER_C) && s->stem > need.half_width) {
    need = (struct lateral_need){s->stem, "the stem"};
  }
  return need;
}

static enum status check_width(const struct pneunet_spec *s, struct error *error) {
  double cavity = s->width - 2.0 * s->side_wall;
  if (cavity < CAVITY_MINIMUM) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/side_wall",
                     "two side walls of %.6g mm leave no cavity in a width of %.6g mm\na side wall "
                     "can be at most %.6g mm thick",
                     to_mm(s->side_wall), to_mm(s->width),
                     to_mm(0.5 * (s->width - CAVITY_MINIMUM)));
  }
  if (s->has_channel && s->channel_width > cavity) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/channel/width",
                     "the channel is %.6g mm wide\nat most as much as the cavities, %.6g mm",
                     to_mm(s->channel_width), to_mm(cavity));
  }
  if (!has_config(s, CHAMBER_C)) {
    return STATUS_OK;
  }
  if (s->has_channel && s->stem <= 0.5 * s->channel_width) {
    return error_set(
        error, STATUS_GEOMETRY, "/actuator/stem",
        "a stem of half width %.6g mm does not enclose the channel\nit must be more than %.6g mm",
        to_mm(s->stem), to_mm(0.5 * s->channel_width));
  }
  if (s->stem >= 0.5 * s->width) {
    return error_set(
        error, STATUS_GEOMETRY, "/actuator/stem",
        "a stem of half width %.6g mm is as wide as the chamber\nit must be less than %.6g mm",
        to_mm(s->stem), to_mm(0.5 * s->width));
  }
  return STATUS_OK;
}

static enum status check_lateral_taper(const struct pneunet_spec *s, double taper,
                                       const char *pointer, struct error *error) {
  struct lateral_need need = lateral_need(s);
  double tip = 0.5 * s->width - s->length * tan(taper);
  if (tip >= need.half_width) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_GEOMETRY, pointer,
                   "a taper of %.6g deg leaves %.6g mm of half width at the tip, %.6g mm from the "
                   "base, but %s need %.6g mm\nthe limit is %.4f deg",
                   to_deg(taper), to_mm(tip), to_mm(s->length), need.what, to_mm(need.half_width),
                   to_deg(atan(fmax(0.5 * s->width - need.half_width, 0.0) / s->length)));
}

static enum status check_channel_height(const struct pneunet_spec *s, struct error *error) {
  if (!s->has_channel || s->channel_cover + s->channel_height < s->bottom_layer) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_GEOMETRY, "/actuator/channel/height",
                   "a channel of %.6g mm under a cover of %.6g mm leaves no floor in a bottom "
                   "layer of %.6g mm\nthe channel must be lower than %.6g mm",
                   to_mm(s->channel_height), to_mm(s->channel_cover), to_mm(s->bottom_layer),
                   to_mm(fmax(s->bottom_layer - s->channel_cover, 0.0)));
}

/* Solid layers and slit over the height, with a cavity of the least height. */
static double vertical_need(const struct pneunet_spec *s) {
  double need = s->bottom_layer + s->top_wall + CAVITY_MINIMUM;
  return has_config(s, CHAMBER_C) ? need + s->slit + s->slit_floor : need;
}

static enum status check_height(const struct pneunet_spec *s, struct error *error) {
  double need = vertical_need(s);
  bool single = s->height_base == s->height_tip;
  const char *layers = has_config(s, CHAMBER_C)
                           ? "bottom layer, slit, slit floor, top wall and a cavity of 0.1 mm"
                           : "bottom layer, top wall and a cavity of 0.1 mm";
  if (s->height_base < need) {
    return error_set(error, STATUS_GEOMETRY, single ? "/actuator/height" : "/actuator/height/base",
                     "a height of %.6g mm is too small for %s\nat least %.6g mm",
                     to_mm(s->height_base), layers, to_mm(need));
  }
  if (s->height_tip < need) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/height/tip",
                     "a height of %.6g mm at the tip is too small for %s\nat least %.6g mm",
                     to_mm(s->height_tip), layers, to_mm(need));
  }
  return STATUS_OK;
}

/* The form of the gaps below their tops. */
static enum status check_gaps(const struct pneunet_spec *s, struct error *error) {
  double height = fmin(s->height_base, s->height_tip) - s->bottom_layer;
  if (s->gap_root > s->chamber_gap) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/gap_root",
                     "the gaps would be %.6g mm wide at the root, more than at the top\nat most "
                     "chamber_gap, %.6g mm",
                     to_mm(s->gap_root), to_mm(s->chamber_gap));
  }
  if (s->gap_round > height) {
    return error_set(error, STATUS_GEOMETRY, "/actuator/gap_round",
                     "the rounded bottom of a U of %.6g mm is higher than the gaps\nat most their "
                     "height, %.6g mm",
                     to_mm(s->gap_round), to_mm(height));
  }
  return STATUS_OK;
}

/* Height of the tip, of which tapers must leave so much. */
static double tip_need(const struct pneunet_spec *s) {
  double need = vertical_need(s), cavity = s->height_base - need + CAVITY_MINIMUM;
  return s->scaled_walls ? s->height_base * CAVITY_MINIMUM / cavity : need;
}

static enum status check_vertical_taper(const struct pneunet_spec *s, struct error *error) {
  double room = (fmin(s->height_base, s->height_tip) - tip_need(s)) / s->length;
  double top = tan(s->taper_top), bottom = tan(s->taper_bottom);
  if (top + bottom <= room) {
    return STATUS_OK;
  }
  double larger = fmax(top, bottom), smaller = fmin(top, bottom);
  bool both = smaller > 0.0 && smaller < room;
  return error_set(error, STATUS_GEOMETRY,
                   larger == top ? "/actuator/taper/top" : "/actuator/taper/bottom",
                   "tapers of top and bottom leave %.6g mm of height at the tip, but walls and a "
                   "cavity of 0.1 mm need %.6g mm\nthe limit is %.4f deg%s",
                   to_mm(s->height_tip - s->length * (top + bottom)), to_mm(tip_need(s)),
                   to_deg(atan(both ? room - smaller : room)), both ? " beside the other one" : "");
}

enum status pneunet_check(const struct pneunet_spec *s, struct error *error) {
  enum status status = check_width(s, error);
  if (status == STATUS_OK) {
    status = check_channel_height(s, error);
  }
  if (status == STATUS_OK) {
    status = check_height(s, error);
  }
  if (status == STATUS_OK) {
    status = check_gaps(s, error);
  }
  if (status == STATUS_OK) {
    status = check_lateral_taper(s, s->taper_left, "/actuator/taper/left", error);
  }
  if (status == STATUS_OK) {
    status = check_lateral_taper(s, s->taper_right, "/actuator/taper/right", error);
  }
  if (status == STATUS_OK) {
    status = check_vertical_taper(s, error);
  }
  return status == STATUS_OK ? pneunet_check_suckers(s, error) : status;
}
