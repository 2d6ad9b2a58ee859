#include "solver/mesh/grid.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static enum status reserve_lines(struct grid_axis *axis, int added) {
  if (axis->line_count + added <= axis->capacity) {
    return STATUS_OK;
  }
  int capacity = 2 * (axis->line_count + added);
  double *line = realloc(axis->line, sizeof *line * (size_t)capacity);
  if (!line) {
    return STATUS_NO_MEMORY;
  }
  axis->line = line;
  int *tags = realloc(axis->tag, sizeof *tags * (size_t)capacity);
  if (!tags) {
    return STATUS_NO_MEMORY;
  }
  axis->tag = tags;
  axis->capacity = capacity;
  return STATUS_OK;
}

/* Length of cell c relative to the others of its stretch. */
static double relative_length(const struct grid_division *d, int c) {
  double weight = c == 0 ? d->first : c == d->cells - 1 ? d->last : 1;
  return weight > 0 ? weight : 1;
}

enum status grid_axis_divide(struct grid_axis *axis, double end,
                             const struct grid_division *division, int tag) {
  int split = division->split > 0 ? division->split : 1;
  if (reserve_lines(axis, division->cells * split) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  double start = axis->line[axis->line_count - 1], total = 0, before = 0;
  for (int c = 0; c < division->cells; c++) {
    total += relative_length(division, c);
  }
  for (int c = 0; c < division->cells; c++) {
    double length = relative_length(division, c);
    for (int s = 1; s <= split; s++) {
      bool last = c == division->cells - 1 && s == split;
      double part = (before + length * s / split) / total;
      axis->tag[axis->line_count - 1] = tag;
      axis->line[axis->line_count++] = last ? end : start + (end - start) * part;
    }
    before += length;
  }
  return STATUS_OK;
}

enum status grid_axis_extend(struct grid_axis *axis, double end, int cells, int tag) {
  if (cells > 0) {
    return grid_axis_divide(axis, end, &(struct grid_division){.cells = cells}, tag);
  }
  if (reserve_lines(axis, 1) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  axis->line[axis->line_count++] = end;
  return STATUS_OK;
}

enum status grid_axis_insert(struct grid_axis *axis, double at) {
  int last = axis->line_count - 1, l = 0;
  double near = 1e-6 * (axis->line[last] - axis->line[0]);
  while (l <= last && axis->line[l] < at - near) {
    l++;
  }
  if (l == 0 || l > last || axis->line[l] <= at + near) {
    return STATUS_OK;
  }
  if (reserve_lines(axis, 1) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  size_t after = (size_t)(last - l);
  memmove(axis->line + l + 1, axis->line + l, sizeof *axis->line * (after + 1));
  memmove(axis->tag + l, axis->tag + l - 1, sizeof *axis->tag * (after + 1));
  axis->line[l] = at;
  axis->line_count++;
  return STATUS_OK;
}

void grid_release(struct grid *grid) {
  for (int d = 0; d < 3; d++) {
    free(grid->axis[d].line);
    free(grid->axis[d].tag);
    grid->axis[d] = (struct grid_axis){0};
  }
}

/* Working data of one grid_mesh call. */
struct builder {
  const struct grid *grid;
  int cells[3];
  int lattice[3];           /* 2 cells + 1 */
  unsigned char *cell_kind; /* cells[0] x cells[1] x cells[2] */
  int *cell_element;        /* element of a solid cell, else -1 */
  int *lattice_node;
};

static int cell_index(const struct builder *b, const int c[3]) {
  return (c[0] * b->cells[1] + c[1]) * b->cells[2] + c[2];
}

static int lattice_index(const struct builder *b, int i, int j, int k) {
  return (i * b->lattice[1] + j) * b->lattice[2] + k;
}

static bool cell_inside(const struct builder *b, const int c[3]) {
  for (int d = 0; d < 3; d++) {
    if (c[d] < 0 || c[d] >= b->cells[d]) {
      return false;
    }
  }
  return true;
}

static double lattice_coordinate(const struct grid_axis *axis, int position) {
  int line = position / 2;
  return position % 2 ? 0.5 * (axis->line[line] + axis->line[line + 1]) : axis->line[line];
}

/* Calls for every cell in element order. */
#define FOR_EACH_CELL(b, c)                                                                        \
  for (int c[3] = {0, 0, 0}; c[0] < (b)->cells[0]; c[0]++)                                         \
    for (c[1] = 0; c[1] < (b)->cells[1]; c[1]++)                                                   \
      for (c[2] = 0; c[2] < (b)->cells[2]; c[2]++)

static int number_cells(struct builder *b, grid_kind_fn kind, const void *context) {
  int elements = 0;
  FOR_EACH_CELL(b, c) {
    int tag[3];
    for (int d = 0; d < 3; d++) {
      tag[d] = b->grid->axis[d].tag[c[d]];
    }
    int index = cell_index(b, c);
    b->cell_kind[index] = (unsigned char)kind(context, tag);
    b->cell_element[index] = b->cell_kind[index] == CELL_SOLID ? elements++ : -1;
  }
  return elements;
}

static int number_nodes(struct builder *b) {
  int total = b->lattice[0] * b->lattice[1] * b->lattice[2];
  for (int n = 0; n < total; n++) {
    b->lattice_node[n] = -1;
  }
  FOR_EACH_CELL(b, c) {
    if (b->cell_kind[cell_index(b, c)] != CELL_SOLID) {
      continue;
    }
    for (int n = 0; n < HEX27_NODES; n++) {
      b->lattice_node[lattice_index(b, 2 * c[0] + n / 9, 2 * c[1] + n / 3 % 3, 2 * c[2] + n % 3)] =
          0;
    }
  }
  int nodes = 0;
  for (int n = 0; n < total; n++) {
    if (b->lattice_node[n] == 0) {
      b->lattice_node[n] = nodes++;
    }
  }
  return nodes;
}

static void fill_nodes(const struct builder *b, bool half, grid_map_fn map, const void *context,
                       struct mesh *mesh) {
  const struct grid_axis *axis = b->grid->axis;
  for (int i = 0; i < b->lattice[0]; i++) {
    for (int j = 0; j < b->lattice[1]; j++) {
      for (int k = 0; k < b->lattice[2]; k++) {
        int node = b->lattice_node[lattice_index(b, i, j, k)];
        if (node < 0) {
          continue;
        }
        double point[3] = {lattice_coordinate(&axis[0], i), lattice_coordinate(&axis[1], j),
                           lattice_coordinate(&axis[2], k)};
        map(context, point, mesh->x + 3 * (size_t)node);
        mesh->node_section[node] = i;
        unsigned char *fixed = mesh->fixed + 3 * (size_t)node;
        fixed[0] = fixed[1] = fixed[2] = i == 0;
        if (half && j == 0) {
          fixed[1] = 1;
        }
      }
    }
  }
  FOR_EACH_CELL(b, c) {
    int element = b->cell_element[cell_index(b, c)];
    if (element < 0) {
      continue;
    }
    for (int d = 0; d < 3; d++) {
      mesh->element_cell[3 * element + d] = c[d];
    }
    for (int n = 0; n < HEX27_NODES; n++) {
      mesh->element_nodes[HEX27_NODES * element + n] = b->lattice_node[lattice_index(
          b, 2 * c[0] + n / 9, 2 * c[1] + n / 3 % 3, 2 * c[2] + n % 3)];
    }
  }
}

/* Kind of the boundary face of cell c towards `axis`, `side`, and the cavity it bounds; false for
 * an inner face. */
static bool face_kind_of(const struct builder *b, bool half, const int c[3], int axis, int side,
                         enum face_kind *kind, unsigned char *cavity) {
  int n[3] = {c[0], c[1], c[2]};
  n[axis] += side;
  *cavity = 0;
  if (!cell_inside(b, n)) {
    *kind = axis == 0 && side < 0           ? FACE_BASE
            : half && axis == 1 && side < 0 ? FACE_SYMMETRY
                                            : FACE_OUTER;
    return true;
  }
  int neighbour = b->cell_kind[cell_index(b, n)];
  *kind = neighbour >= CELL_CAVITY ? FACE_CAVITY : FACE_OUTER;
  *cavity = (unsigned char)(neighbour >= CELL_CAVITY ? neighbour - CELL_CAVITY : 0);
  return neighbour != CELL_SOLID;
}

/* Element that the +axis face of cell c sees across gap cells only, or -1; *width is the
 * distance in grid coordinates. */
static int facing_element(const struct builder *b, const int c[3], int axis, double *width) {
  int n[3] = {c[0], c[1], c[2]};
  do {
    n[axis]++;
    if (!cell_inside(b, n)) {
      return -1;
    }
  } while (b->cell_kind[cell_index(b, n)] == CELL_GAP);
  const double *line = b->grid->axis[axis].line;
  *width = line[n[axis]] - line[c[axis] + 1];
  return n[axis] == c[axis] + 1 ? -1 : b->cell_element[cell_index(b, n)];
}

static void fill_faces(const struct builder *b, bool half, struct mesh *mesh) {
  mesh->gap_width = DBL_MAX;
  FOR_EACH_CELL(b, c) {
    int element = b->cell_element[cell_index(b, c)];
    if (element < 0) {
      continue;
    }
    for (int axis = 0; axis < 3; axis++) {
      for (int side = -1; side <= 1; side += 2) {
        enum face_kind kind;
        unsigned char cavity;
        if (face_kind_of(b, half, c, axis, side, &kind, &cavity)) {
          mesh->faces[mesh->face_count++] = (struct mesh_face){
              element, (signed char)axis, (signed char)side, (unsigned char)kind, cavity};
        }
      }
      double width;
      int other = facing_element(b, c, axis, &width);
      if (other >= 0) {
        mesh->facing[mesh->facing_count++] =
            (struct mesh_facing){{element, (signed char)axis, 1, FACE_OUTER, 0},
                                 {other, (signed char)axis, -1, FACE_OUTER, 0}};
        if (width < mesh->gap_width) {
          mesh->gap_width = width;
        }
      }
    }
  }
  if (mesh->facing_count == 0) {
    mesh->gap_width = 0;
  }
}

/* Copies the lines of the grid. */
static bool copy_lines(const struct grid *grid, struct mesh *mesh) {
  for (int d = 0; d < 3; d++) {
    size_t size = sizeof *mesh->line[d] * (size_t)grid->axis[d].line_count;
    mesh->line_count[d] = grid->axis[d].line_count;
    mesh->line[d] = malloc(size);
    if (!mesh->line[d]) {
      return false;
    }
    memcpy(mesh->line[d], grid->axis[d].line, size);
  }
  return true;
}

static bool allocate_mesh(struct mesh *mesh, int nodes, int elements, int sections) {
  mesh->node_count = nodes;
  mesh->element_count = elements;
  mesh->section_count = sections;
  mesh->x = calloc((size_t)nodes * 3, sizeof *mesh->x);
  mesh->element_nodes = calloc((size_t)elements * HEX27_NODES, sizeof *mesh->element_nodes);
  mesh->element_cell = calloc((size_t)elements * 3, sizeof *mesh->element_cell);
  mesh->fixed = calloc((size_t)nodes * 3, 1);
  mesh->faces = calloc((size_t)elements * 6 + 1, sizeof *mesh->faces);
  mesh->facing = calloc((size_t)elements * 3 + 1, sizeof *mesh->facing);
  mesh->node_section = calloc((size_t)nodes, sizeof *mesh->node_section);
  mesh->node_core = calloc((size_t)nodes, 1);
  mesh->centreline = calloc((size_t)sections, sizeof *mesh->centreline);
  return mesh->x && mesh->element_nodes && mesh->element_cell && mesh->fixed && mesh->faces &&
         mesh->facing && mesh->node_section && mesh->node_core && mesh->centreline;
}

enum status grid_mesh(const struct grid *grid, bool half, grid_kind_fn kind, grid_map_fn map,
                      const void *context, struct mesh *mesh, struct error *error) {
  enum status status = STATUS_OK;
  struct builder b = {.grid = grid};
  *mesh = (struct mesh){.half = half};
  size_t cells = 1, lattice = 1;
  for (int d = 0; d < 3; d++) {
    b.cells[d] = grid->axis[d].line_count - 1;
    b.lattice[d] = 2 * b.cells[d] + 1;
    cells *= (size_t)b.cells[d];
    lattice *= (size_t)b.lattice[d];
  }
  if (lattice > 50000000) {
    status = error_set(error, STATUS_TOO_LARGE, "/mesh", "the mesh would have %zu lattice points",
                       lattice);
    goto done;
  }
  b.cell_kind = calloc(cells, sizeof *b.cell_kind);
  b.cell_element = calloc(cells, sizeof *b.cell_element);
  b.lattice_node = calloc(lattice, sizeof *b.lattice_node);
  if (!b.cell_kind || !b.cell_element || !b.lattice_node) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a grid of %zu cells", cells);
    goto done;
  }
  int elements = number_cells(&b, kind, context);
  int nodes = number_nodes(&b);
  if (!allocate_mesh(mesh, nodes, elements, b.lattice[0]) || !copy_lines(grid, mesh)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for %d elements", elements);
    goto done;
  }
  fill_nodes(&b, half, map, context, mesh);
  fill_faces(&b, half, mesh);
done:
  free(b.cell_kind);
  free(b.cell_element);
  free(b.lattice_node);
  if (status != STATUS_OK) {
    mesh_release(mesh);
  }
  return status;
}

int grid_find_node(const struct mesh *mesh, const double x[3], int section) {
  int best = -1;
  double best_distance = DBL_MAX;
  for (int n = 0; n < mesh->node_count; n++) {
    if (section >= 0 && mesh->node_section[n] != section) {
      continue;
    }
    const double *y = mesh->x + 3 * (size_t)n;
    double distance = 0;
    for (int d = 0; d < 3; d++) {
      distance += (x[d] - y[d]) * (x[d] - y[d]);
    }
    if (distance < best_distance) {
      best_distance = distance;
      best = n;
    }
  }
  return best;
}
