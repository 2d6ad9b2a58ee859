/* A mesh of 27-node hexahedra with the surfaces and sections that the solver needs.
 *
 * Local node n of an element is 9 i + 3 j + k with i, j, k in {0, 1, 2} along the three local
 * axes; i = 1 is the middle. A face is named by its axis and side (-1 or +1). */
#ifndef PNEULAB_MESH_MESH_H
#define PNEULAB_MESH_MESH_H

#include <stdbool.h>
#include "solver/base/error.h"

enum { HEX27_NODES = 27, QUAD9_NODES = 9, MESH_CAVITIES = 2 };

enum face_kind { FACE_OUTER, FACE_CAVITY, FACE_BASE, FACE_SYMMETRY };

struct mesh_face {
  int element;
  signed char axis; /* 0, 1, 2 */
  signed char side; /* -1, +1 */
  unsigned char kind;
  unsigned char cavity; /* of a FACE_CAVITY: number of the cavity it bounds, < MESH_CAVITIES */
};

/* Two faces that look at each other across a gap; the first one is the slave of the contact. */
struct mesh_facing {
  struct mesh_face slave, master;
};

struct mesh {
  int node_count, element_count;
  double *x;               /* node_count x 3, m */
  int *element_nodes;      /* element_count x 27 */
  unsigned char *fixed;    /* node_count x 3: 1 where the displacement is held at zero */
  struct mesh_face *faces; /* boundary faces of every kind */
  int face_count;
  struct mesh_facing *facing;
  int facing_count;
  /* The tensor grid behind the mesh, in its own coordinates: cell of every element, lines. */
  int *element_cell; /* element_count x 3 */
  int line_count[3];
  double *line[3];
  double gap_width;      /* narrowest gap between facing faces, m; 0 without facing */
  double wall_thickness; /* thinnest wall, m: scale of the contact stiffness and tolerances */
  bool half;             /* the other half is the mirror image about y = 0 */
  bool spatial;          /* the body bends and twists: its bending angle is that of its sections */
  /* Axial sections, ordered from the fixed base; section_count is 0 for a body without them. */
  int section_count;
  int *node_section;        /* node_count */
  unsigned char *node_core; /* node_count: 1 for nodes of the bottom layer, which carry the frame */
  int *centreline;          /* section_count: node of the bottom centreline */
  int *station;             /* station_count section indices: start of each chamber, then the tip */
  int station_count;
};

/* Releases everything the mesh owns and clears it; NULL is allowed. */
void mesh_release(struct mesh *mesh);

/* Local nodes of a face, ordered 3 a + b with a along local axis (axis + 1) % 3 and b along
 * (axis + 2) % 3. */
void mesh_face_local_nodes(int axis, int side, int nodes[QUAD9_NODES]);

/* Global nodes of a face in the same order. */
void mesh_face_nodes(const struct mesh *mesh, const struct mesh_face *face, int nodes[QUAD9_NODES]);

#endif
