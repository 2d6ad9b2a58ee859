#include "solver/mesh/pneunet_map.h"

#include <math.h>
#include "solver/mesh/pneunet.h"

double pneunet_height(const struct pneunet_spec *p, double x) {
  double height = p->height_base + (p->height_tip - p->height_base) * x / p->length;
  return height - x * (tan(p->taper_top) + tan(p->taper_bottom));
}

/* The place in a stretch of length `now`, at the base `base`, of what is at `place` at the base:
 * `below` of the stretch at its start and `above` of it at its end keep their thickness, the rest
 * is scaled. */
static double squeeze(double place, double base, double now, double below, double above) {
  if (place <= below) {
    return place;
  }
  if (place >= base - above) {
    return now - (base - place);
  }
  return below + (place - below) * (now - below - above) / (base - below - above);
}

/* Solid layers under the cavities. */
static double floor_height(const struct pneunet_spec *p) {
  return p->bottom_layer + (pneunet_detached(p) ? p->slit + p->slit_floor : 0);
}

double pneunet_bottom(const struct pneunet_spec *p, double x) {
  double height = pneunet_height(p, x);
  double scale = p->scaled_walls ? height / p->height_base : 1;
  return x * tan(p->taper_bottom) + scale * p->bottom_layer;
}

double pneunet_gap_width(const struct pneunet_spec *p, double z) {
  double share = 1;
  if (p->gap_shape == GAP_U && z < p->gap_round) {
    double below = 1 - fmax(z, 0) / p->gap_round;
    share = sqrt(1 - below * below);
  } else if (p->gap_shape == GAP_V || p->gap_shape == GAP_TRAPEZOIDAL) {
    share = fmax(z, 0) / (p->height_base - p->bottom_layer);
  }
  return p->gap_root + (p->chamber_gap - p->gap_root) * share;
}

/* Share of a wall's shear at distance `off` from the middle of its gap: whole at the gap, none at
 * the cavity. In the gap it falls to none in the middle. */
static double wall_share(const struct pneunet_spec *p, double off) {
  double half = 0.5 * p->chamber_gap;
  return off < half ? off / half : fmax(0, 1 - (off - half) / p->gap_wall);
}

/* How far a point moves along x for the shape of the gap it is nearest to. */
static double gap_shift(const struct pneunet_map *map, const double grid_point[3]) {
  const struct pneunet_spec *p = map->p;
  if (p->gap_shape == GAP_RECTANGULAR || map->gap_count == 0) {
    return 0;
  }
  int nearest = 0;
  while (nearest + 1 < map->gap_count &&
         2 * grid_point[0] > map->gap[nearest] + map->gap[nearest + 1]) {
    nearest++;
  }
  double off = grid_point[0] - map->gap[nearest];
  double height = grid_point[2] - p->bottom_layer;
  double shift = 0.5 * (pneunet_gap_width(p, height) - p->chamber_gap) * wall_share(p, fabs(off));
  double fade = fmax(0, fmin(1, grid_point[2] / p->bottom_layer));
  return off < 0 ? -fade * shift : fade * shift;
}

double pneunet_lateral(const struct pneunet_spec *p, double y, double x) {
  double side = 0.5 * p->width, angle = y > 0 ? p->taper_left : p->taper_right;
  double wall = p->scaled_walls ? 0 : p->side_wall;
  return copysign(squeeze(fabs(y), side, side - x * tan(angle), 0, wall), y);
}

/* Share of the suckers' displacement at y and z: whole on the bottom face and below, none above
 * the bottom layer nor in the channel. */
static double sucker_share(const struct pneunet_spec *p, double y, double z) {
  double end = p->bottom_layer;
  if (p->has_channel) {
    double below = p->bottom_layer - p->channel_cover - p->channel_height;
    double beside = fmax(0, fmin(1, 2 * fabs(y) / p->channel_width - 1));
    end = below + beside * (p->bottom_layer - below);
  }
  return fmax(0, 1 - fmax(0, z) / end);
}

/* Displacement in the plane of a point of the grid that makes the suckers round; *depth receives
 * the depth of the sucker at its place, or is left alone. */
static void sucker_shift(const struct pneunet_map *map, const double grid_point[3], double *depth,
                         double shift[2]) {
  const struct pneunet_spec *p = map->p;
  double x = grid_point[0], y = grid_point[1], side = y < 0 ? -1 : 1;
  const struct sucker_frame *f = suckers_frame(&map->suckers, x);
  shift[0] = shift[1] = 0;
  if (f) {
    const double line[3] = {fabs(pneunet_lateral(p, side * f->inner_y, x)),
                            fabs(pneunet_lateral(p, side * f->outer_y, x)),
                            fabs(pneunet_lateral(p, side * 0.5 * p->width, x))};
    double share = sucker_share(p, y, grid_point[2]);
    suckers_displace(f, x, pneunet_lateral(p, y, x), line, shift);
    shift[0] *= share;
    shift[1] *= share;
    *depth = f->depth;
  }
}

void pneunet_map_point(const void *context, const double grid_point[3], double x[3]) {
  const struct pneunet_map *map = context;
  const struct pneunet_spec *p = map->p;
  double shift[2], depth = map->suckers.depth;
  sucker_shift(map, grid_point, &depth, shift);
  double z = grid_point[2] < 0 ? grid_point[2] * depth / map->suckers.depth : grid_point[2];
  double at = grid_point[0] + gap_shift(map, grid_point);
  x[0] = at + shift[0];
  x[1] = pneunet_lateral(p, grid_point[1], at) + shift[1];
  x[2] = x[0] * tan(p->taper_bottom) + squeeze(z, p->height_base, pneunet_height(p, x[0]),
                                               p->scaled_walls ? 0 : floor_height(p),
                                               p->scaled_walls ? 0 : p->top_wall);
}
