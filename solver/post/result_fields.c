/* Files and warnings that go with a result. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/job/material.h"
#include "solver/post/result_internal.h"
#include "solver/post/skin.h"

json_t *result_warnings(const struct result *r) {
  const struct material_spec *m = &r->spec->material;
  json_t *list = json_array();
  double reached = 1, bent = 0, unstable, wall = r->model->mesh->wall_thickness;
  for (size_t i = 0; i < r->sample_count; i++) {
    reached = fmax(reached, r->sample[i].max_stretch);
    bent = fmax(bent, fabs(r->sample[i].shape.bending_angle));
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
  if (r->penetration > 0.02 * wall) {
    json_array_append_new(
        list, json_sprintf(r->spec->contact
                               ? "chambers overlap by %.3f mm, more than 2 %% of the thinnest wall"
                               : "contact is off and chambers overlap by %.3f mm",
                           1e3 * r->penetration));
  }
  if (bent > 1.5 * M_PI) {
    json_array_append_new(
        list, json_sprintf("the body bends by %.0f degrees: beyond about 270 it may meet itself, "
                           "which only neighbouring chambers are kept from",
                           bent * 180 / M_PI));
  }
  return list;
}

/* surface.json: the outer surface in the first and the last recorded state. */
static enum status write_json(struct result *r, const double *stretch_first,
                              const double *stretch_last, const char *path, struct error *error) {
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
  if (!document || json_dump_file(document, path, JSON_COMPACT | JSON_REAL_PRECISION(8)) != 0) {
    status = error_set(error, STATUS_IO, NULL, "writing %s failed: %s", path, strerror(errno));
  }
  json_decref(document);
  skin_release(&skin);
  return status;
}

static enum status write_vtu(struct result *r, const double *stretch, const char *path,
                             struct error *error) {
  struct skin skin;
  enum status status = skin_create(r->model->mesh, true, &skin, error);
  if (status == STATUS_OK) {
    status = skin_write_vtu(r->model->mesh, &skin, r->last.u, stretch, path, error);
    skin_release(&skin);
  }
  return status;
}

enum status result_write_fields(struct result *r, const char *directory, struct error *error) {
  if (r->sample_count == 0) {
    return STATUS_OK;
  }
  char path[4096];
  size_t nodes = (size_t)r->model->mesh->node_count;
  double *first = malloc(sizeof *first * nodes), *last = malloc(sizeof *last * nodes);
  enum status status = STATUS_OK;
  if (!first || !last || shape_stretch(r->model, r->first.u, first) < 0 ||
      shape_stretch(r->model, r->last.u, last) < 0) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the fields");
    goto done;
  }
  snprintf(path, sizeof path, "%s/surface.json", directory);
  status = write_json(r, first, last, path, error);
  if (status != STATUS_OK) {
    goto done;
  }
  json_array_append_new(r->artifacts, json_string("surface.json"));
  snprintf(path, sizeof path, "%s/surface.vtu", directory);
  status = write_vtu(r, last, path, error);
  if (status == STATUS_OK) {
    json_array_append_new(r->artifacts, json_string("surface.vtu"));
  }
done:
  free(first);
  free(last);
  return status;
}
