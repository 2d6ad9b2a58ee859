/* Derivatives of the contact by the motion of an object. A point pushes the object with r, its part
 * of the residual, at the arm s = x - place. Motions a and w of the object turn what it feels, so
 *   dr = K (dx - a - w x s) + w x r,  d(s x r) = s x dr + (dx - a) x r. */
#include <string.h>
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

/* Of one point: column j of the derivatives of r and of s x r by its own place (by_place) and by
 * the six motions. */
struct point_coupling {
  double r[3], arm[3];
  double force_by_place[3][3], moment_by_place[3][3];   /* [column] */
  double force_by_motion[6][3], moment_by_motion[6][3]; /* [column] */
};

static void couple_point(const struct obstacle *o, const struct obstacle_point *point,
                         const struct obstacle_law *law, struct point_coupling *c) {
  memcpy(c->r, law->residual, sizeof c->r);
  for (int i = 0; i < 3; i++) {
    c->arm[i] = point->x[i] - o->pose.place[i];
  }
  for (int j = 0; j < 3; j++) {
    double unit[3] = {j == 0, j == 1, j == 2}, swept[3], pulled[3], turned[3], cross[3];
    double *force = c->force_by_place[j], *shift = c->force_by_motion[j];
    double *turn = c->force_by_motion[3 + j];
    vec3_cross(unit, c->arm, swept);
    for (int i = 0; i < 3; i++) {
      force[i] = law->matrix[i][j];
      pulled[i] = vec3_dot(law->matrix[i], swept);
    }
    vec3_cross(unit, c->r, turned);
    vec3_cross(c->arm, force, c->moment_by_place[j]);
    for (int i = 0; i < 3; i++) {
      shift[i] = -force[i];
      turn[i] = turned[i] - pulled[i];
    }
    vec3_cross(c->arm, turn, c->moment_by_motion[3 + j]);
    vec3_cross(c->arm, shift, c->moment_by_motion[j]);
    vec3_cross(unit, c->r, cross);
    for (int i = 0; i < 3; i++) {
      c->moment_by_place[j][i] += cross[i];
      c->moment_by_motion[j][i] -= cross[i];
    }
  }
}

static void add_coupling(const struct fe_model *m, const double n[QUAD9_NODES],
                         const int nodes[QUAD9_NODES], const struct point_coupling *c,
                         struct obstacle_coupling *out) {
  size_t count = (size_t)m->dof_count;
  double moment[3];
  vec3_cross(c->arm, c->r, moment);
  for (int i = 0; i < 3; i++) {
    out->resultant[i] += c->r[i];
    out->resultant[3 + i] += moment[i];
    for (int j = 0; j < 6; j++) {
      out->own[6 * i + j] += c->force_by_motion[j][i];
      out->own[6 * (3 + i) + j] += c->moment_by_motion[j][i];
    }
  }
  for (int d = 0; d < 3 * QUAD9_NODES; d++) {
    int equation = m->equation[3 * nodes[d / 3] + d % 3];
    if (equation < 0) {
      continue;
    }
    double share = n[d / 3];
    for (size_t j = 0; j < 6; j++) {
      out->by_motion[j * count + (size_t)equation] += share * c->force_by_motion[j][d % 3];
    }
    for (size_t i = 0; i < 3; i++) {
      out->by_u[i * count + (size_t)equation] += share * c->force_by_place[d % 3][i];
      out->by_u[(3 + i) * count + (size_t)equation] += share * c->moment_by_place[d % 3][i];
    }
  }
}

void model_obstacle_coupling(const struct fe_model *m, int index,
                             struct obstacle_coupling *coupling) {
  const struct obstacle *o = m->obstacle[index];
  size_t size = 6 * (size_t)m->dof_count * sizeof(double);
  memset(coupling->by_motion, 0, size);
  memset(coupling->by_u, 0, size);
  memset(coupling->own, 0, sizeof coupling->own);
  memset(coupling->resultant, 0, sizeof coupling->resultant);
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    struct obstacle_point point = o->point[i];
    struct obstacle_law law;
    struct point_coupling c;
    int nodes[QUAD9_NODES];
    if (!o->near[i / QUAD9_POINTS] || !obstacle_point_evaluate(o, &point, true, &law)) {
      continue;
    }
    couple_point(o, &point, &law, &c);
    mesh_face_nodes(m->mesh, &m->contact.face[i / QUAD9_POINTS].face, nodes);
    add_coupling(m, m->quad9.n[i % QUAD9_POINTS], nodes, &c, coupling);
  }
}
