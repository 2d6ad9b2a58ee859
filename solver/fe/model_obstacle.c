/* Rigid objects in the residual and the tangent of a model. */
#include <math.h>
#include <string.h>
#include "solver/base/box_tree.h"
#include "solver/fe/model_internal.h"
#include "solver/fe/obstacle_internal.h"
#include "solver/base/vec3.h"

void obstacle_face_positions(const struct fe_model *m, const double *u, int f,
                             int nodes[QUAD9_NODES], double x[QUAD9_NODES][3]) {
  mesh_face_nodes(m->mesh, &m->contact.face[f].face, nodes);
  for (int d = 0; d < 3 * QUAD9_NODES; d++) {
    x[d / 3][d % 3] = m->mesh->x[3 * nodes[d / 3] + d % 3] + u[3 * nodes[d / 3] + d % 3];
  }
}

/* First the boxes, then the ball around the face's middle node, in which all of the face lies: its
 * functions sum to at most 1.6 in size. */
bool obstacle_reaches(const struct obstacle *o, double x[QUAD9_NODES][3]) {
  const struct box object = {{o->low[0], o->low[1], o->low[2]},
                             {o->high[0], o->high[1], o->high[2]}};
  struct box face = box_empty();
  const double *middle = x[QUAD9_NODES / 2];
  double radius = 0;
  for (int a = 0; a < QUAD9_NODES; a++) {
    double d[3] = {x[a][0] - middle[0], x[a][1] - middle[1], x[a][2] - middle[2]};
    box_include(&face, x[a]);
    radius = fmax(radius, vec3_norm(d));
  }
  face = box_inflate(&face, o->margin + 0.6 * radius);
  struct rigid_nearest nearest;
  return box_overlaps(&face, &object) &&
         rigid_shape_nearest_posed(o->shape, &o->pose, middle, o->margin + 1.6 * radius, &nearest);
}

void obstacle_renew_reach(const struct fe_model *m, struct obstacle *o) {
  double low[3], high[3], most = 0;
  struct box box = box_empty();
  bool bounded = true;
  rigid_shape_bounds(o->shape, low, high);
  for (int i = 0; i < 3; i++) {
    bounded = bounded && isfinite(low[i]) && isfinite(high[i]);
  }
  for (int corner = 0; corner < 8; corner++) {
    double x[3] = {corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                   corner & 4 ? high[2] : low[2]};
    rigid_pose_outward(&o->pose, x, x);
    box_include(&box, x);
  }
  for (int i = 0; i < 3; i++) {
    o->low[i] = bounded ? box.low[i] : -INFINITY;
    o->high[i] = bounded ? box.high[i] : INFINITY;
  }
  for (int i = 0; i < QUAD9_POINTS * m->contact.face_count; i++) {
    most = fmax(most, o->point[i].memory.pressure);
  }
  o->margin = m->contact.reach + most / o->stiffness;
}

/* Renews the points of face f. Returns whether it carries traction: then r and, unless NULL,
 * stiffness are written. */
static bool evaluate_face(const struct fe_model *m, struct obstacle *o, const double *u, int f,
                          int nodes[QUAD9_NODES], double r[3 * QUAD9_NODES],
                          double (*stiffness)[3 * QUAD9_NODES]) {
  struct obstacle_point *point = o->point + (size_t)QUAD9_POINTS * (size_t)f;
  double x[QUAD9_NODES][3];
  obstacle_face_positions(m, u, f, nodes, x);
  if (!obstacle_reaches(o, x)) {
    for (int q = 0; q < QUAD9_POINTS && o->near[f]; q++) {
      obstacle_point_clear(&point[q]);
    }
    o->near[f] = 0;
    return false;
  }
  o->near[f] = 1;
  return obstacle_face_evaluate(o, &m->quad9, point, x, r, stiffness);
}

static void add_to_element(struct fe_model *m, const struct mesh_face *face,
                           double (*stiffness)[3 * QUAD9_NODES]) {
  double *packed = m->element_value + (size_t)face->element * ELEMENT_PACKED;
  int local[QUAD9_NODES];
  mesh_face_local_nodes(face->axis, face->side, local);
  for (int r = 0; r < 3 * QUAD9_NODES; r++) {
    for (int c = r; c < 3 * QUAD9_NODES; c++) {
      int row = HEX27_NODES * (r % 3) + local[r / 3], column = HEX27_NODES * (c % 3) + local[c / 3];
      int first = row < column ? row : column, second = row < column ? column : row;
      packed[model_packed_index(ELEMENT_DOFS, first, second)] += stiffness[r][c];
    }
  }
}

static void evaluate_object(struct fe_model *m, struct obstacle *o, const double *u, bool tangent) {
  for (int f = 0; f < m->contact.face_count; f++) {
    int nodes[QUAD9_NODES];
    double r[3 * QUAD9_NODES], stiffness[3 * QUAD9_NODES][3 * QUAD9_NODES];
    if (!evaluate_face(m, o, u, f, nodes, r, tangent ? stiffness : NULL)) {
      continue;
    }
    for (int d = 0; d < 3 * QUAD9_NODES; d++) {
      int equation = m->equation[3 * nodes[d / 3] + d % 3];
      if (equation >= 0) {
        m->residual[equation] += r[d];
      }
    }
    if (tangent) {
      add_to_element(m, &m->contact.face[f].face, stiffness);
    }
  }
}

void model_evaluate_obstacles(struct fe_model *m, const double *u, bool tangent) {
  for (int k = 0; k < m->obstacle_count; k++) {
    evaluate_object(m, m->obstacle[k], u, tangent);
  }
}

void obstacles_look(struct fe_model *m, const double *u) {
  for (int k = 0; k < m->obstacle_count; k++) {
    for (int f = 0; f < m->contact.face_count; f++) {
      int nodes[QUAD9_NODES];
      double r[3 * QUAD9_NODES];
      evaluate_face(m, m->obstacle[k], u, f, nodes, r, NULL);
    }
  }
}
