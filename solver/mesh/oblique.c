#include "solver/mesh/oblique.h"

#include <math.h>
#include <stdlib.h>
#include "solver/mesh/stretch.h"

/* Features along the body. */
enum axial_tag { AXIAL_END, AXIAL_WALL, AXIAL_CAVITY, AXIAL_GAP };

/* Features across one row, by |y|. Those of the right row (y < 0) have the negative tag. */
enum lateral_tag {
  LATERAL_CENTRE = 1, /* wall between the rows */
  LATERAL_ROW,        /* cavity beside the channel */
  LATERAL_CHANNEL,    /* cavity over the channel */
  LATERAL_SIDE
};

/* Features from the bottom face to the top. */
enum vertical_tag {
  VERTICAL_BOTTOM, /* bottom layer below the channel, or all of it without one */
  VERTICAL_CHANNEL,
  VERTICAL_COVER, /* bottom layer above the channel */
  VERTICAL_CAVITY,
  VERTICAL_TOP
};

static int oblique_cell(const void *context, const int tag[3]) {
  const struct oblique_spec *p = context;
  int axial = tag[0], lateral = abs(tag[1]), vertical = tag[2];
  int cavity = tag[1] > 0 ? CELL_CAVITY : CELL_CAVITY + 1;
  bool hollow;
  switch (vertical) {
  case VERTICAL_BOTTOM:
    return CELL_SOLID;
  case VERTICAL_CHANNEL:
    hollow = lateral == LATERAL_CHANNEL && axial != AXIAL_END;
    break;
  case VERTICAL_COVER:
    hollow = lateral == LATERAL_CHANNEL && axial == AXIAL_CAVITY;
    break;
  default:
    if (axial == AXIAL_GAP) {
      return p->spine && lateral == LATERAL_CENTRE ? CELL_SOLID : CELL_GAP;
    }
    hollow = vertical == VERTICAL_CAVITY && axial == AXIAL_CAVITY &&
             (lateral == LATERAL_ROW || lateral == LATERAL_CHANNEL);
  }
  return hollow ? cavity : CELL_SOLID;
}

/* x at the side faces less x in the middle, where walls are oblique. */
static double lead(const struct oblique_spec *p) {
  return 0.5 * p->width * tan(p->angle);
}

/* x = xi + tan(angle) |y|, times xi/end in the solid end at the base and falling to 0 in that at
 * the tip. */
static void oblique_map(const void *context, const double grid_point[3], double x[3]) {
  const struct oblique_spec *p = context;
  double xi = grid_point[0], tip = p->end + lead(p);
  double share = fmin(1, fmin(xi / p->end, (p->length - xi) / tip));
  x[0] = xi + share * tan(p->angle) * fabs(grid_point[1]);
  x[1] = grid_point[1];
  x[2] = grid_point[2];
}

/* Lines along the body; station[c] receives the line where chamber c starts, station[0] that of the
 * base and station[chamber_count] the last line. */
static enum status axial_lines(const struct oblique_spec *p, const struct oblique_cells *n,
                               struct grid_axis *axis, int *station) {
  double along = 1 / cos(p->angle), x = p->end;
  enum status status = grid_axis_extend(axis, 0, 0, 0);
  station[0] = 0;
  if (status == STATUS_OK) {
    status = grid_axis_divide(axis, x, &n->end, AXIAL_END);
  }
  for (int c = 0; c < p->chamber_count && status == STATUS_OK; c++) {
    if (c > 0) {
      x += along * p->chamber_gap;
      status = grid_axis_divide(axis, x, &n->gap, AXIAL_GAP);
      station[c] = axis->line_count - 1;
    }
    struct stretch chamber[3];
    chamber[0] = (struct stretch){x += along * p->gap_wall, &n->gap_wall, AXIAL_WALL};
    chamber[1] = (struct stretch){x += along * p->cavity, &n->cavity, AXIAL_CAVITY};
    chamber[2] = (struct stretch){x += along * p->gap_wall, &n->gap_wall, AXIAL_WALL};
    status = status == STATUS_OK ? stretch_extend(axis, chamber, 3) : status;
  }
  struct grid_division end = {n->end.cells, n->end.last, n->end.first, n->end.split};
  if (status == STATUS_OK) {
    status = grid_axis_divide(axis, p->length, &end, AXIAL_END);
  }
  station[p->chamber_count] = axis->line_count - 1;
  return status;
}

/* Lines across the body: from 0 for a half model, mirrored about 0 otherwise. */
static enum status lateral_lines(const struct oblique_spec *p, const struct oblique_cells *n,
                                 bool half, struct grid_axis *axis) {
  double inside = 0.5 * p->centre_wall, outside = 0.5 * p->width - p->side_wall;
  double middle = 0.5 * (inside + outside);
  struct stretch list[5];
  int count = 0;
  list[count++] = (struct stretch){inside, &n->centre, LATERAL_CENTRE};
  if (p->has_channel) {
    double front = middle - 0.5 * p->channel_width, back = middle + 0.5 * p->channel_width;
    list[count++] = (struct stretch){front, &n->inner, LATERAL_ROW};
    list[count++] = (struct stretch){back, &n->channel, LATERAL_CHANNEL};
    list[count++] = (struct stretch){outside, &n->outer, LATERAL_ROW};
  } else {
    list[count++] = (struct stretch){outside, &n->row, LATERAL_ROW};
  }
  list[count++] = (struct stretch){0.5 * p->width, &n->side_wall, LATERAL_SIDE};
  enum status status = half ? grid_axis_extend(axis, 0, 0, 0) : STATUS_OK;
  if (!half) {
    status = stretch_mirror(axis, list, count);
    for (int c = 0; status == STATUS_OK && c + 1 < axis->line_count; c++) {
      axis->tag[c] = -axis->tag[c];
    }
  }
  return status == STATUS_OK ? stretch_extend(axis, list, count) : status;
}

/* Lines from bottom to top. */
static enum status vertical_lines(const struct oblique_spec *p, const struct oblique_cells *n,
                                  struct grid_axis *axis) {
  double b = p->bottom_layer, ceiling = b - p->channel_cover;
  struct stretch list[5];
  int count = 0;
  if (p->has_channel) {
    list[count++] = (struct stretch){ceiling - p->channel_height, &n->below, VERTICAL_BOTTOM};
    list[count++] = (struct stretch){ceiling, &n->duct, VERTICAL_CHANNEL};
    list[count++] = (struct stretch){b, &n->cover, VERTICAL_COVER};
  } else {
    list[count++] = (struct stretch){b, &n->bottom, VERTICAL_BOTTOM};
  }
  list[count++] = (struct stretch){p->height - p->top_wall, &n->height, VERTICAL_CAVITY};
  list[count++] = (struct stretch){p->height, &n->top, VERTICAL_TOP};
  enum status status = grid_axis_extend(axis, 0, 0, 0);
  return status == STATUS_OK ? stretch_extend(axis, list, count) : status;
}

/* Marks the nodes of the bottom layer, and finds centreline and stations. */
static enum status mark_sections(const struct oblique_spec *p, const struct grid *grid,
                                 const int *station, struct mesh *mesh) {
  const double *line = grid->axis[0].line;
  for (int n = 0; n < mesh->node_count; n++) {
    mesh->node_core[n] = mesh->x[3 * (size_t)n + 2] <= p->bottom_layer * (1 + 1e-9);
  }
  for (int s = 0; s < mesh->section_count; s++) {
    double x[3] = {s % 2 ? 0.5 * (line[s / 2] + line[s / 2 + 1]) : line[s / 2], 0, 0};
    mesh->centreline[s] = grid_find_node(mesh, x, s);
  }
  mesh->station_count = p->chamber_count + 1;
  mesh->station = malloc(sizeof *mesh->station * (size_t)mesh->station_count);
  for (int s = 0; mesh->station && s < mesh->station_count; s++) {
    mesh->station[s] = 2 * station[s];
  }
  return mesh->station ? STATUS_OK : STATUS_NO_MEMORY;
}

enum status oblique_mesh(const struct job_spec *spec, const struct oblique_cells *cells,
                         struct mesh *mesh, struct error *error) {
  const struct oblique_spec *p = &spec->oblique;
  struct grid grid = {0};
  int station[CHAMBERS_MAX + 1];
  enum status status = axial_lines(p, cells, &grid.axis[0], station);
  if (status == STATUS_OK) {
    status = lateral_lines(p, cells, spec->half_model, &grid.axis[1]);
  }
  if (status == STATUS_OK) {
    status = vertical_lines(p, cells, &grid.axis[2]);
  }
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "no memory for the lines of the mesh");
    goto done;
  }
  status = grid_mesh(&grid, spec->half_model, oblique_cell, oblique_map, p, mesh, error);
  if (status != STATUS_OK) {
    goto done;
  }
  mesh->wall_thickness = fmin(fmin(p->side_wall, p->gap_wall), fmin(p->top_wall, p->centre_wall));
  mesh->gap_width *= cos(p->angle);
  mesh->spatial = true;
  status = mark_sections(p, &grid, station, mesh);
  if (status != STATUS_OK) {
    error_set(error, status, NULL, "no memory for the stations of the mesh");
    mesh_release(mesh);
  }
done:
  grid_release(&grid);
  return status;
}
