#include "tests/physics/hybrid_exact.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_roots.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 7, ONE = 3, RAMP = 4, SINE = 5, COSINE = 6 };

/* Units in which the entries of the matrix are of like size: mm, m/s, 10 kPa. */
static const double scale[HLPV_STATES] = {1e-3, 1.0, 1e4};

/* Tools use this, too, so that it does not assert by the test library. */
static void require(bool holds) {
  if (!holds) {
    fputs("the exact motion cannot be computed\n", stderr);
    abort();
  }
}

static void fill(const struct hlpv_spec *spec, int mode, const struct exact_input *input,
                 gsl_matrix *a) {
  const struct hlpv_mode *m = &spec->mode[mode];
  double u = input->u, beta = hlpv_polynomial_value(&m->beta, u) / scale[2];
  double k = hlpv_polynomial_value(&m->stiffness, u), b = hlpv_polynomial_value(&m->damping, u);
  gsl_matrix_set_zero(a);
  gsl_matrix_set(a, 0, 1, scale[1] / scale[0]);
  gsl_matrix_set(a, 1, 0, -k / spec->mass * scale[0] / scale[1]);
  gsl_matrix_set(a, 1, 1, -b / spec->mass);
  gsl_matrix_set(a, 1, 2, spec->gamma / spec->mass * scale[2] / scale[1]);
  gsl_matrix_set(a, 1, ONE, k * m->rest / spec->mass / scale[1]);
  gsl_matrix_set(a, 2, 2, hlpv_polynomial_value(&m->alpha, u));
  gsl_matrix_set(a, 2, ONE, beta * u);
  gsl_matrix_set(a, 2, RAMP, beta * input->slope);
  gsl_matrix_set(a, 2, SINE, beta * input->amplitude);
  gsl_matrix_set(a, RAMP, ONE, 1.0);
  gsl_matrix_set(a, SINE, COSINE, input->omega);
  gsl_matrix_set(a, COSINE, SINE, -input->omega);
}

void exact_state(const struct hlpv_spec *spec, int mode, const struct exact_input *input,
                 const double x[HLPV_STATES], double span, double after[HLPV_STATES]) {
  gsl_matrix *a = gsl_matrix_alloc(SIZE, SIZE), *power = gsl_matrix_alloc(SIZE, SIZE);
  require(a && power);
  fill(spec, mode, input, a);
  gsl_matrix_scale(a, span);
  require(gsl_linalg_exponential_ss(a, power, GSL_PREC_DOUBLE) == GSL_SUCCESS);
  double start[SIZE] = {x[0] / scale[0],   x[1] / scale[1],  x[2] / scale[2], 1.0, 0.0,
                        sin(input->phase), cos(input->phase)};
  for (size_t i = 0; i < HLPV_STATES; i++) {
    double sum = 0.0;
    for (size_t j = 0; j < SIZE; j++) {
      sum += gsl_matrix_get(power, i, j) * start[j];
    }
    after[i] = scale[i] * sum;
  }
  gsl_matrix_free(a);
  gsl_matrix_free(power);
}

struct passage {
  const struct hlpv_spec *spec;
  const struct hlpv_transition *transition;
  const struct exact_input *input;
  const double *x;
};

static double beyond(double time, void *context) {
  const struct passage *p = context;
  double after[HLPV_STATES];
  exact_state(p->spec, p->transition->from, p->input, p->x, time, after);
  return p->transition->direction * (after[p->transition->quantity] - p->transition->level);
}

static double brent(struct passage *passage, double low, double high) {
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  gsl_function function = {beyond, passage};
  require(gsl_root_fsolver_set(solver, &function, low, high) == GSL_SUCCESS);
  for (int n = 0; n < 100; n++) {
    gsl_root_fsolver_iterate(solver);
    low = gsl_root_fsolver_x_lower(solver);
    high = gsl_root_fsolver_x_upper(solver);
    if (high - low < 1e-14) {
      break;
    }
  }
  double root = gsl_root_fsolver_root(solver);
  gsl_root_fsolver_free(solver);
  return root;
}

double exact_passage(const struct hlpv_spec *spec, const struct hlpv_transition *transition,
                     const struct exact_input *input, const double x[HLPV_STATES], double span,
                     double look) {
  struct passage passage = {spec, transition, input, x};
  double before = 0.0;
  while (before < span) {
    double after = fmin(before + look, span);
    if (beyond(after, &passage) > 0.0) {
      return brent(&passage, before, after);
    }
    before = after;
  }
  return INFINITY;
}
