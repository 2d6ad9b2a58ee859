#include "solver/hlpv/design.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/hlpv/linear.h"
#include "solver/hlpv/riccati.h"

enum { N = HLPV_STATES, NA = DESIGN_STATES, OUTPUTS = DESIGN_OUTPUTS };

/* What is not given is measured at least this well, as a part of the weights. */
#define NOISE_LEAST 1e-3

/* Sampled motion with the integral of the missing elongation as fourth state, each state divided by
 * its scale, so that the matrices are of one size: scaled = state / scale. */
struct augmented {
  double a[NA][NA], b[NA], scale[NA], set_point;
};

static void augment(const struct hlpv_control *c, double a[N][N], const double b[N],
                    struct augmented *out) {
  double scale[NA] = {c->weight_h, c->weight_h / c->interval, c->weight_set_point,
                      c->weight_h * c->integral_time};
  memset(out, 0, sizeof *out);
  memcpy(out->scale, scale, sizeof scale);
  out->set_point = c->weight_set_point;
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < N; k++) {
      out->a[i][k] = a[i][k] * scale[k] / scale[i];
    }
    out->b[i] = b[i] * c->weight_set_point / scale[i];
  }
  out->a[N][N] = 1.0;
  out->a[N][HLPV_H] = -c->interval * scale[HLPV_H] / scale[N];
}

static enum status regulate(const struct augmented *s, struct design_region *region,
                            struct error *error) {
  double q[NA * NA] = {0}, r = 1.0, x[NA * NA], gain[NA], closed[NA * NA];
  q[HLPV_H * NA + HLPV_H] = 1.0;
  q[N * NA + N] = 1.0;
  struct riccati_problem problem = {NA, 1, &s->a[0][0], s->b, q, &r};
  enum status status = riccati_solve(&problem, x, gain, error);
  if (status != STATUS_OK) {
    return status;
  }
  for (int i = 0; i < NA; i++) {
    for (int k = 0; k < NA; k++) {
      closed[i * NA + k] = s->a[i][k] - s->b[i] * gain[k];
    }
    region->gain[i] = gain[i] * s->set_point / s->scale[i];
  }
  return riccati_eigenvalues(NA, closed, region->eigenvalue, error);
}

/* L = P C' (C P C' + R)^-1 with P of the dual Riccati equation; C takes h and p. */
static enum status observe(const struct hlpv_control *c, const struct augmented *s,
                           struct design_region *region, struct error *error) {
  static const int measured[OUTPUTS] = {HLPV_H, HLPV_PRESSURE};
  double a[N * N], b[N * OUTPUTS] = {0}, q[N * N], p[N * N], gain[OUTPUTS * N];
  double noise[OUTPUTS] = {fmax(c->noise_h / c->weight_h, NOISE_LEAST),
                           fmax(c->noise_pressure / c->weight_set_point, NOISE_LEAST)};
  double r[OUTPUTS * OUTPUTS] = {noise[0] * noise[0], 0, 0, noise[1] * noise[1]};
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < N; k++) {
      a[i * N + k] = s->a[k][i];
      q[i * N + k] = s->b[i] * s->b[k];
    }
  }
  for (int o = 0; o < OUTPUTS; o++) {
    b[measured[o] * OUTPUTS + o] = 1.0;
  }
  struct riccati_problem problem = {N, OUTPUTS, a, b, q, r};
  enum status status = riccati_solve(&problem, p, gain, error);
  if (status != STATUS_OK) {
    return status;
  }
  double s00 = p[0] + r[0], s01 = p[HLPV_PRESSURE], s11 = p[N * N - 1] + r[3];
  double determinant = s00 * s11 - s01 * s01;
  for (int i = 0; i < N; i++) {
    double h = p[i * N + HLPV_H], pressure = p[i * N + HLPV_PRESSURE];
    double part[OUTPUTS] = {(h * s11 - pressure * s01) / determinant,
                            (pressure * s00 - h * s01) / determinant};
    for (int o = 0; o < OUTPUTS; o++) {
      region->observer[i][o] = part[o] * s->scale[i] / s->scale[measured[o]];
    }
  }
  return STATUS_OK;
}

/* Whether the region has gains. */
static bool fill(const struct design *design, int mode, struct design_region *region) {
  const struct hlpv_control *c = design->model.control;
  struct error ignored;
  double a[N][N], b[N];
  struct augmented system;
  if (!linear_rest(&design->model, mode, region->set_point, region->rest) ||
      !linear_sampled(&design->model, mode, region->set_point, c->interval, a, b)) {
    return false;
  }
  augment(c, a, b, &system);
  return regulate(&system, region, &ignored) == STATUS_OK &&
         observe(c, &system, region, &ignored) == STATUS_OK;
}

enum status design_create(const struct hlpv_spec *spec, struct design **design,
                          struct error *error) {
  const struct hlpv_control *c = spec->control;
  struct design *created = calloc(1, sizeof *created);
  *design = created;
  if (!created) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the gains");
  }
  created->model = *spec;
  created->model.mass = c->mass;
  created->model.gamma = c->gamma;
  created->regions = c->regions;
  int valid = 0;
  for (int mode = 0; mode < spec->mode_count; mode++) {
    for (int i = 0; i < c->regions; i++) {
      struct design_region *region = &created->region[mode][i];
      double part = c->regions > 1 ? (double)i / (c->regions - 1) : 0.5;
      region->set_point = c->lowest + part * (c->highest - c->lowest);
      region->valid = fill(created, mode, region);
      valid += region->valid;
    }
  }
  return valid > 0 ? STATUS_OK
                   : error_set(error, STATUS_DIVERGED, NULL,
                               "nothing can be controlled: at no set-point within the saturation "
                               "does a mode have a state of rest with gains that hold it");
}

/* a + part (b - a), number by number. */
static void blend(double *a, const double *b, double part, size_t count) {
  for (size_t i = 0; i < count; i++) {
    a[i] += part * (b[i] - a[i]);
  }
}

void design_at(const struct design *design, int mode, double set_point,
               struct design_region *region) {
  const struct design_region *list = design->region[mode];
  const struct design_region *below = NULL, *above = NULL;
  for (int i = 0; i < design->regions; i++) {
    if (list[i].valid && list[i].set_point <= set_point) {
      below = &list[i];
    } else if (list[i].valid && !above) {
      above = &list[i];
    }
  }
  *region = below ? *below : above ? *above : (struct design_region){.valid = false};
  if (below && above) {
    double part = (set_point - below->set_point) / (above->set_point - below->set_point);
    blend(region->gain, above->gain, part, DESIGN_STATES);
    blend(&region->observer[0][0], &above->observer[0][0], part, HLPV_STATES * DESIGN_OUTPUTS);
  }
  region->set_point = set_point;
}
