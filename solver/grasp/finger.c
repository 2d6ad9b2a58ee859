#include "solver/grasp/finger.h"

#include <math.h>
#include <string.h>
#include "solver/base/vec3.h"
#include "solver/grasp/conformity.h"
#include "solver/job/grasp_shape.h"
#include "solver/job/reader.h"
#include "solver/mesh/actuator.h"
#include "solver/post/shape.h"
#include "solver/post/spatial.h"

/* Overlap of body and object at the start that is rounding, in m. */
static const double touching = 1e-6;

/* The plate of a blocked tip stands at its distance from the end of the bottom centreline. */
static void place_plate(struct finger *f) {
  const struct mesh *mesh = &f->solve.mesh;
  const double *tip = mesh->x + 3 * (size_t)mesh->centreline[mesh->section_count - 1];
  for (int i = 0; i < 3 && f->grasp.blocked; i++) {
    f->grasp.object.place[i] += tip[i];
  }
}

/* Names the deepest place of an overlap at rest. */
static enum status refuse_overlap(const struct finger *f, const struct rigid_pose *pose,
                                  struct error *error) {
  const struct mesh *mesh = &f->solve.mesh;
  struct rigid_nearest near;
  double depth = 0, at[3] = {0};
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * (size_t)n;
    if (rigid_shape_nearest_posed(f->shape, pose, x, 0, &near) && -near.distance > depth) {
      depth = -near.distance;
      memcpy(at, x, sizeof at);
    }
  }
  return error_set(error, STATUS_GEOMETRY, f->grasp.blocked ? "/grasp/blocked" : "/object/position",
                   "the object and the actuator at rest overlap where the course begins: by %.4g "
                   "mm at (%.4g, %.4g, %.4g) mm of the actuator\nmove the object out, or let it "
                   "come from outside with \"approach\"\n{\"approach\": {\"from\": [0, 0, \"-50 "
                   "mm\"]}}",
                   1e3 * depth, 1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
}

static enum status add_object(struct finger *f, struct error *error) {
  struct fe_model *m = f->solve.model;
  enum status status =
      model_add_obstacle(m, f->shape, f->grasp.object.friction, &f->obstacle, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct rigid_pose pose = grasp_pose(&f->grasp.object, f->grasp.approach.from);
  model_place_obstacle(m, f->obstacle, &pose);
  m->obstacle[f->obstacle]->stiffness *= f->grasp.stiffness;
  m->obstacle[f->obstacle]->tangential *= f->grasp.stiffness;
  return STATUS_OK;
}

/* How far the object reaches around its origin; a plane as far as the body is long. */
static double reach_of(const struct finger *f) {
  double low[3], high[3], square = 0;
  rigid_shape_bounds(f->shape, low, high);
  for (int i = 0; i < 3; i++) {
    square += pow(fmax(fabs(low[i]), fabs(high[i])), 2);
  }
  return isfinite(square) ? sqrt(square) : f->solve.solver->length;
}

static enum status check_clearance(struct finger *f, struct error *error) {
  struct rigid_pose pose = grasp_pose(&f->grasp.object, f->grasp.approach.from);
  double clearance = model_obstacle_clearance(f->solve.model, f->obstacle, f->solve.state.u);
  return clearance < -touching ? refuse_overlap(f, &pose, error) : STATUS_OK;
}

static enum status prepare_motion(struct finger *f, struct error *error) {
  enum status status = dynamics_create(f->solve.solver, &f->dynamics, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (isfinite(f->grasp.damping_time)) {
    f->dynamics->options.viscosity =
        f->grasp.damping_time * material_shear_modulus(&f->spec.material);
  }
  status = motion_create(f->solve.model, &f->motion);
  return status == STATUS_OK ? STATUS_OK
                             : error_set(error, status, NULL, "no memory for the motion");
}

/* The job as the finger sees it. */
static void look(const struct job_spec *job, int number, struct finger *f) {
  *f = (struct finger){.spec = *job, .grasp = grasp_of_finger(job->grasp, number), .whole = 1};
  memcpy(f->spec.load.gravity, f->grasp.gravity, sizeof f->grasp.gravity);
}

bool finger_symmetric(const struct job_spec *job, int number) {
  struct finger f;
  look(job, number, &f);
  return reader_half_model(&f.spec) && grasp_symmetric(&f.grasp);
}

enum status finger_prepare(const struct job_spec *job, int number, bool half, struct finger *f,
                           struct error *error) {
  look(job, number, f);
  f->spec.half_model = half;
  if (half) {
    f->whole = 2;
    f->grasp.object.place[1] = 0; /* of planes, which are the same there */
  }
  enum status status = actuator_mesh(&f->spec, &f->solve.mesh, error);
  if (status == STATUS_OK) {
    place_plate(f);
    status = grasp_shape_create(&f->grasp.object.shape, &f->shape, error);
  }
  if (status == STATUS_OK) {
    status = solve_prepare_model(&f->spec, NULL, &f->solve, error);
  }
  if (status == STATUS_OK) {
    status = add_object(f, error);
  }
  if (status == STATUS_OK) {
    status = solve_prepare_solver(&f->spec, &f->solve, error);
  }
  if (status == STATUS_OK) {
    f->reach = reach_of(f);
    status = check_clearance(f, error);
  }
  if (status == STATUS_OK &&
      (state_create(f->solve.model, &f->trial) != STATUS_OK || cups_prepare(f) != STATUS_OK)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the state");
  }
  return status == STATUS_OK ? prepare_motion(f, error) : status;
}

void finger_release(struct finger *f) {
  loose_end(f);
  cups_release(f);
  motion_release(&f->motion);
  dynamics_destroy(f->dynamics);
  state_release(&f->trial);
  solve_release(&f->solve);
  rigid_shape_destroy(f->shape);
  *f = (struct finger){.whole = 1};
}

/* ---- measuring ---------------------------------------------------------------------------- */

/* Resultants of the whole finger: the mirror image of a half model's has the opposite force across
 * and the opposite moments along and up. */
static void measure_force(const struct finger *f, const struct obstacle_state *o, double *value) {
  const double *cups = f->cups.force;
  double carried[3]; /* moment of the suckers' force about the place of the object */
  vec3_cross(f->solve.model->obstacle[f->obstacle]->pose.place, cups, carried);
  for (int i = 0; i < 3; i++) {
    bool half = f->spec.half_model;
    double moment = o->moment[i] + cups[3 + i] - carried[i];
    value[GRASP_FORCE_X + i] = half && i == 1 ? 0 : f->whole * (o->force[i] + cups[i]);
    value[GRASP_MOMENT_X + i] = half && i != 1 ? 0 : f->whole * moment;
  }
  const double *way = f->grasp.blocked ? f->grasp.blocked_direction : f->lead.direction;
  double sign = f->grasp.blocked ? 1 : -1;
  value[GRASP_HOLD] = sign * vec3_dot(way, value + GRASP_FORCE_X);
  value[GRASP_TWIST] = -vec3_dot(f->lead.axis, value + GRASP_MOMENT_X);
}

static double bending_angle(const struct finger *f, enum status *status) {
  const struct mesh *mesh = &f->solve.mesh;
  struct spatial spatial = {.bending = 0};
  struct shape shape;
  if (mesh->spatial) {
    *status = spatial_measure(mesh, f->solve.state.u, &spatial);
    return spatial.bending;
  }
  shape_measure(mesh, f->solve.state.u, &shape);
  return shape.bending_angle;
}

enum status finger_measure(struct finger *f, struct grasp_sample *sample) {
  struct obstacle_state o = model_obstacle_state(f->solve.model, f->obstacle);
  struct conformity c;
  double *value = sample->value;
  enum status status =
      conformity_measure(f->solve.model, &f->spec, f->obstacle, f->solve.state.u, &c);
  if (status != STATUS_OK) {
    return status;
  }
  measure_force(f, &o, value);
  value[GRASP_NORMAL] = f->whole * o.normal_force;
  value[GRASP_FRICTION] = f->whole * o.friction_force;
  value[GRASP_AREA] = f->whole * o.area;
  value[GRASP_PEAK] = o.max_pressure;
  value[GRASP_UNIFORMITY] = c.uniformity;
  value[GRASP_SLIP] = o.slip_share;
  value[GRASP_WRAP] = c.wrap;
  value[GRASP_MATCH] = c.match;
  bool drawn = sample->stage >= STAGE_SUCTION && !f->grasp.blocked;
  value[GRASP_SUCTION] = drawn ? f->whole * f->cups.pull : c.suction;
  value[GRASP_RUBBED] = f->whole * o.friction_total;
  value[GRASP_BENDING] = bending_angle(f, &status);
  return status;
}
