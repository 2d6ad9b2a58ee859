#include "solver/snap/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status snap_body_create(const struct snap_spec *spec, struct snap_body *body,
                             struct error *error) {
  memset(body, 0, sizeof *body);
  return solid_body_create(spec, body, error);
}

void snap_body_release(struct snap_body *body) {
  if (body->self) {
    body->destroy(body->self);
  }
  memset(body, 0, sizeof *body);
}

enum status snap_body_state(const struct snap_body *body, struct axi_state *state,
                            struct error *error) {
  *state = (struct axi_state){.stiffness = NAN};
  state->x = calloc((size_t)body->size, sizeof *state->x);
  state->u = calloc((size_t)body->values, sizeof *state->u);
  if (!state->x || !state->u) {
    axi_state_destroy(state);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d unknowns", body->size);
  }
  return STATUS_OK;
}

void snap_body_copy(const struct snap_body *body, const struct axi_state *from,
                    struct axi_state *to) {
  double *x = to->x, *u = to->u;
  memcpy(x, from->x, sizeof *x * (size_t)body->size);
  memcpy(u, from->u, sizeof *u * (size_t)body->values);
  *to = *from;
  to->x = x;
  to->u = u;
}
