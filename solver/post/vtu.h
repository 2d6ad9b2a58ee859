/* VTK's XML files: unstructured grids of one cell type, and collections of them in time.
 *
 * Arrays are inline, compressed with zlib and written in base64, so that the file stays valid
 * XML at about half the size of the raw numbers. */
#ifndef PNEULAB_POST_VTU_H
#define PNEULAB_POST_VTU_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "solver/base/error.h"

/* Cell types: triangle, biquadratic quadrilateral, triquadratic hexahedron. */
enum { VTU_TRIANGLE = 5, VTU_QUAD9 = 28, VTU_HEX27 = 29 };

struct vtu_grid {
  int point_count, cell_count;
  const float *point;          /* point_count x 3 */
  int cell_nodes;              /* nodes of a cell */
  int cell_type;               /* VTU_TRIANGLE, VTU_QUAD9 or VTU_HEX27 */
  const int32_t *connectivity; /* cell_count x cell_nodes, in VTK's order of the cell's nodes */
};

/* Values at the points. */
struct vtu_array {
  const char *name;
  int components; /* 1, 3, or 6 for a symmetric tensor in the order xx yy zz xy yz xz */
  const float *value;
};

/* Turns local nodes 9 i + 3 j + k (hexahedron) or 3 a + b (quadrilateral) into VTK's order:
 * VTK's node n is local node order[n]. Of the quadrilateral, `flipped` gives the other side. */
const int *vtu_order_hex27(void);
const int *vtu_order_quad9(int flipped);

/* Writes the grid with its point data. Failures of writing are left to the caller's ferror;
 * STATUS_NO_MEMORY when there is none for the compression. */
enum status vtu_write(FILE *file, const struct vtu_grid *grid, const struct vtu_array *arrays,
                      int array_count);

/* Writes a collection (PVD) of the files names[k] at the times time[k]. */
void vtu_write_collection(FILE *file, const char *const *names, const double *time, size_t count);

#endif
