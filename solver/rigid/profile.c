#include "solver/rigid/profile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define NEAREST 1e-6 /* m: least distance of neighbours */
#define LARGEST 10.0 /* m */

/* ---- points ----------------------------------------------------------------------------- */

static enum status check_point(const double (*point)[2], int i, bool inner, struct error *error) {
  char pointer[32];
  const double z = point[i][0], r = point[i][1];
  snprintf(pointer, sizeof pointer, "/profile/%d", i);
  if (!(fabs(z) <= LARGEST)) {
    return error_set(error, STATUS_INVALID, pointer,
                     "the place z along the axis is %g mm\nfrom -10 m to 10 m", 1e3 * z);
  }
  if (!(r >= 0 && r <= LARGEST) || (inner && r == 0)) {
    return error_set(error, STATUS_INVALID, pointer, "the radius r of the profile is %g mm\n%s",
                     1e3 * r,
                     inner ? "above 0 between the ends, and at most 10 m" : "from 0 to 10 m");
  }
  if (i > 0 && hypot(z - point[i - 1][0], r - point[i - 1][1]) < NEAREST) {
    return error_set(error, STATUS_INVALID, pointer,
                     "this point of the profile (z %g mm, r %g mm) is the one before again\nat "
                     "least 1 um apart",
                     1e3 * z, 1e3 * r);
  }
  return STATUS_OK;
}

/* Twice the area between the points and the axis, counted along z. */
static double area_below(const double (*point)[2], int count) {
  double area = 0;
  for (int i = 1; i < count; i++) {
    area += (point[i][0] - point[i - 1][0]) * (point[i][1] + point[i - 1][1]);
  }
  return area;
}

static enum status check_points(const double (*point)[2], int count, struct error *error) {
  if (count < 2 || count > RIGID_PROFILE_POINTS) {
    return error_set(error, STATUS_INVALID, "/profile", "the profile has %d points\nfrom 2 to %d",
                     count, RIGID_PROFILE_POINTS);
  }
  enum status status = STATUS_OK;
  for (int i = 0; i < count && status == STATUS_OK; i++) {
    status = check_point(point, i, i > 0 && i < count - 1, error);
  }
  if (status == STATUS_OK && fabs(area_below(point, count)) < NEAREST * NEAREST) {
    status = error_set(error, STATUS_INVALID, "/profile",
                       "the profile encloses nothing with the axis\npoints [z, r] along the "
                       "outline, from one end to the other");
  }
  return status;
}

/* ---- corners ---------------------------------------------------------------------------- */

/* The centre of a circle of signed radius (> 0: in the body) that touches a piece at s. */
static void centre_at(const struct meridian_piece *piece, double s, double radius, double centre[2],
                      double tangent[2]) {
  meridian_piece_point(piece, s, centre, tangent);
  centre[0] += radius * tangent[1];
  centre[1] -= radius * tangent[0];
}

/* Newton's iteration for the places s[0] before and s[1] behind a corner where one circle touches
 * both pieces. */
static bool find_touching(const struct meridian_piece *piece, double radius, double s[2]) {
  double off = INFINITY;
  for (int k = 0; k < 40 && off > 1e-15 + 1e-13 * fabs(radius); k++) {
    double a[2], b[2], ta[2], tb[2];
    centre_at(&piece[0], s[0], radius, a, ta);
    centre_at(&piece[1], s[1], radius, b, tb);
    double ga = 1 - radius * piece[0].curvature, gb = 1 - radius * piece[1].curvature;
    double gap[2] = {b[0] - a[0], b[1] - a[1]}, cross = ta[0] * tb[1] - ta[1] * tb[0];
    off = hypot(gap[0], gap[1]);
    s[0] += (gap[0] * tb[1] - gap[1] * tb[0]) / (cross * ga);
    s[1] += (gap[0] * ta[1] - gap[1] * ta[0]) / (cross * gb);
    if (!(ga > 0 && gb > 0) || !isfinite(s[0] + s[1])) {
      return false;
    }
  }
  for (int i = 0; i < 2; i++) {
    double slack = 1e-9 * piece[i].length;
    if (!(s[i] >= -slack && s[i] <= piece[i].length + slack)) {
      return false;
    }
    s[i] = fmin(fmax(s[i], 0), piece[i].length);
  }
  return off < 1e-9;
}

bool profile_round(struct meridian_piece *piece, int *count, int at, double radius) {
  struct meridian_piece *corner = &piece[at - 1];
  double point[2], start[2], in[2], out[2];
  meridian_piece_point(&corner[0], corner[0].length, point, in);
  const double *go = corner[1].tangent;
  double angle = atan2(in[0] * go[1] - in[1] * go[0], in[0] * go[0] + in[1] * go[1]);
  if (fabs(angle) < 1e-7) {
    return true;
  }
  double side = angle < 0 ? 1 : -1, reach = radius * tan(0.5 * fabs(angle));
  double s[2] = {corner[0].length - reach, reach};
  if (!find_touching(corner, side * radius, s)) {
    return false;
  }
  meridian_piece_point(&corner[0], s[0], start, in);
  meridian_piece_point(&corner[1], s[1], point, out);
  angle = fabs(atan2(in[0] * out[1] - in[1] * out[0], in[0] * out[0] + in[1] * out[1]));
  struct meridian_piece before = corner[0], behind = corner[1];
  memmove(&piece[at + 1], &piece[at], sizeof *piece * (size_t)(*count - at));
  corner[0] = meridian_piece_make(before.start, before.tangent, before.curvature, s[0]);
  corner[1] = meridian_piece_make(start, in, side / radius, radius * angle);
  corner[2] = meridian_piece_make(point, out, behind.curvature, behind.length - s[1]);
  memcpy(corner[2].end, behind.end, sizeof behind.end);
  (*count)++;
  return true;
}

/* Rounds the corners between `from` and `to`, places in the chain before any is rounded. */
static enum status round_corners(struct meridian_piece *piece, int *count, int from, int to,
                                 double edge, struct error *error) {
  for (int at = to; edge > 0 && at >= from; at--) {
    if (!profile_round(piece, count, at, edge)) {
      return error_set(error, STATUS_INVALID, "/rim",
                       "an edge rounded by %g mm has no room at the corner (z %g mm, r %g mm) of "
                       "the profile\na smaller radius, or 0 for sharp edges",
                       1e3 * edge, 1e3 * piece[at].start[0], 1e3 * piece[at].start[1]);
    }
  }
  return STATUS_OK;
}

/* ---- crossings -------------------------------------------------------------------------- */

enum { PARTS_MAX = 12 };

static double side_of(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool segments_cross(const double (*a)[2], const double (*b)[2]) {
  return side_of(a[0], a[1], b[0]) * side_of(a[0], a[1], b[1]) < 0 &&
         side_of(b[0], b[1], a[0]) * side_of(b[0], b[1], a[1]) < 0;
}

/* Refuses a chain whose pieces, taken as segments of at most 15 degrees, cross. */
static enum status check_crossing(const struct meridian_piece *piece, int count,
                                  struct error *error) {
  double(*p)[2] = malloc(sizeof *p * ((size_t)count * PARTS_MAX + 1));
  enum status status = STATUS_OK;
  int points = 0;
  if (!p) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a profile");
  }
  memcpy(p[points++], piece[0].start, sizeof *p);
  for (int i = 0; i < count; i++) {
    /* What rounded corners leave of a line may be nothing. */
    if (piece[i].length < 1e-3 * NEAREST) {
      continue;
    }
    int parts = 1 + (int)(fabs(piece[i].curvature) * piece[i].length / (PI / 12));
    parts = parts < PARTS_MAX ? parts : PARTS_MAX;
    for (int k = 1; k <= parts; k++) {
      meridian_piece_point(&piece[i], piece[i].length * k / parts, p[points++], NULL);
    }
  }
  for (int i = 0; i < points - 1 && status == STATUS_OK; i++) {
    for (int j = i + 2; j < points - 1 && status == STATUS_OK; j++) {
      if (segments_cross((const double(*)[2]) & p[i], (const double(*)[2]) & p[j])) {
        status = error_set(error, STATUS_INVALID, "/profile",
                           "the profile crosses itself near z %g mm, r %g mm\npoints [z, r] in "
                           "order along the outline",
                           1e3 * p[j][0], 1e3 * p[j][1]);
      }
    }
  }
  free(p);
  return status;
}

/* ---- the whole -------------------------------------------------------------------------- */

/* Points as they are or in the other order, so that the body is on the right. */
static bool arrange(const double (*point)[2], int count, double (*arranged)[2]) {
  bool reverse = area_below(point, count) < 0;
  for (int i = 0; i < count; i++) {
    memcpy(arranged[i], point[reverse ? count - 1 - i : i], sizeof *arranged);
  }
  return reverse;
}

static enum status open_chain(const double (*p)[2], int count, bool reverse,
                              enum rigid_profile form, struct meridian_piece *piece, int *pieces,
                              struct error *error) {
  if (form == RIGID_PROFILE_SMOOTH) {
    return profile_curve(p, count, reverse ? count - 1 : 0, reverse ? -1 : 1, piece, pieces, error);
  }
  *pieces = count - 1;
  for (int i = 0; i < count - 1; i++) {
    piece[i] = meridian_piece_line(p[i], p[i + 1]);
  }
  return STATUS_OK;
}

enum status profile_pieces(const double (*point)[2], int count, enum rigid_profile form,
                           double edge, struct meridian_piece *piece, int *pieces,
                           struct error *error) {
  double p[RIGID_PROFILE_POINTS][2];
  enum status status = check_points(point, count, error);
  if (status == STATUS_OK && !(edge >= 0 && edge <= LARGEST)) {
    status = error_set(error, STATUS_INVALID, "/rim",
                       "the edges of the profile are rounded by %g mm\nfrom 0 (sharp) to what has "
                       "room\n\"1 mm\"",
                       1e3 * edge);
  }
  if (status != STATUS_OK) {
    return status;
  }
  bool reverse = arrange(point, count, p);
  bool base = p[0][1] > 0, top = p[count - 1][1] > 0;
  status = open_chain((const double(*)[2])p, count, reverse, form, piece + base, pieces, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (base) {
    piece[0] = meridian_piece_line((double[2]){p[0][0], 0}, p[0]);
  }
  *pieces += base;
  if (top) {
    piece[*pieces] = meridian_piece_line(p[count - 1], (double[2]){p[count - 1][0], 0});
  }
  *pieces += top;
  if (form == RIGID_PROFILE_STRAIGHT) {
    status = round_corners(piece, pieces, 1, *pieces - 1, edge, error);
  } else {
    status = top ? round_corners(piece, pieces, *pieces - 1, *pieces - 1, edge, error) : status;
    if (base && status == STATUS_OK) {
      status = round_corners(piece, pieces, 1, 1, edge, error);
    }
  }
  return status == STATUS_OK ? check_crossing(piece, *pieces, error) : status;
}
