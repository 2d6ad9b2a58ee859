#include "tests/physics/report.h"

#include <check.h>
#include <math.h>
#include <stdio.h>

void report_value(const char *what, const char *mesh, double reference, double computed) {
  printf("| %s | %s | %.6g | %.6g | %.2e |\n", what, mesh, reference, computed,
         reference != 0 ? fabs(computed / reference - 1) : fabs(computed));
  fflush(stdout);
}

void report_check(const char *what, const char *mesh, double reference, double computed,
                  double tolerance) {
  report_value(what, mesh, reference, computed);
  ck_assert_msg(fabs(computed - reference) <= tolerance * fabs(reference),
                "%s (%s): %.8g instead of %.8g, tolerance %.1e", what, mesh, computed, reference,
                tolerance);
}

double report_order(double coarse_error, double fine_error, double refinement) {
  return log(fabs(coarse_error / fine_error)) / log(refinement);
}

void report_second_order(const char *what, double (*error)(void *context, double h), void *context,
                         double first, int halvings, double floor) {
  double previous = error(context, first), smallest = previous, ratio = 0;
  int seen = 0;
  for (int k = 1; k <= 14; k++) {
    double now = error(context, first / (1 << k));
    smallest = fmin(smallest, now);
    if (previous / now > 3.5 && previous / now < 4.5) {
      ratio = previous / now;
      seen++;
    }
    previous = now;
  }
  printf("| %s | - | order 2 | %d halvings, last ratio %.3f | %.1e |\n", what, seen, ratio,
         smallest);
  fflush(stdout);
  ck_assert_msg(seen >= halvings, "%s: only %d halvings of the step show order 2", what, seen);
  ck_assert_msg(smallest < floor, "%s: smallest error %.2e", what, smallest);
}
