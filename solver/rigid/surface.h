/* Closed surfaces of triangles: the way from an STL file to a rigid shape.
 *
 * 1. Welding: corners closer than a millionth of the surface's diagonal (or than single precision
 *    can tell) become one vertex; triangles that thereby lose an edge are left out.
 * 2. Checks, in this order, each naming the fault and a place in the file's own unit: triangles
 *    without area, open edges, edges of more than two triangles, neighbours of opposite
 *    orientation, vertices in which two parts of the surface touch, several bodies, inside out,
 *    edges that pass through other triangles. Triangles that share a vertex, and such that lie
 *    in one plane, are not tested for passing through each other.
 * 3. Smoothing: each triangle becomes a quadratic patch that is normal to the vertices' normals
 *    (Nagata 2005, in the use of Neto, Oliveira, Menezes 2017 for contact with rigid tools), so
 *    that distance, normal and curvature are those of a smooth body and not of facets, while the
 *    vertices stay where they are. The normal of a vertex is the mean over its triangles weighted
 *    with their angles, in which facets far smaller than the largest have no say: flat sides do
 *    not bulge next to the strips of a rounded rim. The distance to the patches is exact, and its
 *    gradient the normal: a contact force with it has a potential. Rounding by an offset would
 *    move the surface, and leave no curvature within facets. Edges that turn by more than `crease`
 *    stay sharp; they are curves that fit both sides.
 * 4. Signed distance: a tree of boxes over the patches, sign by the normal at the nearest point,
 *    at edges and vertices by the angle-weighted mean (Baerentzen, Aanaes 2005). */
#ifndef PNEULAB_RIGID_SURFACE_H
#define PNEULAB_RIGID_SURFACE_H

#include <stdbool.h>
#include "solver/rigid/shape.h"
#include "solver/rigid/stl.h"

struct surface_flat;
struct box_tree;

struct surface {
  int vertex_count, triangle_count;
  double *x;              /* 3 numbers a vertex, m */
  int *triangle;          /* 3 vertices each, counter-clockwise seen from outside */
  int *number;            /* each triangle's place in the file, from 1 */
  int *beside;            /* 3 each: edge e goes from corner e to the next; 3 t + e of its twin */
  bool *sharp;            /* 3 each: the edge is a crease */
  double *normal;         /* 9 each: unit normals at its corners, of its side of a crease */
  double *pseudo;         /* 3 a vertex: angle-weighted mean of the triangles' normals */
  double *bend;           /* 9 each: of the edge curves, m; edge e is
                             (1 - s) a + s b - s (1 - s) bend */
  double low[3], high[3]; /* box of the patches, m */
  struct box_tree *tree;  /* over the patches */
  struct surface_flat *flat; /* the triangles in the order of the tree */
};

/* A surface in metres from triangles in units of `unit` metres. crease: least angle between
 * neighbours that stays sharp, rad; 0 keeps all facets flat. Errors as rigid_shape_create_surface;
 * the caller releases *surface, which is empty after a failure. */
enum status surface_create(const struct stl *stl, double unit, double crease,
                           struct surface *surface, struct error *error);
void surface_release(struct surface *surface);

/* As rigid_shape_nearest and rigid_shape_mass; the volume is that within the patches. */
bool surface_nearest(const struct surface *surface, const double x[3], double reach,
                     struct rigid_nearest *nearest);
void surface_mass(const struct surface *surface, struct rigid_mass *mass);

#endif
