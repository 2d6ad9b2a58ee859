#include "solver/fe/free_object.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/lapack.h"
#include "solver/base/vec3.h"

/* Pivots of the six by six system below this part of the largest one belong to motions that nothing
 * resists: they are left out if nothing drives them either, to this part of the forces. */
static const double idle_pivot = 1e-10, idle_force = 1e-5;
/* Stiffnesses of the object below this part of the largest one are taken for none. */
static const double idle_stiffness = 1e-6;

void free_object_centroid(const struct free_object *o, double centroid[3]) {
  rigid_pose_outward(&o->model->obstacle[o->index]->pose, o->centroid, centroid);
}

/* From the place to the centroid. */
static void arm_of(const struct free_object *o, double arm[3]) {
  rigid_pose_turn_outward(&o->model->obstacle[o->index]->pose, o->centroid, arm);
}

/* Takes the moments in rows 3 to 5 of a column (force, moment) from the place to the centroid. */
static void shift_moment(const double arm[3], double column[6]) {
  double moment[3];
  vec3_cross(arm, column, moment);
  for (int i = 0; i < 3; i++) {
    column[3 + i] -= moment[i];
  }
}

/* Leaves of force and moment what can move the object. */
static void project(const struct free_object *o, double v[6]) {
  if (o->guided) {
    double along = vec3_dot(o->axis, v);
    for (int i = 0; i < 3; i++) {
      v[i] = along * o->axis[i];
      v[3 + i] = 0;
    }
  }
  for (int i = 1; o->half && i < 6; i += 2) {
    v[i] = 0;
  }
}

void free_object_guide(struct free_object *o, const double axis[3]) {
  o->guided = true;
  memcpy(o->axis, axis, sizeof o->axis);
}

void free_object_resultant(const struct free_object *o, double resultant[6]) {
  struct obstacle_state s = model_obstacle_state(o->model, o->index);
  double arm[3];
  arm_of(o, arm);
  memcpy(resultant, s.force, sizeof s.force);
  memcpy(resultant + 3, s.moment, sizeof s.moment);
  shift_moment(arm, resultant);
  for (int i = 0; i < 3; i++) {
    resultant[i] += o->mass * o->gravity[i] + o->applied[i];
    resultant[3 + i] += o->applied[3 + i];
  }
  project(o, resultant);
}

/* g: what inertia wants less what the forces give. */
static void residual_of(const struct free_object *o, double residual[6]) {
  free_object_resultant(o, residual);
  for (int i = 0; i < 6; i++) {
    residual[i] = -residual[i];
  }
  free_motion_add(o, residual, NULL);
}

double free_object_unbalanced(const struct free_object *o) {
  double residual[6];
  residual_of(o, residual);
  return vec3_norm(residual) + vec3_norm(residual + 3) / o->size;
}

/* The coupling by motions of the object, moments about its centroid. */
static void renew_coupling(struct free_object *o) {
  struct obstacle_coupling *c = &o->coupling;
  double arm[3];
  model_obstacle_coupling(o->model, o->index, c);
  arm_of(o, arm);
  int count = o->model->dof_count;
  for (int d = 0; d < count; d++) {
    double column[6];
    for (int i = 0; i < 6; i++) {
      column[i] = c->by_u[i * count + d];
    }
    shift_moment(arm, column);
    for (int i = 3; i < 6; i++) {
      c->by_u[i * count + d] = column[i];
    }
  }
  for (int j = 0; j < 6; j++) {
    double column[6], turned[3] = {0}, moment[3] = {0};
    for (int i = 0; i < 6; i++) {
      column[i] = c->own[6 * i + j];
    }
    shift_moment(arm, column);
    if (j >= 3) { /* the arm turns with the object: -(w x arm) x force */
      double unit[3] = {j == 3, j == 4, j == 5};
      vec3_cross(unit, arm, turned);
      vec3_cross(turned, c->resultant, moment);
    }
    for (int i = 3; i < 6; i++) {
      c->own[6 * i + j] = column[i] - moment[i - 3];
    }
  }
}

/* After a factorisation: X and G + C X. */
static void factored(void *context) {
  struct free_object *o = context;
  int count = o->model->dof_count;
  double residual[6] = {0};
  renew_coupling(o);
  for (int i = 0; i < 36; i++) {
    o->tangent[i] = -o->coupling.own[i];
  }
  free_motion_add(o, residual, o->tangent);
  for (int j = 0; j < 6; j++) {
    double *x = o->response + (size_t)j * (size_t)count;
    model_solve(o->model, o->coupling.by_motion + (size_t)j * (size_t)count, x);
    for (int i = 0; i < 6; i++) {
      const double *row = o->coupling.by_u + (size_t)i * (size_t)count;
      o->tangent[6 * i + j] += cblas_ddot(count, row, 1, x, 1);
    }
  }
}

/* Puts the largest entry of rows and columns k .. 5 at (k, k). */
static void pivot(double a[6][7], int k, int order[6]) {
  int row = k, column = k;
  for (int i = k; i < 6; i++) {
    for (int j = k; j < 6; j++) {
      if (fabs(a[i][j]) > fabs(a[row][column])) {
        row = i;
        column = j;
      }
    }
  }
  for (int j = 0; j < 7; j++) {
    double other = a[k][j];
    a[k][j] = a[row][j];
    a[row][j] = other;
  }
  for (int i = 0; i < 6; i++) {
    double other = a[i][k];
    a[i][k] = a[i][column];
    a[i][column] = other;
  }
  int other = order[k];
  order[k] = order[column];
  order[column] = other;
}

/* Solves a x = (last column) by elimination with complete pivoting; motions without a pivot stay.
 * False when one of them is driven by more than `idle`. */
static bool solve6(double a[6][7], double idle, double x[6]) {
  int order[6] = {0, 1, 2, 3, 4, 5}, rank = 6;
  double largest = 0, y[6] = {0};
  for (int k = 0; k < rank; k++) {
    pivot(a, k, order);
    largest = k == 0 ? fabs(a[0][0]) : largest;
    if (!(fabs(a[k][k]) > idle_pivot * largest)) {
      rank = k;
    }
    for (int i = k + 1; k < rank && i < 6; i++) {
      double factor = a[i][k] / a[k][k];
      for (int j = k; j < 7; j++) {
        a[i][j] -= factor * a[k][j];
      }
    }
  }
  for (int k = rank - 1; k >= 0; k--) {
    y[k] = a[k][6];
    for (int j = k + 1; j < rank; j++) {
      y[k] -= a[k][j] * y[j];
    }
    y[k] /= a[k][k];
  }
  bool free_of_force = true;
  for (int k = 0; k < 6; k++) {
    x[order[k]] = y[k];
    free_of_force = free_of_force && (k < rank || fabs(a[k][6]) <= idle);
  }
  return free_of_force;
}

/* Stiffness of a guided object along its axis, N/m. */
static double guided_stiffness(const struct free_object *o) {
  double sum = 0;
  for (int i = 0; i < 9; i++) {
    sum += o->axis[i / 3] * o->tangent[6 * (i / 3) + i % 3] * o->axis[i % 3];
  }
  return sum;
}

/* As `correct`, of a guided object: one equation. */
static double correct_guided(struct free_object *o, double *step) {
  int count = o->model->dof_count;
  double residual[6], stiffness = guided_stiffness(o);
  residual_of(o, residual);
  double force = vec3_dot(o->axis, residual);
  double idle = idle_force * (o->mass * vec3_norm(o->gravity) + fabs(force));
  for (int i = 0; i < 3; i++) {
    const double *row = o->coupling.by_u + (size_t)i * (size_t)count;
    force += o->axis[i] * cblas_ddot(count, row, 1, step, 1);
  }
  bool good = stiffness != 0 || fabs(force) <= idle;
  double way = good && stiffness != 0 ? force / stiffness : 0;
  for (int j = 0; j < 6; j++) {
    o->correction[j] = j < 3 ? way * o->axis[j] : 0;
    cblas_daxpy(count, -o->correction[j], o->response + (size_t)j * (size_t)count, 1, step, 1);
  }
  return good ? fabs(way) : INFINITY;
}

/* From K^-1 r of the body alone to that of body and object. Turns and moments are scaled by the
 * object's size. */
static double correct(void *context, double *step) {
  struct free_object *o = context;
  if (o->guided) {
    return correct_guided(o, step);
  }
  int count = o->model->dof_count;
  double residual[6], a[6][7], x[6], scale = 1 / o->size;
  residual_of(o, residual);
  for (int i = 0; i < 6; i++) {
    const double *row = o->coupling.by_u + (size_t)i * (size_t)count;
    double by_row = i < 3 ? 1 : scale;
    a[i][6] = by_row * (residual[i] + cblas_ddot(count, row, 1, step, 1));
    for (int j = 0; j < 6; j++) {
      a[i][j] = by_row * (j < 3 ? 1 : scale) * o->tangent[6 * i + j];
    }
  }
  double resultant[3] = {residual[0], residual[1], residual[2]};
  double idle = idle_force * (o->mass * vec3_norm(o->gravity) + vec3_norm(resultant));
  if (o->half) { /* what leads out of the plane of symmetry stays */
    for (int i = 1; i < 6; i += 2) {
      for (int j = 0; j < 7; j++) {
        a[i][j] = 0;
      }
      for (int j = 0; j < 6; j++) {
        a[j][i] = 0;
      }
    }
  }
  bool good = solve6(a, idle, x);
  for (int j = 0; j < 6; j++) {
    o->correction[j] = good ? x[j] * (j < 3 ? 1 : scale) : 0;
    cblas_daxpy(count, -o->correction[j], o->response + (size_t)j * (size_t)count, 1, step, 1);
  }
  return good ? vec3_norm(x) + vec3_norm(x + 3) : INFINITY;
}

static void move(void *context, double share) {
  struct free_object *o = context;
  struct rigid_pose pose = o->model->obstacle[o->index]->pose;
  double shift[3], turn[3];
  for (int i = 0; i < 3; i++) {
    shift[i] = -share * o->correction[i];
    turn[i] = -share * o->correction[3 + i];
  }
  rigid_pose_move(&pose, shift, turn);
  model_place_obstacle(o->model, o->index, &pose);
}

static void keep(void *context) {
  struct free_object *o = context;
  o->kept = o->model->obstacle[o->index]->pose;
}

static void restore(void *context) {
  struct free_object *o = context;
  model_place_obstacle(o->model, o->index, &o->kept);
}

/* By the smallest eigenvalue of the stiffness; of half an object that of what stays in the plane.
 */
bool free_object_stable(const struct free_object *o) {
  static const int work_size = 64;
  double a[36], value[6], work[64];
  int count = 0, info = 0;
  if (o->guided) {
    return guided_stiffness(o) >= 0;
  }
  for (int i = 0; i < 36; i++) {
    bool moves = !o->half || (i / 6 % 2 == 0 && i % 6 % 2 == 0);
    double scale = (i / 6 < 3 ? 1 : 1 / o->size) * (i % 6 < 3 ? 1 : 1 / o->size);
    if (moves) {
      a[count++] = 0.5 * scale * (o->tangent[i] + o->tangent[6 * (i % 6) + i / 6]);
    }
  }
  int n = o->half ? 3 : 6;
  dsyev_("N", "U", &n, a, &n, value, work, &work_size, &info);
  return info == 0 && value[0] >= -idle_stiffness * fmax(fabs(value[0]), fabs(value[n - 1]));
}

void free_object_begin(struct free_object *o) {
  o->start = o->model->obstacle[o->index]->pose;
  memcpy(o->applied_before, o->applied, sizeof o->applied);
}

void free_object_return(struct free_object *o) {
  model_place_obstacle(o->model, o->index, &o->start);
}

double free_object_weight_work(const struct free_object *o) {
  const struct rigid_pose *pose = &o->model->obstacle[o->index]->pose;
  double from[3], to[3], turn[3], work = 0;
  rigid_pose_outward(&o->start, o->centroid, from);
  free_object_centroid(o, to);
  rotation_between(o->start.rotation, pose->rotation, turn);
  rigid_pose_turn_outward(&o->start, turn, turn);
  for (int i = 0; i < 3; i++) {
    double force = o->mass * o->gravity[i] + 0.5 * (o->applied_before[i] + o->applied[i]);
    double moment = 0.5 * (o->applied_before[3 + i] + o->applied[3 + i]);
    work += force * (to[i] - from[i]) + moment * turn[i];
  }
  return work;
}

static enum status fill(struct free_object *o, const struct rigid_shape *shape,
                        struct error *error) {
  struct rigid_mass uniform;
  double low[3], high[3], far = 0;
  if (!rigid_shape_mass(shape, &uniform)) {
    return error_set(error, STATUS_INVALID, "/object/shape",
                     "a plane has no volume and cannot be free: make it fixed");
  }
  rigid_shape_bounds(shape, low, high);
  for (int i = 0; i < 3; i++) {
    o->centroid[i] = uniform.centroid[i];
    double reach = fmax(high[i] - o->centroid[i], o->centroid[i] - low[i]);
    far += reach * reach;
  }
  for (int i = 0; i < 9; i++) {
    o->inertia[i] = o->mass * uniform.inertia[i];
  }
  o->size = sqrt(far);
  return STATUS_OK;
}

enum status free_object_create(struct equilibrium *solver, int index, double mass,
                               struct free_object **out, struct error *error) {
  size_t count = 6 * (size_t)solver->model->dof_count + 1;
  *out = NULL;
  if (!(mass > 0) || !isfinite(mass)) {
    return error_set(error, STATUS_INVALID, "/object/mass",
                     "a free object needs a mass above 0, such as \"50 g\"; found %g kg", mass);
  }
  if (solver->guest) {
    return error_set(error, STATUS_CONFLICT, NULL, "only one object may be free");
  }
  struct free_object *o = calloc(1, sizeof *o);
  if (!o) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a free object");
  }
  o->model = solver->model;
  o->index = index;
  o->half = solver->model->mesh->half;
  o->mass = o->half ? 0.5 * mass : mass;
  o->response = calloc(count, sizeof *o->response);
  o->coupling.by_motion = calloc(count, sizeof *o->coupling.by_motion);
  o->coupling.by_u = calloc(count, sizeof *o->coupling.by_u);
  o->guest = (struct equilibrium_guest){o, factored, correct, move, keep, restore};
  enum status status =
      o->response && o->coupling.by_motion && o->coupling.by_u
          ? fill(o, solver->model->obstacle[index]->shape, error)
          : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a free object");
  if (status != STATUS_OK) {
    free_object_destroy(solver, o);
    return status;
  }
  solver->guest = &o->guest;
  free_object_begin(o);
  *out = o;
  return STATUS_OK;
}

void free_object_destroy(struct equilibrium *solver, struct free_object *o) {
  if (!o) {
    return;
  }
  if (solver->guest == &o->guest) {
    solver->guest = NULL;
  }
  free(o->response);
  free(o->coupling.by_motion);
  free(o->coupling.by_u);
  free(o);
}
