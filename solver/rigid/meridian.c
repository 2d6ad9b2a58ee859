#include "solver/rigid/meridian.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define SHORTEST 1e-9 /* m: pieces below it are left out */
#define SLACK 1e-9    /* relative: neighbours that go on smoothly overlap by it */

static void normal_of(const double tangent[2], double normal[2]) {
  normal[0] = -tangent[1];
  normal[1] = tangent[0];
}

void meridian_piece_point(const struct meridian_piece *piece, double s, double point[2],
                          double tangent[2]) {
  double normal[2], angle = piece->curvature * s;
  normal_of(piece->tangent, normal);
  /* Along and across, without cancellation for slight curvature. */
  double along = fabs(angle) < 1e-4 ? s * (1 - angle * angle / 6) : sin(angle) / piece->curvature;
  double half = sin(0.5 * angle);
  double across = piece->curvature == 0 ? 0 : -2 * half * half / piece->curvature;
  double c = cos(angle), d = sin(angle);
  for (int i = 0; i < 2; i++) {
    point[i] = piece->start[i] + along * piece->tangent[i] + across * normal[i];
    if (tangent) {
      tangent[i] = c * piece->tangent[i] - d * normal[i];
    }
  }
}

struct meridian_piece meridian_piece_make(const double start[2], const double tangent[2],
                                          double curvature, double length) {
  struct meridian_piece piece = {.start = {start[0], start[1]},
                                 .tangent = {tangent[0], tangent[1]},
                                 .curvature = curvature,
                                 .length = length};
  meridian_piece_point(&piece, length, piece.end, NULL);
  meridian_piece_point(&piece, 0.5 * length, piece.middle, piece.direction);
  piece.half = curvature == 0 ? 0.5 * length : sin(0.5 * curvature * length) / curvature;
  return piece;
}

struct meridian_piece meridian_piece_line(const double start[2], const double end[2]) {
  double chord[2] = {end[0] - start[0], end[1] - start[1]}, length = hypot(chord[0], chord[1]);
  struct meridian_piece piece =
      meridian_piece_make(start, (double[2]){chord[0] / length, chord[1] / length}, 0, length);
  memcpy(piece.end, end, sizeof piece.end);
  return piece;
}

static void include(struct meridian *meridian, const double point[2]) {
  for (int i = 0; i < 2; i++) {
    meridian->low[i] = fmin(meridian->low[i], point[i]);
    meridian->high[i] = fmax(meridian->high[i], point[i]);
  }
}

/* Enlarges the box by a piece: its ends, and where an arc is extreme in z or r. */
static void include_piece(struct meridian *meridian, const struct meridian_piece *piece) {
  include(meridian, piece->start);
  include(meridian, piece->end);
  for (int i = 0; i < 4 && piece->curvature != 0; i++) {
    double normal[2], out[2] = {i == 0 ? 1 : i == 1 ? -1 : 0, i == 2 ? 1 : i == 3 ? -1 : 0};
    normal_of(piece->direction, normal);
    double across = out[0] * normal[0] + out[1] * normal[1];
    double along = out[0] * piece->direction[0] + out[1] * piece->direction[1];
    if (across * piece->curvature >= 0 && fabs(along) <= fabs(piece->half * piece->curvature)) {
      double radius = fabs(1 / piece->curvature);
      include(meridian,
              (double[2]){piece->middle[0] - normal[0] / piece->curvature + radius * out[0],
                          piece->middle[1] - normal[1] / piece->curvature + radius * out[1]});
    }
  }
}

/* Whether a piece goes on from the direction in which the one before ends. */
static bool turns(const struct meridian_piece *before, const struct meridian_piece *piece) {
  double point[2], end[2];
  meridian_piece_point(before, before->length, point, end);
  return fabs(end[0] * piece->tangent[1] - end[1] * piece->tangent[0]) > 1e-7 ||
         end[0] * piece->tangent[0] + end[1] * piece->tangent[1] < 0;
}

enum status meridian_init(struct meridian *meridian, const struct meridian_piece *piece,
                          int count) {
  *meridian = (struct meridian){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
  meridian->piece = malloc(sizeof *piece * ((size_t)count + 1));
  if (!meridian->piece) {
    return STATUS_NO_MEMORY;
  }
  const struct meridian_piece *before = NULL;
  for (int i = 0; i < count; i++) {
    if (piece[i].length > SHORTEST) {
      struct meridian_piece *added = &meridian->piece[meridian->count++];
      *added = piece[i];
      added->corner = before && turns(before, added);
      include_piece(meridian, added);
      before = &piece[i];
    }
  }
  return STATUS_OK;
}

void meridian_release(struct meridian *meridian) {
  free(meridian->piece);
  *meridian = (struct meridian){0};
}

/* ---- the nearest point ------------------------------------------------------------------ */

/* What is known in the half plane: signed distance, normal, curvature along the meridian. */
struct flat {
  double distance, normal[2], curvature;
};

/* The foot inside a piece, if it has one, and is nearer than what is known. Seen from the middle of
 * the piece, so that slight curvature loses no digits, and none at all is no exception. */
static void try_piece(const struct meridian_piece *piece, const double q[2], struct flat *best) {
  const double *t = piece->direction, k = piece->curvature;
  double u[2] = {q[0] - piece->middle[0], q[1] - piece->middle[1]};
  double along = u[0] * t[0] + u[1] * t[1], across = u[1] * t[0] - u[0] * t[1];
  double power = 2 * across + k * (along * along + across * across);
  double rho = sqrt(fmax(1 + k * power, 0)); /* distance from the centre in radii */
  double distance = power / (1 + rho);
  if (fabs(along) > (1 + SLACK) * piece->half * rho || 1 + k * across < -SLACK ||
      fabs(distance) >= fabs(best->distance)) {
    return;
  }
  if (rho < 1e-200) { /* the centre: every direction is as good */
    *best = (struct flat){distance, {-t[1], t[0]}, 0};
    return;
  }
  *best = (struct flat){distance, {(k * u[0] - t[1]) / rho, (k * u[1] + t[0]) / rho}, k / rho};
}

/* The corner at which a piece begins; outside of it the surface is a circle of no radius. */
static void try_corner(const struct meridian_piece *piece, const double q[2], struct flat *best) {
  double u[2] = {q[0] - piece->start[0], q[1] - piece->start[1]}, end[2], point[2];
  double distance = sqrt(u[0] * u[0] + u[1] * u[1]);
  if (distance >= fabs(best->distance) || distance < 1e-300) {
    return;
  }
  meridian_piece_point(piece - 1, piece[-1].length, point, end);
  double mean[2] = {-end[1] - piece->tangent[1], end[0] + piece->tangent[0]};
  double side = u[0] * mean[0] + u[1] * mean[1] < 0 ? -1 : 1;
  *best = (struct flat){
      side * distance, {side * u[0] / distance, side * u[1] / distance}, side / distance};
}

bool meridian_nearest(const struct meridian *meridian, const double x[3], double reach,
                      struct rigid_nearest *nearest) {
  double r = sqrt(x[0] * x[0] + x[1] * x[1]), q[2] = {x[2], r};
  struct flat best = {.distance = INFINITY};
  for (int i = 0; i < meridian->count; i++) {
    try_piece(&meridian->piece[i], q, &best);
  }
  for (int i = 0; i < meridian->count; i++) {
    if (meridian->piece[i].corner) {
      try_corner(&meridian->piece[i], q, &best);
    }
  }
  if (!(best.distance <= reach)) {
    return false;
  }
  bool axis = r < 1e-12 * meridian->high[1];
  double out[3] = {axis ? 1 : x[0] / r, axis ? 0 : x[1] / r, 0};
  /* The gradient changes around the axis by its radial part; on the axis as along the meridian. */
  double around = axis ? best.curvature : best.normal[1] / r;
  double tangent[3] = {-best.normal[0] * out[0], -best.normal[0] * out[1], best.normal[1]};
  double hoop[3] = {-out[1], out[0], 0};
  *nearest = (struct rigid_nearest){
      .distance = best.distance,
      .normal = {best.normal[1] * out[0], best.normal[1] * out[1], best.normal[0]}};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      nearest->curvature[i][j] =
          best.curvature * tangent[i] * tangent[j] + around * hoop[i] * hoop[j];
    }
  }
  return true;
}

/* ---- volume and moments ----------------------------------------------------------------- */

/* Integrals over the body: 1, z, z2 and x2. */
struct moments {
  double volume, z, zz, xx;
};

/* Adds a part of a piece: what lies between it and the axis, counted along z. */
static void add_part(const struct meridian_piece *piece, double from, double to,
                     struct moments *sum) {
  static const double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363},
                      weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                   0.1012285362903763};
  for (int i = 0; i < 8; i++) {
    double place = i % 2 ? node[i / 2] : -node[i / 2], point[2], tangent[2];
    meridian_piece_point(piece, 0.5 * (from + to) + 0.5 * (to - from) * place, point, tangent);
    double z = point[0], square = point[1] * point[1];
    double slice = PI * square * tangent[0] * weight[i / 2] * 0.5 * (to - from);
    sum->volume += slice;
    sum->z += slice * z;
    sum->zz += slice * z * z;
    sum->xx += slice * 0.25 * square;
  }
}

void meridian_mass(const struct meridian *meridian, struct rigid_mass *mass) {
  struct moments sum = {0};
  for (int i = 0; i < meridian->count; i++) {
    const struct meridian_piece *piece = &meridian->piece[i];
    int parts = 1 + (int)(fabs(piece->curvature) * piece->length / (PI / 4));
    for (int k = 0; k < parts; k++) {
      add_part(piece, piece->length * k / parts, piece->length * (k + 1) / parts, &sum);
    }
  }
  double z = sum.z / sum.volume;
  double across = (sum.xx + sum.zz) / sum.volume - z * z, along = 2 * sum.xx / sum.volume;
  *mass = (struct rigid_mass){.volume = sum.volume,
                              .centroid = {0, 0, z},
                              .inertia = {across, 0, 0, 0, across, 0, 0, 0, along}};
}
