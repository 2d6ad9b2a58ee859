/* The law of one surface point against one rigid object. Everything is worked out in the object's
 * frame, so that it does not notice a motion of body and object together. */
#include <math.h>
#include <string.h>
#include "solver/fe/contact_internal.h"
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

void obstacle_point_clear(struct obstacle_point *point) {
  static const double zero[3] = {0};
  point->gap = INFINITY;
  point->pressure = point->current = 0;
  point->slips = false;
  memcpy(point->friction, zero, sizeof zero);
  memcpy(point->slip, zero, sizeof zero);
}

/* matrix += factor (1 - n n^T). */
static void add_projector(double factor, const double n[3], double matrix[3][3]) {
  for (int i = 0; i < 9; i++) {
    matrix[i / 3][i % 3] += factor * ((i % 4 == 0) - n[i / 3] * n[i % 3]);
  }
}

/* Return mapping at `place`: adds to law, both in the object's frame; traction[3] is minus that on
 * the body. */
static void add_friction(const struct obstacle *o, struct obstacle_point *point,
                         const double place[3], bool tangent, struct obstacle_law *law,
                         double traction[3]) {
  const struct obstacle_memory *memory = &point->memory;
  const double *n = memory->normal, radius = o->coefficient * memory->pressure;
  double d[3], trial[3], slip[3], area = point->area;
  for (int i = 0; i < 3; i++) {
    d[i] = place[i] - memory->anchor[i];
  }
  double along = vec3_dot(d, n);
  for (int i = 0; i < 3; i++) {
    slip[i] = d[i] - along * n[i];
    trial[i] = memory->traction[i] + o->tangential * slip[i];
  }
  double size = vec3_norm(trial), share = size > radius ? radius / size : 1;
  point->slips = size > radius;
  rigid_pose_turn_outward(&o->pose, slip, point->slip);
  for (int i = 0; i < 3; i++) {
    traction[i] = share * trial[i];
    law->residual[i] += area * traction[i];
  }
  if (!tangent) {
    return;
  }
  add_projector(area * o->tangential * share, n, law->matrix);
  for (int i = 0; i < 9 && point->slips; i++) {
    law->matrix[i / 3][i % 3] -=
        area * o->tangential * share * trial[i / 3] * trial[i % 3] / (size * size);
  }
}

/* The second derivative of the distance, p times which softens the tangent: held below the
 * stiffness of the contact itself where an edge is so sharp that it would exceed it. */
static double curvature_share(const struct obstacle *o, double pressure,
                              const struct rigid_nearest *nearest) {
  double square = 0;
  for (int i = 0; i < 9; i++) {
    double k = nearest->curvature[i / 3][i % 3];
    square += k * k;
  }
  double size = pressure * sqrt(square);
  return size > o->stiffness ? o->stiffness / size : 1;
}

bool obstacle_point_evaluate(const struct obstacle *o, struct obstacle_point *point, bool tangent,
                             struct obstacle_law *law) {
  struct rigid_nearest nearest;
  double place[3], slope, traction[3] = {0};
  obstacle_point_clear(point);
  rigid_pose_inward(&o->pose, point->x, place);
  if (!rigid_shape_nearest(o->shape, place, o->margin, &nearest)) {
    return false;
  }
  const double *n = nearest.normal, eps = o->stiffness;
  rigid_pose_turn_outward(&o->pose, n, point->normal);
  point->gap = nearest.distance;
  double p =
      contact_law(eps, o->smoothing, nearest.distance - point->memory.pressure / eps, &slope);
  bool rubs = point->memory.held && o->coefficient * point->memory.pressure > 0;
  point->pressure = p;
  if (slope <= 0 && !rubs) {
    return false;
  }
  double area = point->area;
  for (int i = 0; i < 3; i++) {
    law->residual[i] = -area * p * n[i];
  }
  double share = tangent ? curvature_share(o, p, &nearest) : 0;
  for (int i = 0; i < 9 && tangent; i++) {
    law->matrix[i / 3][i % 3] =
        area * (slope * n[i / 3] * n[i % 3] - share * p * nearest.curvature[i / 3][i % 3]);
  }
  if (rubs) {
    add_friction(o, point, place, tangent, law, traction);
  }
  rigid_pose_turn_outward(&o->pose, traction, point->friction);
  rigid_pose_turn_outward(&o->pose, law->residual, law->residual);
  for (int i = 0; i < 3; i++) {
    point->friction[i] = -point->friction[i];
  }
  if (tangent) {
    rigid_pose_tensor_outward(&o->pose, law->matrix);
  }
  return true;
}

void obstacle_point_place(const struct quad9_tables *tables, int q, double x[QUAD9_NODES][3],
                          double place[3]) {
  for (int i = 0; i < 3; i++) {
    place[i] = 0;
    for (int m = 0; m < QUAD9_NODES; m++) {
      place[i] += tables->n[q][m] * x[m][i];
    }
  }
}

double obstacle_current_area(const struct quad9_tables *tables, int q, double x[QUAD9_NODES][3]) {
  double a[3] = {0}, b[3] = {0}, normal[3];
  for (int m = 0; m < QUAD9_NODES; m++) {
    for (int i = 0; i < 3; i++) {
      a[i] += tables->dn[q][0][m] * x[m][i];
      b[i] += tables->dn[q][1][m] * x[m][i];
    }
  }
  vec3_cross(a, b, normal);
  return tables->weight[q] * vec3_norm(normal);
}

static void add_stiffness(const double n[QUAD9_NODES], double matrix[3][3],
                          double (*stiffness)[3 * QUAD9_NODES]) {
  for (int a = 0; a < QUAD9_NODES; a++) {
    for (int b = a; b < QUAD9_NODES; b++) {
      double factor = n[a] * n[b];
      for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
          stiffness[3 * a + i][3 * b + j] += factor * matrix[i][j];
        }
      }
    }
  }
}

bool obstacle_face_evaluate(const struct obstacle *o, const struct quad9_tables *tables,
                            struct obstacle_point point[QUAD9_POINTS], double x[QUAD9_NODES][3],
                            double r[3 * QUAD9_NODES], double (*stiffness)[3 * QUAD9_NODES]) {
  bool touched = false;
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const double *n = tables->n[q];
    struct obstacle_law law;
    obstacle_point_place(tables, q, x, point[q].x);
    if (!obstacle_point_evaluate(o, &point[q], stiffness, &law)) {
      continue;
    }
    point[q].current = obstacle_current_area(tables, q, x);
    if (!touched) {
      memset(r, 0, 3 * QUAD9_NODES * sizeof *r);
      if (stiffness) {
        memset(stiffness, 0, 3 * QUAD9_NODES * sizeof *stiffness);
      }
      touched = true;
    }
    for (int d = 0; d < 3 * QUAD9_NODES; d++) {
      r[d] += n[d / 3] * law.residual[d % 3];
    }
    if (stiffness) {
      add_stiffness(n, law.matrix, stiffness);
    }
  }
  return touched;
}
