#include "solver/axi/mesh.h"

#include <stdlib.h>
#include <string.h>

static void *room(int count, size_t size) {
  return calloc(count > 0 ? (size_t)count : 1, size);
}

enum status axi_mesh_create(int node_count, int element_count, int inner_count, int outer_count,
                            struct axi_mesh *mesh, struct error *error) {
  memset(mesh, 0, sizeof *mesh);
  mesh->node_count = node_count;
  mesh->element_count = element_count;
  mesh->inner_count = inner_count;
  mesh->outer_count = outer_count;
  mesh->position = room(2 * node_count, sizeof *mesh->position);
  mesh->element = room(element_count, sizeof *mesh->element);
  mesh->inner = room(inner_count, sizeof *mesh->inner);
  mesh->outer = room(outer_count, sizeof *mesh->outer);
  mesh->hold = room(2 * node_count, sizeof *mesh->hold);
  mesh->offset = room(2 * node_count, sizeof *mesh->offset);
  mesh->master = room(node_count, sizeof *mesh->master);
  if (!mesh->position || !mesh->element || !mesh->inner || !mesh->outer || !mesh->hold ||
      !mesh->offset || !mesh->master) {
    axi_mesh_release(mesh);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a mesh of %d nodes", node_count);
  }
  for (int i = 0; i < node_count; i++) {
    mesh->master[i] = -1;
  }
  return STATUS_OK;
}

void axi_mesh_release(struct axi_mesh *mesh) {
  free(mesh->position);
  free(mesh->element);
  free(mesh->inner);
  free(mesh->outer);
  free(mesh->hold);
  free(mesh->offset);
  free(mesh->master);
  memset(mesh, 0, sizeof *mesh);
}
