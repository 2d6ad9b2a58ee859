/* How many cells go through each feature of a body with oblique chambers. */
#include <math.h>
#include "solver/mesh/oblique.h"

/* The rule of an accuracy tier. The grading is that of the pneunet (pneunet_cells.c): towards the
 * root of the walls, where the stress is singular. */
struct tier {
  struct oblique_cells cells;
  double end; /* longest cell of a solid end, relative to the width */
};

#define PLAIN_CELLS                                                                                \
  .end = {.cells = 1}, .gap_wall = {.cells = 1}, .gap = {.cells = 1}, .centre = {.cells = 1},      \
  .inner = {.cells = 1}, .channel = {.cells = 1}, .outer = {.cells = 1},                           \
  .side_wall = {.cells = 1}, .below = {.cells = 1}, .duct = {.cells = 1}, .cover = {.cells = 1},   \
  .top = {.cells = 1}

static const struct tier tiers[] = {
    [ACCURACY_DRAFT] = {{PLAIN_CELLS, .cavity = {.cells = 1}, .row = {.cells = 1},
                         .bottom = {.cells = 2, .last = 0.4}, .height = {.cells = 2, .first = 0.4}},
                        .end = 0.6},
    [ACCURACY_FAST] = {{PLAIN_CELLS, .cavity = {.cells = 2}, .row = {.cells = 2},
                        .bottom = {.cells = 2, .last = 0.4}, .height = {.cells = 2, .first = 0.4}},
                       .end = 0.6},
    [ACCURACY_STANDARD] = {{PLAIN_CELLS, .cavity = {.cells = 3, .first = 0.5, .last = 0.5},
                            .row = {.cells = 3, .first = 0.5, .last = 0.5},
                            .bottom = {.cells = 3, .last = 0.3},
                            .height = {.cells = 3, .first = 0.2, .last = 0.6}},
                           .end = 0.4},
    [ACCURACY_FINE] = {{.end = {.cells = 2},
                        .gap_wall = {.cells = 2},
                        .cavity = {.cells = 3, .first = 0.5, .last = 0.5},
                        .gap = {.cells = 2},
                        .centre = {.cells = 1},
                        .inner = {.cells = 2},
                        .channel = {.cells = 2},
                        .outer = {.cells = 2},
                        .row = {.cells = 4, .first = 0.4, .last = 0.4},
                        .side_wall = {.cells = 1},
                        .bottom = {.cells = 3, .last = 0.3},
                        .below = {.cells = 1},
                        .duct = {.cells = 1},
                        .cover = {.cells = 1},
                        .height = {.cells = 4, .first = 0.2, .last = 0.5},
                        .top = {.cells = 2}},
                       .end = 0.3},
};

#undef PLAIN_CELLS

/* A number given by the job makes equal cells. */
static void choose(int given, struct grid_division *division) {
  if (given > 0) {
    *division = (struct grid_division){.cells = given};
  }
}

/* Cells of a row beside a channel: those that the job gives for the whole cavity, by their share of
 * its width. */
static void choose_row(int given, struct oblique_cells *cells) {
  choose(given, &cells->row);
  choose(given > 2 ? (given + 1) / 3 : given > 0, &cells->inner);
  choose(given > 2 ? (given + 1) / 3 : given > 0, &cells->channel);
  choose(given > 2 ? (given + 1) / 3 : given > 0, &cells->outer);
}

struct oblique_cells oblique_resolution(const struct job_spec *spec) {
  const struct tier *tier = &tiers[spec->accuracy];
  const struct oblique_spec *p = &spec->oblique;
  struct oblique_cells cells = tier->cells;
  double longest = p->end + 0.5 * p->width * tan(p->angle);
  int end = (int)fmin(40, ceil(longest / (tier->end * p->width) - 0.05));
  cells.end.cells = end > cells.end.cells ? end : cells.end.cells;
  choose(spec->mesh.gap_wall, &cells.gap_wall);
  choose(spec->mesh.cavity, &cells.cavity);
  choose(spec->mesh.gap, &cells.gap);
  choose_row(spec->mesh.half_width, &cells);
  choose(spec->mesh.side_wall, &cells.side_wall);
  choose(spec->mesh.bottom, &cells.bottom);
  choose(spec->mesh.height, &cells.height);
  choose(spec->mesh.top, &cells.top);
  return cells;
}

/* Most of the error sits in the bending of the gap walls and of the floors, along a row's cavity
 * and across it. */
void oblique_refine(struct oblique_cells *cells) {
  cells->cavity.split = 2;
  cells->row.split = 2;
  cells->inner.split = 2;
  cells->outer.split = 2;
}
