/* Slender cantilevers of nearly incompressible material do not lock. */
#include <check.h>
#include <math.h>
#include "solver/verify/report.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1000};

static double young(const struct material_spec *m) {
  double mu = m->c[0], kappa = mu * m->bulk_ratio;
  return 9 * kappa * mu / (3 * kappa + mu);
}

static const double slender_height = 0.05;

struct skew {
  int cells;
  double amount; /* of the planes between elements, of their distance; alternating */
};

/* Length 1, square section of edge 0.05 about the x axis. */
static void beam_map(const void *context, int block, const double s[3], double x[3]) {
  const struct skew *skew = context;
  (void)block;
  double wave = sin(M_PI * skew->cells * s[0] + 0.5 * M_PI) * (s[0] > 0 && s[0] < 1);
  x[1] = slender_height * (s[1] - 0.5);
  x[2] = slender_height * (s[2] - 0.5);
  x[0] = s[0] + skew->amount / skew->cells * wave * (2 * s[2] - 1);
}

/* Tip deflection over that of the Timoshenko beam with Cowper's shear coefficient. The base is
 * held so that the section may contract. */
static double deflection_ratio(struct skew skew) {
  struct body body = {.blocks = 1, .cells = {skew.cells, 1, 1}, .map = beam_map, .context = &skew};
  struct verify_run run = {.control = {.tolerance = 1e-12}};
  struct verify_body b = {.model = NULL};
  struct fe_load load = {0, 0, 1};
  ck_assert_int_eq(body_build(&body, &b.mesh), STATUS_OK);
  body_hold(&b.mesh, 0, 0, HOLD_X);
  body_hold(&b.mesh, 1, 0, HOLD_Y);
  b.mesh.fixed[3 * body_node(&b.mesh, 0, 0, 0) + 2] = 1;
  ck_assert_int_eq(verify_body_open(&b, &rubber, false, NULL), STATUS_OK);
  double area = slender_height * slender_height, inertia = area * area / 12, force = 1e-9;
  body_add_traction(b.model, 0, 1, (double[3]){0, 0, force / area});
  ck_assert_int_eq(newton_solve(b.model, &load, &b.state, &run.control), STATUS_OK);
  double nu = 0.5 * (3 * rubber.bulk_ratio - 2) / (3 * rubber.bulk_ratio + 1);
  double shear = 10 * (1 + nu) / (12 + 11 * nu);
  double beam = force / (3 * young(&rubber) * inertia) + force / (shear * rubber.c[0] * area);
  double ratio = b.state.u[3 * body_node(&b.mesh, 1, 0, 0) + 2] / beam;
  verify_body_close(&run, &b);
  return ratio;
}

/* Elements two and five times as long as high; with curvatures that are constant per element, 4
 * of them can reach 1 - 1/64 at best. A locking element would stay far below. */
START_TEST(bending_does_not_lock) {
  static const struct {
    const char *mesh;
    struct skew skew;
    double tolerance;
  } cases[] = {{"10 elements", {10, 0}, 5e-3},
               {"4 elements", {4, 0}, 0.02},
               {"10 elements, skewed", {10, 0.25}, 0.04}};
  report_check("cantilever L/h = 20, bulk/shear 1000, tip over Timoshenko", cases[_i].mesh, 1,
               deflection_ratio(cases[_i].skew), cases[_i].tolerance);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("beams");
  TCase *beam = tcase_create("beams");
  tcase_set_timeout(beam, 60);
  tcase_add_loop_test(beam, bending_does_not_lock, 0, 3);
  suite_add_tcase(suite, beam);
  return suite_run(suite);
}
