#include "solver/post/skin.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

json_t *skin_quads(const struct skin *skin) {
  json_t *quads = json_array();
  for (int f = 0; f < skin->face_count; f++) {
    const int *p = skin->face[f];
    for (int a = 0; a < 2; a++) {
      for (int b = 0; b < 2; b++) {
        int corner = 3 * a + b;
        int second = skin->inward[f] ? corner + 1 : corner + 3;
        int fourth = skin->inward[f] ? corner + 3 : corner + 1;
        json_array_append_new(quads,
                              json_pack("[iiii]", p[corner], p[second], p[corner + 4], p[fourth]));
      }
    }
  }
  return quads;
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

static void write_points(FILE *file, const struct mesh *mesh, const struct skin *skin,
                         const double *u) {
  fputs("<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n", file);
  for (int p = 0; p < skin->point_count; p++) {
    double x[3];
    skin_position(mesh, skin, u, p, x);
    fprintf(file, "%.7g %.7g %.7g\n", 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
  }
  fputs("</DataArray></Points>\n", file);
}

static void write_cells(FILE *file, const struct skin *skin) {
  /* VTK: corners, edge middles, centre; cell type 28 is the biquadratic quadrilateral. */
  static const int order[2][QUAD9_NODES] = {{0, 6, 8, 2, 3, 7, 5, 1, 4},
                                            {0, 2, 8, 6, 1, 5, 7, 3, 4}};
  fputs("<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n", file);
  for (int f = 0; f < skin->face_count; f++) {
    for (int m = 0; m < QUAD9_NODES; m++) {
      fprintf(file, "%d%c", skin->face[f][order[skin->inward[f]][m]],
              m + 1 < QUAD9_NODES ? ' ' : '\n');
    }
  }
  fputs("</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n", file);
  for (int f = 1; f <= skin->face_count; f++) {
    fprintf(file, "%d\n", QUAD9_NODES * f);
  }
  fputs("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n", file);
  for (int f = 0; f < skin->face_count; f++) {
    fputs("28\n", file);
  }
  fputs("</DataArray></Cells>\n", file);
}

static void write_data(FILE *file, const struct mesh *mesh, const struct skin *skin,
                       const double *u, const double *node_stretch) {
  fputs("<PointData Vectors=\"displacement\" Scalars=\"stretch\">\n"
        "<DataArray type=\"Float32\" Name=\"displacement\" NumberOfComponents=\"3\" "
        "format=\"ascii\">\n",
        file);
  for (int p = 0; p < skin->point_count; p++) {
    double x[3], reference[3];
    skin_position(mesh, skin, u, p, x);
    skin_position(mesh, skin, NULL, p, reference);
    for (int i = 0; i < 3; i++) {
      fprintf(file, "%.7g%c", 1e3 * (x[i] - reference[i]), i < 2 ? ' ' : '\n');
    }
  }
  fputs("</DataArray>\n<DataArray type=\"Float32\" Name=\"stretch\" format=\"ascii\">\n", file);
  for (int p = 0; p < skin->point_count; p++) {
    fprintf(file, "%.6g\n", node_stretch[skin->node[p]]);
  }
  fputs("</DataArray></PointData>\n", file);
}

enum status skin_write_vtu(const struct mesh *mesh, const struct skin *skin, const double *u,
                           const double *node_stretch, const char *path, struct error *error) {
  FILE *file = fopen(path, "w");
  if (!file) {
    return error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  fprintf(file,
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
          "byte_order=\"LittleEndian\">\n<UnstructuredGrid><Piece NumberOfPoints=\"%d\" "
          "NumberOfCells=\"%d\">\n",
          skin->point_count, skin->face_count);
  write_points(file, mesh, skin, u);
  write_cells(file, skin);
  write_data(file, mesh, skin, u, node_stretch);
  fputs("</Piece></UnstructuredGrid></VTKFile>\n", file);
  bool failed = ferror(file);
  failed = fclose(file) != 0 || failed;
  return failed ? error_set(error, STATUS_IO, NULL, "writing %s failed: %s", path, strerror(errno))
                : STATUS_OK;
}
