#include "solver/post/variation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/mesh/pneunet.h"

/* Half the distance of the sides, relative to the parameter or to one of its unit, whichever is
 * more: the errors of truncation and of rounding then both stay below 1e-8. */
static const double relative_step = 3e-6;

bool variation_one_sided(const struct job_spec *spec, const struct job_parameter *parameter) {
  return spec->half_model && (parameter->offset == offsetof(struct job_spec, given.taper_left) ||
                              parameter->offset == offsetof(struct job_spec, given.taper_right));
}

static bool same_layout(const struct mesh *a, const struct mesh *b) {
  return a->node_count == b->node_count && a->element_count == b->element_count &&
         a->face_count == b->face_count && a->facing_count == b->facing_count &&
         memcmp(a->element_nodes, b->element_nodes,
                sizeof *a->element_nodes * HEX27_NODES * (size_t)a->element_count) == 0;
}

/* Fills side k of the variation at `value`. STATUS_OK or NO_MEMORY, or another status when there
 * is no such body or its mesh has another layout. */
static enum status make_side(struct job_spec *spec, const struct pneunet_cells *cells,
                             const struct mesh *mesh, const struct variant *original, double value,
                             int k, struct variation *v) {
  struct mesh moved = {0};
  bool half = spec->half_model;
  enum status status = parameter_set(spec, v->parameter, value, NULL);
  if (status != STATUS_OK) {
    return status;
  }
  v->material[k] = spec->material;
  if (v->parameter->offset >= offsetof(struct job_spec, material)) {
    v->side[k] = *original;
    v->side[k].material = &v->material[k];
    return STATUS_OK;
  }
  if (half && !spec->half_model) {
    spec->pneunet.taper_left = spec->pneunet.taper_right = value;
    spec->half_model = true;
  }
  status = pneunet_mesh_cells(spec, cells, &moved, NULL);
  if (status == STATUS_OK && !same_layout(&moved, mesh)) {
    status = STATUS_CONFLICT;
  }
  if (status == STATUS_OK) {
    v->x[k] = moved.x;
    v->side[k] =
        (struct variant){moved.x, moved.gap_width, moved.wall_thickness, original->material};
    moved.x = NULL;
  }
  mesh_release(&moved);
  return status;
}

enum status variation_create(const struct job_spec *spec, const struct mesh *mesh,
                             const struct variant *original, const struct job_parameter *parameter,
                             struct variation *v) {
  double value = parameter_value(spec, parameter), distance = 0;
  double step = relative_step * fmax(fabs(value), parameter->unit_si);
  struct job_spec *changed = malloc(sizeof *changed);
  struct pneunet_cells cells = pneunet_resolution(spec);
  enum status status = changed ? STATUS_OK : STATUS_NO_MEMORY;
  *v = (struct variation){.parameter = parameter};
  for (int k = 0; status != STATUS_NO_MEMORY && k < 2; k++) {
    *changed = *spec;
    status = make_side(changed, &cells, mesh, original, value + (k ? step : -step), k, v);
    if (status == STATUS_OK) {
      distance += step;
    } else {
      v->side[k] = *original;
    }
  }
  if (distance > 0) {
    v->scale = (variation_one_sided(spec, parameter) ? 0.5 : 1) * parameter->unit_si / distance;
  }
  free(changed);
  return status == STATUS_NO_MEMORY ? status : STATUS_OK;
}

void variation_release(struct variation *v) {
  free(v->x[0]);
  free(v->x[1]);
  *v = (struct variation){0};
}
