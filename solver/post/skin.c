#include "solver/post/skin.h"

#include <stdio.h>
#include <stdlib.h>
#include "solver/post/vtu.h"

static bool wanted(const struct mesh_face *face, bool cavities) {
  return face->kind == FACE_OUTER || face->kind == FACE_BASE ||
         (cavities && face->kind == FACE_CAVITY);
}

/* Point of a node, made when first met. */
static int skin_point(struct skin *skin, int *point_of, int node, bool mirrored) {
  if (point_of[node] < 0) {
    point_of[node] = skin->point_count;
    skin->node[skin->point_count] = node;
    skin->mirrored[skin->point_count++] = mirrored;
  }
  return point_of[node];
}

static void collect(const struct mesh *mesh, bool cavities, bool mirrored, int *point_of,
                    struct skin *skin) {
  for (int n = 0; n < mesh->node_count; n++) {
    /* Points on the plane of symmetry are shared by both halves. */
    if (!mirrored || mesh->x[3 * n + 1] != 0) {
      point_of[n] = -1;
    }
  }
  for (int f = 0; f < mesh->face_count; f++) {
    const struct mesh_face *face = &mesh->faces[f];
    if (!wanted(face, cavities)) {
      continue;
    }
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, face, nodes);
    for (int m = 0; m < QUAD9_NODES; m++) {
      skin->face[skin->face_count][m] = skin_point(skin, point_of, nodes[m], mirrored);
    }
    skin->inward[skin->face_count++] = (face->side < 0) != mirrored;
  }
}

enum status skin_create(const struct mesh *mesh, bool cavities, struct skin *skin,
                        struct error *error) {
  size_t copies = mesh->half ? 2 : 1, faces = 0;
  for (int f = 0; f < mesh->face_count; f++) {
    faces += wanted(&mesh->faces[f], cavities);
  }
  *skin = (struct skin){0};
  int *point_of = malloc(sizeof *point_of * ((size_t)mesh->node_count + 1));
  skin->node = malloc(sizeof *skin->node * (copies * (size_t)mesh->node_count + 1));
  skin->mirrored = malloc(copies * (size_t)mesh->node_count + 1);
  skin->face = malloc(sizeof *skin->face * (copies * faces + 1));
  skin->inward = malloc(copies * faces + 1);
  enum status status = STATUS_OK;
  if (!point_of || !skin->node || !skin->mirrored || !skin->face || !skin->inward) {
    skin_release(skin);
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the surface");
  } else {
    collect(mesh, cavities, false, point_of, skin);
    if (mesh->half) {
      collect(mesh, cavities, true, point_of, skin);
    }
  }
  free(point_of);
  return status;
}

void skin_release(struct skin *skin) {
  free(skin->node);
  free(skin->mirrored);
  free(skin->face);
  free(skin->inward);
  *skin = (struct skin){0};
}

/* Position of a point, m; u NULL gives the undeformed one. */
static void skin_position(const struct mesh *mesh, const struct skin *skin, const double *u,
                          int point, double x[3]) {
  int node = skin->node[point];
  for (int i = 0; i < 3; i++) {
    x[i] = mesh->x[3 * node + i] + (u ? u[3 * node + i] : 0);
  }
  if (skin->mirrored[point]) {
    x[1] = -x[1];
  }
}

void skin_face_quads(const struct skin *skin, int face, int quads[4][4]) {
  const int *p = skin->face[face];
  for (int n = 0; n < 4; n++) {
    int corner = 3 * (n / 2) + n % 2;
    quads[n][0] = p[corner];
    quads[n][1] = p[skin->inward[face] ? corner + 1 : corner + 3];
    quads[n][2] = p[corner + 4];
    quads[n][3] = p[skin->inward[face] ? corner + 3 : corner + 1];
  }
}

json_t *skin_quads(const struct skin *skin) {
  json_t *list = json_array();
  for (int f = 0; f < skin->face_count; f++) {
    int quads[4][4];
    skin_face_quads(skin, f, quads);
    for (int n = 0; n < 4; n++) {
      const int *q = quads[n];
      json_array_append_new(list, json_pack("[iiii]", q[0], q[1], q[2], q[3]));
    }
  }
  return list;
}

/* Rounds for output: 1e-4 mm and 1e-4 of stretch are finer than any picture. */
static json_t *rounded(double value) {
  char text[32];
  snprintf(text, sizeof text, "%.4f", value);
  return json_real(strtod(text, NULL));
}

json_t *skin_state(const struct mesh *mesh, const struct skin *skin, const double *u,
                   const double *node_stretch, double pressure) {
  json_t *points = json_array(), *stretch = json_array();
  for (int p = 0; p < skin->point_count; p++) {
    double x[3];
    skin_position(mesh, skin, u, p, x);
    json_t *point = json_array();
    for (int i = 0; i < 3; i++) {
      json_array_append_new(point, rounded(1e3 * x[i]));
    }
    json_array_append_new(points, point);
    json_array_append_new(stretch, rounded(node_stretch[skin->node[p]]));
  }
  return json_pack("{s:f, s:o, s:o}", "pressure_kPa", 1e-3 * pressure, "points_mm", points,
                   "stretch", stretch);
}

void skin_connectivity(const struct skin *skin, int32_t *connectivity) {
  for (int f = 0; f < skin->face_count; f++) {
    const int *order = vtu_order_quad9(skin->inward[f]);
    for (int m = 0; m < QUAD9_NODES; m++) {
      connectivity[QUAD9_NODES * f + m] = skin->face[f][order[m]];
    }
  }
}
