/* Where the suckers of a pneu-net can be. Lengths in messages are in mm. */
#include <math.h>
#include <stdio.h>

#include "solver/job/reader.h"

/* What has to stay free around a sucker, m. */
static const double margin = 1e-4;

static double to_mm(double metres) {
  return metres * 1e3;
}

static double outer_radius(const struct sucker_spec *sucker) {
  return 0.5 * sucker->diameter + sucker->wall;
}

/* Largest circle about the middle of the bottom face at x that the tapered sides leave. */
static double lateral_room(const struct pneunet_spec *s, double x) {
  double left = (0.5 * s->width - x * tan(s->taper_left)) * cos(s->taper_left);
  double right = (0.5 * s->width - x * tan(s->taper_right)) * cos(s->taper_right);
  return fmin(left, right);
}

static enum status check_ring(const struct pneunet_spec *s, int index, struct error *error) {
  const struct sucker_spec *sucker = &s->sucker[index];
  double outer = outer_radius(sucker), room = lateral_room(s, sucker->position);
  char place[60];
  if (sucker->wall > 0.5 * sucker->diameter) {
    snprintf(place, sizeof place, "/actuator/suckers/%d/wall", index);
    return error_set(error, STATUS_GEOMETRY, place,
                     "a ring of %.6g mm is thicker than the radius of its opening\nat most %.6g mm "
                     "are possible for a diameter of %.6g mm",
                     to_mm(sucker->wall), to_mm(0.5 * sucker->diameter), to_mm(sucker->diameter));
  }
  double first = outer + margin, last = s->length - outer - margin;
  if (sucker->position < first || sucker->position > last) {
    snprintf(place, sizeof place, "/actuator/suckers/%d/position", index);
    return error_set(error, STATUS_GEOMETRY, place,
                     "a sucker of %.6g mm with its ring, in the middle at %.6g mm, leaves the body "
                     "at its %s\nthe middle must be between %.6g mm and %.6g mm",
                     to_mm(2 * outer), to_mm(sucker->position),
                     sucker->position < first ? "base" : "tip", to_mm(first), to_mm(last));
  }
  if (outer + margin > room) {
    snprintf(place, sizeof place, "/actuator/suckers/%d/diameter", index);
    return error_set(error, STATUS_GEOMETRY, place,
                     "a sucker of %.6g mm with its ring is wider than the body, which leaves room "
                     "for %.6g mm at %.6g mm from the base\nthe diameter can be at most %.6g mm",
                     to_mm(2 * outer), to_mm(2 * (room - margin)), to_mm(sucker->position),
                     to_mm(fmax(0.0, 2 * (room - margin - sucker->wall))));
  }
  return STATUS_OK;
}

static enum status check_pair(const struct pneunet_spec *s, int first, int second,
                              struct error *error) {
  const struct sucker_spec *a = &s->sucker[first], *b = &s->sucker[second];
  double distance = fabs(a->position - b->position);
  double least = outer_radius(a) + outer_radius(b) + margin;
  if (distance >= least) {
    return STATUS_OK;
  }
  char place[60];
  snprintf(place, sizeof place, "/actuator/suckers/%d/position", second);
  return error_set(error, STATUS_GEOMETRY, place,
                   "the sucker overlaps that of /actuator/suckers/%d: their middles are %.6g mm "
                   "apart\nat least %.6g mm, with their rings",
                   first, to_mm(distance), to_mm(least));
}

enum status pneunet_check_suckers(const struct pneunet_spec *s, struct error *error) {
  enum status status = STATUS_OK;
  for (int k = 0; k < s->sucker_count && status == STATUS_OK; k++) {
    status = check_ring(s, k, error);
    for (int other = 0; other < k && status == STATUS_OK; other++) {
      status = check_pair(s, other, k, error);
    }
  }
  return status;
}
