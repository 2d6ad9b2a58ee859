#include "solver/fe/transfer.h"

#include <math.h>
#include <stdlib.h>

/* Where a cell of the fine axis lies in the coarse one: its cell, and the range of the parent
 * coordinate there. */
struct place {
  int cell;
  double low, high;
};

struct transfer {
  const struct fe_model *from, *to;
  const struct fe_state *state;
  struct fe_state *carried;
  struct place *place[3];
  int *element; /* of every coarse cell, -1 where it is empty */
  int *face;    /* contact face of every coarse element face, -1 for none */
};

static bool find_places(const struct mesh *from, const struct mesh *to, int axis,
                        struct place *place) {
  const double *coarse = from->line[axis], *fine = to->line[axis];
  int last = from->line_count[axis] - 2, cell = 0;
  double slack = 1e-9 * (coarse[last + 1] - coarse[0]);
  for (int c = 0; c < to->line_count[axis] - 1; c++) {
    double middle = 0.5 * (fine[c] + fine[c + 1]);
    while (cell < last && middle > coarse[cell + 1]) {
      cell++;
    }
    if (fine[c] < coarse[cell] - slack || fine[c + 1] > coarse[cell + 1] + slack) {
      return false;
    }
    double scale = 2 / (coarse[cell + 1] - coarse[cell]);
    place[c] = (struct place){cell, scale * (fine[c] - coarse[cell]) - 1,
                              scale * (fine[c + 1] - coarse[cell]) - 1};
  }
  return true;
}

static size_t cell_index(const struct mesh *mesh, const int cell[3]) {
  size_t rows = (size_t)mesh->line_count[1] - 1, columns = (size_t)mesh->line_count[2] - 1;
  return ((size_t)cell[0] * rows + (size_t)cell[1]) * columns + (size_t)cell[2];
}

static size_t face_index(int element, int axis, int side) {
  return 6 * (size_t)element + 2 * (size_t)axis + (side > 0);
}

static enum status prepare(struct transfer *t, struct error *error) {
  const struct mesh *from = t->from->mesh, *to = t->to->mesh;
  size_t cells = 1, faces = 6 * (size_t)from->element_count;
  for (int d = 0; d < 3; d++) {
    cells *= (size_t)from->line_count[d] - 1;
    t->place[d] = malloc(sizeof *t->place[d] * (size_t)to->line_count[d]);
  }
  t->element = malloc(sizeof *t->element * cells);
  t->face = malloc(sizeof *t->face * faces);
  if (!t->place[0] || !t->place[1] || !t->place[2] || !t->element || !t->face) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the finer mesh");
  }
  for (int d = 0; d < 3; d++) {
    if (!find_places(from, to, d, t->place[d])) {
      return error_set(error, STATUS_INTERNAL, NULL, "the finer mesh is not nested");
    }
  }
  for (size_t c = 0; c < cells; c++) {
    t->element[c] = -1;
  }
  for (int e = 0; e < from->element_count; e++) {
    t->element[cell_index(from, from->element_cell + 3 * e)] = e;
  }
  for (size_t f = 0; f < faces; f++) {
    t->face[f] = -1;
  }
  for (int f = 0; f < t->from->contact.face_count; f++) {
    const struct mesh_face *face = &t->from->contact.face[f].face;
    t->face[face_index(face->element, face->axis, face->side)] = f;
  }
  return STATUS_OK;
}

/* Coarse element around fine element e, and the fine one's box there; -1 when there is none. */
static int locate(const struct transfer *t, int e, double low[3], double high[3]) {
  int cell[3];
  for (int d = 0; d < 3; d++) {
    const struct place *place = &t->place[d][t->to->mesh->element_cell[3 * e + d]];
    cell[d] = place->cell;
    low[d] = place->low;
    high[d] = place->high;
  }
  return t->element[cell_index(t->from->mesh, cell)];
}

/* Centre and half extent of an element: the frame of its pressure field. */
static double pressure_frame(const struct mesh *mesh, int element, double centre[3]) {
  const int *nodes = mesh->element_nodes + HEX27_NODES * (size_t)element;
  double size = 0;
  for (int i = 0; i < 3; i++) {
    centre[i] = mesh->x[3 * nodes[HEX27_NODES / 2] + i];
    for (int a = 0; a < HEX27_NODES; a++) {
      size = fmax(size, fabs(mesh->x[3 * nodes[a] + i] - centre[i]));
    }
  }
  return size;
}

static void carry_element(const struct transfer *t, int e, int parent, const double low[3],
                          const double high[3]) {
  const int *to = t->to->mesh->element_nodes + HEX27_NODES * (size_t)e;
  const int *from = t->from->mesh->element_nodes + HEX27_NODES * (size_t)parent;
  for (int n = 0; n < HEX27_NODES; n++) {
    int step[3] = {n / 9, n / 3 % 3, n % 3};
    double xi[3], shape[HEX27_NODES];
    for (int d = 0; d < 3; d++) {
      xi[d] = low[d] + 0.5 * step[d] * (high[d] - low[d]);
    }
    hex27_shape(xi, shape, NULL);
    for (int i = 0; i < 3; i++) {
      double u = 0;
      for (int a = 0; a < HEX27_NODES; a++) {
        u += shape[a] * t->state->u[3 * from[a] + i];
      }
      t->carried->u[3 * to[n] + i] = u;
    }
  }
  double centre[3], parent_centre[3];
  double size = pressure_frame(t->to->mesh, e, centre);
  double parent_size = pressure_frame(t->from->mesh, parent, parent_centre);
  const double *p = t->state->p + ELEMENT_PRESSURES * (size_t)parent;
  double *out = t->carried->p + ELEMENT_PRESSURES * (size_t)e;
  out[0] = p[0];
  for (int i = 0; i < 3; i++) {
    out[0] += p[1 + i] * (centre[i] - parent_centre[i]) / parent_size;
    out[1 + i] = p[1 + i] * size / parent_size;
  }
}

/* Gauss point (0, 1, 2) nearest to a parent coordinate: they lie at 0 and +-0.775. */
static int nearest_point(double xi) {
  return xi < -0.3873 ? 0 : xi > 0.3873 ? 2 : 1;
}

static enum status carry_multipliers(const struct transfer *t, struct error *error) {
  const struct contact *to = &t->to->contact, *from = &t->from->contact;
  for (int f = 0; f < to->face_count; f++) {
    const struct mesh_face *face = &to->face[f].face;
    double low[3], high[3];
    int parent = locate(t, face->element, low, high);
    int other = parent < 0 ? -1 : t->face[face_index(parent, face->axis, face->side)];
    if (other < 0) {
      return error_set(error, STATUS_INTERNAL, NULL, "the surface of the finer mesh is not nested");
    }
    int a = (face->axis + 1) % 3, b = (face->axis + 2) % 3;
    for (int q = 0; q < QUAD9_POINTS; q++) {
      const double *xi = to->tables->point[q];
      int nearest = 3 * nearest_point(0.5 * (low[a] + high[a] + xi[0] * (high[a] - low[a]))) +
                    nearest_point(0.5 * (low[b] + high[b] + xi[1] * (high[b] - low[b])));
      for (int layer = 0; layer <= to->plane_count; layer++) {
        t->carried->lambda[QUAD9_POINTS * (layer * to->face_count + f) + q] =
            t->state->lambda[QUAD9_POINTS * (layer * from->face_count + other) + nearest];
      }
    }
  }
  return STATUS_OK;
}

enum status transfer_state(const struct fe_model *from, const struct fe_state *state,
                           const struct fe_model *to, struct fe_state *carried,
                           struct error *error) {
  struct transfer t = {.from = from, .to = to, .state = state, .carried = carried};
  enum status status = prepare(&t, error);
  for (int e = 0; e < to->mesh->element_count && status == STATUS_OK; e++) {
    double low[3], high[3];
    int parent = locate(&t, e, low, high);
    if (parent < 0) {
      status = error_set(error, STATUS_INTERNAL, NULL, "the finer mesh is another body");
      break;
    }
    carry_element(&t, e, parent, low, high);
  }
  if (status == STATUS_OK) {
    status = carry_multipliers(&t, error);
  }
  for (int d = 0; d < 3; d++) {
    free(t.place[d]);
  }
  free(t.element);
  free(t.face);
  return status;
}
