#include "tests/physics/pneunet_case.h"

#include <cblas.h>
#include <check.h>
#include <math.h>
#include <string.h>
#include "solver/mesh/pneunet.h"

void case_prototype(struct job_spec *spec, int chambers) {
  memset(spec, 0, sizeof *spec);
  struct pneunet_spec *p = &spec->pneunet;
  p->length = 0.008 * chambers + 0.002 * (chambers - 1);
  p->width = 0.030;
  p->height_base = p->height_tip = 0.020;
  p->runs[0] = (struct chamber_run){CHAMBER_B, chambers};
  p->run_count = 1;
  p->chamber_count = chambers;
  p->chamber_gap = p->side_wall = p->gap_wall = 0.002;
  p->top_wall = 0.0015;
  p->bottom_layer = 0.006;
  p->cavity_length = 0.004;
  p->taper_left = p->taper_right = 2 * M_PI / 180;
  p->scaled_walls = true;
  p->slit = p->slit_floor = 0.001;
  p->stem = 0.004;
  p->channel_width = 0.004;
  p->channel_height = 0.002;
  p->channel_cover = 0.0015;
  spec->half_model = true;
  spec->accuracy = ACCURACY_STANDARD;
  spec->mesh = (struct mesh_spec){.gap_wall = 2,
                                  .cavity = 1,
                                  .gap = 1,
                                  .half_width = 1,
                                  .side_wall = 1,
                                  .bottom = 1,
                                  .height = 3,
                                  .top = 1};
  spec->material = (struct material_spec){.model = MATERIAL_YEOH,
                                          .terms = 3,
                                          .c = {0.25e6, -0.05e6, 0.005e6},
                                          .bulk_ratio = 1000,
                                          .density_kg_m3 = 1080};
  spec->load = (struct load_spec){.pressure_to = 50e3, .steps = 10};
}

void case_refine(struct job_spec *spec, int n) {
  spec->mesh = (struct mesh_spec){.gap_wall = n,
                                  .cavity = n,
                                  .gap = n,
                                  .half_width = 2 * n,
                                  .side_wall = n,
                                  .bottom = n,
                                  .height = 2 * n,
                                  .top = n};
}

void case_open(struct pneunet_case *c, const struct job_spec *spec) {
  openblas_set_num_threads(1); /* as the solver does */
  struct error error = {0};
  memset(c, 0, sizeof *c);
  c->spec = *spec;
  enum status status = pneunet_mesh(spec, &c->mesh, &error);
  if (status == STATUS_OK) {
    status = model_create(&c->mesh, &spec->material, spec->contact, &c->model, &error);
  }
  for (int k = 0; status == STATUS_OK && k < spec->plane_count; k++) {
    status = model_add_plane(c->model, spec->plane[k].point, spec->plane[k].normal, &error);
  }
  if (status == STATUS_OK) {
    status = equilibrium_create(c->model, &c->solver, &error);
  }
  ck_assert_msg(status == STATUS_OK, "%s: %s", status_word(status), error.message);
  ck_assert_int_eq(state_create(c->model, &c->state), STATUS_OK);
  c->solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
  model_add_gravity(c->model, spec->load.gravity);
}

void case_close(struct pneunet_case *c) {
  state_release(&c->state);
  equilibrium_destroy(c->solver);
  model_destroy(c->model);
  mesh_release(&c->mesh);
}

static enum status record(void *context, const struct path_point *point) {
  struct pneunet_case *c = context;
  if (point->recorded) {
    ck_assert_int_lt(c->records, CASE_RECORDS);
    c->pressure[c->records] = point->pressure;
    c->angle[c->records] = case_angle(&c->mesh, point->state->u);
    c->gap[c->records] = contact_summarise(&c->model->contact).min_gap;
    c->records++;
  }
  return STATUS_OK;
}

void case_follow(struct pneunet_case *c) {
  const struct load_spec *load = &c->spec.load;
  struct path_options options = {
      .pressure_to = load->pressure_to, .steps = load->steps, .visit = record, .context = c};
  for (int i = 0; i < 3; i++) {
    options.dead_load = options.dead_load || load->gravity[i] != 0;
  }
  struct error error = {0};
  enum status status = path_follow(c->solver, &options, &c->state, &error);
  c->factorizations = c->model->statistics.factorizations;
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
}

double case_angle_of(const struct job_spec *spec) {
  struct pneunet_case c;
  case_open(&c, spec);
  case_follow(&c);
  double angle = c.angle[c.records - 1];
  case_close(&c);
  return angle;
}

double case_angle(const struct mesh *mesh, const double *u) {
  double total = 0, previous = 0;
  for (int s = 0; s + 1 < mesh->station_count; s++) {
    int a = mesh->centreline[mesh->station[s]], b = mesh->centreline[mesh->station[s + 1]];
    double dx = mesh->x[3 * b] + u[3 * b] - mesh->x[3 * a] - u[3 * a];
    double dz = mesh->x[3 * b + 2] + u[3 * b + 2] - mesh->x[3 * a + 2] - u[3 * a + 2];
    double direction = atan2(-dz, dx);
    total += remainder(direction - previous, 2 * M_PI);
    previous = direction;
  }
  return total * 180 / M_PI;
}
