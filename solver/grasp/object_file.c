#include "solver/grasp/object_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/post/output.h"
#include "solver/post/vtu.h"

enum { OBJECTS_MAX = 64, NAME_SIZE = 32 };

struct object_file {
  int vertex_count, triangle_count;
  double *vertex;   /* 3 each, m, in the object's frame */
  int32_t *corners; /* 3 each */
  float *point;     /* 3 each, mm, where they are */
  int count;
  char name[OBJECTS_MAX][NAME_SIZE];
  double time[OBJECTS_MAX];
};

enum status object_file_create(const struct rigid_skin *skin, struct object_file **out,
                               struct error *error) {
  struct object_file *file = calloc(1, sizeof *file);
  size_t points = 3 * (size_t)skin->vertex_count, corners = 3 * (size_t)skin->triangle_count;
  *out = file;
  if (file) {
    file->vertex_count = skin->vertex_count;
    file->triangle_count = skin->triangle_count;
    file->vertex = malloc((points + 1) * sizeof *file->vertex);
    file->point = malloc((points + 1) * sizeof *file->point);
    file->corners = malloc((corners + 1) * sizeof *file->corners);
  }
  if (!file || !file->vertex || !file->point || !file->corners) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the object's surface");
  }
  memcpy(file->vertex, skin->vertex, points * sizeof *file->vertex);
  for (size_t i = 0; i < corners; i++) {
    file->corners[i] = skin->triangle[i];
  }
  return STATUS_OK;
}

void object_file_destroy(struct object_file *file) {
  if (file) {
    free(file->vertex);
    free(file->point);
    free(file->corners);
    free(file);
  }
}

static enum status write_surface(struct object_file *file, const char *directory,
                                 const struct rigid_pose *pose, struct error *error) {
  struct vtu_grid grid = {.point_count = file->vertex_count,
                          .cell_count = file->triangle_count,
                          .point = file->point,
                          .cell_nodes = 3,
                          .cell_type = VTU_TRIANGLE,
                          .connectivity = file->corners};
  for (int n = 0; n < file->vertex_count; n++) {
    double x[3];
    rigid_pose_outward(pose, file->vertex + 3 * n, x);
    for (int i = 0; i < 3; i++) {
      file->point[3 * n + i] = (float)(1e3 * x[i]);
    }
  }
  struct output output;
  enum status status = output_open(&output, directory, file->name[file->count], error);
  if (status != STATUS_OK) {
    return status;
  }
  status = vtu_write(output.file, &grid, NULL, 0);
  return output_close(&output, status, error);
}

enum status object_file_write(struct object_file *file, const char *directory,
                              const struct rigid_pose *pose, json_t *written, double time,
                              struct error *error) {
  const char *names[OBJECTS_MAX];
  struct output output;
  if (file->count == OBJECTS_MAX) {
    return STATUS_OK;
  }
  snprintf(file->name[file->count], NAME_SIZE, "object-%04d.vtu", file->count);
  enum status status = write_surface(file, directory, pose, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (file->count == 0) {
    json_array_append_new(written, json_string("object.pvd"));
  }
  json_array_append_new(written, json_string(file->name[file->count]));
  file->time[file->count++] = time;
  for (int k = 0; k < file->count; k++) {
    names[k] = file->name[k];
  }
  status = output_open(&output, directory, "object.pvd", error);
  if (status == STATUS_OK) {
    vtu_write_collection(output.file, names, file->time, (size_t)file->count);
    status = output_close(&output, STATUS_OK, error);
  }
  return status;
}
