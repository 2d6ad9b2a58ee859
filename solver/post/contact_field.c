#include "solver/post/contact_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/vec3.h"

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

static void share_pair(const struct contact *contact, int pair, const double *u,
                       const struct sums *sums) {
  int nodes[CONTACT_NODES];
  contact_nodes(contact, pair, nodes);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const struct contact_point *point = &contact->point[QUAD9_POINTS * pair + q];
    double area = deformed_area(contact, nodes, u, q);
    /* The traction is a force per reference area. */
    double pressure = point->valid ? point->traction * point->area / area : 0;
    share(sums, nodes, contact->tables->point[q], area, pressure);
    if (point->valid) {
      share(sums, nodes + QUAD9_NODES, point->xi, area, pressure);
    }
  }
}

enum status contact_field(const struct contact *contact, int node_count, const double *u,
                          double *pressure) {
  struct sums sums = {pressure, calloc((size_t)node_count + 1, sizeof *sums.weight)};
  if (!sums.weight) {
    return STATUS_NO_MEMORY;
  }
  memset(pressure, 0, sizeof *pressure * (size_t)node_count);
  for (int p = 0; p < contact->pair_count; p++) {
    share_pair(contact, p, u, &sums);
  }
  for (int n = 0; n < node_count; n++) {
    pressure[n] = sums.weight[n] > 0 ? sums.product[n] / sums.weight[n] : 0;
  }
  free(sums.weight);
  return STATUS_OK;
}
