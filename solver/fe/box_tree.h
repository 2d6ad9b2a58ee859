/* Tree of axis-aligned boxes, for finding the boxes that overlap a given one. */
#ifndef PNEULAB_FE_BOX_TREE_H
#define PNEULAB_FE_BOX_TREE_H

#include <stdbool.h>

struct box {
  double low[3], high[3];
};

/* The empty box: low = +infinity, high = -infinity. */
struct box box_empty(void);

/* Enlarges the box so that it holds x. */
void box_include(struct box *box, const double x[3]);

/* Enlarges the box by `margin` on every side. */
struct box box_inflate(const struct box *box, double margin);

bool box_overlaps(const struct box *a, const struct box *b);

struct box_tree;

/* Builds the tree over count boxes, split at the median of their centres; the boxes are copied.
 * NULL when memory runs out. The caller owns the result (box_tree_destroy). */
struct box_tree *box_tree_create(const struct box *boxes, int count);
void box_tree_destroy(struct box_tree *tree);

/* Numbers of the boxes that overlap `box`, ascending, at most `capacity` of them into found.
 * Returns how many there are in all. */
int box_tree_find(const struct box_tree *tree, const struct box *box, int *found, int capacity);

#endif
