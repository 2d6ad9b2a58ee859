#include "solver/post/export.h"

#include <stdlib.h>
#include <string.h>
#include "solver/post/contact_field.h"
#include "solver/post/csv.h"
#include "solver/post/deck.h"
#include "solver/post/fields.h"
#include "solver/post/output.h"
#include "solver/post/recording.h"
#include "solver/post/skin.h"

enum { NAME_SIZE = 32, FILES_MAX = EXPORT_STATES + 2 };

/* Files of one view of the body. */
struct series {
  const char *name; /* "surface" or "volume" */
  struct fields_view view;
  int32_t *connectivity;
  char file[FILES_MAX][NAME_SIZE];
};

struct export {
  const struct job_spec *spec;
  const struct fe_model *model;
  const char *directory;
  struct skin skin;
  struct fields fields;
  struct recording *recording;
  struct series series[2];
  double time[FILES_MAX]; /* kPa */
  size_t file_count;      /* of each series */
  int recorded, written;  /* states taken in; number of the last one written, -1: none */
  double pressure;        /* of the last state taken in, Pa */
};

static enum status prepare_surface(struct export *e, struct error *error) {
  struct series *s = &e->series[0];
  enum status status = skin_create(e->model->mesh, true, &e->skin, error);
  if (status != STATUS_OK) {
    return status;
  }
  s->name = "surface";
  s->connectivity =
      malloc(sizeof *s->connectivity * QUAD9_NODES * ((size_t)e->skin.face_count + 1));
  if (!s->connectivity) {
    return STATUS_NO_MEMORY;
  }
  skin_connectivity(&e->skin, s->connectivity);
  s->view = (struct fields_view){e->skin.point_count, e->skin.face_count, e->skin.node,
                                 e->skin.mirrored,    VTU_QUAD9,          s->connectivity};
  return STATUS_OK;
}

static enum status prepare_volume(struct export *e) {
  const struct mesh *mesh = e->model->mesh;
  const int *order = vtu_order_hex27();
  struct series *s = &e->series[1];
  s->name = "volume";
  s->connectivity =
      malloc(sizeof *s->connectivity * HEX27_NODES * ((size_t)mesh->element_count + 1));
  if (!s->connectivity) {
    return STATUS_NO_MEMORY;
  }
  for (int n = 0; n < HEX27_NODES * mesh->element_count; n++) {
    const int *nodes = mesh->element_nodes + n / HEX27_NODES * HEX27_NODES;
    s->connectivity[n] = nodes[order[n % HEX27_NODES]];
  }
  s->view = (struct fields_view){mesh->node_count, mesh->element_count, NULL, NULL,
                                 VTU_HEX27,        s->connectivity};
  return STATUS_OK;
}

enum status export_create(const struct job_spec *spec, const struct fe_model *model,
                          const char *directory, struct export **out, struct error *error) {
  struct export *e = calloc(1, sizeof *e);
  enum status status = e ? STATUS_OK : STATUS_NO_MEMORY;
  *out = NULL;
  if (status == STATUS_OK) {
    *e = (struct export){.spec = spec, .model = model, .directory = directory, .written = -1};
    status = fields_create(model->mesh, &e->fields);
  }
  if (status == STATUS_OK) {
    status = recording_create(model->mesh, &e->recording, error);
  }
  if (status == STATUS_OK) {
    status = prepare_surface(e, error);
  }
  if (status == STATUS_OK) {
    status = prepare_volume(e);
  }
  if (status != STATUS_OK) {
    export_destroy(e);
    return error_set(error, status, NULL, "no memory for the files of the run");
  }
  *out = e;
  return STATUS_OK;
}

void export_destroy(struct export *e) {
  if (!e) {
    return;
  }
  skin_release(&e->skin);
  recording_destroy(e->recording);
  fields_release(&e->fields);
  free(e->series[0].connectivity);
  free(e->series[1].connectivity);
  free(e);
}

static enum status write_collection(struct export *e, const struct series *s, struct error *error) {
  char name[NAME_SIZE];
  const char *files[FILES_MAX];
  struct output output;
  for (size_t k = 0; k < e->file_count; k++) {
    files[k] = s->file[k];
  }
  snprintf(name, sizeof name, "%s.pvd", s->name);
  enum status status = output_open(&output, e->directory, name, error);
  if (status == STATUS_OK) {
    vtu_write_collection(output.file, files, e->time, e->file_count);
    status = output_close(&output, STATUS_OK, error);
  }
  return status;
}

/* Number of series that are written. */
static int views(const struct export *e) {
  return e->spec->few_files ? 0 : 2;
}

/* Files of the last state taken in. */
static enum status write_state(struct export *e, const struct fe_state *state,
                               struct error *error) {
  enum status status = fields_evaluate(e->model, state, &e->fields);
  if (status == STATUS_OK) {
    status = recording_add(e->recording, &e->fields, 1e-3 * e->pressure);
  }
  if (status != STATUS_OK) {
    return error_set(error, status, NULL, "no memory for the fields of a state");
  }
  size_t k = e->file_count;
  for (int v = 0; v < views(e) && status == STATUS_OK; v++) {
    struct series *s = &e->series[v];
    struct output output;
    snprintf(s->file[k], sizeof s->file[k], "%s-%04d.vtu", s->name, e->recorded - 1);
    status = output_open(&output, e->directory, s->file[k], error);
    if (status == STATUS_OK) {
      status = fields_write(output.file, e->model->mesh, &s->view, &e->fields);
      status = output_close(&output, status, error);
    }
  }
  e->time[k] = 1e-3 * e->pressure;
  e->file_count += status == STATUS_OK;
  for (int v = 0; v < views(e) && status == STATUS_OK; v++) {
    status = write_collection(e, &e->series[v], error);
  }
  e->written = e->recorded - 1;
  return status;
}

enum status export_add(struct export *e, const struct fe_state *state, double pressure,
                       struct error *error) {
  const struct fe_model *m = e->model;
  int every = (e->spec->load.steps + EXPORT_STATES - 1) / EXPORT_STATES;
  /* Kept also of a state without files: it may turn out to be the last. */
  if (contact_field(&m->contact, m->mesh->node_count, state->u, e->fields.contact) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the contact pressure");
  }
  e->pressure = pressure;
  e->recorded++;
  if ((e->recorded - 1) % every != 0) {
    return STATUS_OK;
  }
  return write_state(e, state, error);
}

enum table { TABLE_SAMPLES, TABLE_MIDLINES, TABLE_RECORDING, TABLE_DECK };

static enum status write_table(struct export *e, enum table table, const char *name,
                               const json_t *rows, json_t *artifacts, struct error *error) {
  struct output output;
  enum status status = output_open(&output, e->directory, name, error);
  if (status != STATUS_OK) {
    return status;
  }
  switch (table) {
  case TABLE_SAMPLES:
    csv_write_objects(output.file, rows);
    break;
  case TABLE_MIDLINES:
    csv_write_midlines(output.file, rows);
    break;
  case TABLE_RECORDING:
    status = recording_write(e->recording, output.file);
    break;
  case TABLE_DECK:
    status = deck_print(e->model->mesh, e->spec, "C3D20R", output.file, error);
    break;
  }
  status = output_close(&output, status, error);
  if (status == STATUS_OK) {
    json_array_append_new(artifacts, json_string(name));
  }
  return status;
}

enum status export_finish(struct export *e, const struct fe_state *last, const json_t *samples,
                          const json_t *midlines, json_t *artifacts, struct error *error) {
  enum status status = STATUS_OK;
  if (e->recorded > 0 && e->written != e->recorded - 1) {
    status = write_state(e, last, error);
  }
  if (status == STATUS_OK) {
    status = write_table(e, TABLE_SAMPLES, "samples.csv", samples, artifacts, error);
  }
  if (status == STATUS_OK) {
    status = write_table(e, TABLE_MIDLINES, "midlines.csv", midlines, artifacts, error);
  }
  if (status == STATUS_OK && e->file_count > 0) {
    status = write_table(e, TABLE_RECORDING, "surface.bin", NULL, artifacts, error);
  }
  if (status == STATUS_OK && !e->spec->few_files && deck_knows(&e->spec->material)) {
    status = write_table(e, TABLE_DECK, "model.inp", NULL, artifacts, error);
  }
  for (int v = 0; v < views(e) && status == STATUS_OK && e->file_count > 0; v++) {
    json_array_append_new(artifacts, json_sprintf("%s.pvd", e->series[v].name));
    for (size_t k = 0; k < e->file_count; k++) {
      json_array_append_new(artifacts, json_string(e->series[v].file[k]));
    }
  }
  return status;
}
