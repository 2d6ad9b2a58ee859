#include "solver/rigid/skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/rigid/shape_internal.h"

#define PI 3.14159265358979323846

enum { PARTS_MIN = 12, PARTS_MAX = 360 };

void rigid_skin_release(struct rigid_skin *skin) {
  free(skin->vertex);
  free(skin->triangle);
  *skin = (struct rigid_skin){0};
}

static enum status allocate(struct rigid_skin *skin, size_t vertices, size_t triangles) {
  skin->vertex = malloc((vertices + 1) * sizeof(double[3]));
  skin->triangle = malloc((triangles + 1) * sizeof(int[3]));
  return skin->vertex && skin->triangle ? STATUS_OK : STATUS_NO_MEMORY;
}

static int add_vertex(struct rigid_skin *skin, double x, double y, double z) {
  double *at = skin->vertex + 3 * (size_t)skin->vertex_count;
  at[0] = x;
  at[1] = y;
  at[2] = z;
  return skin->vertex_count++;
}

/* Adds a triangle unless two of its corners are one. */
static void add_triangle(struct rigid_skin *skin, int a, int b, int c) {
  if (a != b && b != c && c != a) {
    int *at = skin->triangle + 3 * (size_t)skin->triangle_count++;
    at[0] = a;
    at[1] = b;
    at[2] = c;
  }
}

/* Parts of a full circle whose chords leave it by no more than `tolerance`. */
static int circle_parts(double radius, double tolerance) {
  double sagitta = fmin(fmax(tolerance / radius, 1e-9), 1);
  double parts = ceil(PI / acos(1 - sagitta));
  return (int)fmin(fmax(parts, PARTS_MIN), PARTS_MAX);
}

/* ---- bodies of revolution --------------------------------------------------------------- */

static int piece_parts(const struct meridian_piece *piece, double tolerance) {
  double angle = fabs(piece->curvature) * piece->length;
  return angle < 1e-9
             ? 1
             : (int)ceil(circle_parts(fabs(1 / piece->curvature), tolerance) * angle / (2 * PI) -
                         1e-9);
}

/* One vertex on the axis, or a ring; returns the first. */
static int add_ring(struct rigid_skin *skin, const double point[2], int around) {
  int first = skin->vertex_count;
  for (int j = 0; j < (point[1] > 0 ? around : 1); j++) {
    double angle = 2 * PI * j / around;
    add_vertex(skin, point[1] * cos(angle), point[1] * sin(angle), point[0]);
  }
  return first;
}

static enum status skin_revolution(const struct meridian *meridian, double tolerance,
                                   struct rigid_skin *skin) {
  int around = circle_parts(meridian->high[1], tolerance), rings = 1;
  for (int i = 0; i < meridian->count; i++) {
    rings += piece_parts(&meridian->piece[i], tolerance);
  }
  if (allocate(skin, (size_t)rings * (size_t)around, 2 * (size_t)rings * (size_t)around) !=
      STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  double last[2] = {meridian->piece[0].start[0], 0};
  int before = add_ring(skin, last, around);
  for (int i = 0; i < meridian->count; i++) {
    const struct meridian_piece *piece = &meridian->piece[i];
    int parts = piece_parts(piece, tolerance);
    for (int k = 1; k <= parts; k++) {
      double point[2];
      bool end = i == meridian->count - 1 && k == parts, pole = last[1] == 0;
      meridian_piece_point(piece, piece->length * k / parts, point, NULL);
      point[1] = end ? 0 : point[1];
      int ring = add_ring(skin, point, around);
      for (int j = 0; j < around; j++) {
        int on = (j + 1) % around, a = pole ? before : before + j, b = pole ? before : before + on;
        int c = end ? ring : ring + j, d = end ? ring : ring + on;
        add_triangle(skin, a, b, c);
        add_triangle(skin, c, b, d);
      }
      before = ring;
      memcpy(last, point, sizeof last);
    }
  }
  return STATUS_OK;
}

/* ---- boxes ------------------------------------------------------------------------------ */

/* The surface of a lattice of `side` points each way; m parts of each quarter of a circle's half.
 */
struct lattice {
  const struct rounded_box *box;
  int m, side;
  int *vertex; /* by place in the lattice, -1 where there is none yet */
};

static int lattice_vertex(struct lattice *lattice, const int at[3], struct rigid_skin *skin) {
  const struct rounded_box *box = lattice->box;
  int place[3], m = lattice->m;
  double direction[3], length = 0, x[3];
  for (int i = 0; i < 3; i++) {
    /* Both lines in the middle are one where the box has no flat part. */
    bool upper = at[i] > m;
    place[i] = at[i] == m + 1 && box->core[i] == 0 ? m : at[i];
    direction[i] = m == 0 ? (upper ? 1 : -1) : tan(PI / 4 * (at[i] - m - upper) / m);
    length += direction[i] * direction[i];
    x[i] = upper ? box->core[i] : -box->core[i];
  }
  int *vertex = &lattice->vertex[(place[0] * lattice->side + place[1]) * lattice->side + place[2]];
  if (*vertex < 0) {
    double scale = box->edge / sqrt(length);
    *vertex = add_vertex(skin, x[0] + scale * direction[0], x[1] + scale * direction[1],
                         x[2] + scale * direction[2]);
  }
  return *vertex;
}

static enum status skin_box(const struct rounded_box *box, double tolerance,
                            struct rigid_skin *skin) {
  int m = box->edge > 0 ? (circle_parts(box->edge, tolerance) + 7) / 8 : 0, side = 2 * m + 2;
  size_t places = (size_t)side * (size_t)side * (size_t)side;
  size_t squares = 6 * (size_t)(side - 1) * (size_t)(side - 1);
  struct lattice lattice = {box, m, side, malloc(places * sizeof *lattice.vertex)};
  if (!lattice.vertex || allocate(skin, 6 * (size_t)side * (size_t)side, 2 * squares)) {
    free(lattice.vertex);
    return STATUS_NO_MEMORY;
  }
  for (size_t i = 0; i < places; i++) {
    lattice.vertex[i] = -1;
  }
  for (size_t n = 0; n < squares; n++) {
    int face = (int)(n % 6), axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3, corner[4];
    int i = (int)(n / 6) % (side - 1), j = (int)(n / 6) / (side - 1);
    for (int k = 0; k < 4; k++) {
      int at[3];
      at[axis] = face % 2 ? side - 1 : 0;
      at[u] = i + (k == 1 || k == 2);
      at[v] = j + (k >= 2);
      corner[k] = lattice_vertex(&lattice, at, skin);
    }
    int b = face % 2 ? 1 : 3, d = face % 2 ? 3 : 1;
    add_triangle(skin, corner[0], corner[b], corner[2]);
    add_triangle(skin, corner[0], corner[2], corner[d]);
  }
  free(lattice.vertex);
  return STATUS_OK;
}

/* ---- the others ------------------------------------------------------------------------- */

static enum status skin_plane(double extent, struct rigid_skin *skin) {
  if (allocate(skin, 4, 2) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  add_vertex(skin, -extent, -extent, 0);
  add_vertex(skin, extent, -extent, 0);
  add_vertex(skin, extent, extent, 0);
  add_vertex(skin, -extent, extent, 0);
  add_triangle(skin, 0, 1, 2);
  add_triangle(skin, 0, 2, 3);
  return STATUS_OK;
}

static enum status skin_surface(const struct surface *surface, struct rigid_skin *skin) {
  size_t vertices = (size_t)surface->vertex_count, triangles = (size_t)surface->triangle_count;
  if (allocate(skin, vertices, triangles) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  memcpy(skin->vertex, surface->x, vertices * sizeof(double[3]));
  memcpy(skin->triangle, surface->triangle, triangles * sizeof(int[3]));
  skin->vertex_count = surface->vertex_count;
  skin->triangle_count = surface->triangle_count;
  return STATUS_OK;
}

enum status rigid_shape_skin(const struct rigid_shape *shape, double tolerance, double extent,
                             struct rigid_skin *skin, struct error *error) {
  enum status status;
  *skin = (struct rigid_skin){0};
  switch (shape->kind) {
  case RIGID_PLANE:
    status = skin_plane(extent, skin);
    break;
  case RIGID_BOX:
    status = skin_box(&shape->box, tolerance, skin);
    break;
  case RIGID_SURFACE:
    status = skin_surface(&shape->surface, skin);
    break;
  default:
    status = skin_revolution(&shape->meridian, tolerance, skin);
  }
  if (status != STATUS_OK) {
    rigid_skin_release(skin);
    error_set(error, status, NULL, "no memory for the triangles of a rigid object");
  }
  return status;
}
