#include "solver/grasp/cups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/fe/pressure.h"
#include "solver/grasp/conformity.h"
#include "solver/grasp/finger.h"

/* Faces end at the rim: its inner edge is in the circle of the opening but for so much of the wall,
 * and of the depth. */
static const double round_by = 0.25, short_by = 0.001;

static int count_of(const struct finger *f) {
  return f->spec.family == FAMILY_PNEUNET ? f->spec.pneunet.sucker_count : 0;
}

enum status cups_prepare(struct finger *f) {
  size_t size = 3 * (size_t)f->solve.mesh.node_count;
  if (count_of(f) == 0) {
    return STATUS_OK;
  }
  f->cups.weight = malloc(sizeof *f->cups.weight * size);
  if (!f->cups.weight) {
    return STATUS_NO_MEMORY;
  }
  memcpy(f->cups.weight, f->solve.model->dead_load, sizeof *f->cups.weight * size);
  return STATUS_OK;
}

void cups_release(struct finger *f) {
  free(f->cups.weight);
  f->cups = (struct cups){.weight = NULL};
}

/* Whether the face is inside the cup: its floor or the inner side of its ring. */
static bool is_inside(const struct mesh *mesh, const struct sucker_spec *sucker,
                      const struct mesh_face *face, const int nodes[QUAD9_NODES]) {
  const double *x = mesh->x + 3 * (size_t)nodes[QUAD9_NODES / 2];
  double away = hypot(x[0] - sucker->position, x[1]);
  bool below = x[2] > -(1 - short_by) * sucker->depth && x[2] < short_by * sucker->depth;
  return face->kind == FACE_OUTER && below &&
         away < 0.5 * sucker->diameter + round_by * sucker->wall;
}

/* Adds what the suction does on one face; sum: force and moment about the origin on the body. */
static void add_face(const struct finger *f, const int nodes[QUAD9_NODES], int side, double suction,
                     double sum[6]) {
  double x[QUAD9_NODES][3], force[FACE_DOFS], moment[3];
  struct fe_model *m = f->solve.model;
  for (int d = 0; d < FACE_DOFS; d++) {
    size_t at = 3 * (size_t)nodes[d / 3] + (size_t)(d % 3);
    x[d / 3][d % 3] = m->mesh->x[at] + f->solve.state.u[at];
  }
  pressure_face(&m->quad9, x, side, force);
  for (int a = 0; a < QUAD9_NODES; a++) {
    for (int i = 0; i < 3; i++) {
      force[3 * a + i] *= suction;
      m->dead_load[3 * (size_t)nodes[a] + (size_t)i] += force[3 * a + i];
      sum[i] += force[3 * a + i];
    }
    vec3_cross(x[a], force + 3 * a, moment);
    for (int i = 0; i < 3; i++) {
      sum[3 + i] += moment[i];
    }
  }
}

static void add_cup(struct finger *f, const struct sucker_spec *sucker, double suction) {
  const struct mesh *mesh = &f->solve.mesh;
  double sum[6] = {0};
  for (int k = 0; k < mesh->face_count; k++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[k], nodes);
    if (is_inside(mesh, sucker, &mesh->faces[k], nodes)) {
      add_face(f, nodes, mesh->faces[k].side, suction, sum);
    }
  }
  for (int i = 0; i < 6; i++) {
    f->cups.force[i] -= sum[i];
  }
  sum[1] = f->spec.half_model ? 0 : sum[1];
  f->cups.pull += vec3_norm(sum);
}

int cups_close(struct finger *f) {
  const struct fe_model *m = f->solve.model;
  int count = 0;
  for (int k = 0; k < count_of(f); k++) {
    f->cups.holds[k] = conformity_sealed(m, m->obstacle[f->obstacle], &f->spec.pneunet.sucker[k]);
    count += f->cups.holds[k];
  }
  return count;
}

void cups_watch(struct finger *f) {
  const struct fe_model *m = f->solve.model;
  for (int k = 0; k < count_of(f); k++) {
    f->cups.holds[k] = f->cups.holds[k] &&
                       conformity_sealed(m, m->obstacle[f->obstacle], &f->spec.pneunet.sucker[k]);
  }
}

void cups_pull(struct finger *f, double share) {
  struct fe_model *m = f->solve.model;
  if (!f->cups.weight) {
    return;
  }
  memcpy(m->dead_load, f->cups.weight, sizeof *m->dead_load * 3 * (size_t)m->mesh->node_count);
  memset(f->cups.force, 0, sizeof f->cups.force);
  f->cups.pull = 0;
  for (int k = 0; k < count_of(f); k++) {
    const struct sucker_spec *sucker = &f->spec.pneunet.sucker[k];
    if (f->cups.holds[k]) {
      add_cup(f, sucker, share * f->spec.pneunet.suction_pressure);
    }
  }
  energy_reload(&f->energy, m, &f->solve.state);
}
