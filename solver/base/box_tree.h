/* Tree of axis-aligned boxes, for finding the boxes that overlap a given one, and for walks of
 * other kinds. */
#ifndef PNEULAB_BASE_BOX_TREE_H
#define PNEULAB_BASE_BOX_TREE_H

#include <stdbool.h>

struct box {
  double low[3], high[3];
};

/* The empty box: low = +infinity, high = -infinity. */
struct box box_empty(void);

/* Enlarges the box so that it holds x. */
void box_include(struct box *box, const double x[3]);

/* The box enlarged by `margin` on every side. */
struct box box_inflate(const struct box *box, double margin);

/* Square of the distance of a point from the box, 0 inside. */
static inline double box_distance_square(const struct box *box, const double x[3]) {
  double square = 0;
  for (int i = 0; i < 3; i++) {
    double below = box->low[i] - x[i], above = x[i] - box->high[i];
    double off = below > above ? below : above;
    square += off > 0 ? off * off : 0;
  }
  return square;
}

bool box_overlaps(const struct box *a, const struct box *b);

struct box_tree;

enum { BOX_TREE_LEAF = 4, BOX_TREE_DEPTH = 64 };

/* A branch holds the boxes order[first] .. order[first + count - 1]; a leaf, of at most
 * BOX_TREE_LEAF boxes, has child 0, any other branch its children at child and child + 1. */
struct box_branch {
  struct box box;
  int first, count, child;
};

/* Builds the tree over count boxes, split at the median of their centres; the boxes are copied.
 * NULL when memory runs out. The caller owns the result (box_tree_destroy). */
struct box_tree *box_tree_create(const struct box *boxes, int count);
void box_tree_destroy(struct box_tree *tree);

/* The branches, the root first, and the numbers of the boxes in their order; the tree's. A walk
 * that puts the children of a branch on a stack needs room for BOX_TREE_DEPTH. */
const struct box_branch *box_tree_branches(const struct box_tree *tree);
const int *box_tree_order(const struct box_tree *tree);

/* Numbers of the boxes that overlap `box`, ascending, at most `capacity` of them into found.
 * Returns how many there are in all. */
int box_tree_find(const struct box_tree *tree, const struct box *box, int *found, int capacity);

#endif
