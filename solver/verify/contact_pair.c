#include "solver/verify/contact_pair.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/verify/report.h"

static void two_cubes(const void *context, int block, const double s[3], double x[3]) {
  const double *gap = context;
  memcpy(x, s, 3 * sizeof *x);
  x[0] += block * (1 + *gap);
}

enum status contact_blocks_build(int cells, double gap, struct mesh *mesh) {
  struct body body = {.blocks = 2, .cells = {1, cells, cells}, .map = two_cubes, .context = &gap};
  enum status status = body_build(&body, mesh);
  int pairs = cells * cells;
  mesh->facing = calloc((size_t)pairs, sizeof *mesh->facing);
  if (status != STATUS_OK || !mesh->facing) {
    return STATUS_NO_MEMORY;
  }
  mesh->facing_count = pairs;
  mesh->gap_width = 0.1;
  for (int p = 0; p < pairs; p++) {
    mesh->facing[p].slave = (struct mesh_face){p, 0, 1, FACE_OUTER, 0};
    mesh->facing[p].master = (struct mesh_face){pairs + p, 0, -1, FACE_OUTER, 0};
  }
  return STATUS_OK;
}

enum status contact_pair_open(struct contact_pair_case *c, double gap, double crooked,
                              double lambda) {
  *c = (struct contact_pair_case){.x = {{0}}};
  quad9_tables_fill(&c->tables);
  enum status status = contact_blocks_build(1, 0.1, &c->mesh);
  if (status == STATUS_OK) {
    status = contact_init(&c->contact, &c->mesh, &c->tables, NULL);
  }
  if (status != STATUS_OK) {
    return status;
  }
  c->contact.stiffness = 10;
  c->contact.smoothing = 0.05;
  int nodes[CONTACT_NODES];
  unsigned seed = 17;
  contact_nodes(&c->contact, 0, nodes);
  for (int a = 0; a < CONTACT_NODES; a++) {
    memcpy(c->x[a], c->mesh.x + 3 * nodes[a], sizeof c->x[a]);
    double y = c->x[a][1], z = c->x[a][2];
    c->x[a][0] = 1 + crooked * (2 * y - z + 3 * y * y - 2 * y * z + 2 * z * z);
    c->x[a][0] += a < QUAD9_NODES ? 0.1 * crooked * body_random(&seed) : gap;
    c->x[a][1] += 0.3 * crooked * body_random(&seed);
    c->x[a][2] += 0.3 * crooked * body_random(&seed);
  }
  for (int d = 0; d < CONTACT_DOFS; d++) {
    c->v[d] = body_random(&seed);
  }
  for (int q = 0; q < QUAD9_POINTS; q++) {
    c->contact.point[q].lambda = lambda;
  }
  return STATUS_OK;
}

void contact_pair_close(struct contact_pair_case *c) {
  contact_release(&c->contact);
  mesh_release(&c->mesh);
}

bool contact_pair_residual(struct contact_pair_case *c, double h, double r[CONTACT_DOFS]) {
  double x[CONTACT_NODES][3];
  for (int d = 0; d < CONTACT_DOFS; d++) {
    x[d / 3][d % 3] = c->x[d / 3][d % 3] + h * c->v[d];
  }
  return contact_evaluate(&c->contact, 0, x, r, NULL);
}

enum status contact_pair_tangent(struct contact_pair_case *c) {
  double r[CONTACT_DOFS];
  double *packed = malloc(sizeof *packed * CONTACT_PACKED);
  if (!packed) {
    return STATUS_NO_MEMORY;
  }
  bool touches = contact_evaluate(&c->contact, 0, c->x, r, packed);
  const double *value = packed;
  memset(c->exact, 0, sizeof c->exact);
  for (int i = 0; touches && i < CONTACT_DOFS; i++) {
    for (int j = i; j < CONTACT_DOFS; j++, value++) {
      c->exact[i] += *value * c->v[j];
      c->exact[j] += j > i ? *value * c->v[i] : 0;
    }
  }
  free(packed);
  return touches ? STATUS_OK : STATUS_DIVERGED;
}

double contact_pair_error(void *pair_case, double h) {
  struct contact_pair_case *c = pair_case;
  double a[CONTACT_DOFS] = {0}, b[CONTACT_DOFS] = {0};
  contact_pair_residual(c, -h, a);
  contact_pair_residual(c, h, b);
  return verify_difference_error(CONTACT_DOFS, a, b, h, c->exact);
}
