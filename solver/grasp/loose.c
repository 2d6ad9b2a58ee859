#include "solver/grasp/loose.h"

#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/grasp/finger.h"

/* Distance from the finger at which what goes away has left, in its size. */
static const double left_by = 0.25;

/* Direction of the weight, or of the pull where there is none. */
static void find_direction(struct finger *f, bool pulled) {
  const struct grasp_spec *g = &f->grasp;
  double weight = vec3_norm(g->gravity);
  memset(f->lead.axis, 0, sizeof f->lead.axis);
  for (int i = 0; i < 3; i++) {
    f->lead.direction[i] = pulled || weight == 0 ? g->pull.direction[i] : g->gravity[i] / weight;
  }
}

enum status loose_begin(struct finger *f, struct error *error) {
  struct loose *l = &f->loose;
  const struct grasp_fingers *fingers = &f->grasp.fingers;
  double mass = f->grasp.object.mass / fingers->count;
  enum status status = free_object_create(f->solve.solver, f->obstacle, mass, &l->object, error);
  if (status != STATUS_OK) {
    return status;
  }
  memcpy(l->object->gravity, f->grasp.gravity, sizeof l->object->gravity);
  if (fingers->count > 1) {
    const double axis[3] = {cos(fingers->tilt), 0, -sin(fingers->tilt)};
    free_object_guide(l->object, axis);
  }
  loose_apply(f, 0, 0);
  free_object_resultant(l->object, l->support);
  for (int i = 0; i < 6; i++) {
    l->support[i] = -l->support[i];
  }
  free_object_centroid(l->object, l->start);
  l->clearance = INFINITY;
  f->dynamics->object = l->object;
  f->solve.solver->factor_fits = false;
  loose_apply(f, 1, 0);
  free_object_begin(l->object);
  return STATUS_OK;
}

void loose_end(struct finger *f) {
  if (f->loose.object) {
    f->dynamics->object = NULL;
    free_object_destroy(f->solve.solver, f->loose.object);
  }
  f->loose = (struct loose){.fell = false};
}

void loose_apply(struct finger *f, double support, double pull) {
  struct free_object *o = f->loose.object;
  double force = pull * f->grasp.pull.force / (f->grasp.fingers.count * f->whole);
  const double *cups = f->cups.force;
  double centre[3], carried[3];
  free_object_centroid(o, centre);
  vec3_cross(centre, cups, carried);
  for (int i = 0; i < 3; i++) {
    o->applied[i] = support * f->loose.support[i] + force * f->grasp.pull.direction[i] + cups[i];
    o->applied[3 + i] = support * f->loose.support[3 + i] + cups[3 + i] - carried[i];
  }
  find_direction(f, force > 0);
}

double loose_way(const struct finger *f) {
  double place[3];
  free_object_centroid(f->loose.object, place);
  for (int i = 0; i < 3; i++) {
    place[i] -= f->loose.start[i];
  }
  return vec3_norm(place);
}

bool loose_watch(struct finger *f) {
  struct loose *l = &f->loose;
  const struct fe_model *m = f->solve.model;
  bool touched = model_obstacle_state(m, f->obstacle).touching > 0;
  double before = l->clearance;
  l->clearance = touched ? 0 : model_obstacle_clearance(m, f->obstacle, f->solve.state.u);
  l->fell = l->clearance > left_by * l->object->size && l->clearance >= before;
  return l->fell;
}
