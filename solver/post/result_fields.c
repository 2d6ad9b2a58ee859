/* Files and warnings that go with a result. */
#include <math.h>
#include <stdlib.h>
#include "solver/job/material.h"
#include "solver/post/output.h"
#include "solver/post/result_internal.h"
#include "solver/post/skin.h"

enum status result_cause(const struct result *r, enum status status, struct error *error) {
  double reached = r->arc_stretch, unstable;
  for (size_t i = 0; i < r->sample_count; i++) {
    reached = fmax(reached, r->sample[i].max_stretch);
  }
  bool broke =
      status == STATUS_STEP_MINIMUM || status == STATUS_UNSTABLE_PATH || status == STATUS_INVERTED;
  if (!broke || material_stable_to(&r->spec->material, fmax(reached, 1), &unstable)) {
    return status;
  }
  char message[sizeof error->message];
  snprintf(message, sizeof message, "%s", error->message);
  return error_set(error, STATUS_UNSTABLE, "/material",
                   "%.300s; the material law is not stable beyond a stretch of %.3f, and %.3f was "
                   "reached",
                   message, unstable, reached);
}

json_t *result_warnings(const struct result *r) {
  const struct material_spec *m = &r->spec->material;
  json_t *list = json_array();
  double reached = 1, unstable, wall = r->model->mesh->wall_thickness;
  for (size_t i = 0; i < r->sample_count; i++) {
    reached = fmax(reached, r->sample[i].max_stretch);
  }
  if (r->spec->accuracy == ACCURACY_DRAFT) {
    json_array_append_new(list, json_string("a draft: the mesh is coarser than that of fast, to "
                                            "compare many designs; confirm this one at standard"));
  }
  if (!material_stable_to(m, reached, &unstable)) {
    json_array_append_new(
        list, json_sprintf("the material's tangent is not positive beyond a stretch of %.3f in "
                           "uniaxial, planar or equibiaxial tension; this run reached %.3f",
                           unstable, reached));
  }
  if (m->fit_stretch_max > 0 && reached > m->fit_stretch_max) {
    json_array_append_new(
        list, json_sprintf("this run reached a stretch of %.3f; the material was fitted up to %.3f",
                           reached, m->fit_stretch_max));
  }
  if (r->penetration > 0.005 * wall) {
    json_array_append_new(
        list,
        json_sprintf(r->spec->contact
                         ? "the surfaces overlap by %.3f mm, more than 0.5 %% of the thinnest wall"
                         : "contact is off and chambers overlap by %.3f mm",
                     1e3 * r->penetration));
  }
  if (r->estimate.status != STATUS_OK) {
    json_array_append_new(list, json_sprintf("the errors of the metrics could not be estimated: %s",
                                             r->estimate.message));
  }
  return list;
}

/* surface.json: the outer surface in the first and the last recorded state. */
static enum status write_json(struct result *r, const double *stretch_first,
                              const double *stretch_last, FILE *file, struct error *error) {
  const struct mesh *mesh = r->model->mesh;
  struct skin skin;
  enum status status = skin_create(mesh, false, &skin, error);
  if (status != STATUS_OK) {
    return status;
  }
  json_t *states = json_array();
  json_array_append_new(states,
                        skin_state(mesh, &skin, r->first.u, stretch_first, r->sample[0].pressure));
  if (r->sample_count > 1) {
    json_array_append_new(states, skin_state(mesh, &skin, r->last.u, stretch_last,
                                             r->sample[r->sample_count - 1].pressure));
  }
  json_t *document = json_pack("{s:o, s:o}", "quads", skin_quads(&skin), "states", states);
  if (!document || json_dumpf(document, file, JSON_COMPACT | JSON_REAL_PRECISION(8)) != 0) {
    status = error_set(error, STATUS_IO, NULL, "surface.json could not be written");
  }
  json_decref(document);
  skin_release(&skin);
  return status;
}

enum status result_export(struct result *r, const char *directory, struct error *error) {
  return export_create(r->spec, r->model, directory, &r->export, error);
}

/* surface.json into `directory`, and its name into the list. */
static enum status write_surface(struct result *r, const char *directory, struct error *error) {
  size_t nodes = (size_t)r->model->mesh->node_count;
  double *first = malloc(sizeof *first * nodes), *last = malloc(sizeof *last * nodes);
  struct output output;
  enum status status = STATUS_NO_MEMORY;
  if (!first || !last || shape_stretch(r->model, r->first.u, first) < 0 ||
      shape_stretch(r->model, r->last.u, last) < 0) {
    error_set(error, status, NULL, "no memory for the fields");
    goto done;
  }
  status = output_open(&output, directory, "surface.json", error);
  if (status == STATUS_OK) {
    status = write_json(r, first, last, output.file, error);
    status = output_close(&output, status, error);
  }
  if (status == STATUS_OK) {
    json_array_append_new(r->artifacts, json_string("surface.json"));
  }
done:
  free(first);
  free(last);
  return status;
}

enum status result_write_files(struct result *r, const char *directory, struct error *error) {
  if (r->failure.status != STATUS_OK) {
    *error = r->failure;
    return error->status;
  }
  if (r->sample_count == 0) {
    return STATUS_OK;
  }
  enum status status = write_surface(r, directory, error);
  if (status == STATUS_OK) {
    json_t *samples = result_samples(r);
    status = export_finish(r->export, &r->last, samples, r->midlines, r->artifacts, error);
    json_decref(samples);
  }
  return status;
}
