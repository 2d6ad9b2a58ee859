/* Second variation in circumferential harmonics: against differences of the energy in three
 * dimensions, rigid motions, folds that touch. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/element.h"
#include "solver/axi/harmonic.h"
#include "solver/axi/model.h"
#include "solver/fe/hyperelastic.h"
#include "solver/snap/bellows.h"
#include "tests/physics/axi_block.h"
#include "tests/physics/report.h"
#include "tests/physics/snap_case.h"
#include "tests/unit/suite.h"

static struct error failure;

static void must(enum status status) {
  ck_assert_msg(status == STATUS_OK, "%s", failure.message);
}

/* ---- the energy in three dimensions ---- */

enum { AROUND = 48 };

struct trial {
  struct axi_mesh mesh;
  struct harmonic *harmonic;
  struct harmonic_state state;
  double *u, *v; /* node_count x 2 and x 3 */
  int n;
  double form; /* v K v */
};

/* Displacements of a node at an angle: (u_r, u_t, u_z) and their derivatives by the angle. */
static void displaced(const struct trial *t, double step, int node, double angle, double d[3],
                      double turn[3]) {
  const double *v = t->v + 3 * node, *u = t->u + 2 * node;
  double c = step * cos(t->n * angle), s = step * sin(t->n * angle);
  d[0] = u[0] + v[0] * c;
  d[1] = v[2] * s;
  d[2] = u[1] + v[1] * c;
  turn[0] = -t->n * v[0] * s;
  turn[1] = t->n * v[2] * c;
  turn[2] = -t->n * v[1] * s;
}

/* Elastic energy of an element at one angle, as if the whole ring were like that. */
static double slice_energy(const struct trial *t, int element, double step, double angle) {
  const struct axi_element *e = &t->mesh.element[element];
  const struct material_spec *material = &t->mesh.region[0];
  const struct axi_bulk bulk = axi_bulk_parts(material);
  struct axi_geometry g;
  double x[AXI_NODES][2], energy = 0, moment[3] = {0};
  for (int a = 0; a < AXI_NODES; a++) {
    memcpy(x[a], t->mesh.position + 2 * e->node[a], sizeof x[a]);
  }
  ck_assert(axi_geometry_init(x, &g));
  for (int q = 0; q < AXI_POINTS; q++) {
    const struct axi_point *p = &g.point[q];
    struct kinematics k = {.f = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double stress[9];
    for (int a = 0; a < AXI_NODES; a++) {
      double d[3], turn[3], hoop = p->n[a] / p->radius;
      displaced(t, step, e->node[a], angle, d, turn);
      for (int i = 0; i < 3; i++) {
        k.f[3 * i] += d[i] * p->dr[a];
        k.f[3 * i + 2] += d[i] * p->dz[a];
        k.f[3 * i + 1] += turn[i] * hoop;
      }
      k.f[1] -= d[1] * hoop;
      k.f[4] += d[0] * hoop;
    }
    ck_assert_double_gt(kinematics_complete(&k), 0);
    energy += p->weight * hyperelastic_isochoric(material, &k, stress, NULL);
    energy += 0.5 * p->weight * bulk.local * (k.j - 1) * (k.j - 1);
    for (int i = 0; i < 3; i++) {
      moment[i] += p->weight * p->psi[i] * (k.j - 1);
    }
  }
  for (int i = 0; i < 9; i++) {
    energy += 0.5 * bulk.projected * moment[i / 3] * g.inverse[i] * moment[i % 3];
  }
  return energy;
}

/* Volume on the right of an edge at one angle, as if all around were like that: the flux of a third
 * of the position through the surface, of which the closed contour makes a volume. */
static double slice_volume(const struct trial *t, int edge, double step, double angle) {
  static const double at[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                               0.861136311594052575};
  static const double weight[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                   0.347854845137453857};
  double volume = 0;
  for (int q = 0; q < 4; q++) {
    double s = at[q], value[3] = {0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s};
    double slope[3] = {s - 0.5, s + 0.5, -2 * s}, x[3] = {0}, ds[3] = {0}, dt[3] = {0};
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      int node = t->mesh.inner[edge].node[a];
      double d[3], turn[3];
      displaced(t, step, node, angle, d, turn);
      d[0] += t->mesh.position[2 * node];
      d[2] += t->mesh.position[2 * node + 1];
      for (int i = 0; i < 3; i++) {
        x[i] += value[a] * d[i];
        ds[i] += slope[a] * d[i];
        dt[i] += value[a] * turn[i];
      }
      dt[0] -= value[a] * d[1];
      dt[1] += value[a] * d[0];
    }
    volume += 2 * M_PI * weight[q] / 3 *
              (x[0] * (ds[1] * dt[2] - ds[2] * dt[1]) + x[1] * (ds[2] * dt[0] - ds[0] * dt[2]) +
               x[2] * (ds[0] * dt[1] - ds[1] * dt[0]));
  }
  return volume;
}

static double potential(const struct trial *t, double step) {
  double sum = 0;
  for (int k = 0; k < AROUND; k++) {
    double angle = 2 * M_PI * k / AROUND;
    for (int e = 0; e < t->mesh.element_count; e++) {
      sum += slice_energy(t, e, step, angle);
    }
    for (int e = 0; e < t->mesh.inner_count; e++) {
      sum -= t->state.pressure * slice_volume(t, e, step, angle);
    }
  }
  return sum / AROUND;
}

static double difference_error(void *context, double step) {
  struct trial *t = context;
  double second = (potential(t, step) - 2 * potential(t, 0) + potential(t, -step)) / (step * step);
  return fabs(second / t->form - 1);
}

/* A hollow ring in a state without symmetry, disturbed likewise. */
static void trial_open(struct trial *t, double strain) {
  static const struct block block = {{0.5, 2}, {-0.4, 1.1}, 3, 3, true};
  memset(t, 0, sizeof *t);
  block_mesh(&block, &t->mesh);
  t->mesh.region[0] = block_elastic(1, 0.49);
  t->u = calloc(2 * (size_t)t->mesh.node_count, sizeof *t->u);
  t->v = calloc(3 * (size_t)t->mesh.node_count, sizeof *t->v);
  ck_assert(t->u && t->v);
  for (int i = 0; i < 2 * t->mesh.node_count; i++) {
    const double *x = t->mesh.position + i / 2 * 2;
    t->u[i] = strain * (i % 2 ? sin(2 * x[0]) * (1 + x[1]) : x[0] * cos(x[1] + 0.3 * x[0]));
  }
  for (int i = 0; i < 3 * t->mesh.node_count; i++) {
    const double *x = t->mesh.position + i / 3 * 2;
    t->v[i] = sin(1.7 * x[0] + (i % 3) - x[1]) + 0.3 * (i % 3) * x[1] * x[1];
  }
  t->state = (struct harmonic_state){.u = t->u, .pressure = 0.05};
  must(harmonic_create(&t->mesh, HARMONIC_GUIDED, &t->harmonic, &failure));
}

static void trial_close(struct trial *t) {
  harmonic_destroy(t->harmonic);
  axi_mesh_release(&t->mesh);
  free(t->u);
  free(t->v);
}

START_TEST(energy_in_three_dimensions) {
  static const int wave[] = {0, 1, 2, 5};
  static const double pressure[] = {0, 0.05, 10};
  struct trial t;
  trial_open(&t, 0.1);
  t.n = wave[_i % 4];
  t.state.pressure = pressure[_i / 4];
  for (int node = 0; node < t.mesh.node_count; node++) {
    t.v[3 * node + 2] *= t.n > 0;
  }
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &t.form, &failure));
  char what[80];
  snprintf(what, sizeof what, "second variation, n = %d, p/E = %g", t.n, t.state.pressure);
  report_second_order(what, difference_error, &t, 0.02, 3, 1e-4);
  trial_close(&t);
}
END_TEST

/* Whatever the state, shifts change nothing; turning does not where there is neither stress nor
 * pressure. */
START_TEST(rigid_motion) {
  static const double still[2] = {0};
  struct trial t;
  trial_open(&t, _i == 2 ? 0 : 0.1);
  double scale, value;
  t.n = _i > 0;
  t.state.pressure = _i == 2 ? 0 : 0.05;
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &scale, &failure));
  for (int node = 0; node < t.mesh.node_count; node++) {
    const double *x = t.mesh.position + 2 * node, *u = _i == 2 ? still : t.u + 2 * node;
    double r = x[0] + u[0], z = x[1] + u[1], turned[3] = {z, -r, -z};
    static const double shifted[2][3] = {{0, 1, 0}, {1, 0, -1}};
    memcpy(t.v + 3 * node, _i == 2 ? turned : shifted[_i], sizeof turned);
  }
  must(harmonic_quadratic(t.harmonic, &t.state, t.n, t.v, &value, &failure));
  report_value(_i == 0   ? "rigid shift, n = 0"
               : _i == 1 ? "rigid shift, n = 1"
                         : "rigid turn, n = 1",
               "against any motion", 0, value / scale);
  ck_assert_double_lt(fabs(value), 1e-13 * fabs(scale));
  trial_close(&t);
}
END_TEST

/* In equilibrium under pressure turning changes nothing either, and the form of n = 0 has the
 * inertia of the axisymmetric tangent. */
START_TEST(turned_in_equilibrium) {
  struct trial t;
  struct axi_model *model;
  struct axi_state state;
  double scale, value;
  int count;
  trial_open(&t, 0);
  t.mesh.hold[1] = AXI_FIXED;
  must(axi_model_create(&t.mesh, NULL, &model, &failure));
  must(axi_state_create(model, &state, &failure));
  struct continuation_options options = axi_defaults(model);
  struct axi_load load = {.pressure = 0.02};
  must(axi_equilibrium(model, &load, false, &options, &state, NULL, &failure));
  t.state = (struct harmonic_state){.u = state.u, .pressure = load.pressure};
  must(harmonic_quadratic(t.harmonic, &t.state, 1, t.v, &scale, &failure));
  for (int node = 0; node < t.mesh.node_count; node++) {
    double r = t.mesh.position[2 * node] + state.u[2 * node];
    double z = t.mesh.position[2 * node + 1] + state.u[2 * node + 1];
    memcpy(t.v + 3 * node, (double[]){z, -r, -z}, 3 * sizeof z);
  }
  must(harmonic_quadratic(t.harmonic, &t.state, 1, t.v, &value, &failure));
  report_value("rigid turn under pressure, n = 1", "against any motion", 0, value / scale);
  ck_assert_double_lt(fabs(value), 1e-10 * fabs(scale));
  must(harmonic_negative(t.harmonic, &t.state, 0, 0, &count, &failure));
  ck_assert_int_eq(count, state.negative_free);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  trial_close(&t);
}
END_TEST

/* ---- folds ---- */

static bool until_it_touches(void *context, const struct axi_state *state,
                             const struct continuation_point *point) {
  int *touching = context;
  (void)point;
  *touching += state->touching;
  return *touching < 5 && state->elongation > -10e-3;
}

/* A bellows that is pressed until its folds touch, with a skin: the form of n = 0 is the tangent of
 * the axisymmetric model, and that of waves has half of its skin and contact. */
START_TEST(folds_that_touch) {
  struct job_spec spec;
  struct bellows bellows;
  struct axi_model *model;
  struct axi_model_options options = {.contact = true, .skin = 0.2e-3};
  struct axi_ramp press = {.to = {.force = -20}};
  struct axi_state state;
  struct harmonic *harmonic;
  int touching = 0;
  snap_case_must_read("", "", &spec);
  struct bellows_fineness fineness = bellows_fineness(ACCURACY_FAST);
  must(bellows_create(spec.snap, &fineness, &bellows, &failure));
  must(axi_model_create(&bellows.mesh, &options, &model, &failure));
  must(axi_state_create(model, &state, &failure));
  struct continuation_options path = axi_defaults(model);
  must(axi_follow(model, &press, &path, 1, NULL, until_it_touches, &touching, &state, &failure));
  ck_assert_int_eq(touching, 5);
  must(harmonic_create(&bellows.mesh, HARMONIC_GUIDED, &harmonic, &failure));
  int size = axi_model_size(model), nodes = bellows.mesh.node_count;
  double *d = calloc((size_t)(2 * size + 5 * nodes), sizeof *d), *product = d + size;
  double *u = d + 2 * size, *v = u + 2 * nodes, potential, wanted = 0, value;
  for (int i = 0; i < size - 1; i++) { /* all but h */
    d[i] = sin(1.3 * i);
  }
  axi_model_expand(model, d, u);
  for (int i = 0; i < 2 * nodes; i++) {
    v[3 * (i / 2) + i % 2] = u[i];
  }
  struct axi_load load = {.force = state.force};
  must(axi_evaluate(model, state.x, &load, &potential, NULL, d, product, &failure));
  for (int i = 0; i < size; i++) {
    wanted += d[i] * product[i];
  }
  struct harmonic_state base = {.u = state.u,
                                .elongation = state.elongation,
                                .contact = axi_model_contact(model),
                                .skin = axi_model_skin(model)};
  must(harmonic_quadratic(harmonic, &base, 0, v, &value, &failure));
  report_check("folds that touch, v K v for n = 0", "75 elements", wanted, value, 1e-10);
  struct harmonic_state bare = {.u = state.u};
  double full[2], without[2];
  for (int n = 0; n < 2; n++) {
    must(harmonic_quadratic(harmonic, &base, 2 * n, v, &full[n], &failure));
    must(harmonic_quadratic(harmonic, &bare, 2 * n, v, &without[n], &failure));
  }
  report_check("skin and contact for n = 2 over n = 0", "75 elements", 0.5,
               (full[1] - without[1]) / (full[0] - without[0]), 1e-9);
  free(d);
  harmonic_destroy(harmonic);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  bellows_release(&bellows);
  job_spec_release(&spec);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("harmonics");
  TCase *variation = tcase_create("variation");
  tcase_add_loop_test(variation, energy_in_three_dimensions, 0, 12);
  tcase_add_loop_test(variation, rigid_motion, 0, 3);
  tcase_add_test(variation, turned_in_equilibrium);
  tcase_add_test(variation, folds_that_touch);
  tcase_set_timeout(variation, 60);
  suite_add_tcase(suite, variation);
  return suite_run(suite);
}
