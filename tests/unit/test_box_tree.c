/* The tree of boxes against a search through all of them. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include "solver/base/box_tree.h"
#include "solver/verify/body.h"
#include "tests/unit/suite.h"

enum { BOXES_MAX = 300 };

/* Touching counts as overlap. */
static bool overlap(const struct box *a, const struct box *b) {
  bool apart = false;
  for (int i = 0; i < 3; i++) {
    apart = apart || a->high[i] < b->low[i] || b->high[i] < a->low[i];
  }
  return !apart;
}

static struct box random_box(unsigned *seed, double place, double size) {
  struct box box;
  for (int i = 0; i < 3; i++) {
    double a = place * body_random(seed), b = a + size * fabs(body_random(seed));
    box.low[i] = a;
    box.high[i] = b;
  }
  return box;
}

/* The answer has to be the ascending list of exactly the boxes that overlap. */
static bool right_answer(const struct box_tree *tree, const struct box *boxes, int count,
                         const struct box *query) {
  int found[BOXES_MAX], expected = 0;
  int all = box_tree_find(tree, query, found, BOXES_MAX);
  bool right = all <= count;
  for (int k = 0; k < count && right; k++) {
    if (overlap(&boxes[k], query)) {
      right = expected < all && found[expected] == k;
      expected++;
    }
  }
  return right && all == expected;
}

static void check_against_all(const struct box *boxes, int count, unsigned seed, double size) {
  struct box_tree *tree = box_tree_create(boxes, count);
  ck_assert_ptr_nonnull(tree);
  for (int k = 0; k < 200; k++) {
    struct box query = random_box(&seed, 1.2, size);
    ck_assert(right_answer(tree, boxes, count, &query));
  }
  for (int k = 0; k < count; k++) {
    ck_assert(right_answer(tree, boxes, count, &boxes[k]));
  }
  box_tree_destroy(tree);
}

START_TEST(random_boxes) {
  static const int counts[] = {1, 2, 4, 5, 6, 9, 33, 257, BOXES_MAX};
  static const double sizes[] = {0.02, 0.3, 3};
  struct box boxes[BOXES_MAX];
  unsigned seed = 5;
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
      for (int b = 0; b < counts[k]; b++) {
        boxes[b] = random_box(&seed, 1, sizes[s]);
      }
      check_against_all(boxes, counts[k], seed, 0.3);
    }
  }
}
END_TEST

/* Boxes that no split can part: all the same, all with the same centre, all in one plane. */
START_TEST(equal_centres) {
  struct box boxes[300];
  for (int kind = 0; kind < 3; kind++) {
    for (int b = 0; b < 300; b++) {
      double r = kind == 1 ? 0.001 * (b + 1) : 0.1;
      boxes[b] = (struct box){{-r, -r, -r}, {r, r, r}};
      if (kind == 2) {
        boxes[b] = (struct box){{0.01 * b - 1.5, 0, 0}, {0.01 * b - 1.5, 0, 0}};
      }
    }
    check_against_all(boxes, 300, 11, 0.5);
  }
}
END_TEST

START_TEST(boxes_that_touch_overlap) {
  const struct box boxes[2] = {{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  const struct box point = {{1, 0.5, 0.5}, {1, 0.5, 0.5}};
  const struct box beside = {{0.2, 1 + 1e-12, 0}, {1.8, 2, 1}};
  ck_assert(box_overlaps(&boxes[0], &boxes[1]));
  ck_assert(!box_overlaps(&boxes[0], &beside));
  struct box_tree *tree = box_tree_create(boxes, 2);
  int found[2];
  ck_assert_int_eq(box_tree_find(tree, &point, found, 2), 2);
  ck_assert_int_eq(box_tree_find(tree, &beside, found, 2), 0);
  box_tree_destroy(tree);
}
END_TEST

START_TEST(without_boxes) {
  const struct box everything = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
  int found[1];
  struct box_tree *tree = box_tree_create(NULL, 0);
  ck_assert_ptr_nonnull(tree);
  ck_assert_int_eq(box_tree_find(tree, &everything, found, 1), 0);
  box_tree_destroy(tree);
  box_tree_destroy(NULL);
}
END_TEST

/* An empty box overlaps nothing, grows to what it is given, and stays empty when inflated. */
START_TEST(empty_boxes) {
  const struct box everything = {{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};
  const struct box unit = {{0, 0, 0}, {1, 1, 1}};
  struct box empty = box_empty(), wide = box_inflate(&empty, 1);
  ck_assert(!box_overlaps(&empty, &unit));
  ck_assert(!box_overlaps(&wide, &unit));
  struct box_tree *tree = box_tree_create(&empty, 1);
  int found[1];
  ck_assert_int_eq(box_tree_find(tree, &unit, found, 1), 0);
  box_tree_destroy(tree);
  box_include(&empty, (double[3]){0.5, 2, 3});
  box_include(&empty, (double[3]){0.25, 2, 5});
  const struct box expected = {{0.25, 2, 3}, {0.5, 2, 5}};
  for (int i = 0; i < 3; i++) {
    ck_assert_double_eq(empty.low[i], expected.low[i]);
    ck_assert_double_eq(empty.high[i], expected.high[i]);
  }
  struct box_tree *one = box_tree_create(&unit, 1);
  ck_assert_int_eq(box_tree_find(one, &everything, found, 1), 1);
  ck_assert_int_eq(found[0], 0);
  box_tree_destroy(one);
}
END_TEST

/* More than fit: the number of all, and only valid, different ones within the room. */
START_TEST(more_than_fit) {
  enum { COUNT = 100, ROOM = 7 };
  struct box boxes[COUNT];
  unsigned seed = 3;
  int found[ROOM + 1];
  for (int b = 0; b < COUNT; b++) {
    boxes[b] = random_box(&seed, 1, 0.1);
  }
  const struct box all = {{-9, -9, -9}, {9, 9, 9}};
  struct box_tree *tree = box_tree_create(boxes, COUNT);
  for (int room = 0; room <= ROOM; room++) {
    found[room] = -77;
    ck_assert_int_eq(box_tree_find(tree, &all, found, room), COUNT);
    ck_assert_int_eq(found[room], -77);
    for (int k = 0; k < room; k++) {
      ck_assert_int_ge(found[k], 0);
      ck_assert_int_lt(found[k], COUNT);
      ck_assert(k == 0 || found[k] > found[k - 1]);
    }
  }
  box_tree_destroy(tree);
}
END_TEST

/* The tree keeps its own copy of the boxes. */
START_TEST(boxes_are_copied) {
  struct box boxes[20];
  unsigned seed = 8;
  for (int b = 0; b < 20; b++) {
    boxes[b] = random_box(&seed, 1, 0.5);
  }
  struct box_tree *tree = box_tree_create(boxes, 20);
  const struct box query = {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  int before[20], after[20];
  int count = box_tree_find(tree, &query, before, 20);
  for (int b = 0; b < 20; b++) {
    boxes[b] = box_empty();
  }
  ck_assert_int_gt(count, 0);
  ck_assert_int_eq(box_tree_find(tree, &query, after, 20), count);
  for (int k = 0; k < count; k++) {
    ck_assert_int_eq(after[k], before[k]);
  }
  box_tree_destroy(tree);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("box_tree");
  TCase *tree = tcase_create("box_tree");
  tcase_add_test(tree, random_boxes);
  tcase_add_test(tree, equal_centres);
  tcase_add_test(tree, boxes_that_touch_overlap);
  tcase_add_test(tree, without_boxes);
  tcase_add_test(tree, empty_boxes);
  tcase_add_test(tree, more_than_fit);
  tcase_add_test(tree, boxes_are_copied);
  suite_add_tcase(suite, tree);
  return suite_run(suite);
}
