#include "solver/post/contact_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/vec3.h"

/* Sums of weight times pressure, and of weights. */
struct sums {
  double *product, *weight;
};

/* Shares a pressure among the nodes of a face around the place xi by piecewise linear weights:
 * unlike the shape functions of the face they are nowhere negative. */
static void share(const struct sums *sums, const int nodes[QUAD9_NODES], const double xi[2],
                  double area, double pressure) {
  double s = fmax(-1, fmin(1, xi[0])), t = fmax(-1, fmin(1, xi[1]));
  for (int m = 0; m < QUAD9_NODES; m++) {
    double weight = area * fmax(0, 1 - fabs(s - (m / 3 - 1))) * fmax(0, 1 - fabs(t - (m % 3 - 1)));
    sums->product[nodes[m]] += weight * pressure;
    sums->weight[nodes[m]] += weight;
  }
}

/* Area of the deformed face at Gauss point q, m2. */
static double deformed_area(const struct contact *contact, const int nodes[QUAD9_NODES],
                            const double *u, int q) {
  const struct quad9_tables *tables = contact->tables;
  double a[3] = {0}, b[3] = {0}, normal[3];
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      double x = contact->mesh->x[3 * nodes[m] + i] + u[3 * nodes[m] + i];
      a[i] += tables->dn[q][0][m] * x;
      b[i] += tables->dn[q][1][m] * x;
    }
  }
  vec3_cross(a, b, normal);
  return tables->weight[q] * vec3_norm(normal);
}

/* Shares the tractions of the points of all faces: layer 0 are those against other faces, layer
 * 1 + k those against plane k. */
static void share_layer(const struct contact *contact, int layer, const double *u,
                        const struct sums *sums) {
  for (int i = 0; i < QUAD9_POINTS * contact->face_count; i++) {
    const struct contact_point *point =
        &contact->point[QUAD9_POINTS * contact->face_count * layer + i];
    int face = i / QUAD9_POINTS, q = i % QUAD9_POINTS, nodes[QUAD9_NODES];
    if (!point->valid || (layer == 0 && point->pair < 0)) {
      continue;
    }
    mesh_face_nodes(contact->mesh, &contact->face[face].face, nodes);
    double area = deformed_area(contact, nodes, u, q);
    /* The traction is a force per reference area. */
    double pressure = point->traction * point->area / area;
    share(sums, nodes, contact->tables->point[q], area, pressure);
    if (layer == 0) {
      const struct contact_face *master = &contact->face[contact->pair[point->pair].master];
      mesh_face_nodes(contact->mesh, &master->face, nodes);
      share(sums, nodes, point->xi, area, pressure);
    }
  }
}

enum status contact_field(const struct contact *contact, int node_count, const double *u,
                          double *pressure) {
  size_t nodes = (size_t)node_count;
  double *memory = malloc(2 * sizeof *memory * (nodes + 1));
  struct sums sums = {memory, memory + nodes};
  if (!memory) {
    return STATUS_NO_MEMORY;
  }
  memset(pressure, 0, sizeof *pressure * nodes);
  for (int layer = 0; layer <= contact->plane_count; layer++) {
    memset(memory, 0, 2 * sizeof *memory * nodes);
    share_layer(contact, layer, u, &sums);
    for (int n = 0; n < node_count; n++) {
      pressure[n] += sums.weight[n] > 0 ? sums.product[n] / sums.weight[n] : 0;
    }
  }
  free(memory);
  return STATUS_OK;
}
