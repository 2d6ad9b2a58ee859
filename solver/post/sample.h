/* One recorded state in numbers. */
#ifndef PNEULAB_POST_SAMPLE_H
#define PNEULAB_POST_SAMPLE_H

#include "solver/post/shape.h"
#include "solver/post/spatial.h"
#include "solver/post/stress.h"

struct sample {
  double pressure;    /* Pa */
  struct shape shape; /* of a mesh that is marked spatial, its bending angle is spatial.bending */
  struct spatial spatial;
  double tip_deflection; /* of the end of the bottom centreline towards -z, m */
  double cavity_volume;  /* m3, whole body */
  double min_gap;        /* m, INFINITY without facing faces */
  double max_stretch;
  struct stress_peak stress;
  bool touching;        /* the body can touch itself or a plane */
  double contact_force; /* sum of the normal forces where the body touches itself, N, whole body */
  double contact_area;  /* undeformed area there, m2, whole body */
  double contact_traction; /* largest, Pa, per undeformed area */
  double penetration;      /* largest, m */
  int plane_count;
  double plane_force[PLANES_MAX]; /* push of every plane of the job on the whole body, N */
  int iterations;
};

/* Measures a state and renews the gaps of the model's contact; pressure and iterations are left
 * alone. STATUS_OK or NO_MEMORY. */
enum status sample_measure(struct fe_model *model, const struct fe_state *state,
                           struct sample *sample);

#endif
