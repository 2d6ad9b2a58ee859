/* The tree of boxes over the patches. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

/* Box and centre of each triangle while the tree grows. */
struct item {
  double low[3], high[3], centre[3];
  int triangle;
};

/* A quadratic patch lies within its corners and the control points of its edges. */
static void bound_patch(const struct surface *surface, int triangle, struct item *item) {
  struct patch patch = surface_patch(surface, triangle);
  item->triangle = triangle;
  for (int i = 0; i < 3; i++) {
    item->low[i] = INFINITY;
    item->high[i] = -INFINITY;
    for (int k = 0; k < 3; k++) {
      double corner = patch.x[k][i];
      double control = 0.5 * (corner + patch.x[(k + 1) % 3][i] - patch.bend[3 * k + i]);
      item->low[i] = fmin(item->low[i], fmin(corner, control));
      item->high[i] = fmax(item->high[i], fmax(corner, control));
    }
    item->centre[i] = 0.5 * (item->low[i] + item->high[i]);
  }
}

/* Arranges items so that number `middle` is where sorting by `axis` would put it (quickselect, the
 * middle one of three as pivot; equal ones are exchanged, so that many of them do no harm). */
static void select_middle(struct item *item, int count, int middle, int axis) {
  int low = 0, high = count - 1;
  while (low < high) {
    double a = item[low].centre[axis], b = item[(low + high) / 2].centre[axis],
           c = item[high].centre[axis];
    double pivot = fmax(fmin(a, b), fmin(fmax(a, b), c));
    int i = low, j = high;
    while (i <= j) {
      while (item[i].centre[axis] < pivot) {
        i++;
      }
      while (item[j].centre[axis] > pivot) {
        j--;
      }
      if (i <= j) {
        struct item swap = item[i];
        item[i++] = item[j];
        item[j--] = swap;
      }
    }
    if (middle <= j) {
      high = j;
    } else if (middle >= i) {
      low = i;
    } else {
      return;
    }
  }
}

static int widest_axis(const struct item *item, int count) {
  double low[3], high[3];
  for (int i = 0; i < 3; i++) {
    low[i] = INFINITY;
    high[i] = -INFINITY;
    for (int n = 0; n < count; n++) {
      low[i] = fmin(low[i], item[n].centre[i]);
      high[i] = fmax(high[i], item[n].centre[i]);
    }
  }
  double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/* Fills node `at` over count items, which begin at `first` of all; its children follow. */
static void grow(struct surface *surface, int at, struct item *all, int first, int count) {
  struct surface_node *node = &surface->node[at];
  struct item *item = all + first;
  for (int i = 0; i < 3; i++) {
    node->low[i] = INFINITY;
    node->high[i] = -INFINITY;
    for (int n = 0; n < count; n++) {
      node->low[i] = fmin(node->low[i], item[n].low[i]);
      node->high[i] = fmax(node->high[i], item[n].high[i]);
    }
  }
  node->first = first;
  node->count = count;
  if (count > SURFACE_LEAF) {
    int half = count / 2;
    select_middle(item, count, half, widest_axis(item, count));
    node->first = surface->node_count;
    node->count = 0;
    surface->node_count += 2;
    int child = node->first;
    grow(surface, child, all, first, half);
    grow(surface, child + 1, all, first + half, count - half);
  }
}

static void fill_flat(const struct surface *surface, int triangle, struct surface_flat *flat) {
  struct patch patch = surface_patch(surface, triangle);
  double largest = 0;
  flat->triangle = triangle;
  for (int i = 0; i < 3; i++) {
    flat->x[i] = patch.x[0][i];
    flat->a[i] = patch.x[1][i] - patch.x[0][i];
    flat->b[i] = patch.x[2][i] - patch.x[0][i];
    largest = fmax(largest, vec3_norm(patch.bend + 3 * i));
  }
  flat->aa = vec3_dot(flat->a, flat->a);
  flat->ab = vec3_dot(flat->a, flat->b);
  flat->bb = vec3_dot(flat->b, flat->b);
  flat->inverse = 1 / (flat->aa * flat->bb - flat->ab * flat->ab);
  /* The bends' factors u v, v w and w u add up to a third at most. */
  flat->bulge = largest / 3;
}

enum status surface_plant(struct surface *surface) {
  int count = surface->triangle_count;
  struct item *item = malloc(sizeof *item * (size_t)count);
  surface->node = malloc(sizeof *surface->node * 2 * (size_t)count);
  surface->flat = malloc(sizeof *surface->flat * (size_t)count);
  enum status status = item && surface->node && surface->flat ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    for (int t = 0; t < count; t++) {
      bound_patch(surface, t, &item[t]);
    }
    surface->node_count = 1;
    grow(surface, 0, item, 0, count);
    for (int n = 0; n < count; n++) {
      fill_flat(surface, item[n].triangle, &surface->flat[n]);
    }
    memcpy(surface->low, surface->node[0].low, sizeof surface->low);
    memcpy(surface->high, surface->node[0].high, sizeof surface->high);
  }
  free(item);
  return status;
}
