/* How many cells go through each feature of a pneu-net. */
#include <math.h>
#include "solver/mesh/pneunet.h"

/* The rule of an accuracy tier, found by measurement on bodies of many proportions
 * (tests/bench/bench_error.c). First and last cells of other lengths grade the mesh towards the
 * inner corners, where the stress is singular: the root of the walls above all. Graded so, one
 * cell through an axial wall is enough unless the wall is stocky or shared by two cavities. */
struct tier {
  struct pneunet_cells cells;
  double cavity, half_width; /* longest cell relative to the height of the cavity */
};

/* A cavity longer than this part of its height has stiff axial walls, which need more cells. */
static const double squat_ratio = 0.75;
/* So have walls thicker than this part of the cavity's length. */
static const double thick_ratio = 0.4;

/* Longest cell of a sucker's ring relative to its thickness. */
static const double sucker_ratio = 3;

/* What the tiers have in common; where a feature has one cell, its length changes little. */
#define PLAIN_CELLS                                                                                \
  .gap = {.cells = 1}, .stem = {.cells = 1}, .side_wall = {.cells = 1}, .below = {.cells = 1},     \
  .duct = {.cells = 1}, .cover = {.cells = 1}, .slit = {.cells = 1}, .floor = {.cells = 1},        \
  .top = {.cells = 1}, .sucker = {.cells = 1}

static const struct tier tiers[] = {
    [ACCURACY_DRAFT] = {{PLAIN_CELLS, .channel = {.cells = 1}, .gap_wall = {.cells = 1},
                         .cavity = {.cells = 1}, .half_width = {.cells = 1, .last = 0.25},
                         .bottom = {.cells = 2, .last = 0.4},
                         .height = {.cells = 3, .first = 0.2, .last = 0.6}},
                        .cavity = 1,
                        .half_width = 3},
    [ACCURACY_FAST] = {{PLAIN_CELLS, .channel = {.cells = 2}, .gap_wall = {.cells = 1},
                        .cavity = {.cells = 2}, .half_width = {.cells = 1, .last = 0.25},
                        .bottom = {.cells = 3, .last = 0.3},
                        .height = {.cells = 3, .first = 0.2, .last = 0.6}},
                       .cavity = 0.5,
                       .half_width = 3},
    [ACCURACY_STANDARD] = {{PLAIN_CELLS, .channel = {.cells = 2}, .gap_wall = {.cells = 1},
                            .cavity = {.cells = 2}, .half_width = {.cells = 2, .last = 0.25},
                            .bottom = {.cells = 3, .last = 0.3},
                            .height = {.cells = 3, .first = 0.2, .last = 0.6}},
                           .cavity = 0.5,
                           .half_width = 1.5},
    [ACCURACY_FINE] = {{.gap_wall = {.cells = 2},
                        .cavity = {.cells = 3, .first = 0.5, .last = 0.5},
                        .gap = {.cells = 2},
                        .channel = {.cells = 2},
                        .stem = {.cells = 2},
                        .half_width = {.cells = 3, .last = 0.3},
                        .side_wall = {.cells = 1},
                        .bottom = {.cells = 3, .last = 0.3},
                        .below = {.cells = 1},
                        .duct = {.cells = 1},
                        .cover = {.cells = 1},
                        .slit = {.cells = 1},
                        .floor = {.cells = 1},
                        .height = {.cells = 4, .first = 0.2, .last = 0.5},
                        .top = {.cells = 2},
                        .sucker = {.cells = 2}},
                       .cavity = 0.35,
                       .half_width = 1},
};

#undef PLAIN_CELLS

/* |y| where the stretch of the lateral axis between channel or stem and side wall begins. */
static double inner_start(const struct pneunet_spec *p) {
  return pneunet_detached(p) ? p->stem : p->has_channel ? 0.5 * p->channel_width : 0;
}

static double cavity_height(const struct pneunet_spec *p) {
  double floor = p->bottom_layer + (pneunet_detached(p) ? p->slit + p->slit_floor : 0);
  return p->height_base - p->top_wall - floor;
}

/* Whether a wall separates two cavities: one between neighbours of configuration A. */
static bool has_joint(const struct pneunet_spec *p) {
  int run = 0;
  while (run < p->run_count && (p->runs[run].config != CHAMBER_A || p->runs[run].count < 2)) {
    run++;
  }
  return run < p->run_count;
}

/* A number given by the job makes equal cells. */
static void choose(int given, struct grid_division *division) {
  if (given > 0) {
    *division = (struct grid_division){.cells = given};
  }
}

/* Raises the number of cells until none of equal ones is longer than `size`. */
static void limit(double extent, double size, struct grid_division *division) {
  static const double most = 40;
  int cells = (int)fmin(most, ceil(extent / size - 0.05));
  division->cells = cells > division->cells ? cells : division->cells;
}

struct pneunet_cells pneunet_resolution(const struct job_spec *spec) {
  const struct tier *tier = &tiers[spec->accuracy];
  const struct pneunet_spec *p = &spec->pneunet;
  struct pneunet_cells cells = tier->cells;
  double height = cavity_height(p);
  limit(p->cavity_length, tier->cavity * height, &cells.cavity);
  limit(0.5 * p->width - p->side_wall - inner_start(p), tier->half_width * height,
        &cells.half_width);
  if (spec->accuracy == ACCURACY_DRAFT) {
    /* the same cells whatever the proportions: designs stay neighbours for warm starts */
  } else if (p->cavity_length > squat_ratio * height) {
    cells.gap_wall.cells++;
    cells.height.cells++;
  } else if (spec->accuracy == ACCURACY_STANDARD &&
             (p->gap_wall > thick_ratio * p->cavity_length || has_joint(p))) {
    cells.gap_wall.cells++;
  }
  if (spec->accuracy == ACCURACY_STANDARD && has_joint(p) && cells.cavity.cells < 3) {
    cells.cavity = (struct grid_division){.cells = 3, .first = 0.5, .last = 0.5};
  }
  for (int k = 0; k < p->sucker_count; k++) {
    limit(p->sucker[k].depth, sucker_ratio * p->sucker[k].wall, &cells.sucker);
  }
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

void pneunet_refine(const struct job_spec *spec, struct pneunet_cells *cells) {
  cells->height.split = 2;
  if (spec->accuracy != ACCURACY_FINE) { /* whose walls have two cells: memory goes first */
    cells->gap_wall.split = 2;
  }
}
