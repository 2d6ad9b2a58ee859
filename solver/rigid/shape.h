/* Rigid objects as signed distances: how far a point is from the surface, which way, and how curved
 * the surface is there.
 *
 * Every shape has a frame of its own, which a pose (solver/rigid/pose.h) puts into that of the
 * actuator:
 *   plane       the half space z <= 0
 *   sphere      about the origin
 *   cylinder    along z, its middle in the origin
 *   frustum     a cone cut off, along z, base at -length/2, tip at +length/2
 *   box         its middle in the origin, edges along the axes
 *   revolution  about z; z as its profile gives it
 *   surface     the frame of its triangles (solver/rigid/surface.h)
 *
 * The distance is that of Euclid, exact up to round-off, its gradient a unit vector, and curvature
 * the second derivative. Outside of rounded shapes all of it is defined everywhere, with jumps of
 * the curvature where flat, cylindrical and toroidal parts meet. Inside, distance and normal
 * belong to the nearest part of the surface; the normal jumps where two parts are equally near,
 * which for convex rounded edges is no nearer to the surface than the radius of the rounding, and
 * for sharp ones begins at the edge: give a body that presses on edges a radius. */
#ifndef PNEULAB_RIGID_SHAPE_H
#define PNEULAB_RIGID_SHAPE_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"
#include "solver/rigid/pose.h"

enum rigid_kind {
  RIGID_PLANE,
  RIGID_SPHERE,
  RIGID_CYLINDER,
  RIGID_FRUSTUM,
  RIGID_BOX,
  RIGID_REVOLUTION,
  RIGID_SURFACE
};

/* Never changed after its creation: may be shared by threads. */
struct rigid_shape;

/* What is known at a point about the nearest point of the surface. */
struct rigid_nearest {
  double distance;        /* m, > 0 outside */
  double normal[3];       /* gradient of the distance: unit vector, out of the object */
  double curvature[3][3]; /* Hessian of the distance, 1/m: symmetric, curvature . normal = 0 */
};

/* Solid of uniform density. */
struct rigid_mass {
  double volume;      /* m3 */
  double centroid[3]; /* m, in the shape's frame */
  double inertia[9];  /* about the centroid, divided by the mass, m2; row-major, symmetric */
};

/* Sizes in metres, from 0.1 mm to 10 m. All return STATUS_NO_MEMORY, or STATUS_INVALID with a
 * message that names the number, and a pointer relative to the description of the object
 * ("/diameter", "/profile/3/1"). The caller owns *shape (rigid_shape_destroy). */
enum status rigid_shape_create_plane(struct rigid_shape **shape, struct error *error);
enum status rigid_shape_create_sphere(double diameter, struct rigid_shape **shape,
                                      struct error *error);

/* rim: radius of the rounding of both edges, 0 (sharp) to half of diameter or length. */
enum status rigid_shape_create_cylinder(double diameter, double length, double rim,
                                        struct rigid_shape **shape, struct error *error);

/* rim: radius of the rounding of both edges, 0 (sharp) to what they have room for. Diameters may
 * be equal, and either the larger. */
enum status rigid_shape_create_frustum(double base_diameter, double tip_diameter, double length,
                                       double rim, struct rigid_shape **shape, struct error *error);

/* edge: radius of the rounding of all edges and corners, 0 (sharp) to half of the shortest size. */
enum status rigid_shape_create_box(const double size[3], double edge, struct rigid_shape **shape,
                                   struct error *error);

/* How a profile goes through its points. */
enum rigid_profile {
  RIGID_PROFILE_SMOOTH,  /* a smooth curve through all points */
  RIGID_PROFILE_STRAIGHT /* straight lines, every corner of them rounded by `edge` */
};

enum { RIGID_PROFILE_POINTS = 200 };

/* The body of revolution of 2 to 200 points (z, r >= 0) in m, along the outline from one end to the
 * other; the outline may turn back (a cup with its inside), but not cross itself. Inner points have
 * r > 0. An end with r > 0 is closed by a flat disk, whose edge is rounded by `edge` (m, 0: sharp).
 *
 * The smooth curve passes through the points with continuous tangents and consists of circular
 * arcs, two between neighbours (biarcs whose arcs have equal tangent lengths). At a point its
 * tangent is that of the circle through this point and both neighbours; where z or r turns round
 * there, or a straight part along or across the axis begins, it is along or across the axis. So
 * between neighbours neither z nor r leaves the range of their values: the curve has no waves that
 * the points do not have. For a steep rise between level ends, where a biarc would overshoot, there
 * is arc, line, arc instead. A profile that turns past a direction along and one across the axis at
 * one point is refused. At an end with r = 0 the tangent is across the axis, at one with r > 0 the
 * first arc is of the circle through the points next to it. Three points on a line give a line.
 *
 * Beyond the sizes STATUS_INVALID for outlines that cross themselves, points that coincide (closer
 * than 1 um) ("/profile/3"), corners too near for their edges ("/rim"). */
enum status rigid_shape_create_revolution(const double (*point)[2], int count,
                                          enum rigid_profile form, double edge,
                                          struct rigid_shape **shape, struct error *error);

struct stl;

/* Angle between triangles from which their edge is one of the body, unless another is given. */
#define RIGID_CREASE 0.6981317007977318 /* rad: 40 degrees */

/* The body within the triangles of an STL file (solver/rigid/stl.h), whose coordinates are in
 * `unit` metres, read as its smooth surface: solver/rigid/surface.h tells how, and what is checked.
 * crease: edges at which the triangles turn by this angle (rad) or more stay sharp; with 0 all
 * triangles stay flat. STATUS_INVALID with the surface's fault and where it is ("/stl"), for sizes
 * that only a wrong unit makes ("/unit") and an impossible angle ("/crease"); STATUS_TOO_LARGE when
 * it has too many long thin triangles to be checked. */
enum status rigid_shape_create_surface(const struct stl *stl, double unit, double crease,
                                       struct rigid_shape **shape, struct error *error);

void rigid_shape_destroy(struct rigid_shape *shape);

enum rigid_kind rigid_shape_kind(const struct rigid_shape *shape);

/* Distance, normal and curvature at the point x (m) of the shape's frame. Returns false, and then
 * leaves *nearest alone, when x is outside by more than `reach` (m, may be INFINITY); inside it
 * answers at any depth. At points that are equally far from several parts one of them is taken; at
 * the centre of a sphere the normal is z. */
bool rigid_shape_nearest(const struct rigid_shape *shape, const double x[3], double reach,
                         struct rigid_nearest *nearest);

/* The same for a point, and with an answer, in the outer frame of a pose. */
bool rigid_shape_nearest_posed(const struct rigid_shape *shape, const struct rigid_pose *pose,
                               const double x[3], double reach, struct rigid_nearest *nearest);

/* Smallest box with edges along the axes that holds the shape, m; infinite for a plane. */
void rigid_shape_bounds(const struct rigid_shape *shape, double low[3], double high[3]);

/* Volume, centroid and inertia. False for a plane, which has no volume. */
bool rigid_shape_mass(const struct rigid_shape *shape, struct rigid_mass *mass);

#endif
