/* Quantities: conversions against their definitions, and everything that has to be refused. */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/units.h"
#include "tests/unit/suite.h"

static struct units *units;

static void set_up(void) {
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(units_create(&units, &error) == STATUS_OK, "%s", error.message);
}

static void tear_down(void) {
  units_destroy(units);
  units_destroy(NULL);
}

#define PI 3.14159265358979323846

static const struct {
  const char *text, *unit;
  double si;
} good[] = {
    {"50 kPa", "kPa", 50e3},
    {"50kPa", "kPa", 50e3},
    {"0.05 MPa", "kPa", 50e3},
    {"1 N/mm2", "kPa", 1e6},
    {"1 bar", "kPa", 1e5},
    {"8 psi", "kPa", 8 * 4.4482216152605 / (0.0254 * 0.0254)},
    {"1.5 mm", "mm", 1.5e-3},
    {"1 in", "mm", 0.0254},
    {"1500 um", "mm", 1.5e-3},
    {"1500 \xC2\xB5m", "mm", 1.5e-3},
    {"-2.5e-1 cm", "mm", -2.5e-3},
    {"+1 m", "mm", 1.0},
    {".5 m", "mm", 0.5},
    {"5. m", "mm", 5.0},
    {"2 deg", "deg", 2 * PI / 180},
    {"2 degrees", "deg", 2 * PI / 180},
    {"2 \xC2\xB0", "deg", 2 * PI / 180},
    {"0.1 rad", "deg", 0.1},
    {"9.80665 m/s2", "m/s2", 9.80665},
    {"9.80665 m s-2", "m/s2", 9.80665},
    {"9.80665 m/s^2", "m/s2", 9.80665},
    {"1 standard_free_fall", "m/s2", 9.80665},
    {"10 min", "min", 600},
    {"2 GiB", "MB", 2147483648},
    {"2048 MB", "MB", 2048e6},
    {"1.5 KiB", "MB", 1536},
    {"0.001 TB", "GiB", 1e9},
    {"3 kB/s", "MB/s", 3000},
    {"2 mbar", "kPa", 200},
    {"0.5 h", "s", 1800},
    {"1080 kg/m3", "kg/m3", 1080},
    {"1.08 g/cm3", "kg/m3", 1080},
    {"5.577 N/psi", "N/psi", 5.577 * 0.0254 * 0.0254 / 4.4482216152605},
    {"6 N s/m", "N s/m", 6},
    {"-9 1/s", "1/s", -9},
    {"0 kPa", "kPa", 0},
    {"1 cmH2O", "kPa", 98.0665},
    {"2 mm\xC2\xB2", "mm2", 2e-6},
    {"2 N\xC2\xB7m", "N m", 2},
};

START_TEST(converts_to_si) {
  double si = NAN;
  struct error error = {.status = STATUS_OK};
  enum status status = units_read(units, good[_i].text, good[_i].unit, &si, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", good[_i].text, error.message);
  ck_assert_msg(fabs(si - good[_i].si) <= 1e-9 * fabs(good[_i].si), "%s gave %.17g, not %.17g",
                good[_i].text, si, good[_i].si);
}
END_TEST

static const struct {
  const char *text, *unit, *phrase;
} bad[] = {
    {"50", "kPa", "for example \"50 kPa\""},
    {"50 ", "kPa", "for example \"50 kPa\""},
    {"", "kPa", "\"1 kPa\""},
    {"kPa", "kPa", "decimal number"},
    {" 50 kPa", "kPa", "decimal number"},
    {"fifty kPa", "kPa", "decimal number"},
    {"50 kpa", "kPa", "\"50 kPa\""},
    {"50 kPa!", "kPa", "unknown unit"},
    {"50 kPa 3", "kPa", "unknown unit"},
    {"50 3 kPa", "kPa", "unknown unit"},
    {"50 kPa\n", "kPa", "unknown unit"},
    {"50 kPa/", "kPa", "unknown unit"},
    {"50,5 kPa", "kPa", "unknown unit"},
    {"5 0 kPa", "kPa", "unknown unit"},
    {"50 mm", "kPa", "is a length, but a pressure is wanted"},
    {"50 kPa", "mm", "is a pressure, but a length is wanted"},
    {"2 %", "deg", "a pure number"},
    {"2 m/m", "deg", "a pure number"},
    {"2 rad", "mm", "an angle"},
    {"5 s", "1/s", "a time"},
    {"5 1/m", "mm", "\"5 mm\""},
    {"20 degC", "mm", "not a plain multiple"},
    {"20 K", "mm", "not a plain multiple"},
    {"5 mm @ 3", "mm", "unknown unit"},
    {"5 lg(re mm)", "mm", "\"5 mm\""},
    {"5 ln(re 1 Pa)", "kPa", "\"5 kPa\""},
    {"5 s since 1970-01-01", "s", "unknown unit"},
    {"nan mm", "mm", "decimal number"},
    {"inf mm", "mm", "decimal number"},
    {"0x10 mm", "mm", "unknown unit"},
    {"1e400 mm", "mm", "beyond the range"},
    {"-1e400 mm", "mm", "beyond the range"},
    {"1e-400 mm", "mm", "beyond the range"},
    {"1e308 km", "mm", "beyond the range"},
    {"1e mm", "mm", "\"1 mm\""},
    {"5 mm\xE2\x82\xAC", "mm", "unknown unit"},
    {"5 \xE2\x82\xACmm", "mm", "unknown unit"},
    {"1 m99999999999", "mm", "\"1 mm\""},
    {"1 \xFF", "mm", "unknown unit"},
    {"3W0 mm", "mm", "unknown unit"},
    {"6(m)0 g", "kg", "unknown unit"},
    {"1 (((((((((((((((((((((((((((m))))))))))))))))))))))))))", "mm", "unknown unit"},
    {"1 mmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmmm", "mm", "longer than 64"},
};

START_TEST(refuses) {
  double si = 123.0;
  struct error error = {.status = STATUS_OK};
  enum status status = units_read(units, bad[_i].text, bad[_i].unit, &si, &error);
  ck_assert_msg(status == STATUS_INVALID, "\"%s\" was taken as %g", bad[_i].text, si);
  ck_assert_msg(strstr(error.message, bad[_i].phrase) != NULL, "\"%s\": %s", bad[_i].text,
                error.message);
  ck_assert_double_eq(si, 123.0);
}
END_TEST

START_TEST(our_own_unknown_unit_is_an_internal_error) {
  double si;
  ck_assert_int_eq(units_read(units, "5 mm", "furlongz", &si, NULL), STATUS_INTERNAL);
}
END_TEST

START_TEST(a_missing_database_is_named) {
  struct units *none = NULL;
  struct error error = {.status = STATUS_OK};
  setenv("UDUNITS2_XML_PATH", "/nonexistent/udunits2.xml", 1);
  ck_assert_int_eq(units_create(&none, &error), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(error.message, "UDUNITS2_XML_PATH"));
}
END_TEST

static void *read_many(void *argument) {
  size_t *wrong = argument;
  for (size_t i = 0; i < 2000; i++) {
    size_t k = i % (sizeof good / sizeof *good);
    double si = NAN;
    enum status status = units_read(units, good[k].text, good[k].unit, &si, NULL);
    *wrong += status != STATUS_OK || !(fabs(si - good[k].si) <= 1e-9 * fabs(good[k].si));
    *wrong += units_read(units, "1 (m", "mm", &si, NULL) != STATUS_INVALID;
  }
  return NULL;
}

START_TEST(threads_do_not_disturb_each_other) {
  pthread_t threads[4];
  size_t wrong[4] = {0, 0, 0, 0};
  for (size_t i = 0; i < 4; i++) {
    ck_assert_int_eq(pthread_create(&threads[i], NULL, read_many, &wrong[i]), 0);
  }
  for (size_t i = 0; i < 4; i++) {
    pthread_join(threads[i], NULL);
    ck_assert_uint_eq(wrong[i], 0);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("base: units");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, set_up, tear_down);
  tcase_add_loop_test(tcase, converts_to_si, 0, sizeof good / sizeof *good);
  tcase_add_loop_test(tcase, refuses, 0, sizeof bad / sizeof *bad);
  tcase_add_test(tcase, our_own_unknown_unit_is_an_internal_error);
  tcase_add_test(tcase, a_missing_database_is_named);
  tcase_add_test(tcase, threads_do_not_disturb_each_other);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
