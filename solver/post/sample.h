/* One recorded state in numbers. */
#ifndef PNEULAB_POST_SAMPLE_H
#define PNEULAB_POST_SAMPLE_H

#include "solver/post/shape.h"

struct sample {
  double pressure; /* Pa */
  struct shape shape;
  double tip_deflection; /* of the end of the bottom centreline towards -z, m */
  double cavity_volume;  /* m3, whole body */
  double min_gap;        /* m, INFINITY without facing faces */
  double max_stretch;
  int iterations;
};

/* Measures a state and renews the gaps of the model's contact; pressure and iterations are left
 * alone. STATUS_OK or NO_MEMORY. */
enum status sample_measure(struct fe_model *model, const struct retraction *retraction,
                           const struct fe_state *state, struct sample *sample);

#endif
