#include "solver/job/spec.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/bistable.h"
#include "solver/job/embed.h"
#include "solver/job/grasp.h"
#include "solver/job/hlpv.h"
#include "solver/job/identify.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"
#include "solver/job/schema.h"
#include "solver/job/study.h"
#include "solver/job/study_optimise.h"
#include "solver/job/study_sample.h"

struct job_reader {
  struct units *units;
  struct schema *schema;
};

enum status job_reader_create(struct job_reader **reader, struct error *error) {
  struct job_reader *created = calloc(1, sizeof *created);
  if (!created) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the job reader");
  }
  size_t size = 0;
  const char *text = job_schema_text(&size);
  enum status status = units_create(&created->units, error);
  if (status == STATUS_OK) {
    status = schema_create(text, size, created->units, &created->schema, error);
  }
  if (status != STATUS_OK) {
    job_reader_destroy(created);
    return status;
  }
  *reader = created;
  return STATUS_OK;
}

void job_reader_destroy(struct job_reader *reader) {
  if (!reader) {
    return;
  }
  schema_destroy(reader->schema);
  units_destroy(reader->units);
  free(reader);
}

const struct units *job_reader_units(const struct job_reader *reader) {
  return reader->units;
}

/* ---- typed access ----------------------------------------------------------------------- */

double reader_quantity(const struct reader *reader, const json_t *text, const char *unit) {
  double si = 0.0;
  if (json_is_string(text)) {
    enum status status =
        units_read(reader->units, json_string_value(text), unit, &si, reader->error);
    assert(status == STATUS_OK); /* the schema has accepted the text */
    (void)status;
  }
  return si;
}

double reader_member(const struct reader *reader, const json_t *object, const char *key,
                     const char *unit, double otherwise) {
  const json_t *member = json_object_get(object, key);
  return member ? reader_quantity(reader, member, unit) : otherwise;
}

int reader_count(const json_t *object, const char *key, int otherwise) {
  const json_t *member = json_object_get(object, key);
  return member ? (int)json_number_value(member) : otherwise;
}

void reader_copy(char *field, size_t size, const char *text) {
  size_t length = text ? text_prefix(text, size - 1) : 0;
  if (length > 0) {
    memcpy(field, text, length);
  }
  field[length] = '\0';
}

/* ---- parts of a response job ------------------------------------------------------------ */

static enum status read_planes(const struct reader *reader, const json_t *planes,
                               struct job_spec *spec) {
  size_t index;
  const json_t *plane;
  json_array_foreach(planes, index, plane) {
    struct plane_spec *p = &spec->plane[spec->plane_count++];
    double square = 0;
    for (size_t i = 0; i < 3; i++) {
      p->point[i] =
          reader_quantity(reader, json_array_get(json_object_get(plane, "point"), i), "mm");
      p->normal[i] = json_number_value(json_array_get(json_object_get(plane, "normal"), i));
      square += p->normal[i] * p->normal[i];
    }
    if (square == 0) {
      struct json_pointer pointer = {.length = 0};
      json_pointer_key(&pointer, "planes");
      json_pointer_index(&pointer, index);
      json_pointer_key(&pointer, "normal");
      return error_set(
          reader->error, STATUS_INVALID, pointer.text,
          "the normal of a plane has no length\nat least one number that is not 0\n[0, 0, 1]");
    }
  }
  return STATUS_OK;
}

static void read_mesh(const json_t *mesh, struct mesh_spec *spec) {
  spec->gap_wall = reader_count(mesh, "gap_wall", 0);
  spec->cavity = reader_count(mesh, "cavity", 0);
  spec->gap = reader_count(mesh, "gap", 0);
  spec->half_width = reader_count(mesh, "half_width", 0);
  spec->side_wall = reader_count(mesh, "side_wall", 0);
  spec->bottom = reader_count(mesh, "bottom", 0);
  spec->height = reader_count(mesh, "height", 0);
  spec->top = reader_count(mesh, "top", 0);
}

static enum status read_range(const struct reader *reader, const json_t *metrics, const char *key,
                              double pressure_to, double *from, double *to) {
  const json_t *range = json_object_get(metrics, key);
  *from = 0.0;
  *to = pressure_to;
  if (!range) {
    return STATUS_OK;
  }
  struct json_pointer pointer = {.length = 0};
  json_pointer_key(&pointer, "metrics");
  json_pointer_key(&pointer, key);
  *from = reader_quantity(reader, json_array_get(range, 0), "kPa");
  *to = reader_quantity(reader, json_array_get(range, 1), "kPa");
  if (*from >= *to) {
    return error_set(reader->error, STATUS_INVALID, pointer.text,
                     "%.6g kPa is not below %.6g kPa\nthe first value must be below the "
                     "second\n[\"0 kPa\", \"%.6g kPa\"]",
                     *from / 1e3, *to / 1e3, pressure_to / 1e3);
  }
  if (*to > pressure_to * (1.0 + 1e-9)) {
    return error_set(
        reader->error, STATUS_INVALID, pointer.text,
        "the range ends at %.6g kPa, beyond the load\nat most the end of the load, %.6g kPa",
        *to / 1e3, pressure_to / 1e3);
  }
  return STATUS_OK;
}

static enum accuracy read_accuracy(const char *word) {
  return strcmp(word, "draft") == 0  ? ACCURACY_DRAFT
         : strcmp(word, "fast") == 0 ? ACCURACY_FAST
         : strcmp(word, "fine") == 0 ? ACCURACY_FINE
                                     : ACCURACY_STANDARD;
}

static enum actuator_family read_family(const char *word) {
  return strcmp(word, "oblique-pneunet") == 0 ? FAMILY_OBLIQUE : FAMILY_PNEUNET;
}

bool reader_half_model(const struct job_spec *spec) {
  const struct pneunet_spec *p = &spec->pneunet;
  const double *share = spec->load.cavity_share;
  bool body =
      spec->family == FAMILY_OBLIQUE ? share[0] == share[1] : p->taper_left == p->taper_right;
  bool symmetric = body && spec->load.gravity[1] == 0.0;
  for (int k = 0; k < spec->plane_count; k++) {
    symmetric = symmetric && spec->plane[k].normal[1] == 0.0;
  }
  return symmetric && !spec->whole_model;
}

static enum status read_actuator(const struct reader *reader, const json_t *actuator,
                                 struct job_spec *spec) {
  return spec->family == FAMILY_OBLIQUE
             ? reader_oblique(reader, actuator, &spec->oblique)
             : reader_pneunet(reader, actuator, &spec->given, &spec->pneunet);
}

/* The document has passed the schema and its defaults are filled in. */
static enum status read_response(const struct reader *reader, const json_t *document,
                                 struct job_spec *spec) {
  spec->kind = JOB_RESPONSE;
  reader_copy(spec->name, sizeof spec->name, json_string_value(json_object_get(document, "name")));
  spec->contact = json_is_true(json_object_get(document, "contact"));
  spec->accuracy = read_accuracy(json_string_value(json_object_get(document, "accuracy")));
  const char *symmetry = json_string_value(json_object_get(document, "symmetry"));
  spec->whole_model = strcmp(symmetry, "none") == 0;
  spec->error_estimate = json_is_true(json_object_get(document, "error_estimate"));
  spec->few_files = json_is_string(json_object_get(document, "files")) &&
                    strcmp(json_string_value(json_object_get(document, "files")), "few") == 0;
  spec->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  const json_t *actuator = json_object_get(document, "actuator");
  spec->family = read_family(json_string_value(json_object_get(actuator, "family")));
  read_mesh(json_object_get(document, "mesh"), &spec->mesh);
  const json_t *metrics = json_object_get(document, "metrics");
  enum status status =
      reader_load(reader, json_object_get(document, "load"), spec->family, &spec->load);
  double to = spec->load.pressure_to;
  if (status == STATUS_OK) {
    status = read_range(reader, metrics, "fit_range", to, &spec->metrics.fit_from,
                        &spec->metrics.fit_to);
  }
  if (status == STATUS_OK) {
    status = read_range(reader, metrics, "cai_range", to, &spec->metrics.cai_from,
                        &spec->metrics.cai_to);
  }
  if (status == STATUS_OK) {
    status = read_planes(reader, json_object_get(document, "planes"), spec);
  }
  if (status == STATUS_OK) {
    status = reader_material(reader, json_object_get(document, "material"), &spec->material);
  }
  if (status == STATUS_OK) {
    status = read_actuator(reader, actuator, spec);
  }
  if (status == STATUS_OK) {
    status = reader_sensitivity(reader, json_object_get(document, "sensitivity"), spec);
  }
  if (status == STATUS_OK) {
    status = reader_measured(reader, document, spec);
  }
  spec->half_model = reader_half_model(spec);
  return status;
}

/* ---- a verify job ------------------------------------------------------------------------- */

static enum status read_verify(const struct reader *reader, const json_t *document,
                               struct job_spec *spec) {
  struct verify_spec *verify = &spec->verify;
  spec->kind = JOB_VERIFY;
  reader_copy(spec->name, sizeof spec->name, json_string_value(json_object_get(document, "name")));
  spec->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  reader_copy(verify->name, sizeof verify->name,
              json_string_value(json_object_get(document, "case")));
  verify->refinement = reader_count(document, "refinement", 1);
  return STATUS_OK;
}

/* ---- a study ------------------------------------------------------------------------------ */

static enum status read_study(const struct job_reader *job_reader, const struct reader *reader,
                              json_t *document, struct job_spec *spec) {
  spec->kind = JOB_STUDY;
  reader_copy(spec->name, sizeof spec->name, json_string_value(json_object_get(document, "name")));
  spec->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  struct study study = {.count = 0};
  enum status status = study_sample(reader, document);
  if (status == STATUS_OK && study_is_search(document)) {
    status = study_search_begin(job_reader, document, reader->error);
  }
  if (status == STATUS_OK) {
    status = study_expand(job_reader, document, false, &study, reader->error);
  }
  study_release(&study);
  return status;
}

static enum status read_snap(const struct reader *reader, const json_t *document,
                             struct job_spec *spec) {
  const json_t *dynamics = json_object_get(document, "dynamics");
  enum status status = reader_snap(reader, document, spec);
  return status == STATUS_OK && dynamics ? reader_snap_dynamics(reader, dynamics, spec) : status;
}

static enum status read_grasp(const struct reader *reader, const json_t *document,
                              struct job_spec *spec) {
  enum status status = read_response(reader, document, spec);
  return status == STATUS_OK ? reader_grasp(reader, document, spec) : status;
}

static enum status read_kind(const struct job_reader *job_reader, const struct reader *reader,
                             json_t *document, struct job_spec *spec) {
  const char *kind = json_string_value(json_object_get(document, "kind"));
  return strcmp(kind, "verify") == 0           ? read_verify(reader, document, spec)
         : strcmp(kind, "study") == 0          ? read_study(job_reader, reader, document, spec)
         : strcmp(kind, "fit-material") == 0   ? reader_fit(reader, document, spec)
         : strcmp(kind, "material-curve") == 0 ? reader_material_curve(reader, document, spec)
         : strcmp(kind, "hlpv") == 0           ? reader_hlpv(reader, document, spec)
         : strcmp(kind, "identify") == 0       ? reader_identify(reader, document, spec)
         : strcmp(kind, "snap") == 0           ? read_snap(reader, document, spec)
         : strcmp(kind, "bistable") == 0       ? reader_bistable(reader, document, spec)
         : strcmp(kind, "grasp") == 0          ? read_grasp(reader, document, spec)
                                               : read_response(reader, document, spec);
}

/* What every kind has: who goes first, and with what. */
static void read_queue(const struct reader *reader, const json_t *document, struct job_spec *spec) {
  spec->memory_bytes = reader_member(reader, document, "memory", "MB", 0.0);
  spec->priority = reader_count(document, "priority", 0);
  spec->reuse = json_is_true(json_object_get(document, "reuse"));
}

/* Whether the spec alone does not say everything about the job. */
static bool keeps_document(const struct job_spec *spec) {
  return spec->kind == JOB_STUDY || spec->kind == JOB_FIT_MATERIAL || spec->kind == JOB_IDENTIFY ||
         spec->measured.metric[0] != '\0';
}

/* ---- the whole document ----------------------------------------------------------------- */

enum status job_reader_check(const struct job_reader *reader, json_t *document,
                             struct job_spec *spec, struct error *error) {
  struct error ignored;
  error = error ? error : &ignored;
  struct reader inner = {reader->units, error};
  *spec = (struct job_spec){.kind = JOB_RESPONSE};
  enum status status = embed_refuse(document, error);
  if (status == STATUS_OK) {
    status = schema_check(reader->schema, document, error);
  }
  if (status == STATUS_OK) {
    status = schema_fill(reader->schema, document, error);
  }
  if (status == STATUS_OK) {
    read_queue(&inner, document, spec);
    status = read_kind(reader, &inner, document, spec);
  }
  if (status == STATUS_OK) {
    status = job_hash(document, spec->hash, error);
  }
  if (status == STATUS_OK && keeps_document(spec)) {
    spec->document = json_incref(document);
  }
  if (status != STATUS_OK) {
    job_spec_release(spec);
  }
  return status;
}

enum status job_reader_read(const struct job_reader *reader, const char *text, size_t size,
                            struct job_spec *spec, struct error *error) {
  json_t *document = NULL;
  struct error ignored;
  error = error ? error : &ignored;
  *spec = (struct job_spec){.kind = JOB_RESPONSE};
  enum status status = json_text_read(text, size, &document, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = job_reader_check(reader, document, spec, error);
  if (status != STATUS_OK) {
    json_text_locate(text, size, error->pointer, &error->line, &error->column);
  }
  json_decref(document);
  return status;
}

void job_spec_release(struct job_spec *spec) {
  json_decref(spec->document);
  hlpv_spec_destroy(spec->hlpv);
  free(spec->identify);
  free(spec->snap);
  bistable_spec_destroy(spec->bistable);
  grasp_spec_destroy(spec->grasp);
  *spec = (struct job_spec){.kind = JOB_RESPONSE};
}

enum status job_spec_read(const char *text, size_t size, struct job_spec *spec,
                          struct error *error) {
  struct job_reader *reader = NULL;
  enum status status = job_reader_create(&reader, error);
  if (status == STATUS_OK) {
    status = job_reader_read(reader, text, size, spec, error);
  }
  job_reader_destroy(reader);
  return status;
}
