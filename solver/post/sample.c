#include "solver/post/sample.h"

enum status sample_measure(struct fe_model *model, const struct retraction *retraction,
                           const struct fe_state *state, struct sample *sample) {
  const struct mesh *mesh = model->mesh;
  model_update_gaps(model, state);
  sample->min_gap = contact_summarise(&model->contact).min_gap;
  shape_measure(mesh, retraction, state->u, &sample->shape);
  double rest = mesh->x[3 * mesh->centreline[mesh->section_count - 1] + 2];
  sample->tip_deflection = rest - sample->shape.tip[2];
  sample->cavity_volume = model_volume(model, state, NULL) * (mesh->half ? 2 : 1);
  sample->max_stretch = shape_stretch(model, state->u, NULL);
  return sample->max_stretch < 0 ? STATUS_NO_MEMORY : STATUS_OK;
}
