#include "tests/physics/oblique_case.h"

#include <cblas.h>
#include <check.h>
#include <math.h>
#include "solver/fe/path.h"
#include "solver/mesh/actuator.h"

void oblique_turn(struct oblique_spec *p, double angle_deg) {
  p->angle = angle_deg * M_PI / 180;
  p->end = 0.003;
  double normal =
      p->chamber_count * (p->cavity + 2 * p->gap_wall) + (p->chamber_count - 1) * p->chamber_gap;
  p->length = normal / cos(p->angle) + 0.5 * p->width * tan(p->angle) + 2 * p->end;
}

void oblique_prototype(struct job_spec *spec, double angle_deg, int chambers) {
  *spec = (struct job_spec){.kind = JOB_RESPONSE, .family = FAMILY_OBLIQUE};
  struct oblique_spec *p = &spec->oblique;
  *p = (struct oblique_spec){.width = 0.025,
                             .height = 0.02,
                             .chamber_count = chambers,
                             .cavity = 0.004,
                             .chamber_gap = 0.0015,
                             .gap_wall = 0.0015,
                             .centre_wall = 0.002,
                             .side_wall = 0.002,
                             .top_wall = 0.002,
                             .bottom_layer = 0.006,
                             .channel_width = 0.004,
                             .channel_height = 0.002,
                             .channel_cover = 0.0015};
  oblique_turn(p, angle_deg);
  spec->mesh = (struct mesh_spec){.gap_wall = 1,
                                  .cavity = 1,
                                  .gap = 1,
                                  .half_width = 1,
                                  .side_wall = 1,
                                  .bottom = 1,
                                  .height = 2,
                                  .top = 1};
  spec->material = (struct material_spec){.model = MATERIAL_NEO_HOOKE,
                                          .terms = 1,
                                          .c = {0.4e6},
                                          .bulk_ratio = 1000,
                                          .density_kg_m3 = 1080};
  spec->load = (struct load_spec){.pressure_to = 20e3, .cavity_share = {1, 1}, .steps = 2};
}

static enum status pass(void *context, const struct path_point *point) {
  (void)context;
  (void)point;
  return STATUS_OK;
}

void oblique_follow(const struct job_spec *spec, struct solve *solve) {
  struct error error = {0};
  openblas_set_num_threads(1); /* as the solver does */
  *solve = (struct solve){.model = NULL};
  enum status status = actuator_mesh(spec, &solve->mesh, &error);
  if (status == STATUS_OK) {
    status = solve_prepare(spec, solve, &error);
  }
  if (status == STATUS_OK) {
    struct path_options options = {spec->load.pressure_to, spec->load.steps,
                                   solve_has_gravity(spec), pass, NULL};
    status = path_follow(solve->solver, &options, &solve->state, &error);
  }
  ck_assert_msg(status == STATUS_OK, "%s: %s", status_word(status), error.message);
}
