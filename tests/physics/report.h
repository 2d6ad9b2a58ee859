/* One line of the verification table per check: `make check` leaves them in the test logs. */
#ifndef PNEULAB_TESTS_PHYSICS_REPORT_H
#define PNEULAB_TESTS_PHYSICS_REPORT_H

/* Prints a row "case | mesh | reference | computed | relative error". */
void report_value(const char *what, const char *mesh, double reference, double computed);

/* Prints the row and fails the test unless |computed / reference - 1| <= tolerance. */
void report_check(const char *what, const char *mesh, double reference, double computed,
                  double tolerance);

/* Observed order of convergence from the errors on two meshes whose sizes have the ratio
 * `refinement` > 1. */
double report_order(double coarse_error, double fine_error, double refinement);

/* Fails the test unless the differences of a function of the step h fall with h^2.
 * error(context, h) is the relative error of a central difference with step h; h runs over
 * first / 2^k. At least `halvings` halvings have to show the order 2 (ratio 3.5 to 4.5), and the
 * smallest error has to be below `floor`. */
void report_second_order(const char *what, double (*error)(void *context, double h), void *context,
                         double first, int halvings, double floor);

#endif
