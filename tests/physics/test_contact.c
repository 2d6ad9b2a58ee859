/* Contact between two faces: tangent against differences, balance of forces. */
#include <check.h>
#include <math.h>
#include "solver/base/vec3.h"
#include "solver/verify/contact_pair.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* Range of the law's argument g - lambda/eps over the points of the evaluated pair. */
static void argument_range(const struct contact_pair_case *c, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const struct contact_point *point = &c->contact.point[q];
    ck_assert(point->valid);
    double argument = point->gap - point->lambda / c->contact.stiffness;
    *low = fmin(*low, argument);
    *high = fmax(*high, argument);
  }
}

/* gap, multiplier, range of the law's argument in units of the smoothing, smallest error. */
static const struct regime {
  const char *name;
  double gap, lambda, crooked, low, high, floor;
} regimes[] = {
    {"contact, penetrating", -0.12, 0, 0.05, -INFINITY, -1, 1e-7},
    {"contact, smoothed", 0.01, 0, 0.05, -1, 1, 1e-7},
    {"contact, multiplier across a gap", 0.08, 3, 0.05, -INFINITY, -1, 1e-7},
    {"contact, multiplier, smoothed", 0.11, 1, 0.05, -1, 1, 1e-7},
    {"contact, flat faces", -0.12, 0, 0, -INFINITY, -1, 1e-7},
    {"contact, multiplier on touching faces", 1e-5, 3, 0.02, -INFINITY, -1, 1e-7},
    {"contact, multiplier on closed faces", 1e-10, 3, 0, -INFINITY, -1, 1e-7},
    {"contact, multiplier, hardly penetrating", -1e-9, 3, 0, -INFINITY, -1, 1e-7},
};
enum { REGIMES = sizeof regimes / sizeof *regimes };

START_TEST(tangent_of_a_pair) {
  const struct regime *regime = &regimes[_i];
  struct contact_pair_case c;
  double low, high;
  ck_assert_int_eq(contact_pair_open(&c, regime->gap, regime->crooked, regime->lambda), STATUS_OK);
  ck_assert_int_eq(contact_pair_tangent(&c), STATUS_OK);
  argument_range(&c, &low, &high);
  ck_assert_double_gt(low, regime->low * c.contact.smoothing);
  ck_assert_double_lt(high, regime->high * c.contact.smoothing);
  report_second_order(regime->name, contact_pair_error, &c, 2e-3, 3, regime->floor);
  contact_pair_close(&c);
}
END_TEST

START_TEST(forces_of_a_pair_balance) {
  struct contact_pair_case c;
  double r[CONTACT_DOFS], force[3] = {0}, moment[3] = {0}, turn[3], size = 0;
  ck_assert_int_eq(contact_pair_open(&c, -0.12, 0.05, 0), STATUS_OK);
  ck_assert(contact_pair_residual(&c, 0, r));
  for (int a = 0; a < CONTACT_NODES; a++) {
    vec3_cross(c.x[a], r + 3 * a, turn);
    for (int i = 0; i < 3; i++) {
      force[i] += r[3 * a + i];
      moment[i] += turn[i];
      size += fabs(r[3 * a + i]);
    }
  }
  ck_assert_double_lt(vec3_norm(force), 1e-14 * size);
  ck_assert_double_lt(vec3_norm(moment), 1e-12 * size);
  contact_pair_close(&c);
}
END_TEST

START_TEST(open_faces_carry_nothing) {
  struct contact_pair_case c;
  double r[CONTACT_DOFS];
  ck_assert_int_eq(contact_pair_open(&c, 0.06, 0, 0), STATUS_OK);
  ck_assert(!contact_pair_residual(&c, 0, r));
  ck_assert_double_eq_tol(contact_summarise(&c.contact).min_gap, 0.06, 1e-14);
  ck_assert_int_eq(contact_summarise(&c.contact).active, 0);
  contact_pair_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("contact");
  TCase *contact = tcase_create("contact");
  tcase_set_timeout(contact, 60);
  tcase_add_loop_test(contact, tangent_of_a_pair, 0, REGIMES);
  tcase_add_test(contact, forces_of_a_pair_balance);
  tcase_add_test(contact, open_faces_carry_nothing);
  suite_add_tcase(suite, contact);
  return suite_run(suite);
}
