/* Meshes of bodies of revolution: nine-node quadrilaterals in the meridian half plane (r, z). */
#ifndef PNEULAB_AXI_MESH_H
#define PNEULAB_AXI_MESH_H

#include "solver/base/error.h"
#include "solver/job/spec.h"

enum { AXI_NODES = 9, AXI_EDGE_NODES = 3, AXI_REGIONS_MAX = 4 };

/* Corners 0 to 3 counter-clockwise with r to the right and z up, then the middles of the sides
 * 0-1, 1-2, 2-3, 3-0, then the centre. */
struct axi_element {
  int node[AXI_NODES];
  int region;
};

/* Side of an element on the surface: start, end, middle. The body is on the left of the way from
 * start to end, the cavity or the surroundings on the right. */
struct axi_edge {
  int node[AXI_EDGE_NODES];
};

/* What a component of a node's displacement is. */
enum axi_hold {
  AXI_FREE,
  AXI_FIXED, /* 0 */
  AXI_PLATE, /* of u_z: the elongation h, the motion of the upper plate */
  AXI_TIED,  /* that of the node `master`, which is free or fixed */
  AXI_AHEAD  /* of u_z: that of the node `master` plus the elongation h */
};

struct axi_mesh {
  int node_count, element_count, inner_count, outer_count, region_count;
  double *position; /* node_count x 2: r, z in m */
  struct axi_element *element;
  struct axi_edge *inner; /* around the cavity, which the pressure acts on */
  struct axi_edge *outer; /* facing the surroundings */
  unsigned char *hold;    /* node_count x 2, enum axi_hold of u_r and u_z */
  double *offset;         /* node_count x 2, m: added to what holds a component; 0 unless set */
  int *master;            /* node_count; -1 where nothing is tied */
  struct material_spec region[AXI_REGIONS_MAX]; /* of the elements */
};

/* Reserves everything with node positions 0, all free, masters -1. STATUS_NO_MEMORY. */
enum status axi_mesh_create(int node_count, int element_count, int inner_count, int outer_count,
                            struct axi_mesh *mesh, struct error *error);

/* Frees what the mesh owns and clears it; allowed on a cleared one. */
void axi_mesh_release(struct axi_mesh *mesh);

#endif
