/* The tree of boxes over the patches. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/box_tree.h"
#include "solver/base/vec3.h"
#include "solver/rigid/surface_internal.h"

/* A quadratic patch lies within its corners and the control points of its edges. */
static void bound_patch(const struct surface *surface, int triangle, struct box *box) {
  struct patch patch = surface_patch(surface, triangle);
  *box = box_empty();
  for (int k = 0; k < 3; k++) {
    double control[3];
    for (int i = 0; i < 3; i++) {
      control[i] = 0.5 * (patch.x[k][i] + patch.x[(k + 1) % 3][i] - patch.bend[3 * k + i]);
    }
    box_include(box, patch.x[k]);
    box_include(box, control);
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
  struct box *box = calloc((size_t)count, sizeof *box);
  surface->flat = malloc(sizeof *surface->flat * (size_t)count);
  enum status status = box && surface->flat ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK) {
    for (int t = 0; t < count; t++) {
      bound_patch(surface, t, &box[t]);
    }
    surface->tree = box_tree_create(box, count);
    status = surface->tree ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status == STATUS_OK) {
    const struct box *all = &box_tree_branches(surface->tree)->box;
    for (int n = 0; n < count; n++) {
      fill_flat(surface, box_tree_order(surface->tree)[n], &surface->flat[n]);
    }
    memcpy(surface->low, all->low, sizeof surface->low);
    memcpy(surface->high, all->high, sizeof surface->high);
  }
  free(box);
  return status;
}
