#include "solver/verify/revolution.h"

int revolution_node(const struct revolution *body, int i, int j) {
  return j * (2 * body->cells[0] + 1) + i;
}

static struct axi_edge side(const struct revolution *body, int i, int start, int end) {
  return (struct axi_edge){{revolution_node(body, i, start), revolution_node(body, i, end),
                            revolution_node(body, i, (start + end) / 2)}};
}

enum status revolution_mesh(const struct revolution *body, struct axi_mesh *mesh,
                            struct error *error) {
  static const int at[AXI_NODES][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0},
                                       {2, 1}, {1, 2}, {0, 1}, {1, 1}};
  int n = body->cells[0], m = body->cells[1];
  enum status status = axi_mesh_create((2 * n + 1) * (2 * m + 1), n * m, m, m, mesh, error);
  if (status != STATUS_OK) {
    return status;
  }
  mesh->region_count = 1;
  mesh->region[0] = body->material;
  for (int j = 0; j <= 2 * m; j++) {
    for (int i = 0; i <= 2 * n; i++) {
      body->map(body->context, 0.5 * i / n, 0.5 * j / m,
                &mesh->position[2 * revolution_node(body, i, j)]);
    }
  }
  for (int e = 0; e < n * m; e++) {
    for (int a = 0; a < AXI_NODES; a++) {
      mesh->element[e].node[a] =
          revolution_node(body, 2 * (e % n) + at[a][0], 2 * (e / n) + at[a][1]);
    }
  }
  for (int j = 0; j < m; j++) {
    mesh->inner[j] = side(body, 0, 2 * j + 2, 2 * j);
    mesh->outer[j] = side(body, 2 * n, 2 * j, 2 * j + 2);
  }
  return STATUS_OK;
}

void revolution_hold(const struct revolution *body, struct axi_mesh *mesh, int direction, int end,
                     int component, enum axi_hold hold) {
  int across = 2 * body->cells[1 - direction];
  for (int k = 0; k <= across; k++) {
    int along = end * 2 * body->cells[direction];
    int node = direction == 0 ? revolution_node(body, along, k) : revolution_node(body, k, along);
    mesh->hold[2 * node + component] = (unsigned char)hold;
  }
}
