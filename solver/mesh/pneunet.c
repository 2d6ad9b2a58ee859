#include "solver/mesh/pneunet.h"

#include <math.h>
#include <stdlib.h>
#include "solver/mesh/pneunet_map.h"
#include "solver/mesh/stretch.h"

/* Features along the body, carrying the chamber's configuration. */
enum axial_tag {
  AXIAL_END,      /* wall at the base or the tip, where the channel stops */
  AXIAL_END_C,    /* the same, of a chamber of configuration C */
  AXIAL_WALL,     /* wall of a chamber of configuration A or B */
  AXIAL_WALL_C,   /* wall of a chamber of configuration C */
  AXIAL_JOINT,    /* the one wall between two chambers of configuration A */
  AXIAL_CAVITY,   /* cavity of a chamber of configuration A or B */
  AXIAL_CAVITY_C, /* cavity of a chamber of configuration C */
  AXIAL_GAP
};

/* Features across the body, by |y|. */
enum lateral_tag { LATERAL_CHANNEL, LATERAL_STEM, LATERAL_INNER, LATERAL_SIDE };

/* Features from the bottom face to the top. */
enum vertical_tag {
  VERTICAL_SUCKER, /* below the bottom face */
  VERTICAL_BOTTOM, /* bottom layer below the channel, or all of it without one */
  VERTICAL_CHANNEL,
  VERTICAL_COVER, /* bottom layer above the channel */
  VERTICAL_SLIT,  /* slit under chambers of configuration C */
  VERTICAL_FLOOR, /* floor of chambers of configuration C */
  VERTICAL_CAVITY,
  VERTICAL_TOP
};

static bool tag_is_void_axial(int tag) {
  return tag == AXIAL_CAVITY || tag == AXIAL_CAVITY_C;
}

static int pneunet_cell(const void *context, const int tag[3]) {
  const struct pneunet_map *map = context;
  const struct pneunet_spec *p = map->p;
  int axial = tag[0] % SUCKER_TAG, lateral = tag[1] % SUCKER_TAG, vertical = tag[2];
  bool over_channel = p->has_channel && lateral == LATERAL_CHANNEL;
  bool detached = axial == AXIAL_CAVITY_C || axial == AXIAL_WALL_C || axial == AXIAL_END_C;
  bool end = axial == AXIAL_END || axial == AXIAL_END_C;
  switch (vertical) {
  case VERTICAL_SUCKER:
    return suckers_solid(&map->suckers, tag[0], tag[1]) ? CELL_SOLID : CELL_EMPTY;
  case VERTICAL_BOTTOM:
    return CELL_SOLID;
  case VERTICAL_CHANNEL:
    return over_channel && !end ? CELL_CAVITY : CELL_SOLID;
  case VERTICAL_COVER:
    return over_channel && tag_is_void_axial(axial) ? CELL_CAVITY : CELL_SOLID;
  default:
    break;
  }
  if (axial == AXIAL_GAP) {
    return CELL_GAP;
  }
  if (vertical == VERTICAL_SLIT && detached && lateral != LATERAL_CHANNEL &&
      lateral != LATERAL_STEM) {
    return CELL_GAP;
  }
  if ((vertical == VERTICAL_SLIT || vertical == VERTICAL_FLOOR) && detached) {
    return over_channel && axial == AXIAL_CAVITY_C ? CELL_CAVITY : CELL_SOLID;
  }
  bool hollow = vertical != VERTICAL_TOP && lateral != LATERAL_SIDE && tag_is_void_axial(axial);
  return hollow ? CELL_CAVITY : CELL_SOLID;
}

bool pneunet_detached(const struct pneunet_spec *p) {
  bool detached = false;
  for (int r = 0; r < p->run_count; r++) {
    detached = detached || p->runs[r].config == CHAMBER_C;
  }
  return detached;
}

static enum chamber_config config_of(const struct pneunet_spec *p, int chamber) {
  int run = 0;
  while (chamber >= p->runs[run].count) {
    chamber -= p->runs[run++].count;
  }
  return p->runs[run].config;
}

/* Lines along the body; start[c] receives the place where chamber c starts, and
 * start[chamber_count] the end; the map receives the gaps. */
static enum status axial_lines(struct pneunet_map *map, const struct pneunet_cells *n,
                               struct grid_axis *axis, double *start) {
  const struct pneunet_spec *p = map->p;
  double x = 0;
  enum status status = grid_axis_extend(axis, 0, 0, 0);
  bool shared_wall = false;
  for (int c = 0; c < p->chamber_count && status == STATUS_OK; c++) {
    enum chamber_config config = config_of(p, c);
    bool last = c + 1 == p->chamber_count;
    bool joint = !last && config == CHAMBER_A && config_of(p, c + 1) == CHAMBER_A;
    int wall = config == CHAMBER_C ? AXIAL_WALL_C : AXIAL_WALL;
    int end = config == CHAMBER_C ? AXIAL_END_C : AXIAL_END;
    int cavity = config == CHAMBER_C ? AXIAL_CAVITY_C : AXIAL_CAVITY;
    start[c] = axis->line[axis->line_count - 1];
    struct stretch list[4];
    int count = 0;
    if (!shared_wall) {
      list[count++] = (struct stretch){x += p->gap_wall, &n->gap_wall, c == 0 ? end : wall};
    }
    list[count++] = (struct stretch){x += p->cavity_length, &n->cavity, cavity};
    int after = joint ? AXIAL_JOINT : last ? end : wall;
    list[count++] = (struct stretch){x += p->gap_wall, &n->gap_wall, after};
    if (!last && !joint) {
      map->gap[map->gap_count++] = x + 0.5 * p->chamber_gap;
      list[count++] = (struct stretch){x += p->chamber_gap, &n->gap, AXIAL_GAP};
    }
    status = stretch_extend(axis, list, count);
    shared_wall = joint;
  }
  start[p->chamber_count] = axis->line[axis->line_count - 1];
  return status;
}

/* Lines across the body: from 0 for a half model, mirrored about 0 otherwise. */
static enum status lateral_lines(const struct pneunet_spec *p, const struct pneunet_cells *n,
                                 bool half, bool detached, struct grid_axis *axis) {
  struct stretch list[4];
  int count = 0;
  if (p->has_channel) {
    list[count++] = (struct stretch){0.5 * p->channel_width, &n->channel, LATERAL_CHANNEL};
  }
  if (detached) {
    list[count++] = (struct stretch){p->stem, &n->stem, LATERAL_STEM};
  }
  double side = 0.5 * p->width;
  list[count++] = (struct stretch){side - p->side_wall, &n->half_width, LATERAL_INNER};
  list[count++] = (struct stretch){side, &n->side_wall, LATERAL_SIDE};
  enum status status = half ? grid_axis_extend(axis, 0, 0, 0) : stretch_mirror(axis, list, count);
  return status == STATUS_OK ? stretch_extend(axis, list, count) : status;
}

/* Lines from bottom to top; suckers go down to -depth. */
static enum status vertical_lines(const struct pneunet_spec *p, const struct pneunet_cells *n,
                                  double depth, bool detached, struct grid_axis *axis) {
  double b = p->bottom_layer, h = p->height_base;
  struct stretch below[4];
  int count = 0;
  below[count++] = (struct stretch){0, &n->sucker, VERTICAL_SUCKER};
  if (p->has_channel) {
    double ceiling = b - p->channel_cover;
    below[count++] = (struct stretch){ceiling - p->channel_height, &n->below, VERTICAL_BOTTOM};
    below[count++] = (struct stretch){ceiling, &n->duct, VERTICAL_CHANNEL};
    below[count++] = (struct stretch){b, &n->cover, VERTICAL_COVER};
  } else {
    below[count++] = (struct stretch){b, &n->bottom, VERTICAL_BOTTOM};
  }
  enum status status = grid_axis_extend(axis, -depth, 0, 0);
  if (status == STATUS_OK) {
    status = stretch_extend(axis, below, count);
  }
  struct stretch above[4];
  count = 0;
  if (detached) {
    above[count++] = (struct stretch){b + p->slit, &n->slit, VERTICAL_SLIT};
    above[count++] = (struct stretch){b + p->slit + p->slit_floor, &n->floor, VERTICAL_FLOOR};
  }
  above[count++] = (struct stretch){h - p->top_wall, &n->height, VERTICAL_CAVITY};
  above[count++] = (struct stretch){h, &n->top, VERTICAL_TOP};
  return status == STATUS_OK ? stretch_extend(axis, above, count) : status;
}

static int line_at(const struct grid_axis *axis, double x) {
  int line = 0;
  while (line + 1 < axis->line_count && 2 * x > axis->line[line] + axis->line[line + 1]) {
    line++;
  }
  return line;
}

/* Marks the nodes of the bottom layer, without suckers, and finds centreline and stations. */
static enum status mark_sections(const struct pneunet_map *map, const struct grid *grid,
                                 const double *start, struct mesh *mesh) {
  const struct pneunet_spec *p = map->p;
  const struct grid_axis *axis = grid->axis;
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * (size_t)n;
    double slack = 1e-9 * p->height_base;
    mesh->node_core[n] =
        x[2] <= pneunet_bottom(p, x[0]) + slack && x[2] >= x[0] * tan(p->taper_bottom) - slack;
  }
  for (int s = 0; s < mesh->section_count; s++) {
    double position =
        s % 2 ? 0.5 * (axis[0].line[s / 2] + axis[0].line[s / 2 + 1]) : axis[0].line[s / 2];
    double x[3];
    pneunet_map_point(map, (double[3]){position, 0, 0}, x);
    mesh->centreline[s] = grid_find_node(mesh, x, s);
  }
  mesh->station_count = p->chamber_count + 1;
  mesh->station = malloc(sizeof *mesh->station * (size_t)mesh->station_count);
  if (!mesh->station) {
    return STATUS_NO_MEMORY;
  }
  for (int s = 0; s < mesh->station_count; s++) {
    mesh->station[s] = 2 * line_at(&axis[0], start[s]);
  }
  return STATUS_OK;
}

/* Plans the suckers by the lines of the unsplit cells, which a finer mesh has as well, and puts
 * their lines into the axes. */
static enum status place_suckers(struct pneunet_map *map, const struct pneunet_cells *cells,
                                 bool half, struct grid *grid) {
  const struct pneunet_spec *p = map->p;
  struct pneunet_cells plain = *cells;
  struct pneunet_map unused = {.p = p};
  struct grid coarse = {0};
  double start[CHAMBERS_MAX + 1];
  if (p->sucker_count == 0) {
    return STATUS_OK;
  }
  plain.gap_wall.split = plain.cavity.split = plain.gap.split = 1;
  plain.channel.split = plain.stem.split = plain.half_width.split = plain.side_wall.split = 1;
  enum status status = axial_lines(&unused, &plain, &coarse.axis[0], start);
  if (status == STATUS_OK) {
    status = lateral_lines(p, &plain, half, pneunet_detached(p), &coarse.axis[1]);
  }
  if (status == STATUS_OK) {
    status = suckers_plan(p, &coarse.axis[0], &coarse.axis[1], &map->suckers);
  }
  if (status == STATUS_OK) {
    status = suckers_mark(&map->suckers, &grid->axis[0], &grid->axis[1]);
  }
  grid_release(&coarse);
  return status;
}

/* All lines of the grid. */
static enum status make_axes(struct pneunet_map *map, const struct pneunet_cells *cells, bool half,
                             struct grid *grid, double *start) {
  bool detached = pneunet_detached(map->p);
  enum status status = axial_lines(map, cells, &grid->axis[0], start);
  if (status == STATUS_OK) {
    status = lateral_lines(map->p, cells, half, detached, &grid->axis[1]);
  }
  if (status == STATUS_OK) {
    status = place_suckers(map, cells, half, grid);
  }
  return status == STATUS_OK
             ? vertical_lines(map->p, cells, map->suckers.depth, detached, &grid->axis[2])
             : status;
}

static double thinnest_wall(const struct pneunet_spec *p) {
  double wall = fmin(fmin(p->side_wall, p->gap_wall), p->top_wall);
  for (int k = 0; k < p->sucker_count; k++) {
    wall = fmin(wall, p->sucker[k].wall);
  }
  return wall;
}

enum status pneunet_mesh_cells(const struct job_spec *spec, const struct pneunet_cells *cells,
                               struct mesh *mesh, struct error *error) {
  const struct pneunet_spec *p = &spec->pneunet;
  struct grid grid = {0};
  struct pneunet_map map = {.p = p};
  double start[CHAMBERS_MAX + 1];
  enum status status = make_axes(&map, cells, spec->half_model, &grid, start);
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "no memory for the lines of the mesh");
    goto done;
  }
  status = grid_mesh(&grid, spec->half_model, pneunet_cell, pneunet_map_point, &map, mesh, error);
  if (status != STATUS_OK) {
    goto done;
  }
  if (mesh->facing_count > 0 && map.gap_count > 0) {
    mesh->gap_width = fmin(mesh->gap_width, pneunet_gap_width(p, 0));
  }
  mesh->wall_thickness = thinnest_wall(p);
  status = mark_sections(&map, &grid, start, mesh);
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "no memory for the stations of the mesh");
    mesh_release(mesh);
  }
done:
  suckers_release(&map.suckers);
  grid_release(&grid);
  return status;
}

enum status pneunet_mesh(const struct job_spec *spec, struct mesh *mesh, struct error *error) {
  struct pneunet_cells cells = pneunet_resolution(spec);
  return pneunet_mesh_cells(spec, &cells, mesh, error);
}
