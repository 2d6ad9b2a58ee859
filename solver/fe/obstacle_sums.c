/* What is read off the contact with rigid objects: resultants, areas, distances, fields. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

static void add_point(const struct obstacle *o, const struct obstacle_point *point,
                      struct obstacle_state *s) {
  double force[3], moment[3], arm[3];
  double normal = point->area * point->pressure, rub = point->area * vec3_norm(point->friction);
  if (normal == 0 && rub == 0) {
    return;
  }
  for (int i = 0; i < 3; i++) {
    double push = -normal * point->normal[i], drag = -point->area * point->friction[i];
    s->normal[i] += push;
    s->friction[i] += drag;
    force[i] = push + drag;
    s->force[i] += force[i];
    arm[i] = point->x[i] - o->pose.place[i];
  }
  vec3_cross(arm, force, moment);
  for (int i = 0; i < 3; i++) {
    s->moment[i] += moment[i];
  }
  s->normal_force += normal;
  s->friction_force += rub;
  s->slip_share += point->slips ? normal : 0;
  s->area += point->current;
  s->touching++;
}

/* Mean pressure of the part of a face that touches. */
static double face_pressure(const struct obstacle_point *point) {
  double force = 0, area = 0;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    force += point[q].area * point[q].pressure;
    area += point[q].pressure > 0 ? point[q].current : 0;
  }
  return area > 0 ? force / area : 0;
}

struct obstacle_state model_obstacle_state(const struct fe_model *m, int index) {
  const struct obstacle *o = m->obstacle[index];
  struct obstacle_state s = {.min_gap = INFINITY,
                             .friction_work = o->friction_work,
                             .motion_work = o->motion_work,
                             .friction_total = o->friction_total,
                             .motion_total = o->motion_total};
  for (int f = 0; f < m->contact.face_count; f++) {
    const struct obstacle_point *point = &o->point[QUAD9_POINTS * (size_t)f];
    for (int q = 0; q < QUAD9_POINTS && o->near[f]; q++) {
      s.min_gap = fmin(s.min_gap, point[q].gap);
      add_point(o, &point[q], &s);
    }
    s.max_pressure = fmax(s.max_pressure, o->near[f] ? face_pressure(point) : 0);
  }
  s.mean_pressure = s.area > 0 ? s.normal_force / s.area : 0;
  s.slip_share = s.normal_force > 0 ? s.slip_share / s.normal_force : 0;
  return s;
}

static double distance_of(const struct obstacle *o, const double x[3]) {
  struct rigid_nearest nearest;
  return rigid_shape_nearest_posed(o->shape, &o->pose, x, INFINITY, &nearest) ? nearest.distance
                                                                              : INFINITY;
}

double model_obstacle_clearance(const struct fe_model *m, int index, const double *u) {
  const struct obstacle *o = m->obstacle[index];
  double least = INFINITY;
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    double x[QUAD9_NODES][3];
    obstacle_face_positions(m, u, f, nodes, x);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double place[3] = {0};
      for (int d = 0; d < 3 * QUAD9_NODES; d++) {
        place[d % 3] += m->quad9.n[q][d / 3] * x[d / 3][d % 3];
      }
      least = fmin(least, fmin(distance_of(o, place), distance_of(o, x[q])));
    }
  }
  return least;
}

/* Adds the forces of all objects at the points of face f to its nodes: pressure, and friction
 * unless NULL; both times area. */
static void add_face_fields(const struct fe_model *m, int f, const int nodes[QUAD9_NODES],
                            double *pressure, double *friction) {
  for (int k = 0; k < m->obstacle_count; k++) {
    const struct obstacle_point *point = &m->obstacle[k]->point[QUAD9_POINTS * (size_t)f];
    for (int q = 0; q < QUAD9_POINTS && m->obstacle[k]->near[f]; q++) {
      for (int a = 0; a < QUAD9_NODES; a++) {
        double share = m->quad9.n[q][a] * point[q].area;
        pressure[nodes[a]] += share * point[q].pressure;
        for (int i = 0; friction && i < 3; i++) {
          friction[3 * nodes[a] + i] += share * point[q].friction[i];
        }
      }
    }
  }
}

enum status model_obstacle_fields(const struct fe_model *m, const double *u, double *pressure,
                                  double *friction) {
  size_t count = (size_t)m->mesh->node_count;
  double *area = calloc(count + 1, sizeof *area);
  if (!area) {
    return STATUS_NO_MEMORY;
  }
  memset(pressure, 0, count * sizeof *pressure);
  if (friction) {
    memset(friction, 0, 3 * count * sizeof *friction);
  }
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    double x[QUAD9_NODES][3];
    obstacle_face_positions(m, u, f, nodes, x);
    for (int q = 0; q < QUAD9_POINTS; q++) {
      double here = obstacle_current_area(&m->quad9, q, x);
      for (int a = 0; a < QUAD9_NODES; a++) {
        area[nodes[a]] += m->quad9.n[q][a] * here;
      }
    }
    add_face_fields(m, f, nodes, pressure, friction);
  }
  for (size_t n = 0; n < count; n++) {
    pressure[n] = area[n] > 0 ? pressure[n] / area[n] : 0;
    for (size_t i = 0; friction && i < 3; i++) {
      friction[3 * n + i] = area[n] > 0 ? friction[3 * n + i] / area[n] : 0;
    }
  }
  free(area);
  return STATUS_OK;
}
