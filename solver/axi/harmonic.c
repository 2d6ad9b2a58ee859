#include "solver/axi/harmonic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/harmonic_internal.h"

/* What touches in the state. */
static enum status find_contact(const struct harmonic_state *state, struct error *error) {
  return state->contact
             ? axi_contact_evaluate(state->contact, state->u, state->elongation, true, error)
             : STATUS_OK;
}

enum status harmonic_negative(struct harmonic *h, const struct harmonic_state *state, int first,
                              int last, int *count, struct error *error) {
  struct harmonic_system own[HARMONIC_KINDS] = {{0}}, *s;
  enum status status = find_contact(state, error);
  for (int n = first; n <= last && status == STATUS_OK; n++) {
    count[n - first] = 0;
    status = harmonic_system_get(h, state, n, own, &s, error);
    if (status == STATUS_OK) {
      status = harmonic_system_factor(h, s, state, n, 0, &count[n - first], error);
    }
  }
  harmonic_systems_release(own);
  return status;
}

/* ---- the lowest mode ---- */

/* Inverse iteration with the present factor: x becomes the mode whose eigenvalue is nearest to the
 * shift, *distance the eigenvalue less the shift. */
static bool iterate(const struct harmonic_system *s, double *x, double *y, double tolerance,
                    double *distance) {
  enum { ROUNDS = 400 };
  double last = 0;
  for (int round = 0; round < ROUNDS; round++) {
    double xbx = 0, xby = 0, yby = 0;
    for (int i = 0; i < s->dof_count; i++) {
      y[i] = s->mass[i] * x[i];
    }
    ldlt_solve(s->ldlt, y, y);
    for (int i = 0; i < s->dof_count; i++) {
      xbx += s->mass[i] * x[i] * x[i];
      xby += s->mass[i] * x[i] * y[i];
      yby += s->mass[i] * y[i] * y[i];
    }
    if (!(yby > 0) || !isfinite(yby) || xby == 0) {
      return false;
    }
    *distance = xbx / xby;
    for (int i = 0; i < s->dof_count; i++) {
      x[i] = y[i] / sqrt(yby);
    }
    if (fabs(*distance - last) <= tolerance * fabs(*distance)) {
      return true;
    }
    last = *distance;
  }
  return false;
}

/* Factorises with a shift below the lowest eigenvalue, and near it when that is negative: doubled
 * until no pivot is negative, then halved into the last interval. */
static enum status shift_below(const struct harmonic *h, struct harmonic_system *s,
                               const struct harmonic_state *state, int n, double *x, double *y,
                               double *shift, struct error *error) {
  enum { DOUBLINGS = 60, HALVINGS = 5 };
  int negative;
  double above = 0, below = 0;
  *shift = 0;
  enum status status = harmonic_system_factor(h, s, state, n, 0, &negative, error);
  if (status != STATUS_OK || negative == 0) {
    return status;
  }
  iterate(s, x, y, 0.1, &below);
  below = -2 * fabs(below);
  for (int k = 0; k < DOUBLINGS; k++) {
    status = harmonic_system_factor(h, s, state, n, below, &negative, error);
    if (status != STATUS_OK || negative == 0) {
      break;
    }
    above = below;
    below *= 2;
  }
  for (int k = 0; k < HALVINGS && status == STATUS_OK && below < 1.2 * above; k++) {
    double middle = 0.5 * (above + below);
    status = harmonic_system_factor(h, s, state, n, middle, &negative, error);
    *(negative > 0 ? &above : &below) = middle;
  }
  *shift = below;
  return status == STATUS_OK ? harmonic_system_factor(h, s, state, n, below, &negative, error)
                             : status;
}

/* The unknowns x as displacements of the nodes, the largest 1; returns the factor. */
static double mode_expand(const struct harmonic *h, const struct harmonic_system *s,
                          const double *x, double *mode) {
  double largest = 0, sign = 1;
  for (int i = 0; i < HARMONIC_PARTS * h->mesh->node_count; i++) {
    mode[i] = 0;
    for (int k = 0; k < HARMONIC_TERMS; k++) {
      int dof = s->term[i].dof[k];
      mode[i] += dof >= 0 ? s->term[i].factor[k] * x[dof] : 0;
    }
    if (fabs(mode[i]) > largest) {
      largest = fabs(mode[i]);
      sign = mode[i] < 0 ? -1 : 1;
    }
  }
  double scale = largest > 0 ? sign / largest : 1;
  for (int i = 0; i < HARMONIC_PARTS * h->mesh->node_count; i++) {
    mode[i] *= scale;
  }
  return scale;
}

enum status harmonic_mode(struct harmonic *h, const struct harmonic_state *state, int n,
                          double *mode, double *stiffness, struct error *error) {
  struct harmonic_system own[HARMONIC_KINDS] = {{0}}, *s;
  double *x = NULL, shift = 0, distance = 0, mass = 0;
  unsigned random = 1;
  enum status status = find_contact(state, error);
  if (status == STATUS_OK) {
    status = harmonic_system_get(h, state, n, own, &s, error);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  x = malloc(sizeof *x * (2 * (size_t)s->dof_count + 1));
  if (!x) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a mode");
    goto done;
  }
  for (int i = 0; i < s->dof_count; i++) {
    random = random * 1664525u + 1013904223u;
    x[i] = random / 4294967296.0 - 0.5;
  }
  if (s->dof_count > 0) {
    status = shift_below(h, s, state, n, x, x + s->dof_count, &shift, error);
    if (status == STATUS_OK && !iterate(s, x, x + s->dof_count, 1e-9, &distance)) {
      status = error_set(error, STATUS_DIVERGED, NULL, "the mode of harmonic %d did not settle", n);
    }
  }
  if (status == STATUS_OK) {
    double scale = mode_expand(h, s, x, mode);
    for (int i = 0; i < s->dof_count; i++) {
      mass += s->mass[i] * x[i] * x[i] * scale * scale;
    }
    *stiffness = (shift + distance) * mass;
  }
done:
  free(x);
  harmonic_systems_release(own);
  return status;
}

/* ---- life ---- */

static enum status element_geometry(const struct axi_mesh *mesh, int element,
                                    struct axi_geometry *geometry, struct error *error) {
  double x[AXI_NODES][2];
  for (int a = 0; a < AXI_NODES; a++) {
    memcpy(x[a], mesh->position + 2 * mesh->element[element].node[a], sizeof x[a]);
  }
  if (!axi_geometry_init(x, geometry)) {
    return error_set(error, STATUS_GEOMETRY, NULL, "element %d is turned inside out", element);
  }
  return STATUS_OK;
}

enum status harmonic_create(const struct axi_mesh *mesh, enum harmonic_plate plate,
                            struct harmonic **out, struct error *error) {
  struct harmonic *h = calloc(1, sizeof *h);
  enum status status = STATUS_OK;
  size_t elements = (size_t)mesh->element_count + 1;
  if (h) {
    h->mesh = mesh;
    h->plate = plate;
    h->geometry = malloc(sizeof *h->geometry * elements);
    h->volume = calloc(elements, AXI_NODES * sizeof *h->volume);
  }
  if (!h || !h->geometry || !h->volume) {
    harmonic_destroy(h);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the harmonics of %d nodes",
                     mesh->node_count);
  }
  for (int i = 0; i < mesh->node_count; i++) {
    h->small = fmax(h->small, 1e-9 * mesh->position[2 * i]);
  }
  for (int e = 0; e < mesh->element_count && status == STATUS_OK; e++) {
    status = element_geometry(mesh, e, &h->geometry[e], error);
    for (int q = 0; q < AXI_POINTS * AXI_NODES && status == STATUS_OK; q++) {
      const struct axi_point *p = &h->geometry[e].point[q / AXI_NODES];
      h->volume[AXI_NODES * e + q % AXI_NODES] += p->weight * p->n[q % AXI_NODES];
    }
  }
  if (status != STATUS_OK) {
    harmonic_destroy(h);
    return status;
  }
  *out = h;
  return STATUS_OK;
}

void harmonic_destroy(struct harmonic *h) {
  if (!h) {
    return;
  }
  harmonic_systems_release(h->system);
  free(h->geometry);
  free(h->volume);
  free(h);
}

/* ---- the form of any perturbation ---- */

enum status harmonic_quadratic(const struct harmonic *h, const struct harmonic_state *state, int n,
                               const double *v, double *value, struct error *error) {
  enum status status = find_contact(state, error);
  return status == STATUS_OK ? harmonic_system_product(h, state, n, v, value, error) : status;
}
