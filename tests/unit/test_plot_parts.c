/* The parts of the plots that have an answer of their own: ticks, places, colours. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "server/plot/colour.h"
#include "server/plot/place.h"
#include "server/plot/ticks.h"
#include "tests/unit/suite.h"

START_TEST(ticks_are_round_and_inside) {
  static const double ranges[][2] = {{0, 50},     {-60, 0.3},   {1e-6, 3e-6}, {-1e9, 1e9},
                                     {0.1, 0.11}, {117, 117.9}, {-7, -6.5}};
  for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++) {
    for (int target = 2; target <= 20; target++) {
      struct ticks ticks = ticks_make(ranges[r][0], ranges[r][1], target);
      double digits = ticks.step / pow(10, floor(log10(ticks.step) + 1e-9));
      ck_assert(fabs(digits - 1) < 1e-6 || fabs(digits - 2) < 1e-6 || fabs(digits - 5) < 1e-6);
      ck_assert_int_ge(ticks.count, 1);
      ck_assert_int_le(ticks.count, 2 * target + 1);
      double slack = 1e-5 * ticks.step;
      ck_assert_double_ge(ticks_value(&ticks, 0), ranges[r][0] - slack);
      ck_assert_double_le(ticks_value(&ticks, ticks.count - 1), ranges[r][1] + slack);
      for (int i = 1; i < ticks.count; i++) {
        char before[TICKS_TEXT], text[TICKS_TEXT];
        ticks_label(&ticks, i - 1, before);
        ticks_label(&ticks, i, text);
        ck_assert_str_ne(before, text);
      }
    }
  }
}
END_TEST

START_TEST(labels_have_a_true_minus_and_no_minus_zero) {
  struct ticks ticks = ticks_make(-1, 1, 4);
  char text[TICKS_TEXT];
  ticks_label(&ticks, 0, text);
  ck_assert_str_eq(text, "\u22121.0");
  ticks_label(&ticks, ticks.count / 2, text);
  ck_assert_str_eq(text, "0.0");
}
END_TEST

START_TEST(ranges_grow_to_ticks) {
  double min = 0, max = 63.7;
  ticks_widen(&min, &max, 7);
  ck_assert_double_eq_tol(min, 0, 1e-12);
  ck_assert_double_eq_tol(max, 70, 1e-9);
  min = max = 12;
  ticks_widen(&min, &max, 5);
  ck_assert(min < 12 && max > 12);
  min = max = 0;
  ticks_widen(&min, &max, 5);
  ck_assert(min < 0 && max > 0);
  min = NAN;
  ticks_widen(&min, &max, 5);
  ck_assert(min < max);
}
END_TEST

/* Positions of logarithmic axes are decimal logarithms; every tick is 1, 2 or 5 times a power of
 * ten, few of them, and all within the range. */
START_TEST(logarithmic_ticks) {
  static const double ranges[][2] = {{-0.9, -0.3}, {-12, 1},    {0, 0},
                                     {-15, 9},     {2.1, 2.15}, {-3, 0}};
  for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++) {
    for (int target = 2; target <= 12; target++) {
      double min = ranges[r][0], max = ranges[r][1];
      ticks_widen_log(&min, &max, target);
      ck_assert(min < max && min <= ranges[r][0] + 1e-6 && max >= ranges[r][1] - 1e-6);
      struct ticks ticks = ticks_make_log(min, max, target);
      ck_assert_int_ge(ticks.count, 2);
      ck_assert_int_le(ticks.count, 2 * target + 4);
      ck_assert_double_eq_tol(ticks_value(&ticks, 0), min, 1e-5 + ticks.step);
      for (int i = 0; i < ticks.count; i++) {
        double value = ticks_value(&ticks, i), digit = pow(10, value - floor(value + 1e-9));
        ck_assert_double_le(value, max + 1e-6);
        ck_assert(fabs(digit - 1) < 1e-6 || fabs(digit - 2) < 1e-6 || fabs(digit - 5) < 1e-6);
      }
    }
  }
  double min = NAN, max = NAN;
  ticks_widen_log(&min, &max, 5);
  ck_assert(min < max);
}
END_TEST

START_TEST(logarithmic_labels) {
  char text[TICKS_TEXT];
  struct ticks wide = ticks_make_log(-12, 0, 4);
  ticks_label(&wide, 0, text);
  ck_assert_str_eq(text, "10\u207b\u00b9\u00b2");
  struct ticks narrow = ticks_make_log(-1, 0, 6);
  ck_assert_int_eq(narrow.count, 4);
  ticks_label(&narrow, 1, text);
  ck_assert_str_eq(text, "0.2");
  struct ticks small = ticks_make_log(-5, -4, 6);
  ticks_label(&small, 2, text);
  ck_assert_str_eq(text, "5\u00b710\u207b\u2075");
}
END_TEST

START_TEST(numbers) {
  static const struct {
    double value;
    int digits;
    const char *number, *plain;
  } cases[] = {
      {1.2746, 3, "1.27", "1.27"},
      {50, 3, "50.0", "50"},
      {-0.05, 2, "\u22120.050", "\u22120.05"},
      {0, 3, "0", "0"},
      {1234.5, 3, "1234", "1234"},
      {1e-9, 2, "1.0e\u221209", "1.0e\u221209"},
      {NAN, 3, "n/a", "n/a"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char text[TICKS_TEXT];
    ticks_number(cases[i].value, cases[i].digits, text);
    ck_assert_str_eq(text, cases[i].number);
    ticks_plain(cases[i].value, cases[i].digits, text);
    ck_assert_str_eq(text, cases[i].plain);
  }
}
END_TEST

START_TEST(places_avoid_what_is_there) {
  struct place place = {.bounds = {0, 0, 100, 100}};
  struct box found;
  ck_assert(place_find(&place, 30, 10, 2, &found));
  ck_assert(found.x == 2 && found.y == 2);
  place_add_segment(&place, (struct place_segment){0, 0, 100, 100});
  ck_assert(place_find(&place, 30, 10, 2, &found));
  ck_assert(found.x == 68 && found.y == 2); /* the first corner off the diagonal */
  ck_assert(!place_is_free(&place, (struct box){40, 40, 20, 20}, 0));
  ck_assert(place_is_free(&place, (struct box){60, 10, 20, 20}, 0));
  ck_assert(!place_is_free(&place, (struct box){90, 10, 20, 20}, 0)); /* sticks out */
  place_add_box(&place, (struct box){0, 0, 100, 100});
  ck_assert(!place_find(&place, 5, 5, 0, &found));
  ck_assert(!place_find(&place, 200, 5, 0, &found));
  place_release(&place);
}
END_TEST

START_TEST(a_label_stays_beside_its_point) {
  struct place place = {.bounds = {0, 0, 100, 100}};
  struct box found;
  ck_assert(place_find_beside(&place, 50, 50, 20, 10, 5, &found));
  ck_assert(found.x > 50 && found.y + found.height < 50); /* above right */
  ck_assert(place_find_beside(&place, 98, 50, 20, 10, 5, &found));
  ck_assert(found.x + found.width < 98); /* no room on the right */
  place_release(&place);
}
END_TEST

static double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* Relative luminance as in WCAG 2. */
static double luminance(struct colour colour, enum colour_theme theme) {
  struct rgb c = colour_rgb(colour, theme);
  return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

/* Contrast against the paper as in WCAG 2. */
static double contrast(struct colour colour, enum colour_theme theme) {
  double a = luminance(colour, theme), b = luminance(colour_paper, theme);
  return (fmax(a, b) + 0.05) / (fmin(a, b) + 0.05);
}

START_TEST(maps_get_lighter_and_lines_stay_visible) {
  enum colour_theme theme = (enum colour_theme)_i;
  double before = -1, line_before = -1;
  for (int i = 0; i <= 100; i++) {
    double area = luminance(colour_map_area(i / 100.0), theme),
           line = luminance(colour_map_line(i / 100.0), theme);
    ck_assert_double_gt(area, before);
    ck_assert_double_gt(line, line_before);
    ck_assert_double_ge(contrast(colour_map_line(i / 100.0), theme), 3.0);
    before = area;
    line_before = line;
  }
  ck_assert_double_eq(luminance(colour_map_area(-3), theme), luminance(colour_map_area(0), theme));
  ck_assert_double_eq(luminance(colour_map_area(9), theme), luminance(colour_map_area(1), theme));
  ck_assert_double_lt(luminance(colour_map_area(NAN), theme), 1);
}
END_TEST

START_TEST(words_have_contrast) {
  enum colour_theme theme = (enum colour_theme)_i;
  ck_assert_double_ge(contrast(colour_ink, theme), 7.0);
  ck_assert_double_ge(contrast(colour_muted, theme), 4.5);
  ck_assert_double_ge(contrast(colour_notice, theme), 4.5);
}
END_TEST

/* The lightest curves of the palette have less than 3:1 on white; marks and dashes tell them. */
START_TEST(curves_are_seen_on_either_sheet) {
  enum colour_theme theme = (enum colour_theme)_i;
  for (size_t i = 0; i < COLOUR_SERIES_COUNT; i++) {
    ck_assert_double_ge(contrast(colour_series(i), theme), theme == THEME_DARK ? 4.0 : 2.2);
  }
}
END_TEST

START_TEST(faded_colours_end_in_the_paper) {
  enum colour_theme theme = (enum colour_theme)_i;
  double paper = luminance(colour_paper, theme);
  ck_assert_double_eq_tol(luminance(colour_fade(colour_ink, 1), theme), paper, 1e-12);
  ck_assert_double_eq(luminance(colour_fade(colour_ink, 0), theme), luminance(colour_ink, theme));
  double half = luminance(colour_fade(colour_ink, 0.5), theme), ink = luminance(colour_ink, theme);
  ck_assert(half > fmin(ink, paper) && half < fmax(ink, paper));
}
END_TEST

START_TEST(themes_have_names) {
  enum colour_theme theme = THEME_COUNT;
  ck_assert(colour_theme_of("dark", &theme) && theme == THEME_DARK);
  ck_assert(colour_theme_of("light", &theme) && theme == THEME_LIGHT);
  ck_assert(!colour_theme_of("Dark", &theme) && !colour_theme_of("", &theme));
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plot parts");
  TCase *parts = tcase_create("parts");
  tcase_add_test(parts, ticks_are_round_and_inside);
  tcase_add_test(parts, labels_have_a_true_minus_and_no_minus_zero);
  tcase_add_test(parts, ranges_grow_to_ticks);
  tcase_add_test(parts, logarithmic_ticks);
  tcase_add_test(parts, logarithmic_labels);
  tcase_add_test(parts, numbers);
  tcase_add_test(parts, places_avoid_what_is_there);
  tcase_add_test(parts, a_label_stays_beside_its_point);
  tcase_add_loop_test(parts, maps_get_lighter_and_lines_stay_visible, 0, THEME_COUNT);
  tcase_add_loop_test(parts, words_have_contrast, 0, THEME_COUNT);
  tcase_add_loop_test(parts, curves_are_seen_on_either_sheet, 0, THEME_COUNT);
  tcase_add_loop_test(parts, faded_colours_end_in_the_paper, 0, THEME_COUNT);
  tcase_add_test(parts, themes_have_names);
  suite_add_tcase(suite, parts);
  return suite_run(suite);
}
