#include "solver/grasp/conformity.h"

#include <math.h>
#include <stdlib.h>
#include "solver/base/vec3.h"
#include "solver/post/shape.h"
#include "solver/post/suction.h"

enum { SECTORS = 16 }; /* of a sucker's rim */

/* Part of the body's length over which the direction of its centreline is taken. */
static const double window = 1.0 / 24;

/* What touches in one section of the body. */
struct ring {
  double normal[3]; /* out of the object, summed by force */
  double force;     /* N */
};

static int section_of(const struct fe_model *m, int face) {
  int nodes[QUAD9_NODES];
  mesh_face_nodes(m->mesh, &m->contact.face[face].face, nodes);
  return m->mesh->node_section[nodes[4]];
}

/* Sums the points by sections; in a half model the mirror image of a normal cancels what lies
 * across. */
static double sum_points(const struct fe_model *m, const struct obstacle *o, struct ring *ring) {
  double force = 0, area = 0, square = 0;
  for (int f = 0; f < m->contact.face_count; f++) {
    int section = section_of(m, f);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      const struct obstacle_point *p = &o->point[QUAD9_POINTS * f + q];
      if (!(p->pressure > 0)) {
        continue;
      }
      double share = p->pressure * p->area;
      force += share;
      area += p->area;
      square += p->pressure * share;
      ring[section].force += share;
      for (int i = 0; i < 3; i++) {
        ring[section].normal[i] += m->mesh->half && i == 1 ? 0 : share * p->normal[i];
      }
    }
  }
  return square > 0 ? force * force / (area * square) : 0;
}

static double angle_between(const double a[3], const double b[3]) {
  double across[3];
  vec3_cross(a, b, across);
  return atan2(vec3_norm(across), vec3_dot(a, b));
}

static double sum_turns(const struct ring *ring, int count) {
  double sum = 0;
  const struct ring *last = NULL;
  for (int s = 0; s < count; s++) {
    if (ring[s].force > 0) {
      sum += last ? angle_between(last->normal, ring[s].normal) : 0;
      last = &ring[s];
    }
  }
  return sum;
}

/* Direction of the centreline `line` from point a to point b, and their distance. */
static double direction(const double *line, int a, int b, double out[3]) {
  for (int i = 0; i < 3; i++) {
    out[i] = line[3 * b + i] - line[3 * a + i];
  }
  double length = vec3_norm(out);
  for (int i = 0; i < 3; i++) {
    out[i] /= length > 0 ? length : 1;
  }
  return length;
}

/* The section at least `reach` away from s, towards `step`, or the last one there is. */
static int section_at(const double *line, int count, int s, int step, double reach) {
  double way = 0, unit[3];
  int at = s;
  while (way < reach && at + step >= 0 && at + step < count) {
    way += direction(line, at, at + step, unit);
    at += step;
  }
  return at;
}

/* Curvatures at section s: that of the body towards the object, and that of the object along it. */
static bool curvatures(const struct obstacle *o, const double *line, int count, int s, double reach,
                       double out[2]) {
  int before = section_at(line, count, s, -1, reach), after = section_at(line, count, s, 1, reach);
  double first[3], second[3], along[3];
  struct rigid_nearest near;
  if (before == s || after == s ||
      !rigid_shape_nearest_posed(o->shape, &o->pose, line + 3 * s, INFINITY, &near)) {
    return false;
  }
  double way = direction(line, before, s, first) + direction(line, s, after, second);
  direction(line, before, after, along);
  out[0] = out[1] = 0;
  for (int i = 0; i < 3; i++) {
    out[0] -= 2 * (second[i] - first[i]) / way * near.normal[i];
    out[1] += along[i] * vec3_dot(near.curvature[i], along);
  }
  return true;
}

static double match_of(const struct fe_model *m, const struct obstacle *o, const struct ring *ring,
                       const double *line) {
  int count = m->mesh->section_count;
  double apart = 0, scale = 0, unit[3], length = 0, k[2];
  for (int s = 1; s < count; s++) {
    length += direction(line, s - 1, s, unit);
  }
  for (int s = 0; s < count; s++) {
    if (ring[s].force > 0 && curvatures(o, line, count, s, window * length, k)) {
      apart += ring[s].force * fabs(k[0] - k[1]);
      scale += ring[s].force * fmax(fabs(k[0]), fabs(k[1]));
    }
  }
  return scale > 0 ? 1 - apart / scale : 0;
}

/* ---- suckers ------------------------------------------------------------------------------ */

/* Whether the face is the end of the rim of this sucker; then the sector in which its middle is. */
static bool on_rim(const struct mesh *mesh, const struct sucker_spec *sucker,
                   const struct mesh_face *face, int *sector) {
  int nodes[QUAD9_NODES];
  mesh_face_nodes(mesh, face, nodes);
  for (int n = 0; n < QUAD9_NODES; n++) {
    if (mesh->x[3 * nodes[n] + 2] > -0.999 * sucker->depth) {
      return false;
    }
  }
  const double *x = mesh->x + 3 * (size_t)nodes[4];
  double dx = x[0] - sucker->position;
  *sector = (int)floor(SECTORS * (0.5 + atan2(x[1], dx) / (2 * M_PI))) % SECTORS;
  return hypot(dx, x[1]) < 0.5 * sucker->diameter + 2 * sucker->wall;
}

static bool face_touches(const struct obstacle *o, int face) {
  bool touches = false;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    touches = touches || o->point[QUAD9_POINTS * face + q].pressure > 0;
  }
  return touches;
}

/* In every sector that has a part of the rim. */
bool conformity_sealed(const struct fe_model *m, const struct obstacle *o,
                       const struct sucker_spec *sucker) {
  bool there[SECTORS] = {false}, touches[SECTORS] = {false}, good = false;
  for (int f = 0; f < m->contact.face_count; f++) {
    int sector;
    if (on_rim(m->mesh, sucker, &m->contact.face[f].face, &sector)) {
      there[sector] = true;
      touches[sector] = touches[sector] || face_touches(o, f);
    }
  }
  for (int k = 0; k < SECTORS; k++) {
    if (there[k] && !touches[k]) {
      return false;
    }
    good = good || there[k];
  }
  return good;
}

enum status conformity_measure(const struct fe_model *m, const struct job_spec *spec, int index,
                               const double *u, struct conformity *conformity) {
  const struct obstacle *o = m->obstacle[index];
  int count = m->mesh->section_count;
  struct ring *ring = calloc((size_t)count + 1, sizeof *ring);
  double *line = malloc(3 * ((size_t)count + 1) * sizeof *line);
  enum status status = ring && line ? STATUS_OK : STATUS_NO_MEMORY;
  *conformity = (struct conformity){0};
  if (status == STATUS_OK) {
    shape_midline(m->mesh, u, line);
    conformity->uniformity = sum_points(m, o, ring);
    conformity->wrap = sum_turns(ring, count);
    conformity->match = match_of(m, o, ring, line);
  }
  int suckers = spec->family == FAMILY_PNEUNET ? spec->pneunet.sucker_count : 0;
  for (int k = 0; k < suckers && status == STATUS_OK; k++) {
    if (conformity_sealed(m, o, &spec->pneunet.sucker[k])) {
      conformity->suction += suction_force(spec, k);
      conformity->sealed++;
    }
  }
  free(ring);
  free(line);
  return status;
}
