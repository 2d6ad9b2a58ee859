/* The surface that can touch: its faces, points and planes; sums over all points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/contact_internal.h"
#include "solver/base/vec3.h"

/* Reference areas of the 9 points of every face, from `point` on. */
static void fill_points(const struct contact *contact, struct contact_point *point) {
  for (int f = 0; f < contact->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(contact->mesh, &contact->face[f].face, nodes);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double a[3] = {0}, b[3] = {0}, normal[3];
      for (int m = 0; m < QUAD9_NODES; m++) {
        for (int i = 0; i < 3; i++) {
          a[i] += contact->tables->dn[q][0][m] * contact->mesh->x[3 * nodes[m] + i];
          b[i] += contact->tables->dn[q][1][m] * contact->mesh->x[3 * nodes[m] + i];
        }
      }
      vec3_cross(a, b, normal);
      *point++ =
          (struct contact_point){.area = contact->tables->weight[q] * vec3_norm(normal),
                                 .xi = {contact->tables->point[q][0], contact->tables->point[q][1]},
                                 .pair = -1};
    }
  }
}

/* Place of a face in a list of all six faces of every element. */
static size_t face_key(const struct mesh_face *face) {
  return 6 * (size_t)face->element + 2 * (size_t)face->axis + (face->side > 0);
}

/* Lists the outer faces and those of the base, slaves of the gaps first, and the pairs across gaps.
 * `listed` has six places an element. */
static void list_faces(struct contact *contact, unsigned char *listed) {
  const struct mesh *mesh = contact->mesh;
  int gaps = mesh->facing_count;
  for (int p = 0; p < 2 * gaps; p++) {
    const struct mesh_facing *facing = &mesh->facing[p % gaps];
    const struct mesh_face *face = p < gaps ? &facing->slave : &facing->master;
    contact->face[contact->face_count++] = (struct contact_face){*face, p < gaps ? 1 : -1};
    listed[face_key(face)] = 1;
  }
  for (int p = 0; p < gaps; p++) {
    contact->pair[p] = (struct contact_pair){p, gaps + p};
  }
  contact->pair_count = gaps;
  for (int f = 0; f < mesh->face_count; f++) {
    bool outside = mesh->faces[f].kind == FACE_OUTER || mesh->faces[f].kind == FACE_BASE;
    if (outside && !listed[face_key(&mesh->faces[f])]) {
      contact->face[contact->face_count++] = (struct contact_face){mesh->faces[f], 0};
    }
  }
}

enum status contact_init(struct contact *contact, const struct mesh *mesh,
                         const struct quad9_tables *tables, struct error *error) {
  *contact = (struct contact){.mesh = mesh, .tables = tables};
  size_t faces = (size_t)mesh->face_count + 2 * (size_t)mesh->facing_count + 1;
  unsigned char *listed = calloc(6 * (size_t)mesh->element_count + 1, 1);
  contact->pair_capacity = mesh->facing_count + 1;
  contact->face = calloc(faces, sizeof *contact->face);
  contact->pair = calloc((size_t)contact->pair_capacity, sizeof *contact->pair);
  if (listed && contact->face && contact->pair) {
    list_faces(contact, listed);
    contact->point_count = QUAD9_POINTS * contact->face_count;
    contact->point = calloc((size_t)contact->point_count + 1, sizeof *contact->point);
  }
  free(listed);
  if (!contact->point) {
    contact_release(contact);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the contact of %d faces",
                     mesh->face_count);
  }
  fill_points(contact, contact->point);
  for (int i = 0; i < QUAD9_POINTS * mesh->facing_count; i++) {
    contact->point[i].pair = i / QUAD9_POINTS;
  }
  return STATUS_OK;
}

void contact_release(struct contact *contact) {
  contact_search_release(contact->search);
  free(contact->face);
  free(contact->pair);
  free(contact->point);
  *contact = (struct contact){0};
}

enum status contact_add_plane(struct contact *contact, const struct contact_plane *plane) {
  if (contact->plane_count == CONTACT_PLANES) {
    return STATUS_TOO_LARGE;
  }
  int points = contact->point_count + QUAD9_POINTS * contact->face_count;
  struct contact_point *point = realloc(contact->point, sizeof *point * ((size_t)points + 1));
  if (!point) {
    return STATUS_NO_MEMORY;
  }
  contact->point = point;
  fill_points(contact, point + contact->point_count);
  contact->point_count = points;
  struct contact_plane *added = &contact->plane[contact->plane_count++];
  *added = *plane;
  double length = vec3_norm(plane->normal);
  for (int i = 0; i < 3; i++) {
    added->normal[i] /= length;
  }
  return STATUS_OK;
}

void contact_nodes(const struct contact *contact, int pair, int nodes[CONTACT_NODES]) {
  const struct contact_pair *p = &contact->pair[pair];
  mesh_face_nodes(contact->mesh, &contact->face[p->slave].face, nodes);
  mesh_face_nodes(contact->mesh, &contact->face[p->master].face, nodes + QUAD9_NODES);
}

bool contact_folded(const struct contact *contact) {
  for (int i = 0; i < QUAD9_POINTS * contact->face_count; i++) {
    const struct contact_point *point = &contact->point[i];
    if (point->pair >= contact->mesh->facing_count && point->lambda > 0 &&
        contact->face[contact->pair[point->pair].slave].role <= 0) {
      return true;
    }
  }
  return false;
}

static void add_surface_point(const struct contact_point *point, struct contact_summary *s) {
  s->min_gap = fmin(s->min_gap, point->gap);
  if (point->traction > 0) {
    s->force += point->area * point->traction;
    s->area += point->area;
    s->max_traction = fmax(s->max_traction, point->traction);
  }
}

static void add_plane_point(const struct contact_plane *plane, const struct contact_point *point,
                            double force[3], struct contact_summary *s) {
  for (int i = 0; i < 3; i++) {
    force[i] += point->area * point->traction * plane->normal[i];
  }
  if (!plane->symmetry) {
    s->min_plane_gap = fmin(s->min_plane_gap, point->gap);
    s->max_traction = fmax(s->max_traction, point->traction);
  }
}

struct contact_summary contact_summarise(const struct contact *contact) {
  struct contact_summary s = {.min_gap = INFINITY, .min_plane_gap = INFINITY};
  int surface = QUAD9_POINTS * contact->face_count;
  for (int i = 0; i < contact->point_count; i++) {
    const struct contact_point *point = &contact->point[i];
    if (!point->valid) {
      continue;
    }
    s.active += point->traction > 0;
    s.penetration = fmax(s.penetration, -point->gap);
    if (i < surface) {
      add_surface_point(point, &s);
    } else {
      int plane = i / surface - 1;
      add_plane_point(&contact->plane[plane], point, s.plane_force[plane], &s);
    }
  }
  return s;
}

/* Aitken's factor for the next update, from this and the last t - lambda of all points. */
static double aitken_factor(const struct contact *contact, double last_factor) {
  double product = 0, square = 0;
  for (int i = 0; i < contact->point_count; i++) {
    const struct contact_point *point = &contact->point[i];
    double difference = point->traction - point->lambda - point->change;
    product += point->change * difference;
    square += difference * difference;
  }
  double factor = square > 0 ? -last_factor * product / square : 1;
  return fmax(1, fmin(10, factor));
}

double contact_update_multipliers(struct contact *contact, double *relaxation) {
  double largest = 0;
  *relaxation = *relaxation > 0 ? aitken_factor(contact, *relaxation) : 1;
  for (int i = 0; i < contact->point_count; i++) {
    struct contact_point *point = &contact->point[i];
    point->change = point->traction - point->lambda;
    largest = fmax(largest, fabs(point->change));
    point->lambda = fmax(0, point->lambda + *relaxation * point->change);
  }
  return largest;
}
