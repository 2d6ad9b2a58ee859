#include "solver/base/box_tree.h"

#include <math.h>
#include <stdlib.h>

struct box_tree {
  struct box *box;
  int *order;
  struct box_branch *branch;
  int branch_count;
};

struct box box_empty(void) {
  return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

void box_include(struct box *box, const double x[3]) {
  for (int i = 0; i < 3; i++) {
    box->low[i] = fmin(box->low[i], x[i]);
    box->high[i] = fmax(box->high[i], x[i]);
  }
}

struct box box_inflate(const struct box *box, double margin) {
  struct box larger = *box;
  for (int i = 0; i < 3; i++) {
    larger.low[i] -= margin;
    larger.high[i] += margin;
  }
  return larger;
}

bool box_overlaps(const struct box *a, const struct box *b) {
  for (int i = 0; i < 3; i++) {
    if (a->low[i] > b->high[i] || b->low[i] > a->high[i]) {
      return false;
    }
  }
  return true;
}

static double centre(const struct box *box, int axis) {
  return 0.5 * (box->low[axis] + box->high[axis]);
}

/* Partly sorts the boxes of a branch by their centres, so that the one of rank `middle` stands
 * in its place (Hoare's selection; the middle one of three is the pivot, and equal ones are
 * exchanged, so that many of them do no harm). Ties keep no order, but always the same one. */
static void select_median(struct box_tree *t, int first, int last, int middle, int axis) {
  while (first < last) {
    double a = centre(&t->box[t->order[first]], axis),
           b = centre(&t->box[t->order[(first + last) / 2]], axis),
           c = centre(&t->box[t->order[last]], axis);
    double pivot = fmax(fmin(a, b), fmin(fmax(a, b), c));
    int low = first, high = last;
    while (low <= high) {
      while (centre(&t->box[t->order[low]], axis) < pivot) {
        low++;
      }
      while (centre(&t->box[t->order[high]], axis) > pivot) {
        high--;
      }
      if (low <= high) {
        int swap = t->order[low];
        t->order[low++] = t->order[high];
        t->order[high--] = swap;
      }
    }
    if (middle <= high) {
      last = high;
    } else if (middle >= low) {
      first = low;
    } else {
      return;
    }
  }
}

static void fill_branch(struct box_tree *t, int index) {
  struct box_branch *b = &t->branch[index];
  struct box centres = box_empty();
  b->box = box_empty();
  for (int i = b->first; i < b->first + b->count; i++) {
    const struct box *box = &t->box[t->order[i]];
    double middle[3] = {centre(box, 0), centre(box, 1), centre(box, 2)};
    box_include(&b->box, box->low);
    box_include(&b->box, box->high);
    box_include(&centres, middle);
  }
  if (b->count <= BOX_TREE_LEAF) {
    return;
  }
  int axis = 0;
  for (int i = 1; i < 3; i++) {
    if (centres.high[i] - centres.low[i] > centres.high[axis] - centres.low[axis]) {
      axis = i;
    }
  }
  int half = b->count / 2;
  select_median(t, b->first, b->first + b->count - 1, b->first + half, axis);
  b->child = t->branch_count;
  t->branch_count += 2;
  t->branch[b->child] = (struct box_branch){.first = b->first, .count = half};
  t->branch[b->child + 1] = (struct box_branch){.first = b->first + half, .count = b->count - half};
}

struct box_tree *box_tree_create(const struct box *boxes, int count) {
  struct box_tree *t = calloc(1, sizeof *t);
  if (!t) {
    return NULL;
  }
  t->box = malloc(sizeof *t->box * ((size_t)count + 1));
  t->order = malloc(sizeof *t->order * ((size_t)count + 1));
  t->branch = calloc(2 * (size_t)count + 1, sizeof *t->branch);
  if (!t->box || !t->order || !t->branch) {
    box_tree_destroy(t);
    return NULL;
  }
  for (int i = 0; i < count; i++) {
    t->box[i] = boxes[i];
    t->order[i] = i;
  }
  t->branch[0].count = count;
  t->branch_count = 1;
  for (int b = 0; b < t->branch_count; b++) {
    fill_branch(t, b);
  }
  return t;
}

void box_tree_destroy(struct box_tree *t) {
  if (!t) {
    return;
  }
  free(t->box);
  free(t->order);
  free(t->branch);
  free(t);
}

const struct box_branch *box_tree_branches(const struct box_tree *t) {
  return t->branch;
}

const int *box_tree_order(const struct box_tree *t) {
  return t->order;
}

static int ascending(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

int box_tree_find(const struct box_tree *t, const struct box *box, int *found, int capacity) {
  int waiting[BOX_TREE_DEPTH] = {0}, top = 1, count = 0;
  while (top > 0) {
    const struct box_branch *b = &t->branch[waiting[--top]];
    if (!box_overlaps(&b->box, box)) {
      continue;
    }
    if (b->child > 0) {
      waiting[top++] = b->child;
      waiting[top++] = b->child + 1;
      continue;
    }
    for (int i = b->first; i < b->first + b->count; i++) {
      if (box_overlaps(&t->box[t->order[i]], box)) {
        if (count < capacity) {
          found[count] = t->order[i];
        }
        count++;
      }
    }
  }
  qsort(found, (size_t)(count < capacity ? count : capacity), sizeof *found, ascending);
  return count;
}
