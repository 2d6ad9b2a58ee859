#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/grasp/files.h"
#include "solver/grasp/object_file.h"
#include "solver/job/grasp_shape.h"
#include "solver/mesh/actuator.h"
#include "solver/post/contact_field.h"
#include "solver/post/csv.h"
#include "solver/post/fields.h"
#include "solver/post/grasp_frames.h"
#include "solver/post/output.h"
#include "solver/post/skin.h"
#include "solver/rigid/skin.h"

enum { FRAMES_MAX = 60, FILE_NAME = 60 };

/* How far the object's triangles may be from its surface, of the length of the body. */
static const double flatness = 5e-4;

struct grasp_files {
  const struct gripper *gripper;
  const char *directory;
  json_t *written; /* names of files */
  struct grasp_frames *frames;
  struct object_file *object;
  /* Of the finger that is being solved. */
  int number;
  const struct finger *finger;
  struct skin skin;
  struct fields fields;
  double *touch; /* contact pressure of the object at the nodes, Pa */
  int32_t *connectivity;
  int recorded; /* states so far */
  int count;    /* frames */
  char name[FRAMES_MAX][FILE_NAME];
  double time[FRAMES_MAX]; /* s */
};

/* The object's surface for the pages; of a plane as much as a finger can reach. */
static enum status create_frames(struct grasp_files *files, struct error *error) {
  const struct job_spec *spec = files->gripper->spec;
  struct rigid_shape *shape = NULL;
  struct rigid_skin skin = {.vertex_count = 0};
  double extent = actuator_length(spec);
  enum status status = grasp_shape_create(&spec->grasp->object.shape, &shape, error);
  if (status == STATUS_OK) {
    status = rigid_shape_skin(shape, flatness * extent, extent, &skin, error);
  }
  if (status == STATUS_OK) {
    struct grasp_frames_object object = {skin.vertex_count, skin.vertex, skin.triangle_count,
                                         skin.triangle};
    status = grasp_frames_create(&object, &files->frames, error);
  }
  if (status == STATUS_OK) {
    status = object_file_create(&skin, &files->object, error);
  }
  rigid_skin_release(&skin);
  rigid_shape_destroy(shape);
  return status;
}

enum status grasp_files_create(const struct gripper *gripper, const char *directory,
                               struct grasp_files **out, struct error *error) {
  struct grasp_files *files = calloc(1, sizeof *files);
  *out = files;
  if (files) {
    files->gripper = gripper;
    files->directory = directory;
    files->written = json_array();
  }
  if (!files || !files->written) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the files of the run");
  }
  return create_frames(files, error);
}

static void end_finger(struct grasp_files *files) {
  skin_release(&files->skin);
  fields_release(&files->fields);
  free(files->touch);
  free(files->connectivity);
  files->touch = NULL;
  files->connectivity = NULL;
}

void grasp_files_destroy(struct grasp_files *files) {
  if (files) {
    end_finger(files);
    grasp_frames_destroy(files->frames);
    object_file_destroy(files->object);
    json_decref(files->written);
    free(files);
  }
}

static struct grasp_frames_pose pose_of(const struct rigid_pose *pose) {
  struct grasp_frames_pose out;
  memcpy(out.place, pose->place, sizeof out.place);
  memcpy(out.rotation, pose->rotation, sizeof out.rotation);
  return out;
}

/* Begins the frames of a finger, which stand for all that see the object as it does. */
static enum status begin_frames(struct grasp_files *files, int number, const struct mesh *mesh,
                                struct error *error) {
  const struct gripper *g = files->gripper;
  struct grasp_frames_pose pose[GRASP_FINGERS_MAX];
  int count = 0;
  for (int k = 0; k < g->count; k++) {
    const struct gripper_finger *finger = &g->finger[k];
    if (finger->like == number) {
      memcpy(pose[count].place, finger->place, sizeof finger->place);
      memcpy(pose[count++].rotation, finger->rotation, sizeof finger->rotation);
    }
  }
  return grasp_frames_begin(files->frames, mesh, pose, count, error);
}

enum status grasp_files_begin(struct grasp_files *files, int number, const struct finger *finger,
                              struct error *error) {
  const struct mesh *mesh = &finger->solve.mesh;
  end_finger(files);
  files->number = number;
  files->finger = finger;
  files->recorded = 0;
  files->count = 0;
  enum status status = skin_create(mesh, true, &files->skin, error);
  if (status == STATUS_OK) {
    status = fields_create(mesh, &files->fields);
  }
  files->connectivity =
      malloc(sizeof *files->connectivity * QUAD9_NODES * ((size_t)files->skin.face_count + 1));
  files->touch = malloc(sizeof *files->touch * ((size_t)mesh->node_count + 1));
  if (status != STATUS_OK || !files->connectivity || !files->touch) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the files of the run");
  }
  skin_connectivity(&files->skin, files->connectivity);
  return begin_frames(files, number, mesh, error);
}

/* Every how many recorded states there is a frame, so that they are few enough. */
static int frame_interval(const struct grasp_files *files) {
  const struct grasp_spec *g = files->gripper->spec->grasp;
  int steps = files->gripper->spec->load.steps;
  int records = steps * (g->release ? 2 : 1) + g->approach.steps + g->pull.steps + 8;
  int room = FRAMES_MAX - STAGE_COUNT - 1;
  return (records + room - 1) / room;
}

/* Contact with the object alone is shown by the pages, all contact together by the files. */
static enum status evaluate_fields(struct grasp_files *files) {
  const struct finger *f = files->finger;
  const struct fe_model *m = f->solve.model;
  enum status status = contact_field(&m->contact, files->finger->solve.mesh.node_count,
                                     f->solve.state.u, files->fields.contact);
  if (status == STATUS_OK) {
    status = fields_evaluate(m, &f->solve.state, &files->fields);
  }
  if (status == STATUS_OK) {
    status = model_obstacle_fields(m, f->solve.state.u, files->touch, NULL);
  }
  for (int n = 0; n < files->finger->solve.mesh.node_count; n++) {
    files->touch[n] = fmax(files->touch[n], 0); /* means over faces overshoot beside the contact */
    files->fields.contact[n] += files->touch[n];
  }
  return status;
}

static enum status write_surface(struct grasp_files *files, const char *name, struct error *error) {
  const struct skin *skin = &files->skin;
  struct fields_view view = {skin->point_count, skin->face_count, skin->node,
                             skin->mirrored,    VTU_QUAD9,        files->connectivity};
  struct output output;
  enum status status = output_open(&output, files->directory, name, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = fields_write(output.file, &files->finger->solve.mesh, &view, &files->fields);
  return output_close(&output, status, error);
}

static enum status write_list(struct grasp_files *files, const char *name, struct error *error) {
  struct output output;
  const char *names[FRAMES_MAX];
  for (int k = 0; k < files->count; k++) {
    names[k] = files->name[k];
  }
  enum status status = output_open(&output, files->directory, name, error);
  if (status == STATUS_OK) {
    vtu_write_collection(output.file, names, files->time, (size_t)files->count);
    status = output_close(&output, STATUS_OK, error);
  }
  return status;
}

static const struct rigid_pose *object_pose(const struct grasp_files *files) {
  return &files->finger->solve.model->obstacle[files->finger->obstacle]->pose;
}

/* Hands the state on to what the pages show. */
static enum status add_frame(struct grasp_files *files, const struct grasp_sample *sample) {
  const struct finger *f = files->finger;
  struct grasp_frames_state state = {f->solve.state.u, files->touch, files->fields.stretch};
  struct grasp_frames_pose pose = pose_of(object_pose(files));
  json_t *row = grasp_sample_object(sample);
  enum status status = row ? grasp_frames_add(files->frames, row, &pose, &state) : STATUS_NO_MEMORY;
  json_decref(row);
  return status;
}

/* Writes the present state of the finger, and the list of its files so far. */
static enum status write_frame(struct grasp_files *files, const struct grasp_sample *sample,
                               struct error *error) {
  char prefix[20] = "", list[FILE_NAME], *name = files->name[files->count];
  enum status status = evaluate_fields(files);
  if (status == STATUS_OK) {
    status = add_frame(files, sample);
  }
  if (status != STATUS_OK) {
    return error_set(error, status, NULL, "no memory for the fields of a state");
  }
  if (files->number > 0) {
    snprintf(prefix, sizeof prefix, "finger-%d-", files->number + 1);
  }
  snprintf(name, FILE_NAME, "%ssurface-%04d.vtu", prefix, files->count);
  snprintf(list, sizeof list, "%ssurface.pvd", prefix);
  status = write_surface(files, name, error);
  if (status == STATUS_OK && files->number == 0) {
    status = object_file_write(files->object, files->directory, object_pose(files), files->written,
                               sample->value[GRASP_TIME], error);
  }
  if (status == STATUS_OK) {
    if (files->count == 0) {
      json_array_append_new(files->written, json_string(list));
    }
    json_array_append_new(files->written, json_string(name));
    files->time[files->count++] = sample->value[GRASP_TIME];
    status = write_list(files, list, error);
  }
  return status;
}

enum status grasp_files_add(struct grasp_files *files, const struct grasp_sample *sample,
                            struct error *error) {
  bool first = files->count == 0;
  if (!sample->recorded || (sample->along == 0 && !first)) {
    return STATUS_OK;
  }
  files->recorded++;
  bool wanted = first || sample->along == 1 || files->recorded % frame_interval(files) == 0;
  return wanted && files->count < FRAMES_MAX ? write_frame(files, sample, error) : STATUS_OK;
}

enum status grasp_files_finish(struct grasp_files *files, const json_t *samples, json_t *artifacts,
                               struct error *error) {
  struct output output;
  enum status status =
      grasp_frames_save(files->frames, samples, files->directory, files->written, error);
  if (status == STATUS_OK) {
    status = output_open(&output, files->directory, "samples.csv", error);
  }
  if (status == STATUS_OK) {
    csv_write_objects(output.file, samples);
    status = output_close(&output, STATUS_OK, error);
    json_array_append_new(files->written, json_string("samples.csv"));
  }
  return status == STATUS_OK && json_array_extend(artifacts, files->written) != 0
             ? error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the files of the run")
             : status;
}
