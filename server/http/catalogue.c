#include <string.h>

#include "schema/embedded.h"
#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "solver/job/material.h"
#include "solver/job/schema.h"

static json_t *material_view(const struct material_spec *material) {
  static const char *const models[] = {[MATERIAL_NEO_HOOKE] = "neo-hooke",
                                       [MATERIAL_YEOH] = "yeoh",
                                       [MATERIAL_MOONEY_RIVLIN] = "mooney-rivlin",
                                       [MATERIAL_OGDEN] = "ogden"};
  json_t *coefficients = json_array(), *exponents = json_array();
  for (int i = 0; i < material->terms; i++) {
    json_array_append_new(coefficients, json_real(material->c[i]));
    if (material->model == MATERIAL_OGDEN) {
      json_array_append_new(exponents, json_real(material->alpha[i]));
    }
  }
  return json_pack("{s:s, s:s, s:o, s:o, s:f, s:f, s:f, s:s, s:f}", "name", material->name, "model",
                   models[material->model], "coefficients_Pa", coefficients, "alpha", exponents,
                   "density_kg_m3", material->density_kg_m3, "bulk_ratio", material->bulk_ratio,
                   "shear_modulus_Pa", material_shear_modulus(material), "source", material->source,
                   "fit_stretch_max", material->fit_stretch_max);
}

void catalogue_materials(struct request *request, struct reply *reply) {
  (void)request;
  json_t *list = json_array();
  const struct material_spec *material;
  for (size_t i = 0; (material = material_builtin(i)); i++) {
    json_array_append_new(list, material_view(material));
  }
  reply_json(reply, 200, json_pack("{s:o}", "materials", list));
}

static const struct embedded_file *embedded_find(const char *name) {
  for (size_t i = 0; i < embedded_file_count; i++) {
    if (strcmp(embedded_files[i].name, name) == 0) {
      return &embedded_files[i];
    }
  }
  return NULL;
}

/* Replies with a document that the program carries. */
static void document_reply(const struct request *request, struct reply *reply,
                           const char *content_type, const void *data, size_t size) {
  uint64_t tag = cache_tag_add(cache_tag(), data, size);
  if (!cache_fresh(request, reply, tag)) {
    reply_static(reply, content_type, data, size);
    cache_mark(reply, tag);
  }
}

void catalogue_schema(struct request *request, struct reply *reply) {
  const char *name = request->parameters[0];
  const struct embedded_file *file = embedded_find("result.schema.json");
  if (strcmp(name, "job") == 0) {
    size_t size;
    const char *text = job_schema_text(&size);
    document_reply(request, reply, "application/schema+json", text, size);
  } else if (strcmp(name, "result") == 0 && file) {
    document_reply(request, reply, "application/schema+json", file->data, file->size);
  } else {
    reply_problem(reply, 404, "not_found", "There are the schemas job and result.");
  }
}

static void description_reply(const struct request *request, struct reply *reply, const char *name,
                              const char *content_type) {
  const struct embedded_file *file = embedded_find(name);
  if (file) {
    document_reply(request, reply, content_type, file->data, file->size);
  } else {
    reply_problem(reply, 404, "not_found", "This build carries no API description.");
  }
}

void catalogue_openapi_json(struct request *request, struct reply *reply) {
  description_reply(request, reply, "openapi.json", "application/json");
}

void catalogue_openapi_yaml(struct request *request, struct reply *reply) {
  description_reply(request, reply, "openapi.yaml", "application/yaml");
}
