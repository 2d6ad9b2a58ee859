/* Bodies of revolution for the verification: a rectangle of elements, mapped into the meridian. */
#ifndef PNEULAB_VERIFY_REVOLUTION_H
#define PNEULAB_VERIFY_REVOLUTION_H

#include "solver/axi/model.h"

/* cells[0] x cells[1] elements over (s, t) in the unit square; `map` keeps the orientation, so that
 * s to the right and t up become r and z without a reflection. */
struct revolution {
  int cells[2];
  void (*map)(const void *context, double s, double t, double x[2]);
  const void *context;
  struct material_spec material;
};

/* Builds the mesh: s = 0 are the inner edges, s = 1 the outer ones, everything is free. The caller
 * owns it (axi_mesh_release). STATUS_NO_MEMORY. */
enum status revolution_mesh(const struct revolution *body, struct axi_mesh *mesh,
                            struct error *error);

/* Node at i / (2 cells[0]) of s and j / (2 cells[1]) of t. */
int revolution_node(const struct revolution *body, int i, int j);

/* Holds a component of all nodes of a side: of s = `end` (direction 0) or t = `end` (direction 1),
 * end 0 or 1. */
void revolution_hold(const struct revolution *body, struct axi_mesh *mesh, int direction, int end,
                     int component, enum axi_hold hold);

#endif
