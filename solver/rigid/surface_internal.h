/* The steps from triangles to a surface, and its patches. */
#ifndef PNEULAB_RIGID_SURFACE_INTERNAL_H
#define PNEULAB_RIGID_SURFACE_INTERNAL_H

#include "solver/rigid/surface.h"

/* ---- welding (surface_weld.c) ----------------------------------------------------------- */

/* Fills vertices, triangles and numbers, in the file's unit. *tolerance: distance below which
 * corners are one. STATUS_NO_MEMORY. */
enum status surface_weld(const struct stl *stl, struct surface *surface, double *tolerance);

/* ---- checks (surface_check.c, surface_cross.c) ------------------------------------------ */

/* Checks everything but crossings and fills `beside`. tolerance: height below which a triangle has
 * no area. STATUS_INVALID with the fault, STATUS_NO_MEMORY. */
enum status surface_check(struct surface *surface, double tolerance, struct error *error);

/* Refuses edges that pass through triangles; the surface has its tree. */
enum status surface_check_crossing(const struct surface *surface, double unit, struct error *error);

/* The corner (3 t + k) of the same vertex in the next triangle around it, counter-clockwise seen
 * from outside. */
int surface_next_corner(const struct surface *surface, int corner);

/* ---- normals (surface_normal.c) --------------------------------------------------------- */

/* Fills `sharp`, `normal` and `pseudo`, and the triangles' own unit normals `flat` (3 each).
 * STATUS_NO_MEMORY. */
enum status surface_find_normals(struct surface *surface, double crease, double *flat);

/* ---- patches (surface_patch.c) ---------------------------------------------------------- */

/* Fills `bend` after the normals. STATUS_NO_MEMORY. */
enum status surface_smooth(struct surface *surface, double crease);

/* A triangle's quadratic patch: u x0 + v x1 + w x2 - u v c0 - v w c1 - w u c2, u = 1 - v - w. */
struct patch {
  const double *x[3];
  const double *bend; /* c0, c1, c2 */
};

struct patch surface_patch(const struct surface *surface, int triangle);

/* Point of a patch at (v, w), and its derivatives by v and w; `slope` may be NULL. */
void patch_point(const struct patch *patch, double v, double w, double point[3],
                 double slope[2][3]);

/* The second derivatives by vv, vw and ww, which are constant. */
void patch_curvature(const struct patch *patch, double second[3][3]);

/* Unit normal at (v, w), outwards. */
void patch_normal(const struct patch *patch, double v, double w, double normal[3]);

/* ---- tree (surface_tree.c) -------------------------------------------------------------- */

/* A triangle of a leaf, with what its distance needs, side by side in memory. */
struct surface_flat {
  double x[3], a[3], b[3]; /* a corner, and the edges from it to the next and the last, m */
  double aa, ab, bb;       /* their products */
  double inverse;          /* 1 / (aa bb - ab^2) */
  double bulge;            /* the patch is nowhere farther than this from the triangle, m */
  int triangle;
};

/* Builds the tree over the patches. STATUS_NO_MEMORY. */
enum status surface_plant(struct surface *surface);

#endif
