#include "tests/physics/axi_block.h"

#include <check.h>

struct material_spec block_elastic(double modulus, double poisson) {
  double mu = 0.5 * modulus / (1 + poisson);
  return (struct material_spec){.model = MATERIAL_NEO_HOOKE,
                                .terms = 1,
                                .c = {mu},
                                .bulk_ratio = 2 * (1 + poisson) / (3 - 6 * poisson)};
}

static int block_node(const struct block *b, int i, int j) {
  return (2 * b->columns + 1) * j + i;
}

static struct axi_edge block_edge(const struct block *b, int i0, int j0, int i1, int j1) {
  return (struct axi_edge){
      {block_node(b, i0, j0), block_node(b, i1, j1), block_node(b, (i0 + i1) / 2, (j0 + j1) / 2)}};
}

void block_mesh(const struct block *b, struct axi_mesh *mesh) {
  int across = 2 * b->columns + 1, along = 2 * b->rows + 1, e = 0;
  int elements = b->columns * b->rows - (b->ring ? 1 : 0);
  static const int at[AXI_NODES][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0},
                                       {2, 1}, {1, 2}, {0, 1}, {1, 1}};
  ck_assert_int_eq(axi_mesh_create(across * along, elements, b->ring ? 4 : b->rows, 0, mesh, NULL),
                   STATUS_OK);
  for (int n = 0; n < across * along; n++) {
    double x = (double)(n % across) / (across - 1), y = (double)(n / across) / (along - 1);
    mesh->position[2 * n] = b->r[0] + x * (b->r[1] - b->r[0]);
    mesh->position[2 * n + 1] = b->z[0] + y * (b->z[1] - b->z[0]);
  }
  for (int j = 0; j < b->rows; j++) {
    for (int i = 0; i < b->columns; i++) {
      if (b->ring && i == 1 && j == 1) {
        continue;
      }
      for (int a = 0; a < AXI_NODES; a++) {
        mesh->element[e].node[a] = block_node(b, 2 * i + at[a][0], 2 * j + at[a][1]);
      }
      mesh->element[e++].region = 0;
    }
  }
  if (b->ring) { /* clockwise around the hole: the cavity is on the right */
    mesh->inner[0] = block_edge(b, 2, 2, 2, 4);
    mesh->inner[1] = block_edge(b, 2, 4, 4, 4);
    mesh->inner[2] = block_edge(b, 4, 4, 4, 2);
    mesh->inner[3] = block_edge(b, 4, 2, 2, 2);
    int middle = block_node(b, 3, 3); /* belongs to no element */
    mesh->hold[2 * middle] = mesh->hold[2 * middle + 1] = AXI_FIXED;
  } else { /* upwards along the outer side */
    for (int j = 0; j < b->rows; j++) {
      mesh->inner[j] = block_edge(b, 2 * b->columns, 2 * j, 2 * b->columns, 2 * j + 2);
    }
  }
  mesh->region_count = 1;
}
