#include "tests/physics/oblique_case.h"

#include <math.h>

void oblique_prototype(struct job_spec *spec, double angle_deg, int chambers) {
  *spec = (struct job_spec){.kind = JOB_RESPONSE, .family = FAMILY_OBLIQUE};
  struct oblique_spec *p = &spec->oblique;
  *p = (struct oblique_spec){.width = 0.025,
                             .height = 0.02,
                             .angle = angle_deg * M_PI / 180,
                             .chamber_count = chambers,
                             .cavity = 0.004,
                             .chamber_gap = 0.0015,
                             .gap_wall = 0.0015,
                             .centre_wall = 0.002,
                             .side_wall = 0.002,
                             .top_wall = 0.002,
                             .bottom_layer = 0.006,
                             .end = 0.003,
                             .channel_width = 0.004,
                             .channel_height = 0.002,
                             .channel_cover = 0.0015};
  double normal = chambers * (p->cavity + 2 * p->gap_wall) + (chambers - 1) * p->chamber_gap;
  p->length = normal / cos(p->angle) + 0.5 * p->width * tan(p->angle) + 2 * p->end;
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
