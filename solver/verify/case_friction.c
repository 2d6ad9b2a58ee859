/* Friction between a body and a rigid object that moves: a block on a plane, the work in a closed
 * cycle, and a belt around a drum. */
#include <math.h>
#include "solver/base/vec3.h"
#include "solver/verify/cases.h"
#include "solver/verify/slider.h"

static const double none[3] = {0};

/* A body with the object that is to move against it. */
struct scene {
  struct verify_body body;
  struct rigid_shape *shape;
  struct slider slider;
};

static void scene_close(struct verify_run *run, struct scene *scene) {
  slider_close(&scene->slider);
  verify_body_close(run, &scene->body);
  rigid_shape_destroy(scene->shape);
}

/* ---- block of 1 x 1 x 0.1 on a plane, its top held ---- */

static const double press = 0.002; /* way of the plane into the block */

static void low_block(const void *context, int block, const double s[3], double x[3]) {
  (void)context;
  (void)block;
  x[0] = s[0];
  x[1] = s[1];
  x[2] = 0.1 * s[2];
}

/* The block, pressed by the plane. */
static enum status block_open(struct scene *scene, int cells, double friction,
                              const struct verify_run *run, struct error *error) {
  const struct material_spec rubber = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 5};
  const struct rigid_pose pose = rigid_pose_identity();
  struct body body = {.blocks = 1, .cells = {cells, cells, cells}, .map = low_block};
  *scene = (struct scene){.shape = NULL};
  enum status status = body_build(&body, &scene->body.mesh);
  if (status == STATUS_OK) {
    scene->body.mesh.wall_thickness = 0.1;
    body_hold(&scene->body.mesh, 2, 0.1, HOLD_ALL);
    status = verify_body_open(&scene->body, &rubber, false, error);
  }
  if (status == STATUS_OK) {
    status = rigid_shape_create_plane(&scene->shape, error);
  }
  if (status == STATUS_OK) {
    status = slider_open(&scene->slider, &scene->body, scene->shape, &pose, friction, run, error);
  }
  if (status == STATUS_OK) {
    scene->slider.solver->options.force_tolerance = 1e-6;
    status = slider_move(&scene->slider, (double[3]){0, 0, press}, none, 2, error);
  }
  return status;
}

enum status case_friction_block(struct verify_run *run, struct error *error) {
  static const double friction[] = {0.1, 0.3, 0.6, 0.9, 1.2};
  enum { COEFFICIENTS = sizeof friction / sizeof *friction };
  enum status status = STATUS_OK;
  for (int n = 2; status == STATUS_OK && n < 2 + run->refinement; n++) {
    double worst = 0;
    struct scene scene;
    verify_points_clear(run);
    for (int k = 0; status == STATUS_OK && k < COEFFICIENTS; k++) {
      status = block_open(&scene, n, friction[k], run, error);
      if (status == STATUS_OK) {
        double way = 80 * friction[k] * press;
        status = slider_move(&scene.slider, (double[3]){way, 0, 0}, none, 4, error);
      }
      const struct obstacle_state *now = &scene.slider.now;
      double found = -now->force[0] / -now->force[2];
      worst = fmax(worst, fabs(found / friction[k] - 1));
      verify_point(run, friction[k], found, friction[k]);
      verify_result(run, found, friction[k], 0);
      if (status == STATUS_OK && k == COEFFICIENTS - 1) {
        verify_row(run, 1.0 / n, found, worst, scene.body.model, "%d x %d x %d", n, n, n);
      }
      scene_close(run, &scene);
    }
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

/* Pressed, dragged to and fro and to one side, and lifted off: all work has then gone into
 * friction. */
enum status case_friction_energy(struct verify_run *run, struct error *error) {
  static const double way[][3] = {{0.04, 0, 0}, {-0.06, 0, 0}, {0, 0.05, 0}, {0, 0, -2 * press}};
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < run->refinement; k++) {
    int steps = 16 << k;
    struct scene scene;
    status = block_open(&scene, 3, 0.4, run, error);
    for (size_t i = 0; status == STATUS_OK && i < sizeof way / sizeof *way; i++) {
      status = slider_move(&scene.slider, way[i], none, steps, error);
    }
    if (status == STATUS_OK) {
      const struct obstacle_state *now = &scene.slider.now;
      verify_result(run, now->friction_total / now->motion_total, 1, 0);
      verify_row(run, 1.0 / steps, run->report.computed, run->report.error, scene.body.model,
                 "%d steps a way", steps);
    }
    scene_close(run, &scene);
  }
  return status;
}

/* ---- belt: an arc around a drum of radius 1, and a straight leg at either end ---- */

enum { LEG_CELLS = 2 };
static const double belt_thickness = 0.004;
static const double belt_width = 0.02;
static const double belt_strain = 0.02; /* of the tight end, roughly */
static const double leg = 0.15;

struct belt {
  double wrap;
  int cells; /* of the arc */
  double friction, tension;
};

static void belt_map(const void *context, int block, const double s[3], double x[3]) {
  const struct belt *belt = context;
  double at = s[0] * (belt->cells + 2 * LEG_CELLS) - LEG_CELLS;
  double on_arc = fmax(0, fmin(1, at / belt->cells)), angle = belt->wrap * on_arc;
  double off = (at - on_arc * belt->cells) * leg / LEG_CELLS; /* way along a leg */
  double radius = 1 + belt_thickness * s[2];
  (void)block;
  x[0] = radius * cos(angle) - off * sin(angle);
  x[1] = radius * sin(angle) + off * cos(angle);
  x[2] = belt_width * (s[1] - 0.5);
}

static void belt_hold(struct mesh *mesh, double wrap) {
  double along[3] = {-sin(wrap), cos(wrap), 0}, out[3] = {cos(wrap), sin(wrap), 0};
  body_hold(mesh, -1, 0, HOLD_Z);
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * n;
    if (fabs(vec3_dot(x, along) - leg) < 1e-9 && vec3_dot(x, out) > 0) {
      mesh->fixed[3 * n] = mesh->fixed[3 * n + 1] = 1;
    }
  }
}

/* A belt without tension has hardly any stiffness: the first step starts from the pressure under
 * the tense one, with which the drum holds it in both directions, and softly, so that it does so
 * over some way. */
static void belt_guess(struct scene *scene, double tension) {
  const struct fe_model *m = scene->body.model;
  struct obstacle *drum = m->obstacle[scene->slider.object];
  drum->stiffness = drum->tangential = 2 * belt_thickness;
  drum->smoothing = 0.01 * tension / belt_width / drum->stiffness;
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
    const double *x = m->mesh->x + 3 * nodes[QUAD9_NODES / 2];
    for (int q = 0; q < QUAD9_POINTS && fabs(hypot(x[0], x[1]) - 1) < 1e-9; q++) {
      scene->body.state.memory[QUAD9_POINTS * f + q].pressure = tension / belt_width;
    }
  }
}

/* The belt lies on the drum, pulled by `tension` (per section, N) at its slack end, along -y. */
static enum status belt_open(struct scene *scene, const struct belt *belt,
                             const struct verify_run *run, struct error *error) {
  const struct material_spec rubber = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1000};
  const struct rigid_pose pose = rigid_pose_identity();
  struct body body = {
      .blocks = 1, .cells = {belt->cells + 2 * LEG_CELLS, 1, 1}, .map = belt_map, .context = belt};
  *scene = (struct scene){.shape = NULL};
  enum status status = body_build(&body, &scene->body.mesh);
  if (status == STATUS_OK) {
    scene->body.mesh.wall_thickness = belt_thickness;
    belt_hold(&scene->body.mesh, belt->wrap);
    status = verify_body_open(&scene->body, &rubber, false, error);
  }
  if (status == STATUS_OK) {
    double traction = belt->tension / (belt_thickness * belt_width);
    body_add_traction(scene->body.model, 1, -leg, (double[3]){0, -traction, 0});
    status = rigid_shape_create_cylinder(2, 1, 0, &scene->shape, error);
  }
  if (status == STATUS_OK) {
    status =
        slider_open(&scene->slider, &scene->body, scene->shape, &pose, belt->friction, run, error);
  }
  if (status == STATUS_OK) {
    belt_guess(scene, belt->tension);
    scene->slider.load.dead = 1;
    status = slider_move(&scene->slider, none, none, 1, error);
  }
  return status;
}

/* The drum turns towards the slack end until the belt slips everywhere. Returns the ratio of the
 * tensions by the balance of forces on the belt. */
static enum status belt_slip(struct scene *scene, const struct belt *belt, double *ratio,
                             struct error *error) {
  double turn = 2 * belt_strain * belt->wrap;
  enum status status = slider_move(&scene->slider, none, (double[3]){0, 0, -turn}, 8, error);
  const double *force = scene->slider.now.force;
  double held[3] = {force[0], force[1] + belt->tension, 0};
  *ratio = (held[1] * cos(belt->wrap) - held[0] * sin(belt->wrap)) / belt->tension;
  return status;
}

enum status case_capstan(struct verify_run *run, struct error *error) {
  static const struct {
    double wrap, friction;
  } belts[] = {{M_PI / 2, 0.2}, {M_PI / 2, 0.6},   {M_PI, 0.4},
               {M_PI, 0.8},     {1.5 * M_PI, 0.3}, {1.5 * M_PI, 0.5}};
  enum { BELTS = sizeof belts / sizeof *belts };
  enum status status = STATUS_OK;
  for (int r = 0; status == STATUS_OK && r < run->refinement; r++) {
    verify_points_clear(run);
    for (int k = 0; status == STATUS_OK && k < BELTS; k++) {
      double wanted = exp(belts[k].friction * belts[k].wrap), ratio = 0;
      struct belt belt = {.wrap = belts[k].wrap,
                          .friction = belts[k].friction,
                          .cells = (int)ceil(belts[k].wrap / M_PI * (16 << r)),
                          .tension = 4 * belt_strain * belt_thickness * belt_width / wanted};
      struct scene scene;
      status = belt_open(&scene, &belt, run, error);
      if (status == STATUS_OK) {
        status = belt_slip(&scene, &belt, &ratio, error);
      }
      if (status == STATUS_OK) {
        verify_point(run, belt.friction * belt.wrap, ratio, wanted);
        verify_result(run, ratio, wanted, 0);
      }
      if (status == STATUS_OK && k == BELTS - 1) {
        verify_row(run, M_PI / (16 << r), ratio, run->report.error, scene.body.model,
                   "%d elements a half turn", 16 << r);
      }
      scene_close(run, &scene);
    }
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}
