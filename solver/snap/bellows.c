#include "solver/snap/bellows.h"

#include <math.h>
#include <string.h>

/* Elements along a part: limits for bodies of odd proportions. */
enum { CELLS_MIN = 2, CELLS_MAX = 60 };

/* By how much elements at the edges of the PET are shorter than on average. */
static const double grading = 0.5;

struct bellows_fineness bellows_fineness(enum accuracy accuracy) {
  static const struct bellows_fineness table[] = {
      [ACCURACY_FAST] = {1, 1, 0.4},
      [ACCURACY_STANDARD] = {2, 1, 0.25},
      [ACCURACY_FINE] = {3, 2, 0.15},
  };
  return table[accuracy];
}

int bellows_node(const struct bellows *bellows, int row, int column) {
  return row * bellows->column_count + column;
}

/* ---- counting ----------------------------------------------------------------------------- */

static int cells(const struct snap_spec *spec, const struct bellows_fineness *fineness,
                 const struct meridian_part *part) {
  double wanted = ceil(part->length / (fineness->length * spec->wall) - 1e-9);
  return (int)fmin(fmax(wanted, CELLS_MIN), CELLS_MAX);
}

double bellows_boundary(const struct meridian_part *part, int cells, int cell) {
  double t = (double)cell / cells;
  if (part->edge[0] && part->edge[1]) {
    return t - grading * sin(2.0 * M_PI * t) / (2.0 * M_PI);
  }
  double sign = part->edge[1] ? 1.0 : part->edge[0] ? -1.0 : 0.0;
  return t + sign * grading * sin(M_PI * t) / M_PI;
}

/* ---- nodes -------------------------------------------------------------------------------- */

/* Distance of a column from the middle line, positive outwards. */
static double offset(const struct bellows *b, double wall, double core, int column) {
  int layers = b->core_from;
  double side = 0.5 * (wall - core);
  if (column <= b->core_from) {
    return -0.5 * wall + side * column / layers;
  }
  if (column <= b->core_to) {
    return core * ((double)(column - b->core_from) / (b->core_to - b->core_from) - 0.5);
  }
  return 0.5 * core + side * (column - b->core_to) / layers;
}

static void place_row(struct bellows *b, const struct snap_spec *spec,
                      const struct meridian_part *part, double s, int row) {
  double point[2], normal[2];
  meridian_point(part, s, point, normal);
  double wall = meridian_wall(spec, part, s), core = meridian_core(part, s);
  for (int j = 0; j < b->column_count; j++) {
    double *x = b->mesh.position + 2 * (size_t)bellows_node(b, row, j);
    double t = offset(b, wall, core, j);
    x[0] = point[0] + t * normal[0];
    x[1] = point[1] + t * normal[1];
  }
}

/* The rows of a part of `count` elements, whose first one is `row`. */
static void place_part(struct bellows *b, const struct snap_spec *spec,
                       const struct meridian_part *part, int count, int row) {
  for (int k = 0; k < count; k++) {
    double from = part->length * bellows_boundary(part, count, k);
    double to = part->length * bellows_boundary(part, count, k + 1);
    place_row(b, spec, part, from, row + 2 * k);
    place_row(b, spec, part, 0.5 * (from + to), row + 2 * k + 1);
    place_row(b, spec, part, to, row + 2 * k + 2);
  }
}

static void add_sheet(struct bellows *b, const struct meridian_part *part, int from, int to) {
  if (part->pet) {
    b->sheet[b->sheet_count++] = (struct bellows_sheet){part->pair, part->snapping, from, to};
  }
}

/* ---- elements ----------------------------------------------------------------------------- */

static void connect(struct bellows *b, int element, int row, int column, int region) {
  static const int place[AXI_NODES][2] = {{0, 0}, {0, 2}, {2, 2}, {2, 0}, {0, 1},
                                          {1, 2}, {2, 1}, {1, 0}, {1, 1}};
  struct axi_element *e = &b->mesh.element[element];
  e->region = region;
  for (int a = 0; a < AXI_NODES; a++) {
    e->node[a] = bellows_node(b, row + place[a][0], column + place[a][1]);
  }
}

static void connect_part(struct bellows *b, const struct meridian_part *part, int from, int to) {
  int layers = (b->column_count - 1) / 2;
  for (int row = from; row < to; row += 2) {
    int line = row / 2, last = b->column_count - 1;
    for (int l = 0; l < layers; l++) {
      bool inside = 2 * l >= b->core_from && 2 * l < b->core_to;
      connect(b, line * layers + l, row, 2 * l,
              part->pet && inside ? BELLOWS_PET : BELLOWS_SILICONE);
    }
    b->mesh.inner[line] = (struct axi_edge){
        {bellows_node(b, row + 2, 0), bellows_node(b, row, 0), bellows_node(b, row + 1, 0)}};
    b->mesh.outer[line] =
        (struct axi_edge){{bellows_node(b, row, last), bellows_node(b, row + 2, last),
                           bellows_node(b, row + 1, last)}};
  }
}

/* ---- ends --------------------------------------------------------------------------------- */

static void hold_ends(struct bellows *b, enum snap_ends ends) {
  struct axi_mesh *mesh = &b->mesh;
  for (int j = 0; j < b->column_count; j++) {
    int low = bellows_node(b, 0, j), high = bellows_node(b, b->row_count - 1, j);
    if (ends == SNAP_PLATES) {
      mesh->hold[2 * low] = mesh->hold[2 * low + 1] = mesh->hold[2 * high] = AXI_FIXED;
      mesh->hold[2 * high + 1] = AXI_PLATE;
    } else {
      mesh->hold[2 * high] = AXI_TIED;
      mesh->hold[2 * high + 1] = AXI_AHEAD;
      mesh->master[high] = low;
    }
  }
  if (ends == SNAP_PERIODIC) {
    mesh->hold[2 * bellows_node(b, 0, b->column_count / 2) + 1] = AXI_FIXED;
  }
}

/* ---- the whole ---------------------------------------------------------------------------- */

enum status bellows_create(const struct snap_spec *spec, const struct bellows_fineness *fineness,
                           struct bellows *b, struct error *error) {
  int layers = 2 * fineness->silicone + fineness->pet;
  memset(b, 0, sizeof *b);
  struct meridian *m = &b->line;
  meridian_build(spec, m);
  for (int i = 0; i < m->count; i++) {
    b->row[i + 1] = b->row[i] + 2 * cells(spec, fineness, &m->part[i]);
  }
  int lines = b->row[m->count] / 2;
  b->row_count = 2 * lines + 1;
  b->column_count = 2 * layers + 1;
  b->core_from = 2 * fineness->silicone;
  b->core_to = b->core_from + 2 * fineness->pet;
  enum status status = axi_mesh_create(b->row_count * b->column_count, lines * layers, lines, lines,
                                       &b->mesh, error);
  if (status != STATUS_OK) {
    return status;
  }
  b->mesh.region_count = BELLOWS_REGIONS;
  b->mesh.region[BELLOWS_SILICONE] = spec->silicone;
  b->mesh.region[BELLOWS_PET] = spec->pet;
  for (int i = 0; i < m->count; i++) {
    place_part(b, spec, &m->part[i], (b->row[i + 1] - b->row[i]) / 2, b->row[i]);
    connect_part(b, &m->part[i], b->row[i], b->row[i + 1]);
    add_sheet(b, &m->part[i], b->row[i], b->row[i + 1]);
  }
  hold_ends(b, spec->ends);
  return STATUS_OK;
}

void bellows_release(struct bellows *bellows) {
  axi_mesh_release(&bellows->mesh);
  memset(bellows, 0, sizeof *bellows);
}

/* ---- shells ------------------------------------------------------------------------------- */

static void current(const struct bellows *b, int node, const double *u, double x[2]) {
  for (int i = 0; i < 2; i++) {
    x[i] = b->mesh.position[2 * node + i] + (u ? u[2 * node + i] : 0.0);
  }
}

double bellows_shell_angle(const struct bellows *b, int pair, const double *u) {
  int middle = (b->column_count - 1) / 2;
  for (int s = 0; s < b->sheet_count; s++) {
    const struct bellows_sheet *sheet = &b->sheet[s];
    if (sheet->snapping && sheet->pair == pair) {
      double low[2], high[2];
      current(b, bellows_node(b, sheet->from, middle), u, low);
      current(b, bellows_node(b, sheet->to, middle), u, high);
      return atan2(high[1] - low[1], low[0] - high[0]);
    }
  }
  return NAN;
}

int bellows_inverted(const struct bellows *bellows, int pair_count, const double *u) {
  int count = 0;
  for (int k = 0; k < pair_count; k++) {
    count += bellows_shell_angle(bellows, k, u) < 0.0;
  }
  return count;
}
