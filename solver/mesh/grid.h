/* A tensor grid of cells, some of them empty, turned into a mesh of 27-node hexahedra. */
#ifndef PNEULAB_MESH_GRID_H
#define PNEULAB_MESH_GRID_H

#include "solver/mesh/mesh.h"

/* Across cells of CELL_GAP the solid faces itself; those of CELL_EMPTY are outside without that.
 * CELL_CAVITY + c is a cell of cavity c < MESH_CAVITIES, each with a pressure of its own. */
enum cell_kind { CELL_SOLID, CELL_GAP, CELL_EMPTY, CELL_CAVITY };

/* One grid axis: line_count lines bound line_count - 1 cells; tag[c] says which feature cell c
 * belongs to (meaning up to the caller). */
struct grid_axis {
  int line_count;
  int capacity;
  double *line;
  int *tag;
};

struct grid {
  struct grid_axis axis[3];
};

/* How a stretch is divided: into `cells` cells, equal but for the first and the last one, which
 * are `first` and `last` times as long as the others (0 stands for 1); each of them is then cut
 * into `split` equal parts (0 stands for 1). */
struct grid_division {
  int cells;
  double first, last;
  int split;
};

/* Appends the cells of a stretch that ends at coordinate `end`. The axis must have its start.
 * Returns STATUS_OK or STATUS_NO_MEMORY. */
enum status grid_axis_divide(struct grid_axis *axis, double end,
                             const struct grid_division *division, int tag);

/* Appends `cells` equal cells up to coordinate `end`. The first call sets the start with
 * cells = 0. Returns STATUS_OK or STATUS_NO_MEMORY. */
enum status grid_axis_extend(struct grid_axis *axis, double end, int cells, int tag);

/* Cuts the cell around coordinate `at` in two of its tag; nothing happens where a line is already,
 * to within a millionth of the axis, or outside. Returns STATUS_OK or STATUS_NO_MEMORY. */
enum status grid_axis_insert(struct grid_axis *axis, double at);

void grid_release(struct grid *grid);

/* What a cell holds, an enum cell_kind. tag: its tags along the three axes. */
typedef int (*grid_kind_fn)(const void *context, const int tag[3]);

/* Moves a point of the tensor grid to its place in the body. */
typedef void (*grid_map_fn)(const void *context, const double grid_point[3], double x[3]);

/* Builds the mesh of all solid cells: nodes numbered section by section along axis 0, boundary
 * faces with their kinds (cells outside the grid are outer; the first plane of axis 0 is the
 * base; with `half`, the first plane of axis 1 is the symmetry plane), and facing pairs: every
 * solid face that sees another one across gap cells along the same axis.
 * Base nodes are fixed, symmetry nodes are held in y. Sections are filled but for node_core,
 * centreline and stations. On success the caller releases *mesh. */
enum status grid_mesh(const struct grid *grid, bool half, grid_kind_fn kind, grid_map_fn map,
                      const void *context, struct mesh *mesh, struct error *error);

/* Node nearest to x (m) among those of `section` (-1: all). Searches every node; meant for a
 * few lookups after grid_mesh. Returns -1 for a mesh without such nodes. */
int grid_find_node(const struct mesh *mesh, const double x[3], int section);

#endif
