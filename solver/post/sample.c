#include "solver/post/sample.h"

#include "solver/base/vec3.h"

static void measure_contact(const struct fe_model *model, struct sample *sample) {
  struct contact_summary c = contact_summarise(&model->contact);
  double whole = model->mesh->half ? 2 : 1;
  sample->min_gap = c.min_gap;
  sample->touching = model->use_contact || model->contact.plane_count > 0;
  sample->contact_force = whole * c.force;
  sample->contact_area = whole * c.area;
  sample->contact_traction = c.max_traction;
  sample->penetration = c.penetration;
  sample->plane_count = 0;
  for (int k = 0; k < model->contact.plane_count; k++) {
    const struct contact_plane *plane = &model->contact.plane[k];
    if (!plane->symmetry) {
      sample->plane_force[sample->plane_count++] =
          whole * vec3_dot(c.plane_force[k], plane->normal);
    }
  }
}

enum status sample_measure(struct fe_model *model, const struct fe_state *state,
                           struct sample *sample) {
  const struct mesh *mesh = model->mesh;
  model_update_gaps(model, state);
  measure_contact(model, sample);
  shape_measure(mesh, state->u, &sample->shape);
  enum status status = spatial_measure(mesh, state->u, &sample->spatial);
  if (status != STATUS_OK) {
    return status;
  }
  if (mesh->spatial) {
    sample->shape.bending_angle = sample->spatial.bending;
  }
  double rest = mesh->x[3 * mesh->centreline[mesh->section_count - 1] + 2];
  sample->tip_deflection = rest - sample->shape.tip[2];
  sample->cavity_volume = 0;
  for (int c = 0; c < MESH_CAVITIES; c++) {
    sample->cavity_volume += model_cavity_volume(model, state, c) * (mesh->half ? 2 : 1);
  }
  sample->stress = stress_peak(model, state);
  sample->max_stretch = shape_stretch(model, state->u, NULL);
  return sample->max_stretch < 0 ? STATUS_NO_MEMORY : STATUS_OK;
}
