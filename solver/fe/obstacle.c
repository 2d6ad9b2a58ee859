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

/* Ends the step for one point; returns the work that friction has dissipated there, J. */
static double commit_point(const struct obstacle *o, struct obstacle_point *point) {
  struct obstacle_memory *memory = &point->memory;
  double traction[3], slip[3], work = 0;
  if (!(point->pressure > 0)) {
    *memory = (struct obstacle_memory){.pressure = 0};
    return 0;
  }
  if (memory->held && !point->slips) {
    memset(memory->rubbed, 0, sizeof memory->rubbed);
    return 0;
  }
  if (memory->held) {
    rigid_pose_turn_inward(&o->pose, point->friction, traction);
    rigid_pose_turn_inward(&o->pose, point->slip, slip);
    /* Where it slipped before, the mean of the tractions is right to second order. */
    bool rubbed = vec3_dot(memory->rubbed, memory->rubbed) > 0;
    for (int i = 0; i < 3; i++) {
      double end = -traction[i], start = rubbed ? memory->rubbed[i] : end;
      work += 0.5 * point->area * (start + end) * slip[i];
      memory->rubbed[i] = memory->traction[i] = end; /* the traction stays, without slip */
    }
  } else {
    rigid_pose_turn_inward(&o->pose, point->normal, memory->normal);
  }
  memory->held = true;
  rigid_pose_inward(&o->pose, point->x, memory->anchor);
  return work;
}

/* Work that the object's motion since the last commit has done on the body, by the mean of the
 * resultants before and after. Renews the former. */
static double commit_motion(struct obstacle *o, const struct obstacle_state *state) {
  double turn[3], work = 0;
  /* rotation_between sees the turn from the first frame. */
  rotation_between(o->committed.rotation, o->pose.rotation, turn);
  rigid_pose_turn_outward(&o->committed, turn, turn);
  for (int i = 0; i < 3; i++) {
    double shift = o->pose.place[i] - o->committed.place[i];
    work -= 0.5 * (o->force[i] + state->force[i]) * shift;
    work -= 0.5 * (o->moment[i] + state->moment[i]) * turn[i];
    o->force[i] = state->force[i];
    o->moment[i] = state->moment[i];
  }
  o->committed = o->pose;
  return work;
}

void model_commit_obstacles(struct fe_model *m, struct fe_state *state) {
  if (m->obstacle_count == 0) {
    return;
  }
  obstacles_use(m, state);
  obstacles_look(m, state->u);
  for (int k = 0; k < m->obstacle_count; k++) {
    struct obstacle *o = m->obstacle[k];
    struct obstacle_state sums = model_obstacle_state(m, k);
    o->friction_work = 0;
    for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
      o->friction_work += commit_point(o, &o->point[i]);
    }
    o->motion_work = commit_motion(o, &sums);
    o->friction_total += o->friction_work;
    o->motion_total += o->motion_work;
  }
  obstacles_keep(m, state);
}
