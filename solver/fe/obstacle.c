#include "solver/fe/obstacle_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"

static void obstacle_destroy(struct obstacle *o) {
  if (o) {
    free(o->point);
    free(o->near);
    free(o);
  }
}

void obstacles_release(struct fe_model *m) {
  for (int k = 0; k < m->obstacle_count; k++) {
    obstacle_destroy(m->obstacle[k]);
  }
  m->obstacle_count = 0;
}

enum status model_add_obstacle(struct fe_model *m, const struct rigid_shape *shape, double friction,
                               int *index, struct error *error) {
  if (!(friction >= 0 && isfinite(friction))) {
    return error_set(error, STATUS_INVALID, "/friction",
                     "the coefficient of friction is %g\nat least 0\n0.6", friction);
  }
  if (m->obstacle_count == MODEL_OBSTACLES) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "more than %d objects", MODEL_OBSTACLES);
  }
  size_t faces = (size_t)m->contact.face_count;
  struct obstacle *o = calloc(1, sizeof *o);
  if (o) {
    o->point = calloc(QUAD9_POINTS * faces + 1, sizeof *o->point);
    o->near = calloc(faces + 1, 1);
  }
  if (!o || !o->point || !o->near) {
    obstacle_destroy(o);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the contact with an object");
  }
  o->shape = shape;
  o->pose = o->committed = rigid_pose_identity();
  o->coefficient = friction;
  o->stiffness = o->tangential = m->contact.stiffness;
  o->smoothing = m->contact.smoothing;
  for (size_t i = 0; i < QUAD9_POINTS * faces; i++) {
    o->point[i].area = m->contact.point[i].area;
    obstacle_point_clear(&o->point[i]);
  }
  *index = m->obstacle_count;
  m->obstacle[m->obstacle_count++] = o;
  obstacle_renew_reach(m, o);
  return STATUS_OK;
}

void model_place_obstacle(struct fe_model *m, int index, const struct rigid_pose *pose) {
  struct obstacle *o = m->obstacle[index];
  o->pose = *pose;
  if (!o->placed) {
    o->committed = *pose;
    o->placed = true;
  }
  obstacle_renew_reach(m, o);
}

void model_reject_obstacles(struct fe_model *m) {
  for (int k = 0; k < m->obstacle_count; k++) {
    struct obstacle *o = m->obstacle[k];
    o->pose = o->committed;
    obstacle_renew_reach(m, o);
  }
}

/* Work that friction has dissipated at one point since the last commit, J: by the mean of the
 * tractions at both ends of the way, with which the works of the pressure and of the object are
 * taken too, so that the ledger closes where contact comes or goes within a step. */
static double point_work(const struct obstacle *o, const struct obstacle_point *point) {
  const struct obstacle_memory *memory = &point->memory;
  double place[3], traction[3], work = 0;
  if (!memory->seen || (point->pressure > 0 && !point->slips)) {
    return 0;
  }
  rigid_pose_inward(&o->pose, point->x, place);
  rigid_pose_turn_inward(&o->pose, point->friction, traction);
  for (int i = 0; i < 3; i++) {
    work += 0.5 * point->area * (memory->drag[i] - traction[i]) * (place[i] - memory->place[i]);
  }
  return work;
}

/* Ends the step for one point. */
static void commit_point(const struct obstacle *o, struct obstacle_point *point) {
  struct obstacle_memory *memory = &point->memory;
  bool touches = point->pressure > 0, anew = touches && !memory->held;
  double place[3], traction[3];
  rigid_pose_inward(&o->pose, point->x, place);
  rigid_pose_turn_inward(&o->pose, point->friction, traction);
  if (!touches) {
    *memory = (struct obstacle_memory){.pressure = 0};
  } else if (anew) {
    rigid_pose_turn_inward(&o->pose, point->normal, memory->normal);
  }
  for (int i = 0; i < 3; i++) {
    memory->drag[i] = -traction[i];
    memory->place[i] = place[i];
    if (touches && point->slips) {
      memory->traction[i] = -traction[i]; /* which stays, without slip */
    }
    if (anew || (touches && point->slips)) {
      memory->anchor[i] = place[i];
    }
  }
  memory->held = touches;
  memory->seen = true;
}

/* Evaluates all objects at the state, and where all points are, also those out of reach. */
static void look(struct fe_model *m, const struct fe_state *state) {
  obstacles_use(m, state);
  obstacles_look(m, state->u);
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    double x[QUAD9_NODES][3];
    obstacle_face_positions(m, state->u, f, nodes, x);
    for (int k = 0; k < m->obstacle_count; k++) {
      for (int q = 0; q < QUAD9_POINTS; q++) {
        obstacle_point_place(&m->quad9, q, x, m->obstacle[k]->point[QUAD9_POINTS * f + q].x);
      }
    }
  }
}

/* Works since the last commit, as last looked at; that of the object's motion by the mean of the
 * resultants before and after. */
static struct obstacle_work works(const struct fe_model *m, const struct obstacle *o,
                                  const struct obstacle_state *state) {
  struct obstacle_work work = {0, 0};
  double turn[3];
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    work.friction += point_work(o, &o->point[i]);
  }
  /* rotation_between sees the turn from the first frame. */
  rotation_between(o->committed.rotation, o->pose.rotation, turn);
  rigid_pose_turn_outward(&o->committed, turn, turn);
  for (int i = 0; i < 3; i++) {
    double shift = o->pose.place[i] - o->committed.place[i];
    work.motion -= 0.5 * (o->force[i] + state->force[i]) * shift;
    work.motion -= 0.5 * (o->moment[i] + state->moment[i]) * turn[i];
  }
  return work;
}

struct obstacle_work model_obstacle_work(struct fe_model *m, const struct fe_state *state,
                                         int index) {
  look(m, state);
  struct obstacle_state sums = model_obstacle_state(m, index);
  return works(m, m->obstacle[index], &sums);
}

void model_commit_obstacles(struct fe_model *m, struct fe_state *state) {
  if (m->obstacle_count == 0) {
    return;
  }
  look(m, state);
  for (int k = 0; k < m->obstacle_count; k++) {
    struct obstacle *o = m->obstacle[k];
    struct obstacle_state sums = model_obstacle_state(m, k);
    struct obstacle_work work = works(m, o, &sums);
    for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
      commit_point(o, &o->point[i]);
    }
    memcpy(o->force, sums.force, sizeof o->force);
    memcpy(o->moment, sums.moment, sizeof o->moment);
    o->committed = o->pose;
    o->friction_work = work.friction;
    o->motion_work = work.motion;
    o->friction_total += work.friction;
    o->motion_total += work.motion;
  }
  obstacles_keep(m, state);
}
