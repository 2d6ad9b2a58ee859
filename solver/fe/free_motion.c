/* A rigid object in a step in time. */
#include <string.h>
#include "solver/fe/free_object.h"
#include "solver/base/vec3.h"

/* Where the step has brought the object: end of the step by Newmark's formulas. */
struct end {
  double arm[3];                       /* place to centroid */
  double turn[3];                      /* rotation vector of the step, in its frame */
  double acceleration[3], velocity[3]; /* of the centroid */
  double turning[3], spin[3];          /* in its frame */
};

static void newmark(const struct object_step *s, double way, double velocity, double acceleration,
                    double *end_acceleration, double *end_velocity) {
  *end_acceleration =
      (way - s->h * velocity) / (s->beta * s->h * s->h) - (0.5 / s->beta - 1) * acceleration;
  *end_velocity = velocity + s->h * ((1 - s->gamma) * acceleration + s->gamma * *end_acceleration);
}

static void find_end(const struct free_object *o, struct end *e) {
  const struct rigid_pose *pose = &o->model->obstacle[o->index]->pose;
  double from[3], to[3];
  rigid_pose_outward(&o->start, o->centroid, from);
  rigid_pose_outward(pose, o->centroid, to);
  rigid_pose_turn_outward(pose, o->centroid, e->arm);
  rotation_between(o->start.rotation, pose->rotation, e->turn);
  for (int i = 0; i < 3; i++) {
    newmark(&o->step, to[i] - from[i], o->step.velocity[i], o->step.acceleration[i],
            &e->acceleration[i], &e->velocity[i]);
    newmark(&o->step, e->turn[i], o->step.spin[i], o->step.turning[i], &e->turning[i], &e->spin[i]);
  }
}

/* Rate of the moment of momentum in the object's frame, I A + W x I W, with the drag. */
static void gyration(const struct free_object *o, const double turning[3], const double spin[3],
                     double drag, double rate[3]) {
  double momentum[3], turned[3];
  mat3_apply(o->inertia, spin, momentum);
  mat3_apply(o->inertia, turning, rate);
  vec3_cross(spin, momentum, turned);
  for (int i = 0; i < 3; i++) {
    rate[i] += turned[i] + drag * momentum[i];
  }
}

/* The rate at the end of the step, with the accelerations of its balance. */
static void balance_rate(const struct free_object *o, const struct end *e, double rate[3]) {
  double mixed[3];
  for (int i = 0; i < 3; i++) {
    mixed[i] = (1 - o->step.alpha) * e->turning[i] + o->step.alpha * o->step.turning[i];
  }
  gyration(o, mixed, e->spin, o->step.drag, rate);
}

/* Change of `rate` by the change `turn` of the rotation vector, in the object's frame. */
static void rate_change(const struct free_object *o, const struct end *e, const double turn[3],
                        double change[3]) {
  const struct object_step *s = &o->step;
  double by_turning = (1 - s->alpha) / (s->beta * s->h * s->h),
         by_spin = s->gamma / (s->beta * s->h);
  double turning[3], spin[3], momentum[3], own[3], other[3];
  for (int i = 0; i < 3; i++) {
    turning[i] = by_turning * turn[i];
    spin[i] = by_spin * turn[i];
  }
  mat3_apply(o->inertia, turning, change);
  mat3_apply(o->inertia, e->spin, momentum);
  vec3_cross(spin, momentum, own);
  mat3_apply(o->inertia, spin, momentum);
  vec3_cross(e->spin, momentum, other);
  for (int i = 0; i < 3; i++) {
    change[i] += own[i] + other[i] + s->drag * momentum[i];
  }
}

/* Columns of the tangent: a shift moves the centroid, a turn about the place swings it, too. */
static void add_tangent(const struct free_object *o, const struct end *e, const double rate[3],
                        double tangent[36]) {
  const struct object_step *s = &o->step;
  const struct rigid_pose *pose = &o->model->obstacle[o->index]->pose;
  double inert =
      o->mass * ((1 - s->alpha) / (s->beta * s->h * s->h) + s->drag * s->gamma / (s->beta * s->h));
  double outer_rate[3];
  rigid_pose_turn_outward(pose, rate, outer_rate);
  for (int j = 0; j < 3; j++) {
    double unit[3] = {j == 0, j == 1, j == 2}, swing[3], turn[3], half[3], change[3], carried[3];
    tangent[7 * j] += inert;
    vec3_cross(unit, e->arm, swing);
    /* The rotation vector changes by (1 + turn/2 x) R^T w, to first order in the turn. */
    rigid_pose_turn_inward(pose, unit, turn);
    vec3_cross(e->turn, turn, half);
    for (int i = 0; i < 3; i++) {
      turn[i] += 0.5 * half[i];
    }
    rate_change(o, e, turn, change);
    rigid_pose_turn_outward(pose, change, change);
    vec3_cross(unit, outer_rate, carried);
    for (int i = 0; i < 3; i++) {
      tangent[6 * i + 3 + j] += inert * swing[i];
      tangent[6 * (3 + i) + 3 + j] += change[i] + carried[i];
    }
  }
}

void free_motion_add(const struct free_object *o, double residual[6], double tangent[36]) {
  const struct object_step *s = &o->step;
  if (s->h <= 0) {
    return;
  }
  struct end e;
  double rate[3], outer[3];
  find_end(o, &e);
  balance_rate(o, &e, rate);
  rigid_pose_turn_outward(&o->model->obstacle[o->index]->pose, rate, outer);
  for (int i = 0; i < 3; i++) {
    double mixed = (1 - s->alpha) * e.acceleration[i] + s->alpha * s->acceleration[i];
    residual[i] += o->mass * (mixed + s->drag * e.velocity[i]);
    residual[3 + i] += outer[i];
  }
  if (tangent) {
    add_tangent(o, &e, rate, tangent);
  }
}

void free_motion_end(const struct free_object *o, double acceleration[3], double turning[3]) {
  struct end e;
  find_end(o, &e);
  memcpy(acceleration, e.acceleration, sizeof e.acceleration);
  memcpy(turning, e.turning, sizeof e.turning);
}

void free_motion_accept(const struct free_object *o, struct object_motion *motion) {
  const struct object_step *s = &o->step;
  struct end e;
  find_end(o, &e);
  for (int i = 0; i < 3; i++) {
    motion->velocity[i] = e.velocity[i];
    motion->spin[i] = e.spin[i];
    motion->balanced[i] = (1 - s->alpha) * e.acceleration[i] + s->alpha * s->acceleration[i];
    motion->balanced_turning[i] = (1 - s->alpha) * e.turning[i] + s->alpha * s->turning[i];
    motion->acceleration[i] = e.acceleration[i];
    motion->turning[i] = e.turning[i];
  }
}

/* x of the symmetric a x = b. */
static void solve3(const double a[9], const double b[3], double x[3]) {
  double c[3][3];
  vec3_cross(a + 3, a + 6, c[0]);
  vec3_cross(a + 6, a, c[1]);
  vec3_cross(a, a + 3, c[2]);
  double determinant = vec3_dot(a, c[0]);
  for (int i = 0; i < 3; i++) {
    x[i] = (b[0] * c[0][i] + b[1] * c[1][i] + b[2] * c[2][i]) / determinant;
  }
}

void free_motion_balance(const struct free_object *o, double drag, struct object_motion *motion) {
  const struct rigid_pose *pose = &o->model->obstacle[o->index]->pose;
  const double still[3] = {0, 0, 0};
  double resultant[6], rate[3], moment[3];
  free_object_resultant(o, resultant);
  rigid_pose_turn_inward(pose, resultant + 3, moment);
  gyration(o, still, motion->spin, drag, rate);
  for (int i = 0; i < 3; i++) {
    moment[i] -= rate[i];
    motion->balanced[i] = resultant[i] / o->mass - drag * motion->velocity[i];
  }
  solve3(o->inertia, moment, motion->balanced_turning);
  memcpy(motion->acceleration, motion->balanced, sizeof motion->acceleration);
  memcpy(motion->turning, motion->balanced_turning, sizeof motion->turning);
}

double free_motion_kinetic(const struct free_object *o, const struct object_motion *motion) {
  double momentum[3];
  mat3_apply(o->inertia, motion->spin, momentum);
  return 0.5 * (o->mass * vec3_dot(motion->velocity, motion->velocity) +
                vec3_dot(motion->spin, momentum));
}

void free_motion_momentum(const struct free_object *o, const struct object_motion *motion,
                          double linear[3], double angular[3]) {
  mat3_apply(o->inertia, motion->spin, angular);
  rigid_pose_turn_outward(&o->model->obstacle[o->index]->pose, angular, angular);
  for (int i = 0; i < 3; i++) {
    linear[i] = o->mass * motion->velocity[i];
  }
}
