/* The meridian of a body of revolution: a chain of straight lines and circular arcs in the half
 * plane (z, r >= 0), from the axis to the axis, with the body on its right. */
#ifndef PNEULAB_RIGID_MERIDIAN_H
#define PNEULAB_RIGID_MERIDIAN_H

#include <stdbool.h>
#include "solver/rigid/shape.h"

enum { MERIDIAN_PIECES = 1024 };

/* A line or an arc of at most half a circle. */
struct meridian_piece {
  double start[2], end[2]; /* (z, r), m */
  double tangent[2];       /* at the start, unit vector; the normal (-t_r, t_z) leaves the body */
  double curvature;        /* 1/m: 0 straight, > 0 where the body is convex */
  double length;           /* m */
  double middle[2];        /* half way */
  double direction[2];     /* the tangent there */
  double half;             /* extent of the piece along it to either side, m */
  bool corner;             /* begins with another direction than the piece before ends */
};

struct meridian {
  int count;
  struct meridian_piece *piece;
  double low[2], high[2]; /* box that holds the chain: (z, r), m */
};

/* A point of a piece at arc length s from its start (may lie beyond its ends), and the unit tangent
 * there, which may be NULL. */
void meridian_piece_point(const struct meridian_piece *piece, double s, double point[2],
                          double tangent[2]);

/* A piece from its start, its unit tangent there, its curvature and its length (m). */
struct meridian_piece meridian_piece_make(const double start[2], const double tangent[2],
                                          double curvature, double length);

/* A straight piece. The points differ. */
struct meridian_piece meridian_piece_line(const double start[2], const double end[2]);

/* Copies `count` pieces, each of which starts where the one before ends, leaving out those
 * shorter than a thousandth of a micrometre. Fills all of *meridian. STATUS_NO_MEMORY. */
enum status meridian_init(struct meridian *meridian, const struct meridian_piece *piece, int count);
void meridian_release(struct meridian *meridian);

/* As rigid_shape_nearest. */
bool meridian_nearest(const struct meridian *meridian, const double x[3], double reach,
                      struct rigid_nearest *nearest);

/* Volume, centroid and inertia by Gauss quadrature over each piece, exact to round-off. */
void meridian_mass(const struct meridian *meridian, struct rigid_mass *mass);

#endif
