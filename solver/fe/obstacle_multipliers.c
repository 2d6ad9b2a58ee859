/* Multipliers of the contact with rigid objects: their way from and to a state, and their updates.
 */
#include <math.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

size_t obstacles_memory_count(const struct fe_model *m) {
  return (size_t)m->obstacle_count * QUAD9_POINTS * (size_t)m->contact.face_count;
}

void obstacles_use(struct fe_model *m, const struct fe_state *state) {
  size_t count = QUAD9_POINTS * (size_t)m->contact.face_count;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (size_t i = 0; i < count; i++) {
      m->obstacle[k]->point[i].memory = state->memory[(size_t)k * count + i];
    }
    obstacle_renew_reach(m, m->obstacle[k]);
  }
}

void obstacles_keep(const struct fe_model *m, struct fe_state *state) {
  size_t count = QUAD9_POINTS * (size_t)m->contact.face_count;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (size_t i = 0; i < count; i++) {
      state->memory[(size_t)k * count + i] = m->obstacle[k]->point[i].memory;
    }
  }
}

double obstacles_intrusion(const struct fe_model *m) {
  double deepest = 0;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
      deepest = fmax(deepest, -m->obstacle[k]->point[i].gap);
    }
  }
  return deepest;
}

/* lambda and tau that the tractions of a point ask for, less those that it has. */
static void point_change(const struct obstacle *o, const struct obstacle_point *point,
                         double change[OBSTACLE_VALUES]) {
  double traction[3];
  change[0] = point->wanted - point->memory.pressure;
  rigid_pose_turn_inward(&o->pose, point->friction, traction);
  for (int i = 0; i < 3; i++) {
    change[1 + i] = point->memory.held ? -traction[i] - point->memory.traction[i] : 0;
  }
}

void obstacle_face_multipliers(const struct obstacle *o, int f,
                               double value[QUAD9_POINTS][OBSTACLE_VALUES],
                               double change[QUAD9_POINTS][OBSTACLE_VALUES]) {
  const struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f];
  for (int q = 0; q < QUAD9_POINTS; q++) {
    value[q][0] = point[q].memory.pressure;
    memcpy(value[q] + 1, point[q].memory.traction, 3 * sizeof(double));
    point_change(o, &point[q], change[q]);
  }
}

/* Turns the tangential vector t of the normal a into the tangent plane of b, the shortest way. */
static void turn_tangent(const double a[3], const double b[3], double t[3]) {
  double cosine = vec3_dot(a, b), along = vec3_dot(b, t);
  for (int i = 0; i < 3; i++) {
    t[i] = cosine > -0.99 ? t[i] - along / (1 + cosine) * (a[i] + b[i]) : 0;
  }
}

/* Gives a point that was apart at the last commit the stick point where it touched: see obstacle.h.
 */
static void touch(const struct obstacle *o, struct obstacle_point *point) {
  struct obstacle_memory *memory = &point->memory;
  double depth = point->pressure / o->stiffness, place[3];
  struct rigid_nearest start;
  bool apart = rigid_shape_nearest(o->shape, memory->place, INFINITY, &start) && start.distance > 0;
  double share = apart ? depth / (depth + start.distance) : 1;
  rigid_pose_inward(&o->pose, point->x, place);
  for (int i = 0; i < 3; i++) {
    memory->anchor[i] = place[i] - share * (place[i] - memory->place[i]);
    memory->traction[i] = 0;
  }
  rigid_pose_turn_inward(&o->pose, point->normal, memory->normal);
  memory->held = true;
}

void obstacle_face_set(const struct obstacle *o, int f,
                       double value[QUAD9_POINTS][OBSTACLE_VALUES]) {
  for (int q = 0; q < QUAD9_POINTS; q++) {
    struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f + (size_t)q];
    struct obstacle_memory *memory = &point->memory;
    double normal[3];
    memory->pressure = fmax(0, value[q][0]);
    if (!memory->held && memory->seen && point->pressure > 0) {
      touch(o, point);
      continue;
    }
    if (!memory->held || !isfinite(point->gap)) {
      continue;
    }
    memcpy(memory->traction, value[q] + 1, sizeof memory->traction);
    rigid_pose_turn_inward(&o->pose, point->normal, normal);
    turn_tangent(memory->normal, normal, memory->traction);
    memcpy(memory->normal, normal, sizeof normal);
  }
}
