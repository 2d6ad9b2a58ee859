#include "solver/mesh/mesh.h"

#include <stdlib.h>

void mesh_release(struct mesh *mesh) {
  if (!mesh) {
    return;
  }
  free(mesh->x);
  free(mesh->element_nodes);
  free(mesh->element_cell);
  for (int d = 0; d < 3; d++) {
    free(mesh->line[d]);
  }
  free(mesh->fixed);
  free(mesh->faces);
  free(mesh->facing);
  free(mesh->node_section);
  free(mesh->node_core);
  free(mesh->centreline);
  free(mesh->station);
  *mesh = (struct mesh){0};
}

void mesh_face_local_nodes(int axis, int side, int nodes[QUAD9_NODES]) {
  static const int stride[3] = {9, 3, 1};
  int first = side > 0 ? 2 * stride[axis] : 0;
  for (int a = 0; a < 3; a++) {
    for (int b = 0; b < 3; b++) {
      nodes[3 * a + b] = first + a * stride[(axis + 1) % 3] + b * stride[(axis + 2) % 3];
    }
  }
}

void mesh_face_nodes(const struct mesh *mesh, const struct mesh_face *face,
                     int nodes[QUAD9_NODES]) {
  int local[QUAD9_NODES];
  mesh_face_local_nodes(face->axis, face->side, local);
  for (int n = 0; n < QUAD9_NODES; n++) {
    nodes[n] = mesh->element_nodes[HEX27_NODES * face->element + local[n]];
  }
}
