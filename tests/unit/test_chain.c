/* Chains of designs against their definition. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/chain.h"
#include "solver/explore/random.h"
#include "tests/unit/suite.h"

enum { MEMBERS = 150, DIMENSIONS = 3, LENGTH = 16 };

static const struct chain_dimension plain[DIMENSIONS] = {{0}};

static void draw(double *value, uint64_t seed) {
  uint64_t random = seed;
  for (int i = 0; i < MEMBERS * DIMENSIONS; i++) {
    value[i] = random_uniform(&random);
  }
}

/* walk[]: the members in the order of their chains; the lengths of the chains are checked, of which
 * none is longer than the one before. */
static void walk_of(const struct chain_place *place, size_t members, size_t length, size_t *walk) {
  size_t from = 0, longest = length;
  for (size_t c = 0; from < members; c++) {
    size_t count = 0;
    for (size_t m = 0; m < members; m++) {
      count += place[m].chain == c;
    }
    ck_assert(count <= longest && (count >= length / 2 || from + count == members));
    longest = count;
    for (size_t m = 0; m < members; m++) {
      if (place[m].chain == c) {
        ck_assert(place[m].position < count);
        walk[from + place[m].position] = m;
      }
    }
    from += count;
  }
  ck_assert_uint_eq(from, members);
}

static double leg(const double *unit, size_t a, size_t b) {
  double sum = 0;
  for (size_t d = 0; d < DIMENSIONS; d++) {
    double x = unit[a * DIMENSIONS + d] - unit[b * DIMENSIONS + d];
    sum += x * x;
  }
  return sqrt(sum);
}

/* Length of the greedy walk from the first member. */
static double greedy_length(const double *unit) {
  bool visited[MEMBERS] = {true};
  double length = 0;
  for (size_t k = 1, here = 0; k < MEMBERS; k++) {
    size_t next = here;
    for (size_t m = 0; m < MEMBERS; m++) {
      if (!visited[m] && (next == here || leg(unit, here, m) < leg(unit, here, next))) {
        next = m;
      }
    }
    length += leg(unit, here, next);
    visited[next] = true;
    here = next;
  }
  return length;
}

/* The values lie in 0 .. 1 but for a scale that the order must not see. */
START_TEST(no_stretch_turned_round_makes_the_walk_shorter) {
  double value[MEMBERS * DIMENSIONS], unit[MEMBERS * DIMENSIONS], length = 0;
  struct chain_place place[MEMBERS], again[MEMBERS];
  size_t walk[MEMBERS];
  bool visited[MEMBERS] = {false};
  draw(unit, 7);
  for (int d = 0; d < DIMENSIONS; d++) { /* the extremes are taken, so that the scale is known */
    unit[d] = 0;
    unit[(MEMBERS - 1) * DIMENSIONS + d] = 1;
  }
  for (int i = 0; i < MEMBERS * DIMENSIONS; i++) {
    value[i] = 1e-3 * pow(1000, i % DIMENSIONS) * (unit[i] + 5);
  }
  ck_assert(chain_order(value, plain, MEMBERS, DIMENSIONS, LENGTH, place, NULL) == STATUS_OK);
  ck_assert(chain_order(value, plain, MEMBERS, DIMENSIONS, LENGTH, again, NULL) == STATUS_OK);
  ck_assert(memcmp(place, again, sizeof place) == 0);
  walk_of(place, MEMBERS, LENGTH, walk);
  ck_assert(chain_order(value, plain, MEMBERS, DIMENSIONS, MEMBERS, place, NULL) == STATUS_OK);
  walk_of(place, MEMBERS, MEMBERS, walk); /* a single chain is the walk itself */
  ck_assert_uint_eq(walk[0], 0);
  for (size_t k = 0; k < MEMBERS; k++) {
    ck_assert(!visited[walk[k]]);
    visited[walk[k]] = true;
    length += k > 0 ? leg(unit, walk[k - 1], walk[k]) : 0;
  }
  for (size_t i = 0; i + 3 < MEMBERS; i++) {
    for (size_t j = i + 2; j + 1 < MEMBERS; j++) {
      double now = leg(unit, walk[i], walk[i + 1]) + leg(unit, walk[j], walk[j + 1]);
      double then = leg(unit, walk[i], walk[j]) + leg(unit, walk[i + 1], walk[j + 1]);
      ck_assert_double_ge(then, now * (1 - 1e-6));
    }
  }
  printf("%d designs: walk of %.2f, greedy one %.2f\n", MEMBERS, length, greedy_length(unit));
  ck_assert_double_lt(length, 0.95 * greedy_length(unit));
}
END_TEST

/* Two heaps of 11 and 9 on a line: the chain ends between them, though it might be longer. */
START_TEST(chains_end_where_the_way_is_long) {
  double value[20];
  struct chain_place place[20];
  for (int i = 0; i < 20; i++) {
    value[i] = i < 11 ? i : 50 + i;
  }
  ck_assert(chain_order(value, plain, 20, 1, 16, place, NULL) == STATUS_OK);
  for (size_t i = 0; i < 20; i++) {
    ck_assert_uint_eq(place[i].chain, i >= 11);
    ck_assert_uint_eq(place[i].position, i < 11 ? i : i - 11);
  }
}
END_TEST

START_TEST(words_part_more_than_numbers) {
  static const struct chain_dimension dimension[2] = {{.categorical = true}, {0}};
  static const double value[] = {0, 0, 1, 0.1, 0, 0.9, 1, 0.2, 0, 0.3, 1, 1};
  static const size_t expected[] = {0, 4, 2, 5, 3, 1};
  struct chain_place place[6];
  ck_assert(chain_order(value, dimension, 6, 2, 6, place, NULL) == STATUS_OK);
  for (size_t k = 0; k < 6; k++) {
    ck_assert_uint_eq(place[expected[k]].chain, 0);
    ck_assert_uint_eq(place[expected[k]].position, k);
  }
}
END_TEST

/* Three kinds of 7, 2 and 9 designs: a chain ends where the kind changes, but two are too few to be
 * one of their own. The longer one, of two kinds, is the first. */
START_TEST(chains_end_where_words_change) {
  static const struct chain_dimension dimension[2] = {{.categorical = true}, {0}};
  double value[36];
  struct chain_place place[18];
  for (int i = 0; i < 18; i++) {
    value[2 * i] = i < 7 ? 1 : i < 9 ? 2 : 3;
    value[2 * i + 1] = i;
  }
  ck_assert(chain_order(value, dimension, 18, 2, 12, place, NULL) == STATUS_OK);
  for (size_t i = 0; i < 18; i++) {
    ck_assert_uint_eq(place[i].chain, i < 7);
    ck_assert_uint_eq(place[i].position, i < 7 ? i : i - 7);
  }
}
END_TEST

/* From 10, 2 is nearer than 19, but a smaller part of it. */
START_TEST(distances_may_be_those_of_logarithms) {
  static const struct chain_dimension dimension = {.logarithmic = true};
  static const double value[] = {10, 19, 2};
  struct chain_place place[3];
  ck_assert(chain_order(value, &dimension, 3, 1, 3, place, NULL) == STATUS_OK);
  ck_assert_uint_eq(place[1].position, 1);
  ck_assert(chain_order(value, plain, 3, 1, 3, place, NULL) == STATUS_OK);
  ck_assert_uint_eq(place[2].position, 1);
}
END_TEST

START_TEST(designs_without_values_keep_their_order) {
  static const double none[] = {NAN, NAN, NAN, NAN, NAN};
  struct chain_place place[5];
  for (size_t dimensions = 0; dimensions < 2; dimensions++) {
    ck_assert(chain_order(none, plain, 5, dimensions, 2, place, NULL) == STATUS_OK);
    for (size_t m = 1; m < 5; m++) {
      bool follows = place[m].chain == place[m - 1].chain
                         ? place[m].position == place[m - 1].position + 1
                         : place[m].chain == place[m - 1].chain + 1 && place[m].position == 0;
      ck_assert(follows);
    }
  }
  ck_assert(chain_order(none, plain, 0, 1, 2, place, NULL) == STATUS_OK);
}
END_TEST

START_TEST(chains_leave_work_for_several_workers) {
  ck_assert_uint_eq(chain_length(1, false), 1);
  ck_assert_uint_eq(chain_length(7, true), 1);
  ck_assert_uint_eq(chain_length(76, false), 19);
  ck_assert_uint_eq(chain_length(256, false), CHAIN_LENGTH_HEAVY);
  ck_assert_uint_eq(chain_length(10000, true), CHAIN_LENGTH_MAX);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("explore: chains of designs");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, no_stretch_turned_round_makes_the_walk_shorter);
  tcase_add_test(tcase, chains_end_where_the_way_is_long);
  tcase_add_test(tcase, words_part_more_than_numbers);
  tcase_add_test(tcase, chains_end_where_words_change);
  tcase_add_test(tcase, distances_may_be_those_of_logarithms);
  tcase_add_test(tcase, designs_without_values_keep_their_order);
  tcase_add_test(tcase, chains_leave_work_for_several_workers);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
