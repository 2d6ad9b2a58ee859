#include "tests/unit/mesh_volume.h"

#include <check.h>
#include <string.h>
#include "solver/fe/element.h"
#include "solver/fe/pressure.h"

double mesh_cavity_volume(const struct mesh *mesh) {
  struct quad9_tables tables;
  double volume = 0;
  quad9_tables_fill(&tables);
  for (int f = 0; f < mesh->face_count; f++) {
    double x[QUAD9_NODES][3], force[FACE_DOFS];
    int nodes[QUAD9_NODES];
    if (mesh->faces[f].kind == FACE_CAVITY) {
      mesh_face_nodes(mesh, &mesh->faces[f], nodes);
      for (int m = 0; m < QUAD9_NODES; m++) {
        memcpy(x[m], mesh->x + 3 * nodes[m], sizeof x[m]);
      }
      volume += pressure_face(&tables, x, mesh->faces[f].side, force);
    }
  }
  return volume;
}

double mesh_solid_volume(const struct mesh *mesh) {
  struct hex27_tables tables;
  struct element_geometry geometry;
  double volume = 0;
  hex27_tables_fill(&tables);
  for (int e = 0; e < mesh->element_count; e++) {
    double x[HEX27_NODES][3];
    for (int a = 0; a < HEX27_NODES; a++) {
      memcpy(x[a], mesh->x + 3 * mesh->element_nodes[HEX27_NODES * e + a], sizeof x[a]);
    }
    double part = element_geometry_fill(&tables, x, &geometry);
    ck_assert_double_gt(part, 0);
    volume += part;
  }
  return volume;
}
