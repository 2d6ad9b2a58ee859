/* Laws of cells from tables against the closed form that the tables were made of. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/bistable/law.h"
#include "solver/bistable/system.h"
#include "tests/physics/fold_law.h"
#include "tests/unit/suite.h"

static const double levels[] = {-40e3, -20e3, 0.0, 20e3, 40e3, 60e3};
enum { LEVELS = sizeof levels / sizeof *levels, POINTS = 120 };

static void make_law(const struct fold *fold, bool energies, struct law_spec *spec,
                     struct law **law) {
  struct error error = {.status = STATUS_OK};
  *spec = (struct law_spec){.is_table = true};
  fold_table(fold, LEVELS, levels, POINTS, -2.5e-3, 13e-3, &spec->table);
  for (int k = 0; k < LEVELS && !energies; k++) {
    spec->table.level[k].energy = NULL;
  }
  ck_assert_msg(law_create(spec, law, &error) == STATUS_OK, "%s", error.message);
}

/* Pressures in and between those of the table, on both sides up to the turning points. */
START_TEST(a_folding_table_gives_back_its_law) {
  struct law_spec spec;
  struct law *law;
  make_law(&fold_pair, _i == 0, &spec, &law);
  ck_assert(law_has_branches(law));
  double shift = NAN;
  for (double p = -38e3; p < 60e3; p += 3.7e3) {
    for (int side = 0; side < 2; side++) {
      double end = fold_end(&fold_pair, side, p);
      ck_assert_double_eq_tol(law_end(law, (enum law_side)side, p), end, 2e-6);
      for (int i = 1; i < 20; i++) {
        double h = end + (side ? 1 : -1) * 2e-4 * i, state[4];
        struct law_value value;
        fold_state(&fold_pair, fold_inner(&fold_pair, side, h, p), p, state);
        law_evaluate(law, (enum law_side)side, h, p, &value);
        ck_assert_double_eq_tol(value.force, state[1], 0.02);
        /* 0.03 % of what the volume changes by */
        ck_assert_double_eq_tol(value.volume, state[2], 2e-9);
        double potential = state[3] - p * state[2];
        shift = isnan(shift) ? value.potential - potential : shift;
        ck_assert_double_eq_tol(value.potential - shift, potential, 3e-5);
      }
    }
  }
  ck_assert(_i == 1 || fabs(shift) < 3e-5);
  struct law_consistency check = law_check(law);
  ck_assert_double_lt(check.volume, 2e-4);
  ck_assert(_i == 1 ? isnan(check.energy) : check.energy < 2e-4);
  law_destroy(law);
  law_table_release(&spec.table);
}
END_TEST

/* F = dPhi/dh and V = -dPhi/dp to the accuracy of differences, anywhere, also beyond the table. */
START_TEST(force_and_volume_derive_from_the_potential) {
  struct law_spec spec;
  struct law *law;
  struct fold fold = fold_pair;
  fold.K = _i == 0 ? fold_pair.K : 4e4; /* the latter does not fold */
  make_law(&fold, true, &spec, &law);
  ck_assert(law_has_branches(law) == (_i == 0));
  srand(7);
  for (int n = 0; n < 2000; n++) {
    double p = -60e3 + 150e3 * rand() / RAND_MAX, h = -8e-3 + 26e-3 * rand() / RAND_MAX;
    enum law_side side = n % 2 ? LAW_STRETCHED : LAW_COMPRESSED;
    double dh = 1e-8, dp = 1.0;
    struct law_value at, up, down;
    if (fabs(h - law_end(law, side, p)) < 1e-6) {
      continue;
    }
    law_evaluate(law, side, h, p, &at);
    law_evaluate(law, side, h + dh, p, &up);
    law_evaluate(law, side, h - dh, p, &down);
    ck_assert_double_eq_tol((up.potential - down.potential) / (2.0 * dh), at.force,
                            1e-4 + 1e-4 * fabs(at.force));
    law_evaluate(law, side, h, p + dp, &up);
    law_evaluate(law, side, h, p - dp, &down);
    ck_assert_double_eq_tol((down.potential - up.potential) / (2.0 * dp), at.volume, 1e-9);
  }
  law_destroy(law);
  law_table_release(&spec.table);
}
END_TEST

/* The greatest force of the compressed side: without a load, the trigger pressure. */
START_TEST(limits_and_rests) {
  struct law_spec spec;
  struct law *law;
  make_law(&fold_pair, true, &spec, &law);
  const struct fold *f = &fold_pair;
  double x = (f->x1 + f->x2 - sqrt(f->x1 * f->x1 + f->x2 * f->x2 - f->x1 * f->x2)) / 3.0;
  double trigger = f->a * x * (x - f->x1) * (x - f->x2) / (f->A + f->B), state[4];
  fold_state(f, x, trigger, state);
  ck_assert_double_eq_tol(trigger, 34.9e3, 700.0);
  ck_assert_double_eq_tol(law_limit(law, LAW_COMPRESSED, trigger), state[0], 2e-5);
  ck_assert(!isnan(law_rest(law, LAW_COMPRESSED, trigger - 60.0, 0.0)));
  ck_assert(isnan(law_rest(law, LAW_COMPRESSED, trigger + 60.0, 0.0)));
  /* at p = 0 without force the inner elongation is 0 or x2, and h the same */
  ck_assert_double_eq_tol(law_rest(law, LAW_COMPRESSED, 0.0, 0.0), 0.0, 2e-7);
  ck_assert_double_eq_tol(law_rest(law, LAW_STRETCHED, 0.0, 0.0), f->x2, 2e-7);
  law_destroy(law);
  law_table_release(&spec.table);
}
END_TEST

/* A path in reverse order is the same path. */
START_TEST(order_does_not_matter) {
  struct law_spec spec;
  struct law *law, *reversed;
  make_law(&fold_pair, true, &spec, &law);
  struct law_value a, b;
  law_evaluate(law, LAW_COMPRESSED, 1e-3, 11e3, &a);
  law_destroy(law);
  for (int k = 0; k < LEVELS; k++) {
    double *column[] = {spec.table.level[k].h, spec.table.level[k].force,
                        spec.table.level[k].volume, spec.table.level[k].energy};
    for (int c = 0; c < 4; c++) {
      for (int i = 0; i < POINTS / 2; i++) {
        double held = column[c][i];
        column[c][i] = column[c][POINTS - 1 - i];
        column[c][POINTS - 1 - i] = held;
      }
    }
  }
  ck_assert_int_eq(law_create(&spec, &reversed, NULL), STATUS_OK);
  law_evaluate(reversed, LAW_COMPRESSED, 1e-3, 11e3, &b);
  ck_assert_double_eq_tol(a.force, b.force, 1e-12);
  ck_assert_double_eq_tol(a.potential, b.potential, 1e-12);
  law_destroy(reversed);
  law_table_release(&spec.table);
}
END_TEST

/* A return of h by some micrometres within a side, as of walls that touch, is no branch of its own:
 * the sides stay what they are. */
START_TEST(small_folds_are_stepped_over) {
  struct law_spec spec;
  struct law *law;
  struct error error = {.status = STATUS_OK};
  make_law(&fold_pair, true, &spec, &law);
  double ends[2] = {law_end(law, LAW_COMPRESSED, 13e3), law_end(law, LAW_STRETCHED, 13e3)};
  struct law_value whole, stepped;
  law_evaluate(law, LAW_STRETCHED, 10e-3, 13e3, &whole);
  law_destroy(law);
  struct law_level *level = &spec.table.level[3];
  for (size_t i = POINTS - 30; i < POINTS - 20; i++) {
    level->h[i] = level->h[POINTS - 31] - 1e-6 * (double)(i - (POINTS - 31));
  }
  ck_assert_msg(law_create(&spec, &law, &error) == STATUS_OK, "%s", error.message);
  ck_assert_double_eq_tol(law_end(law, LAW_COMPRESSED, 13e3), ends[0], 1e-12);
  ck_assert_double_eq_tol(law_end(law, LAW_STRETCHED, 13e3), ends[1], 1e-12);
  law_evaluate(law, LAW_STRETCHED, 10e-3, 13e3, &stepped);
  ck_assert_double_eq_tol(stepped.force, whole.force, 0.05 * fabs(whole.force));
  law_destroy(law);
  law_table_release(&spec.table);
}
END_TEST

/* A quintic with two falling stretches: limits are the outer ones. */
START_TEST(closed_forms) {
  struct law_spec spec = {.count = 4,
                          .per = 1e-3,
                          .c = {0.0, 8.0, -6.0, 1.0},
                          .area = 8e-4,
                          .volume = 1e-5,
                          .from = -2e-3,
                          .to = 6e-3};
  struct law *law;
  struct law_value value;
  ck_assert_int_eq(law_create(&spec, &law, NULL), STATUS_OK);
  law_evaluate(law, LAW_COMPRESSED, 1e-3, 2e3, &value);
  suite_check_near(value.force, 3.0 - 1.6);
  suite_check_near(value.volume, 1e-5 + 8e-7);
  suite_check_near(value.potential, 1e-3 * (4.0 - 2.0 + 0.25) - 2e3 * 1.08e-5);
  /* 8 - 12 x + 3 x^2 = 0 */
  ck_assert_double_eq_tol(law_limit(law, LAW_COMPRESSED, 0.0), (2.0 - sqrt(4.0 / 3.0)) * 1e-3,
                          1e-12);
  ck_assert_double_eq_tol(law_end(law, LAW_COMPRESSED, 0.0), (2.0 + sqrt(4.0 / 3.0)) * 1e-3, 1e-12);
  ck_assert_double_eq_tol(law_rest(law, LAW_COMPRESSED, 0.0, 0.0), 0.0, 1e-12);
  ck_assert_double_eq_tol(law_rest(law, LAW_STRETCHED, 0.0, 0.0), 4e-3, 1e-12);
  law_destroy(law);
}
END_TEST

/* A path that goes nowhere is refused with its place. */
START_TEST(a_table_without_order_is_refused) {
  char text[4000], level[1500] = "";
  static const double wild[] = {0, 3, 1, 4, 0.5, 5, 0.2, 0.1, 6, 0.05};
  size_t used = 0;
  for (size_t i = 0; i < sizeof wild / sizeof *wild; i++) {
    used += (size_t)snprintf(level + used, sizeof level - used,
                             "%s{\"h_mm\": %g, \"force_N\": %zu, \"volume_mm3\": 9000}",
                             i ? "," : "", wild[i], i);
  }
  snprintf(text, sizeof text,
           "{\"kind\": \"bistable\", \"laws\": {\"wild\": {\"table\": [{\"pressure_kPa\": 0, "
           "\"points\": [%s]}, {\"pressure_kPa\": 9, \"points\": [%s]}]}}, \"actuators\": "
           "[{\"cells\": [{\"law\": \"wild\", \"mass\": \"1 g\"}]}], \"plate\": {\"mass\": \"1 "
           "g\"}, \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"1 s\"}",
           level, level);
  struct job_spec job;
  struct bistable_system system;
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(job_spec_read(text, strlen(text), &job, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_eq(system_open(job.bistable, &system, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/laws/wild");
  ck_assert_ptr_nonnull(strstr(error.message, "at 0 kPa the path turns back"));
  system_close(&system);
  job_spec_release(&job);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("bistable: laws of cells");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, a_folding_table_gives_back_its_law, 0, 2);
  tcase_add_loop_test(tcase, force_and_volume_derive_from_the_potential, 0, 2);
  tcase_add_test(tcase, limits_and_rests);
  tcase_add_test(tcase, order_does_not_matter);
  tcase_add_test(tcase, small_folds_are_stepped_over);
  tcase_add_test(tcase, closed_forms);
  tcase_add_test(tcase, a_table_without_order_is_refused);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
