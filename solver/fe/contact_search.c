/* Who meets whom: partners of the surface points at a given state. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/box_tree.h"
#include "solver/fe/contact_internal.h"
#include "solver/fe/contact_projection.h"
#include "solver/base/vec3.h"

enum { CANDIDATES_MAX = 256 };

/* A partner across a gap of the mesh is kept until a point has slid this far past its edge. */
static const double xi_keep_facing = 1.25;
/* Faces met by bending: a little beyond the edge, so that no point falls between two faces. */
static const double xi_keep = 1.05;
static const double xi_take = 1.02;
/* A list of pairs must hold the points nearer than need_share of the reach; one that has to be made
 * anew takes those up to list_share, so that it lasts. */
static const double need_share = 0.1, list_share = 0.4;
/* Faces whose outward normals make a smaller angle than some 75 degrees look the same way. */
static const double same_direction = 0.25;

/* One surface face at one state. */
struct view {
  double x[QUAD9_NODES][3];
  double centre[3], normal[3];
  struct box box;
};

struct contact_search_data {
  struct view *rest; /* per face, undeformed */
  struct view *view; /* per face, now */
  struct box *box;   /* per face */
  int *partner;      /* per surface point: master face or -1 */
  double *xi;        /* per surface point: 2 */
  double *gap;       /* per surface point, m */
  int *first;        /* per face + 1: pairs beyond those of the gaps, ordered by slave */
  double intrusion;
};

void contact_search_release(struct contact_search_data *d) {
  if (!d) {
    return;
  }
  free(d->rest);
  free(d->view);
  free(d->box);
  free(d->partner);
  free(d->xi);
  free(d->gap);
  free(d->first);
  free(d);
}

static void look(const struct contact *c, const double *u, int face, struct view *v) {
  static const double middle[2] = {0, 0};
  int nodes[QUAD9_NODES];
  double n[QUAD9_NODES], dn[2][QUAD9_NODES], a[3] = {0}, b[3] = {0};
  mesh_face_nodes(c->mesh, &c->face[face].face, nodes);
  quad9_shape(middle[0], middle[1], n, dn, NULL);
  v->box = box_empty();
  memset(v->centre, 0, sizeof v->centre);
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      v->x[m][i] = c->mesh->x[3 * nodes[m] + i] + (u ? u[3 * nodes[m] + i] : 0);
      v->centre[i] += n[m] * v->x[m][i];
      a[i] += dn[0][m] * v->x[m][i];
      b[i] += dn[1][m] * v->x[m][i];
    }
    box_include(&v->box, v->x[m]);
  }
  vec3_cross(a, b, v->normal);
  double length = vec3_norm(v->normal) * c->face[face].face.side;
  for (int i = 0; i < 3; i++) {
    v->normal[i] /= length;
  }
}

static struct contact_search_data *search_create(const struct contact *c) {
  struct contact_search_data *d = calloc(1, sizeof *d);
  if (!d) {
    return NULL;
  }
  size_t faces = (size_t)c->face_count + 1;
  d->rest = malloc(sizeof *d->rest * faces);
  d->view = malloc(sizeof *d->view * faces);
  d->box = malloc(sizeof *d->box * faces);
  d->partner = malloc(sizeof *d->partner * QUAD9_POINTS * faces);
  d->xi = malloc(sizeof *d->xi * 2 * QUAD9_POINTS * faces);
  d->gap = malloc(sizeof *d->gap * QUAD9_POINTS * faces);
  d->first = calloc(faces + 1, sizeof *d->first);
  if (!d->rest || !d->view || !d->box || !d->partner || !d->xi || !d->gap || !d->first) {
    contact_search_release(d);
    return NULL;
  }
  for (int f = 0; f < c->face_count; f++) {
    look(c, NULL, f, &d->rest[f]);
  }
  return d;
}

/* Which of two faces carries the points: across a gap of the mesh as listed there; elsewhere the
 * one nearer the tip, whose edges would slip between the points of the other. */
static bool acts_on(const struct contact *c, int slave, int master) {
  int a = c->face[slave].role, b = c->face[master].role;
  if (a * b < 0) {
    return a > 0;
  }
  const struct mesh *mesh = c->mesh;
  int i = c->face[slave].face.element, j = c->face[master].face.element;
  if (mesh->section_count > 0) {
    int s = mesh->node_section[mesh->element_nodes[HEX27_NODES * i]];
    int t = mesh->node_section[mesh->element_nodes[HEX27_NODES * j]];
    if (s != t) {
      return s > t;
    }
  }
  return i > j;
}

static bool share_node(const struct contact *c, int f, int g) {
  int a[QUAD9_NODES], b[QUAD9_NODES];
  mesh_face_nodes(c->mesh, &c->face[f].face, a);
  mesh_face_nodes(c->mesh, &c->face[g].face, b);
  for (int i = 0; i < QUAD9_NODES * QUAD9_NODES; i++) {
    if (a[i / QUAD9_NODES] == b[i % QUAD9_NODES]) {
      return true;
    }
  }
  return false;
}

static double ahead(const struct view *from, const double x[3]) {
  double d[3] = {x[0] - from->centre[0], x[1] - from->centre[1], x[2] - from->centre[2]};
  return vec3_dot(d, from->normal);
}

/* Two sides of one wall look away from each other at rest and stay within its thickness: they
 * never touch, though each is "behind" the other. */
static bool through_wall(const struct contact *c, const struct view *f, const struct view *g) {
  double d[3] = {f->centre[0] - g->centre[0], f->centre[1] - g->centre[1],
                 f->centre[2] - g->centre[2]};
  bool see = ahead(f, g->centre) > 0 && ahead(g, f->centre) > 0;
  struct box near = box_inflate(&f->box, 2 * c->reach);
  return !see && (box_overlaps(&near, &g->box) || vec3_norm(d) < 4 * c->reach);
}

/* Faces that `slave` may meet, ascending. */
static int find_candidates(const struct contact *c, const struct box_tree *tree, int slave,
                           int *list) {
  const struct contact_search_data *d = c->search;
  int found[CANDIDATES_MAX], count = 0;
  struct box box = box_inflate(&d->view[slave].box, c->reach);
  int all = box_tree_find(tree, &box, found, CANDIDATES_MAX);
  for (int k = 0; k < all && k < CANDIDATES_MAX; k++) {
    int g = found[k];
    if (g != slave && acts_on(c, slave, g) &&
        vec3_dot(d->view[slave].normal, d->view[g].normal) < same_direction &&
        !share_node(c, slave, g) && !through_wall(c, &d->rest[slave], &d->rest[g])) {
      list[count++] = g;
    }
  }
  return count;
}

static void point_position(const struct contact *c, int face, int q, double x[3]) {
  const struct view *v = &c->search->view[face];
  memset(x, 0, 3 * sizeof *x);
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      x[i] += c->tables->n[q][m] * v->x[m][i];
    }
  }
}

/* Gap of x to face g within `limit` of its parent square, started at xi; INFINITY when outside. */
static double gap_to(const struct contact *c, int g, const double x[3], double limit,
                     double xi[2]) {
  struct projection p;
  double normal[3];
  if (!projection_find(c->search->view[g].x, x, xi, &p) || fabs(xi[0]) > limit ||
      fabs(xi[1]) > limit) {
    return INFINITY;
  }
  return projection_gap(&p, c->face[g].face.side, normal);
}

/* Keeps the partner of point i when its last evaluation found it good, and returns true. */
static bool keep_partner(const struct contact *c, int i) {
  struct contact_search_data *d = c->search;
  const struct contact_point *point = &c->point[i];
  if (point->pair < 0 || !point->valid) {
    return false;
  }
  bool facing = point->pair < c->mesh->facing_count;
  double limit = facing ? xi_keep_facing : xi_keep;
  d->partner[i] = c->pair[point->pair].master;
  memcpy(d->xi + 2 * i, point->xi, sizeof point->xi);
  d->gap[i] = point->gap;
  return fabs(point->xi[0]) < limit && fabs(point->xi[1]) < limit &&
         (facing || fabs(point->gap) < c->reach);
}

/* Nearest of the candidates for point i. A point on the slave side of a gap falls back on the
 * face across. */
static void choose_partner(const struct contact *c, int i, const int *list, int count) {
  struct contact_search_data *d = c->search;
  int face = i / QUAD9_POINTS;
  double x[3], best = c->reach;
  point_position(c, face, i % QUAD9_POINTS, x);
  d->partner[i] = c->face[face].role > 0 ? c->pair[face].master : -1;
  memcpy(d->xi + 2 * i, c->point[i].xi, 2 * sizeof *d->xi);
  d->gap[i] = INFINITY;
  for (int k = 0; k < count; k++) {
    struct box reach = box_inflate(&d->view[list[k]].box, best);
    struct box here = {{x[0], x[1], x[2]}, {x[0], x[1], x[2]}};
    double xi[2] = {0, 0};
    if (!box_overlaps(&reach, &here)) {
      continue;
    }
    double gap = gap_to(c, list[k], x, xi_take, xi);
    if (fabs(gap) < best) {
      best = fabs(gap);
      d->gap[i] = gap;
      d->partner[i] = list[k];
      memcpy(d->xi + 2 * i, xi, sizeof xi);
      d->intrusion = fmax(d->intrusion, -gap);
    }
  }
}

static void choose_partners(const struct contact *c, const struct box_tree *tree, int face) {
  int list[CANDIDATES_MAX], count = -1;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    int i = QUAD9_POINTS * face + q;
    if (keep_partner(c, i)) {
      continue;
    }
    if (count < 0) {
      count = find_candidates(c, tree, face, list);
    }
    choose_partner(c, i, list, count);
  }
}

/* Number of the pair (slave, master), -1 when it is not listed. */
static int pair_index(const struct contact *c, int slave, int master) {
  if (c->face[slave].role > 0 && c->pair[slave].master == master) {
    return slave;
  }
  for (int p = c->search->first[slave]; p < c->search->first[slave + 1]; p++) {
    if (c->pair[p].master == master) {
      return p;
    }
  }
  return -1;
}

static bool add_pair(struct contact *c, int slave, int master) {
  if (c->pair_count == c->pair_capacity) {
    int capacity = 2 * c->pair_capacity;
    struct contact_pair *pair = realloc(c->pair, sizeof *pair * (size_t)capacity);
    if (!pair) {
      return false;
    }
    c->pair = pair;
    c->pair_capacity = capacity;
  }
  c->pair[c->pair_count++] = (struct contact_pair){slave, master};
  return true;
}

/* Whether point i has a partner nearer than `share` of the reach, or presses on one. */
static bool near_partner(const struct contact *c, int i, double share) {
  const struct contact_search_data *d = c->search;
  return d->partner[i] >= 0 && (d->gap[i] < share * c->reach || c->point[i].lambda > 0);
}

/* Makes the list of pairs anew from the partners: those that are near by now. */
static bool list_pairs(struct contact *c) {
  struct contact_search_data *d = c->search;
  c->pair_count = c->mesh->facing_count;
  for (int f = 0; f < c->face_count; f++) {
    d->first[f] = d->first[f + 1] = c->pair_count;
    for (int i = QUAD9_POINTS * f; i < QUAD9_POINTS * (f + 1); i++) {
      if (near_partner(c, i, list_share) && pair_index(c, f, d->partner[i]) < 0) {
        if (!add_pair(c, f, d->partner[i])) {
          return false;
        }
        d->first[f + 1] = c->pair_count;
      }
    }
  }
  return true;
}

/* Every point takes over its partner, if they are a listed pair. */
static void assign_points(struct contact *c) {
  struct contact_search_data *d = c->search;
  for (int i = 0; i < QUAD9_POINTS * c->face_count; i++) {
    struct contact_point *point = &c->point[i];
    point->pair = d->partner[i] >= 0 ? pair_index(c, i / QUAD9_POINTS, d->partner[i]) : -1;
    memcpy(point->xi, d->xi + 2 * i, sizeof point->xi);
    if (point->pair < 0) {
      point->valid = false;
      point->traction = 0;
    }
  }
}

/* Whether all points that are about to touch have their pair in the list. */
static bool pairs_listed(const struct contact *c) {
  const struct contact_search_data *d = c->search;
  for (int i = 0; i < QUAD9_POINTS * c->face_count; i++) {
    if (near_partner(c, i, need_share) && pair_index(c, i / QUAD9_POINTS, d->partner[i]) < 0) {
      return false;
    }
  }
  return true;
}

enum status contact_search(struct contact *c, const double *u, bool *changed) {
  *changed = false;
  if (!c->search) {
    c->search = search_create(c);
    if (!c->search) {
      return STATUS_NO_MEMORY;
    }
    for (int f = 0; f <= c->face_count; f++) {
      c->search->first[f] = c->mesh->facing_count;
    }
  }
  struct contact_search_data *d = c->search;
  for (int f = 0; f < c->face_count; f++) {
    look(c, u, f, &d->view[f]);
    d->box[f] = d->view[f].box;
  }
  struct box_tree *tree = box_tree_create(d->box, c->face_count);
  if (!tree) {
    return STATUS_NO_MEMORY;
  }
  d->intrusion = 0;
  for (int f = 0; f < c->face_count; f++) {
    choose_partners(c, tree, f);
  }
  box_tree_destroy(tree);
  if (!pairs_listed(c)) {
    *changed = true;
    if (!list_pairs(c)) {
      return STATUS_NO_MEMORY;
    }
  }
  assign_points(c);
  return STATUS_OK;
}

double contact_intrusion(const struct contact *c) {
  return c->search ? c->search->intrusion : 0;
}
