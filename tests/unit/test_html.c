/* What the pages are made of: markup that texts cannot break, and numbers as people read them. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/html.h"
#include "server/http/page_text.h"
#include "tests/unit/suite.h"

START_TEST(texts_stay_texts) {
  struct html html;
  size_t size;
  ck_assert(html_start(&html));
  html_open(&html, "a", "href", "/?a=1&b=\"'<", "title", NULL, "hidden", "", NULL);
  html_text(&html, "<script>'&\"\xc3\xa9");
  html_format(&html, "%s %d", "</a>", 7);
  html_void(&html, "img", "alt", "", NULL);
  html_leaf(&html, "b", "x", NULL);
  html_close(&html);
  char *text = html_finish(&html, &size);
  ck_assert_str_eq(text,
                   "<a href=\"/?a=1&amp;b=&quot;&#39;&lt;\" hidden=\"\">"
                   "&lt;script&gt;&#39;&amp;&quot;\xc3\xa9&lt;/a&gt; 7<img alt=\"\"><b>x</b></a>");
  ck_assert_uint_eq(size, strlen(text));
  free(text);
}
END_TEST

static const struct {
  double value;
  const char *text;
} numbers[] = {{0, "0"},
               {37, "37"},
               {-1234, "−1234"},
               {1234567, "1\u202f234\u202f567"},
               {12.3456, "12.35"},
               {0.00012344, "0.0001234"},
               {-0.5, "−0.5000"},
               {54321.6, "54\u202f322"},
               {7.0849e-5, "7.085·10⁻⁵"},
               {2.5e13, "2.500·10¹³"},
               {NAN, "–"},
               {INFINITY, "–"}};

START_TEST(numbers_are_short) {
  char text[PAGE_TEXT];
  page_number(numbers[_i].value, text);
  ck_assert_str_eq(text, numbers[_i].text);
}
END_TEST

START_TEST(quantities_have_units) {
  char text[PAGE_TEXT];
  page_quantity("bending_angle_deg", 12.5, text);
  ck_assert_str_eq(text, "12.50°");
  page_quantity("peak_memory_MB", 70, text);
  ck_assert_str_eq(text, "70\u00a0MB");
  page_quantity("count", 3, text);
  ck_assert_str_eq(text, "3");
  page_label("max_stretch", text);
  ck_assert_str_eq(text, "Largest stretch");
  page_word("timed_out", text);
  ck_assert_str_eq(text, "timed out");
  ck_assert_ptr_nonnull(strstr(page_advice("memory_limit"), "memory"));
  ck_assert_ptr_null(page_advice(""));
}
END_TEST

START_TEST(metrics_in_order) {
  json_t *metrics = json_pack("{s:f, s:f, s:f, s:f, s:f}", "zeta", 1.0, "mass_g", 2.0, "alpha", 3.0,
                              "bending_angle_deg", 4.0, "bending_angle_deg_error", 0.5);
  const char **keys = page_metric_order(metrics);
  ck_assert_str_eq(keys[0], "bending_angle_deg");
  ck_assert_str_eq(keys[1], "mass_g");
  ck_assert_str_eq(keys[2], "alpha");
  ck_assert_str_eq(keys[3], "zeta");
  ck_assert_ptr_null(keys[4]);
  ck_assert_double_eq(page_metric_error(metrics, "bending_angle_deg"), 0.5);
  ck_assert(isnan(page_metric_error(metrics, "mass_g")));
  free(keys);
  json_decref(metrics);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("html");
  TCase *html = tcase_create("html");
  tcase_add_test(html, texts_stay_texts);
  tcase_add_loop_test(html, numbers_are_short, 0, (int)(sizeof numbers / sizeof *numbers));
  tcase_add_test(html, quantities_have_units);
  tcase_add_test(html, metrics_in_order);
  suite_add_tcase(suite, html);
  return suite_run(suite);
}
