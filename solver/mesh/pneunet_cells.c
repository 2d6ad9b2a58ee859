/* How many cells go through each feature of a pneu-net. */
#include <math.h>
#include "solver/mesh/pneunet.h"

/* The rule of an accuracy tier. The lengths of first and last cells grade the mesh towards the
 * inner corners, where the stress is singular. */
struct tier {
  struct pneunet_cells cells;        /* least numbers, and grading */
  double cavity, half_width, height; /* longest cell, relative to the extent given below */
  double bottom;
};

/* |y| where the stretch of the lateral axis between channel or stem and side wall begins. */
static double inner_start(const struct pneunet_spec *p) {
  return pneunet_detached(p) ? p->stem : p->has_channel ? 0.5 * p->channel_width : 0;
}

/* z where the stretch of the vertical axis below the top wall begins. */
static double cavity_floor(const struct pneunet_spec *p) {
  return p->bottom_layer + (pneunet_detached(p) ? p->slit + p->slit_floor : 0);
}

#define PLAIN                                                                                      \
  { .cells = 1 }
#define COMMON                                                                                     \
  .gap = PLAIN, .channel = PLAIN, .stem = PLAIN, .below = PLAIN, .duct = PLAIN, .cover = PLAIN,    \
  .slit = PLAIN, .floor = PLAIN, .cavity = PLAIN, .half_width = PLAIN, .bottom = PLAIN,            \
  .height = PLAIN
static const struct tier tiers[] = {
    [ACCURACY_FAST] = {.cells = {COMMON, .gap_wall = {.cells = 2}, .side_wall = PLAIN,
                                 .top = PLAIN},
                       .cavity = .35,
                       .half_width = .7,
                       .bottom = .45,
                       .height = .33},
    [ACCURACY_STANDARD] = {.cells = {COMMON, .gap_wall = {.cells = 2}, .side_wall = PLAIN,
                                     .top = PLAIN},
                           .cavity = .35,
                           .half_width = .7,
                           .bottom = .45,
                           .height = .22},
    [ACCURACY_FINE] = {.cells = {COMMON, .gap_wall = {.cells = 2}, .side_wall = {.cells = 2},
                                 .top = {.cells = 2}},
                       .cavity = .18,
                       .half_width = .24,
                       .bottom = .2,
                       .height = .11},
};

/* A number given by the job makes equal cells. */
static void choose(int given, struct grid_division *division) {
  if (given > 0) {
    *division = (struct grid_division){.cells = given};
  }
}

/* Raises the number of cells until none is longer than `size`. */
static void limit(double extent, double size, struct grid_division *division) {
  int cells = (int)fmin(40, ceil(extent / size - 0.05));
  division->cells = cells > division->cells ? cells : division->cells;
}

struct pneunet_cells pneunet_resolution(const struct job_spec *spec) {
  const struct tier *tier = &tiers[spec->accuracy];
  const struct pneunet_spec *p = &spec->pneunet;
  struct pneunet_cells cells = tier->cells;
  double h = p->height_base;
  limit(p->cavity_length, tier->cavity * h, &cells.cavity);
  limit(0.5 * p->width - p->side_wall - inner_start(p), tier->half_width * h, &cells.half_width);
  limit(p->bottom_layer, tier->bottom * h, &cells.bottom);
  limit(h - p->top_wall - cavity_floor(p), tier->height * h, &cells.height);
  choose(spec->mesh.gap_wall, &cells.gap_wall);
  choose(spec->mesh.cavity, &cells.cavity);
  choose(spec->mesh.gap, &cells.gap);
  choose(spec->mesh.half_width, &cells.half_width);
  choose(spec->mesh.side_wall, &cells.side_wall);
  choose(spec->mesh.bottom, &cells.bottom);
  choose(spec->mesh.height, &cells.height);
  choose(spec->mesh.top, &cells.top);
  return cells;
}

void pneunet_refine(struct pneunet_cells *cells) {
  cells->gap_wall.split = 2;
  cells->half_width.split = 2;
  cells->height.split = 2;
}
