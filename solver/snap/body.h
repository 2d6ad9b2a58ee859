/* The body of a snap job, whatever its model: equilibrium paths, and what is read off a state.
 *
 * States are struct axi_state whose x and u belong to the body; u has `values` numbers. Loads,
 * ramps and visitors are those of solver/axi/model.h. */
#ifndef PNEULAB_SNAP_BODY_H
#define PNEULAB_SNAP_BODY_H

#include <jansson.h>
#include "solver/axi/model.h"
#include "solver/job/snap.h"
#include "solver/snap/folded.h"

struct snap_body {
  void *self;
  int size, values; /* of x and u of a state */
  double length;    /* as moulded, along the axis, m */
  double skin;      /* its thickness, m; 0 of a shell */
  struct continuation_options (*options)(const void *self);
  enum status (*follow)(void *self, const struct axi_ramp *ramp,
                        const struct continuation_options *options, int direction,
                        const double *along, axi_visit *visit, void *visit_context,
                        struct axi_state *state, struct error *error);
  enum status (*equilibrium)(void *self, const struct axi_load *load, bool held,
                             const struct continuation_options *options, struct axi_state *state,
                             struct error *error);
  /* The state without load with all snapping shells inside out: see solver/snap/folded.h. */
  enum status (*fold)(void *self, const struct folded_limits *limits, struct axi_state *state,
                      struct error *error);
  /* Number of snapping shells that are inside out. */
  int (*inverted)(const void *self, const double *u);
  /* Largest principal logarithmic strain of the PET, by its size. */
  double (*pet_strain)(const void *self, const double *u);
  /* NULL of a shell. count[n - first] = negative pivots of the second variation with n waves, first
   * <= n <= last. STATUS_OK, INVERTED or NO_MEMORY. */
  enum status (*harmonics)(void *self, const struct axi_state *state, int first, int last,
                           int *count, struct error *error);
  /* Regions with their outlines in mm, a new array of objects as results have it. */
  json_t *(*outlines)(const void *self, const double *u);
  void (*destroy)(void *self);
};

/* The body of a checked job. Released with snap_body_release, also after a failure. Returns as
 * axi_model_create. */
enum status snap_body_create(const struct snap_spec *spec, struct snap_body *body,
                             struct error *error);
void snap_body_release(struct snap_body *body);

/* The state as moulded; the caller owns it (axi_state_destroy). STATUS_NO_MEMORY. */
enum status snap_body_state(const struct snap_body *body, struct axi_state *state,
                            struct error *error);
void snap_body_copy(const struct snap_body *body, const struct axi_state *from,
                    struct axi_state *to);

/* Of nine-node elements through silicone and PET, or a shell on their rows (solver/axi/shell.h). As
 * snap_body_create. */
enum status solid_body_create(const struct snap_spec *spec, struct snap_body *body,
                              struct error *error);

#endif
