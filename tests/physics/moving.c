#include "tests/physics/moving.h"

#include <cblas.h>
#include <check.h>

static const struct fe_load unloaded = {0, 0, 0};

static void open_rest(struct moving *b) {
  struct error error = {0};
  enum status status = equilibrium_create(b->model, &b->solver, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  status = dynamics_create(b->solver, &b->dynamics, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(state_create(b->model, &b->state), STATUS_OK);
  ck_assert_int_eq(motion_create(b->model, &b->motion), STATUS_OK);
  b->dynamics->options.fast = 1;
  b->dynamics->options.viscosity = 0;
  b->dynamics->options.tolerance = 1e-6 * b->solver->length;
}

static void open_model(struct moving *b, const struct material_spec *material) {
  struct error error = {0};
  openblas_set_num_threads(1);
  enum status status = model_create(&b->mesh, material, false, &b->model, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
}

void moving_open(struct moving *b, const struct material_spec *material) {
  open_model(b, material);
  open_rest(b);
}

void moving_open_with(struct moving *b, const struct material_spec *material,
                      const struct rigid_shape *shape, double friction, int *index) {
  struct error error = {0};
  open_model(b, material);
  enum status status = model_add_obstacle(b->model, shape, friction, index, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  open_rest(b);
}

void moving_close(struct moving *b) {
  motion_release(&b->motion);
  state_release(&b->state);
  dynamics_destroy(b->dynamics);
  equilibrium_destroy(b->solver);
  model_destroy(b->model);
  mesh_release(&b->mesh);
}

struct corners {
  const double *low, *high;
};

static void between(const void *context, int block, const double s[3], double x[3]) {
  const struct corners *c = context;
  (void)block;
  for (int i = 0; i < 3; i++) {
    x[i] = c->low[i] + s[i] * (c->high[i] - c->low[i]);
  }
}

void moving_block(struct moving *b, const double low[3], const double high[3], const int cells[3]) {
  struct corners corners = {low, high};
  struct body body = {
      .blocks = 1, .cells = {cells[0], cells[1], cells[2]}, .map = between, .context = &corners};
  *b = (struct moving){.model = NULL};
  ck_assert_int_eq(body_build(&body, &b->mesh), STATUS_OK);
  b->mesh.wall_thickness = high[2] - low[2];
}

double moving_frequency(struct moving *b, double *mode) {
  double frequency;
  ck_assert_int_eq(dynamics_frequency(b->dynamics, &unloaded, &b->state, mode, &frequency),
                   STATUS_OK);
  return frequency;
}

void moving_march(struct moving *b, double h, int count, struct energy *energy) {
  b->motion.step = h;
  for (int k = 0; k < count; k++) {
    enum status status = dynamics_step(b->dynamics, &unloaded, 0, &b->state, &b->motion, energy);
    ck_assert_msg(status == STATUS_OK, "step %d: %s", k, status_sentence(status));
  }
}

double moving_energy(const struct moving *b) {
  return energy_strain(b->model, &b->state) +
         inertia_kinetic(b->dynamics->inertia, b->motion.velocity);
}
