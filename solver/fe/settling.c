#include "solver/fe/settling.h"

#include <cblas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/lapack.h"
#include "solver/base/vec3.h"
#include "solver/fe/obstacle_internal.h"

enum { WINDOW = 8 };
/* An update after which the difference has grown by this much starts anew. */
static const double growth = 2;
/* Of the normal equations of the differences, by their trace. */
static const double regularization = 1e-12;

/* Multipliers z, their change f = G(z) - z, and the nodal forces of the change. */
struct settling {
  int values, forces; /* lengths of vectors: multipliers, nodal forces */
  double *z, *f, *force;
  double *last_z, *last_f, *last_force;
  double *step[WINDOW];       /* differences of z + f of successive updates */
  double *difference[WINDOW]; /* differences of the nodal forces */
  int columns, next;
  bool has_last;
  double size, last_size; /* of the nodal forces of the change, N */
  double *nodal;          /* OBSTACLE_ROOM x node_count: for obstacle_smooth */
  double *room;
};

struct settling *settling_create(const struct fe_model *m) {
  struct settling *s = calloc(1, sizeof *s);
  if (!s) {
    return NULL;
  }
  s->values = OBSTACLE_VALUES * QUAD9_POINTS * m->contact.face_count * m->obstacle_count;
  s->forces = 3 * m->mesh->node_count;
  size_t values = (size_t)s->values, forces = (size_t)s->forces;
  s->room = calloc((4 + WINDOW) * values + (2 + WINDOW) * forces +
                       OBSTACLE_ROOM * (size_t)m->mesh->node_count + 1,
                   sizeof *s->room);
  if (!s->room) {
    free(s);
    return NULL;
  }
  double **part[] = {&s->z, &s->f, &s->last_z, &s->last_f};
  double *next = s->room;
  for (size_t k = 0; k < sizeof part / sizeof *part; k++, next += values) {
    *part[k] = next;
  }
  s->force = next;
  s->last_force = next + forces;
  next += 2 * forces;
  for (int k = 0; k < WINDOW; k++) {
    s->step[k] = next;
    s->difference[k] = next + values;
    next += values + forces;
  }
  s->nodal = next;
  return s;
}

void settling_destroy(struct settling *s) {
  if (s) {
    free(s->room);
    free(s);
  }
}

void settling_restart(struct settling *s) {
  s->columns = s->next = 0;
  s->has_last = false;
}

/* Adds what the change of a face's multipliers does to the nodes; returns the sum of the sizes of
 * the points' forces. */
static double add_face(struct settling *s, const struct fe_model *m, const struct obstacle *o,
                       int f, double change[QUAD9_POINTS][OBSTACLE_VALUES]) {
  const struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f];
  double size = 0;
  int nodes[QUAD9_NODES];
  mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    if (!isfinite(point[q].gap)) {
      continue;
    }
    double t[3], shear[3], pressure = point[q].pressure;
    rigid_pose_turn_outward(&o->pose, change[q] + 1, shear);
    for (int i = 0; i < 3; i++) {
      t[i] = point[q].area * (change[q][0] * point[q].normal[i] - shear[i]);
    }
    size +=
        point[q].area * sqrt(pressure * pressure + vec3_dot(point[q].friction, point[q].friction));
    for (int d = 0; d < 3 * QUAD9_NODES; d++) {
      s->force[3 * nodes[d / 3] + d % 3] += m->quad9.n[q][d / 3] * t[d % 3];
    }
  }
  return size;
}

struct settling_change settling_measure(struct settling *s, const struct fe_model *m) {
  double wall = m->mesh->wall_thickness, size = 0, sum = 0;
  size_t next = 0;
  memset(s->force, 0, sizeof *s->force * (size_t)s->forces);
  for (int k = 0; k < m->obstacle_count; k++) {
    obstacle_smooth(m, m->obstacle[k], s->nodal);
    for (int f = 0; f < m->contact.face_count; f++, next += QUAD9_POINTS * OBSTACLE_VALUES) {
      double value[QUAD9_POINTS][OBSTACLE_VALUES], change[QUAD9_POINTS][OBSTACLE_VALUES];
      obstacle_face_multipliers(m->obstacle[k], f, value, change);
      memcpy(s->z + next, value, sizeof value);
      memcpy(s->f + next, change, sizeof change);
      size += m->obstacle[k]->near[f] ? add_face(s, m, m->obstacle[k], f, change) : 0;
    }
  }
  for (int n = 0; n < m->mesh->node_count; n++) {
    sum += vec3_norm(s->force + 3 * (size_t)n);
  }
  s->size = sum;
  /* With a contraction by `rate` what is left is rate / (1 - rate) times the last change; but of
   * one update alone not much is known. */
  double rate = s->has_last && s->last_size > 0 ? sum / s->last_size : 0.5;
  double left = fmax(0.5, fmin(0.9, rate)) / (1 - fmax(0.5, fmin(0.9, rate)));
  /* Forces too small to matter need not settle by that part of themselves. */
  double next_change = sum / (size + 1e-2 * material_shear_modulus(&m->material) * wall * wall);
  return (struct settling_change){next_change, left * next_change};
}

/* Takes the differences to the last update into the window. */
static void remember(struct settling *s) {
  double *step = s->step[s->next], *difference = s->difference[s->next];
  for (int i = 0; i < s->values; i++) {
    step[i] = s->z[i] + s->f[i] - s->last_z[i] - s->last_f[i];
  }
  for (int i = 0; i < s->forces; i++) {
    difference[i] = s->force[i] - s->last_force[i];
  }
  s->next = (s->next + 1) % WINDOW;
  s->columns += s->columns < WINDOW;
}

/* f <- f - sum of gamma_j step_j, with the gamma that make the nodal forces smallest. */
static void accelerate(struct settling *s) {
  static const int one = 1, lead = WINDOW;
  double a[WINDOW][WINDOW], gamma[WINDOW], trace = 0;
  int info = 0;
  for (int i = 0; i < s->columns; i++) {
    for (int j = 0; j < s->columns; j++) {
      a[i][j] = cblas_ddot(s->forces, s->difference[i], 1, s->difference[j], 1);
    }
    gamma[i] = cblas_ddot(s->forces, s->difference[i], 1, s->force, 1);
    trace += a[i][i];
  }
  for (int i = 0; i < s->columns; i++) {
    a[i][i] += regularization * trace;
  }
  dposv_("U", &s->columns, &one, a[0], &lead, gamma, &lead, &info);
  if (info != 0) {
    settling_restart(s);
    return;
  }
  for (int j = 0; j < s->columns; j++) {
    cblas_daxpy(s->values, -gamma[j], s->step[j], 1, s->f, 1);
  }
}

void settling_update(struct settling *s, struct fe_model *m) {
  size_t next = 0;
  if (s->has_last && s->size > growth * s->last_size) {
    settling_restart(s);
  }
  if (s->has_last) {
    remember(s);
  }
  memcpy(s->last_f, s->f, sizeof *s->f * (size_t)s->values);
  memcpy(s->last_force, s->force, sizeof *s->force * (size_t)s->forces);
  memcpy(s->last_z, s->z, sizeof *s->z * (size_t)s->values);
  s->last_size = s->size;
  s->has_last = true;
  if (s->columns > 0) {
    accelerate(s);
  }
  for (int k = 0; k < m->obstacle_count; k++) {
    for (int f = 0; f < m->contact.face_count; f++, next += QUAD9_POINTS * OBSTACLE_VALUES) {
      double value[QUAD9_POINTS][OBSTACLE_VALUES];
      for (int i = 0; i < QUAD9_POINTS * OBSTACLE_VALUES; i++) {
        value[i / OBSTACLE_VALUES][i % OBSTACLE_VALUES] =
            s->z[next + (size_t)i] + s->f[next + (size_t)i];
      }
      obstacle_face_set(m->obstacle[k], f, value);
    }
    obstacle_renew_reach(m, m->obstacle[k]);
  }
}
