/* Sequences and Latin hypercubes: what nets and hypercubes are by definition, and discrepancies
 * that others have published. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/latin.h"
#include "solver/explore/random.h"
#include "solver/explore/sequence.h"
#include "tests/unit/suite.h"

static struct sequence *must_create(enum sequence_kind kind, int dimension, bool scrambled,
                                    uint64_t seed) {
  struct sequence *made;
  struct error error;
  ck_assert_msg(sequence_create(kind, dimension, scrambled, seed, &made, &error) == STATUS_OK, "%s",
                error.message);
  return made;
}

/* Any 2^m points of Sobol's sequence in two dimensions, from the first, have one point in every box
 * of sides 2^-a and 2^-(m-a): a (0, m, 2)-net. Scrambling must keep that. */
START_TEST(sobol_points_are_a_net) {
  enum { M = 8, POINTS = 1 << M };
  struct sequence *s = must_create(SEQUENCE_SOBOL, 2, _i > 0, (uint64_t)_i);
  static int filled[M + 1][POINTS];
  double x[2];
  memset(filled, 0, sizeof filled);
  for (int i = 0; i < POINTS; i++) {
    sequence_next(s, x);
    ck_assert(x[0] >= 0 && x[0] < 1 && x[1] >= 0 && x[1] < 1);
    for (int a = 0; a <= M; a++) {
      int column = (int)(x[0] * (1 << a)), row = (int)(x[1] * (1 << (M - a)));
      filled[a][column * (1 << (M - a)) + row]++;
    }
  }
  for (int a = 0; a <= M; a++) {
    for (int i = 0; i < POINTS; i++) {
      ck_assert_int_eq(filled[a][i], 1);
    }
  }
  sequence_destroy(s);
}
END_TEST

/* Halton (1960): 0, 1/2, 1/4, 3/4, ... and 0, 1/3, 2/3, 1/9, ... */
START_TEST(halton_points_are_radical_inverses) {
  static const double wanted[6][2] = {{0, 0},          {0.5, 1.0 / 3},   {0.25, 2.0 / 3},
                                      {0.75, 1.0 / 9}, {0.125, 4.0 / 9}, {0.625, 7.0 / 9}};
  struct sequence *s = must_create(SEQUENCE_HALTON, 2, false, 0);
  double x[2];
  for (int i = 0; i < 6; i++) {
    sequence_next(s, x);
    ck_assert_double_eq_tol(x[0], wanted[i][0], 1e-15);
    ck_assert_double_eq_tol(x[1], wanted[i][1], 1e-15);
  }
  sequence_destroy(s);
}
END_TEST

/* Any b^k points from the first have one in each interval of length b^-k, scrambled too. */
START_TEST(scrambled_halton_fills_its_intervals) {
  struct sequence *s = must_create(SEQUENCE_HALTON, 3, true, 5);
  static int thirds[243], fifths[125];
  double x[3];
  memset(thirds, 0, sizeof thirds);
  memset(fifths, 0, sizeof fifths);
  for (int i = 0; i < 243; i++) {
    sequence_next(s, x);
    thirds[(int)(x[1] * 243)]++;
    if (i < 125) {
      fifths[(int)(x[2] * 125)]++;
    }
  }
  for (int i = 0; i < 243; i++) {
    ck_assert_int_eq(thirds[i], 1);
    ck_assert(i >= 125 || fifths[i] == 1);
  }
  sequence_destroy(s);
}
END_TEST

/* The product of pi/2 sin(pi x) over 5 dimensions has the integral 1. Random points in that number
 * would err by (1.2337^5 - 1)^(1/2) / 64 = 0.021; over scrambled nets the variance falls almost as
 * n^-3 (Owen 1997). The mean over seeds shows that the estimate is unbiased. */
START_TEST(scrambled_points_integrate) {
  double squares = 0, mean = 0;
  for (uint64_t seed = 1; seed <= 16; seed++) {
    struct sequence *s = must_create(_i ? SEQUENCE_HALTON : SEQUENCE_SOBOL, 5, true, seed);
    double sum = 0, x[5];
    for (int i = 0; i < 4096; i++) {
      double product = 1;
      sequence_next(s, x);
      for (int k = 0; k < 5; k++) {
        product *= M_PI / 2 * sin(M_PI * x[k]);
      }
      sum += product / 4096;
    }
    squares += pow(sum - 1, 2) / 16;
    mean += (sum - 1) / 16;
    sequence_destroy(s);
  }
  ck_assert_double_lt(sqrt(squares), 0.021 / 5);
  ck_assert_double_lt(fabs(mean), 3 * sqrt(squares / 16));
}
END_TEST

START_TEST(more_points_keep_the_first_and_seeds_differ) {
  enum sequence_kind kind = _i ? SEQUENCE_HALTON : SEQUENCE_SOBOL;
  struct sequence *a = must_create(kind, 7, true, 1), *b = must_create(kind, 7, true, 1);
  struct sequence *c = must_create(kind, 7, true, 2);
  double x[7], y[7], z[7];
  int equal = 0;
  for (int i = 0; i < 500; i++) {
    sequence_next(a, x);
    sequence_next(b, y);
    sequence_next(c, z);
    for (int k = 0; k < 7; k++) {
      ck_assert(x[k] == y[k]);
      equal += x[k] == z[k];
    }
  }
  ck_assert_int_eq(equal, 0);
  sequence_destroy(a);
  sequence_destroy(b);
  sequence_destroy(c);
}
END_TEST

START_TEST(too_many_dimensions_are_refused) {
  struct sequence *made;
  struct error error;
  ck_assert(sequence_create(SEQUENCE_SOBOL, 41, true, 0, &made, &error) == STATUS_TOO_LARGE);
  ck_assert(sequence_create(SEQUENCE_HALTON, 0, true, 0, &made, &error) == STATUS_TOO_LARGE);
}
END_TEST

/* Fang, Li and Sudjianto (2006): two designs of six points in two dimensions, 0.0081 and 0.0105. n
 * midpoints in one dimension: 1 / (12 n^2) exactly. */
START_TEST(discrepancies_are_as_published) {
  static const double first[6][2] = {{1, 3}, {2, 6}, {3, 2}, {4, 5}, {5, 1}, {6, 4}};
  static const double second[6][2] = {{1, 5}, {2, 4}, {3, 3}, {4, 2}, {5, 1}, {6, 6}};
  double x[12], y[12], line[10];
  for (int i = 0; i < 12; i++) {
    x[i] = (first[i / 2][i % 2] - 0.5) / 6;
    y[i] = (second[i / 2][i % 2] - 0.5) / 6;
  }
  ck_assert_double_eq_tol(latin_discrepancy(x, 6, 2), 0.0081, 5e-5);
  ck_assert_double_eq_tol(latin_discrepancy(y, 6, 2), 0.0105, 1e-4);
  for (int i = 0; i < 10; i++) {
    line[i] = (i + 0.5) / 10;
  }
  ck_assert_double_eq_tol(latin_discrepancy(line, 10, 1), 1.0 / 1200, 1e-15);
}
END_TEST

/* The first points as they come, without scrambling: values of the reference manual of SciPy (1.16,
 * scipy.stats.qmc.Sobol and .Halton, examples). */
START_TEST(discrepancies_of_sequences_are_as_published) {
  struct sequence *sobol = must_create(SEQUENCE_SOBOL, 2, false, 0);
  struct sequence *halton = must_create(SEQUENCE_HALTON, 2, false, 0);
  double x[16];
  for (int i = 0; i < 8; i++) {
    sequence_next(sobol, x + 2 * i);
  }
  ck_assert_double_eq_tol(latin_discrepancy(x, 8, 2), 0.013882107204860938, 1e-15);
  for (int i = 0; i < 5; i++) {
    sequence_next(halton, x + 2 * i);
  }
  ck_assert_double_eq_tol(latin_discrepancy(x, 5, 2), 0.088893711419753, 1e-14);
  sequence_destroy(sobol);
  sequence_destroy(halton);
}
END_TEST

/* The mean over many designs: independent points ((5/4)^s - (13/12)^s) / n (Hickernell 1998, eq.
 * 5.5), which scrambled points must undercut by far. */
START_TEST(scrambled_points_are_more_even_than_random_ones) {
  enum { COUNT = 128, DIMENSION = 4, SEEDS = 8 };
  double x[COUNT * DIMENSION], mean[3] = {0, 0, 0};
  double wanted = (pow(1.25, DIMENSION) - pow(13.0 / 12, DIMENSION)) / COUNT;
  for (uint64_t seed = 1; seed <= SEEDS; seed++) {
    struct sequence *s[2] = {must_create(SEQUENCE_SOBOL, DIMENSION, true, seed),
                             must_create(SEQUENCE_HALTON, DIMENSION, true, seed)};
    uint64_t random = seed;
    for (int kind = 0; kind < 3; kind++) {
      for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < DIMENSION && kind == 2; k++) {
          x[i * DIMENSION + k] = random_uniform(&random);
        }
        if (kind < 2) {
          sequence_next(s[kind], x + i * DIMENSION);
        }
      }
      mean[kind] += latin_discrepancy(x, COUNT, DIMENSION) / SEEDS;
    }
    sequence_destroy(s[0]);
    sequence_destroy(s[1]);
  }
  ck_assert_double_eq_tol(mean[2], wanted, 0.3 * wanted);
  ck_assert_double_lt(mean[0], wanted / 10);
  ck_assert_double_lt(mean[1], wanted / 5);
}
END_TEST

static void must_be_latin(const double *x, int count, int dimension) {
  for (int k = 0; k < dimension; k++) {
    for (int cell = 0; cell < count; cell++) {
      int inside = 0;
      for (int i = 0; i < count; i++) {
        inside += fabs(x[i * dimension + k] - (cell + 0.5) / count) < 1e-12;
      }
      ck_assert_int_eq(inside, 1);
    }
  }
}

/* Six points in two dimensions: the optimum is the published design, whatever the seed. Larger ones
 * come out more even than Sobol's points, which are not made for such numbers. */
START_TEST(hypercubes_are_latin_and_even) {
  static const int sizes[][2] = {{6, 2}, {30, 3}, {100, 8}, {2, 2}, {1, 3}};
  int count = sizes[_i][0], dimension = sizes[_i][1];
  double *x = malloc((size_t)(count * dimension) * sizeof *x);
  double *y = malloc((size_t)(count * dimension) * sizeof *y);
  struct error error;
  for (uint64_t seed = 1; seed <= 3; seed++) {
    ck_assert(latin_hypercube(count, dimension, seed, x, &error) == STATUS_OK);
    must_be_latin(x, count, dimension);
    ck_assert(latin_hypercube(count, dimension, seed, y, &error) == STATUS_OK);
    ck_assert(memcmp(x, y, (size_t)(count * dimension) * sizeof *x) == 0);
    struct sequence *s = must_create(SEQUENCE_SOBOL, dimension, true, seed);
    for (int i = 0; i < count; i++) {
      sequence_next(s, y + i * dimension);
    }
    sequence_destroy(s);
    double ours = latin_discrepancy(x, count, dimension);
    ck_assert(count < 6 || ours < latin_discrepancy(y, count, dimension));
    ck_assert(count != 6 || ours < 0.00814204);
  }
  free(x);
  free(y);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: sampling");
  TCase *sequences = tcase_create("sequences"), *hypercubes = tcase_create("hypercubes");
  tcase_add_loop_test(sequences, sobol_points_are_a_net, 0, 4);
  tcase_add_test(sequences, halton_points_are_radical_inverses);
  tcase_add_test(sequences, scrambled_halton_fills_its_intervals);
  tcase_add_loop_test(sequences, scrambled_points_integrate, 0, 2);
  tcase_add_loop_test(sequences, more_points_keep_the_first_and_seeds_differ, 0, 2);
  tcase_add_test(sequences, too_many_dimensions_are_refused);
  tcase_add_test(hypercubes, discrepancies_are_as_published);
  tcase_add_test(hypercubes, discrepancies_of_sequences_are_as_published);
  tcase_add_test(hypercubes, scrambled_points_are_more_even_than_random_ones);
  tcase_add_loop_test(hypercubes, hypercubes_are_latin_and_even, 0, 5);
  tcase_set_timeout(hypercubes, 300);
  suite_add_tcase(suite, sequences);
  suite_add_tcase(suite, hypercubes);
  return suite_run(suite);
}
