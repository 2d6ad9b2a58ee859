/* Multipliers of the contact with rigid objects: their way from and to a state, and their updates.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/fe/vec3.h"

size_t obstacles_memory_count(const struct fe_model *m) {
  return (size_t)m->obstacle_count * QUAD9_POINTS * (size_t)m->contact.face_count;
}

void obstacles_use(struct fe_model *m, const struct fe_state *state) {
  size_t count = QUAD9_POINTS * (size_t)m->contact.face_count;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (size_t i = 0; i < count; i++) {
      m->obstacle[k]->point[i].memory = state->memory[(size_t)k * count + i];
    }
    obstacle_renew_reach(m, m->obstacle[k]);
  }
}

void obstacles_keep(const struct fe_model *m, struct fe_state *state) {
  size_t count = QUAD9_POINTS * (size_t)m->contact.face_count;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (size_t i = 0; i < count; i++) {
      state->memory[(size_t)k * count + i] = m->obstacle[k]->point[i].memory;
    }
  }
}

double obstacles_intrusion(const struct fe_model *m) {
  double deepest = 0;
  for (int k = 0; k < m->obstacle_count; k++) {
    for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
      deepest = fmax(deepest, -m->obstacle[k]->point[i].gap);
    }
  }
  return deepest;
}

/* Adds `sign` times the forces of the objects to the nodes; returns the sum of their sizes, N. */
static double add_forces(const struct fe_model *m, double sign, double *force) {
  double size = 0;
  for (int k = 0; k < m->obstacle_count; k++) {
    const struct obstacle *o = m->obstacle[k];
    for (int f = 0; f < m->contact.face_count; f++) {
      int nodes[QUAD9_NODES];
      if (!o->near[f]) {
        continue;
      }
      mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
      for (int q = 0; q < QUAD9_POINTS; q++) {
        const struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f + (size_t)q];
        double t[3] = {0};
        for (int i = 0; i < 3 && isfinite(point->gap); i++) {
          t[i] = point->area * (point->pressure * point->normal[i] + point->friction[i]);
        }
        size += vec3_norm(t);
        for (int d = 0; d < 3 * QUAD9_NODES; d++) {
          force[3 * nodes[d / 3] + d % 3] += sign * m->quad9.n[q][d / 3] * t[d % 3];
        }
      }
    }
  }
  return size;
}

/* Pressures that the multipliers of a face should have: those of the points. A face that touches
 * with all its points has more of them than its nodes can keep apart from a curved object: there
 * the pressures are made linear over the face, which its displacements can follow; what the
 * pressure does beyond that is left to eps. Force and moments stay. */
static void wanted_pressures(const struct quad9_tables *tables, const struct obstacle_point *point,
                             double wanted[QUAD9_POINTS]) {
  double basis[3][QUAD9_POINTS], value[QUAD9_POINTS] = {0};
  bool whole = true;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    wanted[q] = point[q].pressure;
    whole = whole && point[q].pressure > 0;
    basis[0][q] = 1;
    basis[1][q] = tables->point[q][0];
    basis[2][q] = tables->point[q][1];
  }
  for (int a = 0; a < 3 && whole; a++) { /* Gram, Schmidt, weighted by area */
    for (int b = 0; b <= a; b++) {
      double product = 0, square = 0;
      for (int q = 0; q < QUAD9_POINTS; q++) {
        product += point[q].area * basis[b][q] * (b < a ? basis[a][q] : wanted[q]);
        square += point[q].area * basis[b][q] * basis[b][q];
      }
      for (int q = 0; q < QUAD9_POINTS; q++) {
        if (b < a) {
          basis[a][q] -= product / square * basis[b][q];
        } else {
          value[q] += product / square * basis[a][q];
        }
      }
    }
  }
  double least = INFINITY, mean = 0;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    least = fmin(least, value[q]);
    mean += value[q] / QUAD9_POINTS;
  }
  double share = whole ? fmax(0, fmin(1, 4 * least / mean)) : 0;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    wanted[q] += share * (value[q] - wanted[q]);
  }
}

/* What the update wants of lambda and tau: the tractions less the multipliers. A point that slips
 * has its tau from the return mapping, which needs no acceleration. */
static void find_change(const struct obstacle *o, const struct obstacle_point *point,
                        double pressure, double change[4]) {
  double traction[3];
  change[0] = pressure - point->memory.pressure;
  rigid_pose_turn_inward(&o->pose, point->friction, traction);
  bool sticks = point->memory.held && !point->slips;
  for (int i = 0; i < 3; i++) {
    change[1 + i] = sticks ? -traction[i] - point->memory.traction[i] : 0;
  }
}

/* Aitken's factor for the next update (Irons, Tuck 1969), weighted by area. */
static double relaxation_factor(const struct fe_model *m, double last) {
  double product = 0, square = 0;
  for (int k = 0; k < m->obstacle_count; k++) {
    const struct obstacle *o = m->obstacle[k];
    double wanted[QUAD9_POINTS];
    for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
      const struct obstacle_point *point = &o->point[i];
      double change[4];
      if (!o->near[i / QUAD9_POINTS]) {
        continue;
      }
      if (i % QUAD9_POINTS == 0) {
        wanted_pressures(&m->quad9, point, wanted);
      }
      find_change(o, point, wanted[i % QUAD9_POINTS], change);
      for (int c = 0; c < 4; c++) {
        double difference = change[c] - point->change[c];
        product += point->area * point->change[c] * difference;
        square += point->area * difference * difference;
      }
    }
  }
  double factor = square > 0 ? -last * product / square : 1;
  return fmax(1, fmin(10, factor));
}

/* Turns the tangential vector t of the normal a into the tangent plane of b, the shortest way. */
static void turn_tangent(const double a[3], const double b[3], double t[3]) {
  double cosine = vec3_dot(a, b), along = vec3_dot(b, t);
  for (int i = 0; i < 3; i++) {
    t[i] = cosine > -0.99 ? t[i] - along / (1 + cosine) * (a[i] + b[i]) : 0;
  }
}

static void update_point(const struct obstacle *o, struct obstacle_point *point, double pressure,
                         double factor) {
  struct obstacle_memory *memory = &point->memory;
  double normal[3], traction[3];
  find_change(o, point, pressure, point->change);
  memory->pressure = fmax(0, memory->pressure + factor * point->change[0]);
  if (!memory->held || !isfinite(point->gap)) {
    return;
  }
  rigid_pose_turn_inward(&o->pose, point->friction, traction);
  for (int i = 0; i < 3; i++) {
    memory->traction[i] =
        point->slips ? -traction[i] : memory->traction[i] + factor * point->change[1 + i];
  }
  rigid_pose_turn_inward(&o->pose, point->normal, normal);
  turn_tangent(memory->normal, normal, memory->traction);
  memcpy(memory->normal, normal, sizeof normal);
}

enum status obstacles_update(struct fe_model *m, const double *u, double *relaxation,
                             double *change) {
  double *force = calloc(3 * (size_t)m->mesh->node_count + 1, sizeof *force);
  *change = 0;
  if (!force) {
    return STATUS_NO_MEMORY;
  }
  add_forces(m, -1, force);
  double factor = *relaxation > 0 ? relaxation_factor(m, *relaxation) : 1;
  *relaxation = factor;
  for (int k = 0; k < m->obstacle_count; k++) {
    struct obstacle *o = m->obstacle[k];
    for (int f = 0; f < m->contact.face_count; f++) {
      struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f];
      double wanted[QUAD9_POINTS];
      wanted_pressures(&m->quad9, point, wanted);
      for (int q = 0; q < QUAD9_POINTS; q++) {
        update_point(o, &point[q], wanted[q], factor);
      }
    }
    obstacle_renew_reach(m, o);
  }
  obstacles_look(m, u);
  double size = add_forces(m, 1, force), sum = 0;
  for (int n = 0; n < m->mesh->node_count; n++) {
    sum += vec3_norm(force + 3 * (size_t)n);
  }
  /* Forces too small to matter need not settle by that part of themselves. */
  double wall = m->mesh->wall_thickness;
  *change = sum / (size + 1e-2 * material_shear_modulus(&m->material) * wall * wall);
  free(force);
  return STATUS_OK;
}
