/* Materials against closed forms. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/material.h"
#include "solver/job/schema.h"
#include "tests/unit/suite.h"
#include <jansson.h>

static const double uniaxial[3] = {1.0, -0.5, -0.5};
static const double planar[3] = {1.0, 0.0, -1.0};
static const double equibiaxial[3] = {1.0, 1.0, -2.0};

static struct material_spec yeoh(double c1, double c2, double c3) {
  return (struct material_spec){.model = MATERIAL_YEOH, .terms = 3, .c = {c1, c2, c3}};
}

static struct material_spec mooney(double c10, double c01) {
  return (struct material_spec){.model = MATERIAL_MOONEY_RIVLIN, .terms = 2, .c = {c10, c01}};
}

static struct material_spec ogden(double mu, double alpha) {
  return (struct material_spec){.model = MATERIAL_OGDEN, .terms = 1, .c = {mu}, .alpha = {alpha}};
}

static void check_near(double value, double wanted, double tolerance) {
  ck_assert_msg(fabs(value - wanted) <= tolerance * fabs(wanted), "%.12g, not %.12g", value,
                wanted);
}

START_TEST(shear_moduli) {
  struct material_spec neo = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {4e5}};
  struct material_spec law = yeoh(1e5, 7e4, 3e4);
  check_near(material_shear_modulus(&neo), 4e5, 1e-15);
  check_near(material_shear_modulus(&law), 2e5, 1e-15);
  law = mooney(1e5, 2e4);
  check_near(material_shear_modulus(&law), 2.4e5, 1e-15);
  /* The three-term fit of Ogden (1972) to Treloar's data. */
  law = (struct material_spec){
      .model = MATERIAL_OGDEN, .terms = 3, .c = {6.3e5, 1.2e3, -1e4}, .alpha = {1.3, 5.0, -2.0}};
  check_near(material_shear_modulus(&law), 0.5 * (6.3e5 * 1.3 + 1.2e3 * 5 + 1e4 * 2), 1e-15);
}
END_TEST

/* At the undeformed state every law has the slopes 3 mu, 4 mu and 12 mu along the three paths. */
START_TEST(initial_tangents_follow_from_the_shear_modulus) {
  const struct material_spec laws[] = {
      {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {4e5}},
      yeoh(2.5e5, -5e4, 5e3),
      mooney(1e5, 2e4),
      {.model = MATERIAL_OGDEN, .terms = 2, .c = {6.3e5, -1e4}, .alpha = {1.3, -2.0}},
  };
  for (size_t i = 0; i < sizeof laws / sizeof *laws; i++) {
    double mu = material_shear_modulus(&laws[i]);
    check_near(material_tangent(&laws[i], uniaxial, 1.0), 3 * mu, 1e-13);
    check_near(material_tangent(&laws[i], planar, 1.0), 4 * mu, 1e-13);
    check_near(material_tangent(&laws[i], equibiaxial, 1.0), 12 * mu, 1e-13);
  }
}
END_TEST

/* Yeoh, uniaxial: P = 2 (s - s^-2) W'(I1), differentiated by central differences. */
static double yeoh_uniaxial_stress(const double *c, double s) {
  double x = s * s + 2 / s - 3;
  return 2 * (s - 1 / (s * s)) * (c[0] + 2 * c[1] * x + 3 * c[2] * x * x);
}

START_TEST(yeoh_tangent_is_the_slope_of_its_stress) {
  struct material_spec law = yeoh(2.5e5, -5e4, 5e3);
  for (double s = 1.0; s < 4.0; s += 0.1) {
    double h = 1e-5;
    double slope =
        (yeoh_uniaxial_stress(law.c, s + h) - yeoh_uniaxial_stress(law.c, s - h)) / (2 * h);
    ck_assert_double_eq_tol(material_tangent(&law, uniaxial, s), slope, 1e-6 * 7.5e5);
  }
}
END_TEST

START_TEST(mooney_tangents_are_the_closed_forms) {
  struct material_spec law = mooney(1e5, 2e4);
  for (double s = 1.0; s < 5.0; s += 0.25) {
    check_near(material_tangent(&law, uniaxial, s),
               2 * (1e5 * (1 + 2 / pow(s, 3)) + 2e4 * 3 / pow(s, 4)), 1e-12);
    check_near(material_tangent(&law, planar, s), 2 * (1e5 + 2e4) * (1 + 3 / pow(s, 4)), 1e-12);
    check_near(material_tangent(&law, equibiaxial, s),
               4 * (1e5 * (1 + 5 / pow(s, 6)) + 2e4 * (3 * s * s + 3 / pow(s, 4))), 1e-12);
  }
}
END_TEST

/* One Ogden term, uniaxial: the slope vanishes at s^(3 alpha / 2) = (1 + alpha/2) / (1 - alpha).
 * The other two paths are checked to vanish later. */
START_TEST(ogden_limit_is_the_closed_form) {
  for (double alpha = 0.3; alpha < 0.95; alpha += 0.1) {
    struct material_spec law = ogden(1e5, alpha);
    double tension = pow((1 + alpha / 2) / (1 - alpha), 2 / (3 * alpha));
    double shear = pow((1 + alpha) / (1 - alpha), 1 / (2 * alpha));
    double biaxial = pow((1 + 2 * alpha) / (1 - alpha), 1 / (3 * alpha));
    double first = fmin(tension, fmin(shear, biaxial)), found = 0.0;
    ck_assert(!material_stable_to(&law, 1e3, &found));
    check_near(found, first, 1e-8);
    ck_assert(material_stable_to(&law, first * 0.9999, &found));
    ck_assert(!material_stable_to(&law, first * 1.0001, NULL));
  }
}
END_TEST

/* Mooney-Rivlin with C01 = -k C10: the biaxial slope vanishes where
 * 1 + 5 s^-6 = 3 k (s^2 + s^-4); the planar and uniaxial ones never, for k < 1. */
START_TEST(mooney_limit_is_the_root_of_its_closed_form) {
  double k = 0.1;
  struct material_spec law = mooney(1e5, -k * 1e5);
  double low = 1.0, high = 10.0;
  while (high - low > 1e-13) {
    double s = 0.5 * (low + high);
    *(1 + 5 / pow(s, 6) > 3 * k * (s * s + 1 / pow(s, 4)) ? &low : &high) = s;
  }
  double found = 0.0;
  ck_assert(!material_stable_to(&law, 10.0, &found));
  check_near(found, low, 1e-8);
}
END_TEST

/* Yeoh with C2 = -k C1 alone, planar: with q = (s - 1/s)^2 = I1 - 3 and r = q + 4 = (s + 1/s)^2,
 * W = C1 (q - k q^2); the root is found here from the stress by differences. */
START_TEST(softening_yeoh_is_unstable_where_its_stress_has_a_maximum) {
  double k = 0.05;
  struct material_spec law = yeoh(1e5, -k * 1e5, 0.0);
  double found = 0.0, peak = INFINITY;
  for (int mode = 0; mode < 3; mode++) {
    const double *e = mode == 0 ? uniaxial : mode == 1 ? planar : equibiaxial;
    double best = -INFINITY;
    for (double s = 1.0; s < 5.0; s += 1e-4) {
      double x = pow(s, 2 * e[0]) + pow(s, 2 * e[1]) + pow(s, 2 * e[2]) - 3;
      double slope_of_x = 0.0;
      for (int i = 0; i < 3; i++) {
        slope_of_x += 2 * e[i] * pow(s, 2 * e[i] - 1);
      }
      double stress = (1 - 2 * k * x) * slope_of_x;
      if (stress < best) {
        peak = fmin(peak, s);
        break;
      }
      best = stress;
    }
  }
  ck_assert(!material_stable_to(&law, 5.0, &found));
  ck_assert_double_eq_tol(found, peak, 2e-4);
}
END_TEST

START_TEST(stable_laws_are_stable) {
  struct material_spec neo = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e5}};
  double found = 42.0;
  ck_assert(material_stable_to(&neo, 100.0, &found));
  struct material_spec law = mooney(1e5, 2e4);
  ck_assert(material_stable_to(&law, 100.0, &found));
  law = ogden(1e5, 2.0);
  ck_assert(material_stable_to(&law, 100.0, &found));
  ck_assert_double_eq(found, 42.0);
}
END_TEST

START_TEST(built_in_materials_are_complete) {
  size_t count = 0;
  for (; material_builtin(count); count++) {
    const struct material_spec *m = material_builtin(count);
    ck_assert_ptr_eq(material_find(m->name), m);
    ck_assert_uint_gt(strlen(m->source), 10);
    ck_assert_double_gt(material_shear_modulus(m), 1e4);
    ck_assert(m->density_kg_m3 > 900 && m->density_kg_m3 < 1300);
    ck_assert_double_eq(m->bulk_ratio, 1000.0);
    double limit = m->fit_stretch_max > 0 ? m->fit_stretch_max : 2.0, found = 0.0;
    bool stable = material_stable_to(m, limit, &found);
    ck_assert_msg(stable || found > 1.2, "%s is unstable at %g", m->name, found);
  }
  ck_assert_uint_eq(count, 11);
  ck_assert_ptr_null(material_find("steel"));
}
END_TEST

START_TEST(the_paper_s_elastic_50a_is_as_printed) {
  const struct material_spec *m = material_find("elastic-50a");
  ck_assert_double_eq(m->c[0], 0.25e6);
  ck_assert_double_eq(m->c[1], -0.05e6);
  ck_assert_double_eq_tol(m->c[2], 0.005e6, 1e-9);
}
END_TEST

START_TEST(the_schema_names_exactly_the_built_in_materials) {
  size_t size = 0, index;
  const char *text = job_schema_text(&size);
  json_t *root = json_loadb(text, size, 0, NULL), *name;
  json_t *material = json_object_get(json_object_get(root, "$defs"), "material");
  json_t *names = json_object_get(json_array_get(json_object_get(material, "oneOf"), 0), "enum");
  json_array_foreach(names, index, name) {
    ck_assert_ptr_nonnull(material_builtin(index));
    ck_assert_ptr_nonnull(material_find(json_string_value(name)));
  }
  ck_assert_ptr_null(material_builtin(index));
  json_decref(root);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: material");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, shear_moduli);
  tcase_add_test(tcase, initial_tangents_follow_from_the_shear_modulus);
  tcase_add_test(tcase, yeoh_tangent_is_the_slope_of_its_stress);
  tcase_add_test(tcase, mooney_tangents_are_the_closed_forms);
  tcase_add_test(tcase, ogden_limit_is_the_closed_form);
  tcase_add_test(tcase, mooney_limit_is_the_root_of_its_closed_form);
  tcase_add_test(tcase, softening_yeoh_is_unstable_where_its_stress_has_a_maximum);
  tcase_add_test(tcase, stable_laws_are_stable);
  tcase_add_test(tcase, built_in_materials_are_complete);
  tcase_add_test(tcase, the_paper_s_elastic_50a_is_as_printed);
  tcase_add_test(tcase, the_schema_names_exactly_the_built_in_materials);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
