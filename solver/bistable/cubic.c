#include "solver/bistable/cubic.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdbool.h>
#include <stdlib.h>

enum { COLUMNS = 6 };

void cubic_release(struct cubic *cubic) {
  free(cubic->x);
  *cubic = (struct cubic){0};
}

/* The integral of (a + t)^power value(t) from t = 0, for the cubic of the knot a = x[i]. */
static double integrate(const struct cubic *cubic, size_t i, double t) {
  double sum = 0.0, weighted = 0.0, factor = t;
  for (int k = 0; k < 4; k++) {
    sum += cubic->c[k][i] * factor / (k + 1);
    weighted += cubic->c[k][i] * factor * t / (k + 2);
    factor *= t;
  }
  return cubic->power == 0 ? sum : cubic->x[i] * sum + weighted;
}

/* Second derivatives at the knots from the continuity of the first ones; at either end two knots
 * have the same, so that a parabola is met. */
static bool find_bends(size_t count, const double x[], const double y[], double bend[]) {
  size_t n = count - 2;
  gsl_vector *diagonal = gsl_vector_alloc(n), *beside = gsl_vector_alloc(n > 1 ? n - 1 : 1);
  gsl_vector *right = gsl_vector_alloc(n), *inner = gsl_vector_alloc(n);
  bool good = diagonal && beside && right && inner;
  for (size_t i = 0; good && i < n; i++) {
    double before = x[i + 1] - x[i], after = x[i + 2] - x[i + 1];
    double slopes = (y[i + 2] - y[i + 1]) / after - (y[i + 1] - y[i]) / before;
    double ends = (i == 0 ? before : 0.0) + (i + 1 == n ? after : 0.0);
    gsl_vector_set(diagonal, i, 2.0 * (before + after) + ends);
    gsl_vector_set(right, i, 6.0 * slopes);
    if (i + 1 < n) {
      gsl_vector_set(beside, i, after);
    }
  }
  if (good && n > 1) {
    good = gsl_linalg_solve_symm_tridiag(diagonal, beside, right, inner) == GSL_SUCCESS;
  } else if (good) {
    gsl_vector_set(inner, 0, gsl_vector_get(right, 0) / gsl_vector_get(diagonal, 0));
  }
  for (size_t i = 0; good && i < count; i++) {
    bend[i] = gsl_vector_get(inner, i == 0 ? 0 : i > n ? n - 1 : i - 1);
  }
  gsl_vector_free(diagonal);
  gsl_vector_free(beside);
  gsl_vector_free(right);
  gsl_vector_free(inner);
  return good;
}

enum status cubic_create(size_t count, const double x[], const double y[], int power,
                         struct cubic *cubic, struct error *error) {
  *cubic = (struct cubic){.count = count, .power = power};
  cubic->x = calloc(COLUMNS * count, sizeof *cubic->x);
  if (!cubic->x) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a spline");
  }
  for (int k = 0; k < 4; k++) {
    cubic->c[k] = cubic->x + (size_t)(k + 1) * count;
  }
  cubic->integral = cubic->x + 5 * count;
  for (size_t i = 0; i < count; i++) {
    cubic->x[i] = x[i];
  }
  if (!find_bends(count, x, y, cubic->c[2])) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a spline");
  }
  for (size_t i = 0; i + 1 < count; i++) {
    double step = x[i + 1] - x[i], bend = cubic->c[2][i], next = cubic->c[2][i + 1];
    cubic->c[0][i] = y[i];
    cubic->c[1][i] = (y[i + 1] - y[i]) / step - step * (2.0 * bend + next) / 6.0;
    cubic->c[2][i] = 0.5 * bend;
    cubic->c[3][i] = (next - bend) / (6.0 * step);
    cubic->integral[i + 1] = cubic->integral[i] + integrate(cubic, i, step);
  }
  return STATUS_OK;
}

void cubic_evaluate(const struct cubic *cubic, double x, struct cubic_value *value) {
  size_t low = 0, high = cubic->count - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (x >= cubic->x[middle]) {
      low = middle;
    } else {
      high = middle;
    }
  }
  double t = x - cubic->x[low];
  const double a[] = {cubic->c[0][low], cubic->c[1][low], cubic->c[2][low], cubic->c[3][low]};
  value->value = a[0] + t * (a[1] + t * (a[2] + t * a[3]));
  value->slope = a[1] + t * (2.0 * a[2] + t * 3.0 * a[3]);
  value->integral = cubic->integral[low] + integrate(cubic, low, t);
}
