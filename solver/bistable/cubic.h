/* Piecewise cubic functions with the integrals that a potential is made of. */
#ifndef PNEULAB_BISTABLE_CUBIC_H
#define PNEULAB_BISTABLE_CUBIC_H

#include <stddef.h>
#include "solver/base/error.h"

/* The cubic spline through points, with parabolas at its ends (equal second derivatives at the two
 * outer knots). */
struct cubic {
  size_t count;
  double *x;        /* knots, rising: one block that x owns */
  double *c[4];     /* value = sum over k of c[k][i] (x - x[i])^k, between the knots i and i + 1 */
  double *integral; /* of x^power value, from x[0] to every knot */
  int power;        /* 0 or 1 */
};

struct cubic_value {
  double value, slope, integral;
};

/* Fills *cubic, which the caller releases in any case. count >= 3, x rising. STATUS_NO_MEMORY.
 */
enum status cubic_create(size_t count, const double x[], const double y[], int power,
                         struct cubic *cubic, struct error *error);
void cubic_release(struct cubic *cubic);

/* Value, slope, and integral of x^power value from x[0]. Outside the knots the outer cubics go on.
 */
void cubic_evaluate(const struct cubic *cubic, double x, struct cubic_value *value);

#endif
