/* Smooth curves through points: tangents without overshoot, and arcs between them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/rigid/profile.h"

#define PI 3.14159265358979323846
#define SQUARE_TURN (0.5 * PI)
#define PARALLEL 1e-9 /* rad: directions that are taken as equal */

/* Difference of two directions in (-pi, pi]. */
static double turn(double from, double to) {
  double angle = remainder(to - from, 2 * PI);
  return angle <= -PI ? angle + 2 * PI : angle;
}

static double chord_direction(const double a[2], const double b[2]) {
  return atan2(b[1] - a[1], b[0] - a[0]);
}

/* Direction at an inner point between chords: that of the circle through the three points, or the
 * one direction along or across the axis that lies between the chords. */
static enum status inner_direction(const double (*p)[2], int number, double *direction,
                                   struct error *error) {
  double before = chord_direction(p[-1], p[0]), angle = turn(before, chord_direction(p[0], p[1]));
  double low = fmin(before, before + angle) / SQUARE_TURN, high = low + fabs(angle) / SQUARE_TURN;
  double first = ceil(low - PARALLEL), last = floor(high + PARALLEL);
  if (last - first > 0.5) {
    char pointer[32];
    snprintf(pointer, sizeof pointer, "/profile/%d", number);
    return error_set(error, STATUS_INVALID, pointer,
                     "the profile turns by %.3g degrees at the point (z %g mm, r %g mm), past a "
                     "direction along and one across the axis\na smooth profile has more points "
                     "where it turns; one of straight lines may turn at once",
                     fabs(angle) * 180 / PI, 1e3 * p[0][0], 1e3 * p[0][1]);
  }
  if (last - first > -0.5) {
    *direction = first * SQUARE_TURN;
    return STATUS_OK;
  }
  double tangent[2], l1 = 0, l2 = 0;
  for (int i = 0; i < 2; i++) {
    l1 += (p[0][i] - p[-1][i]) * (p[0][i] - p[-1][i]);
    l2 += (p[1][i] - p[0][i]) * (p[1][i] - p[0][i]);
  }
  for (int i = 0; i < 2; i++) {
    tangent[i] = (p[0][i] - p[-1][i]) / l1 + (p[1][i] - p[0][i]) / l2;
  }
  *direction = atan2(tangent[1], tangent[0]);
  return STATUS_OK;
}

/* Direction at an end off the axis: that of the circle through both points with direction `inner`
 * at the other, but not beyond the directions along and across the axis. */
static double end_direction(double chord, double inner) {
  double angle = -turn(chord, inner);
  double low = floor(chord / SQUARE_TURN + PARALLEL) * SQUARE_TURN;
  double high = ceil(chord / SQUARE_TURN - PARALLEL) * SQUARE_TURN;
  return fmin(fmax(chord + angle, fmin(low, chord)), fmax(high, chord));
}

/* The arc from `start` with a tangent to `end`. */
static struct meridian_piece arc_to(const double start[2], const double tangent[2],
                                    const double end[2]) {
  double chord[2] = {end[0] - start[0], end[1] - start[1]}, length = hypot(chord[0], chord[1]);
  double half = atan2(tangent[0] * chord[1] - tangent[1] * chord[0],
                      tangent[0] * chord[0] + tangent[1] * chord[1]);
  if (fabs(half) < PARALLEL) {
    return meridian_piece_line(start, end);
  }
  struct meridian_piece piece =
      meridian_piece_make(start, tangent, -2 * sin(half) / length, length * half / sin(half));
  memcpy(piece.end, end, sizeof piece.end);
  return piece;
}

/* Arc, line, arc with arcs of equal radius: the line in direction `middle`. */
static int steep_rise(const double a[2], const double b[2], double from, double middle, double to,
                      struct meridian_piece *piece) {
  double s0 = middle > from ? 1 : -1, s1 = to > middle ? 1 : -1;
  double across[2] = {s0 * (sin(middle) - sin(from)) + s1 * (sin(to) - sin(middle)),
                      s0 * (cos(from) - cos(middle)) + s1 * (cos(middle) - cos(to))};
  double line[2] = {cos(middle), sin(middle)}, chord[2] = {b[0] - a[0], b[1] - a[1]};
  double determinant = across[0] * line[1] - across[1] * line[0];
  double radius = (chord[0] * line[1] - chord[1] * line[0]) / determinant;
  double length = (across[0] * chord[1] - across[1] * chord[0]) / determinant;
  piece[0] = meridian_piece_make(a, (double[2]){cos(from), sin(from)}, -s0 / radius,
                                 radius * fabs(middle - from));
  piece[1] = meridian_piece_make(piece[0].end, line, 0, length);
  piece[2] = meridian_piece_make(piece[1].end, line, -s1 / radius, radius * fabs(to - middle));
  memcpy(piece[2].end, b, sizeof piece[2].end);
  return 3;
}

/* The pieces between two neighbours with the directions there; returns their number. */
static int between(const double a[2], const double b[2], double from, double to,
                   struct meridian_piece *piece) {
  double chord = chord_direction(a, b), alpha = turn(chord, from), beta = turn(chord, to);
  if (fabs(alpha) < PARALLEL && fabs(beta) < PARALLEL) {
    piece[0] = meridian_piece_line(a, b);
    return 1;
  }
  /* Where both tangents are on one side of the chord, the curve crosses it in the middle. */
  double down = floor(chord / SQUARE_TURN + PARALLEL) * SQUARE_TURN - chord;
  double up = ceil(chord / SQUARE_TURN - PARALLEL) * SQUARE_TURN - chord;
  double room = alpha > 0 ? down : up, crossing = -0.5 * (alpha + beta);
  if (alpha * beta > 0 && fabs(crossing) > fabs(room)) {
    return steep_rise(a, b, chord + alpha, chord + 0.5 * room, chord + beta, piece);
  }
  double t0[2] = {cos(from), sin(from)}, t1[2] = {cos(to), sin(to)}, joint[2];
  double v[2] = {b[0] - a[0], b[1] - a[1]}, square = v[0] * v[0] + v[1] * v[1];
  double along = v[0] * (t0[0] + t1[0]) + v[1] * (t0[1] + t1[1]);
  double open = 2 * (1 - t0[0] * t1[0] - t0[1] * t1[1]);
  double reach = square / (along + sqrt(along * along + open * square));
  for (int i = 0; i < 2; i++) {
    joint[i] = 0.5 * (a[i] + b[i] + reach * (t0[i] - t1[i]));
  }
  piece[0] = arc_to(a, t0, joint);
  double end[2], tangent[2];
  meridian_piece_point(&piece[0], piece[0].length, end, tangent);
  piece[1] = arc_to(joint, tangent, b);
  return 2;
}

enum status profile_curve(const double (*point)[2], int count, int first, int step,
                          struct meridian_piece *piece, int *pieces, struct error *error) {
  double direction[RIGID_PROFILE_POINTS];
  int last = count - 1;
  for (int i = 1; i < last; i++) {
    enum status status = inner_direction(&point[i], first + i * step, &direction[i], error);
    if (status != STATUS_OK) {
      return status;
    }
  }
  double begin = chord_direction(point[0], point[1]);
  double end = chord_direction(point[last - 1], point[last]);
  bool lone = count == 2;
  direction[0] = point[0][1] == 0 ? SQUARE_TURN : lone ? begin : end_direction(begin, direction[1]);
  direction[last] = point[last][1] == 0 ? -SQUARE_TURN
                    : lone              ? end_direction(end, direction[0])
                                        : end_direction(end, direction[last - 1]);
  *pieces = 0;
  for (int i = 0; i < last; i++) {
    *pieces += between(point[i], point[i + 1], direction[i], direction[i + 1], piece + *pieces);
  }
  return STATUS_OK;
}
