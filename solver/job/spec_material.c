#include <stdio.h>
#include <string.h>

#include "solver/job/material.h"
#include "solver/job/reader.h"

static int read_moduli(const struct reader *reader, const json_t *values, double *c) {
  int count = 0;
  size_t index;
  json_t *value;
  json_array_foreach(values, index, value) {
    c[count++] = reader_quantity(reader, value, "MPa");
  }
  return count;
}

static enum status read_ogden(const struct reader *reader, const json_t *material,
                              struct material_spec *spec) {
  const json_t *alpha = json_object_get(material, "alpha");
  spec->terms = read_moduli(reader, json_object_get(material, "mu"), spec->c);
  if (json_array_size(alpha) != (size_t)spec->terms) {
    return error_set(reader->error, STATUS_INVALID, "/material/alpha",
                     "there are %zu exponents for %d moduli\ngive one for each",
                     json_array_size(alpha), spec->terms);
  }
  for (int i = 0; i < spec->terms; i++) {
    spec->alpha[i] = json_number_value(json_array_get(alpha, (size_t)i));
    if (spec->alpha[i] == 0.0) {
      char pointer[40];
      snprintf(pointer, sizeof pointer, "/material/alpha/%d", i);
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "an exponent is 0\nit must be another number\n1.3");
    }
  }
  return STATUS_OK;
}

static enum status read_law(const struct reader *reader, const json_t *material, const char *model,
                            struct material_spec *spec) {
  if (strcmp(model, "neo-hooke") == 0) {
    spec->model = MATERIAL_NEO_HOOKE;
    spec->terms = 1;
    spec->c[0] = reader_member(reader, material, "mu", "MPa", 0.0);
    return STATUS_OK;
  }
  if (strcmp(model, "yeoh") == 0) {
    spec->model = MATERIAL_YEOH;
    spec->terms = read_moduli(reader, json_object_get(material, "C"), spec->c);
    return STATUS_OK;
  }
  if (strcmp(model, "mooney-rivlin") == 0) {
    spec->model = MATERIAL_MOONEY_RIVLIN;
    spec->terms = 2;
    spec->c[0] = reader_member(reader, material, "C10", "MPa", 0.0);
    spec->c[1] = reader_member(reader, material, "C01", "MPa", 0.0);
    return STATUS_OK;
  }
  spec->model = MATERIAL_OGDEN;
  return read_ogden(reader, material, spec);
}

enum status reader_material(const struct reader *reader, const json_t *material,
                            struct material_spec *spec) {
  if (json_is_string(material)) {
    const struct material_spec *found = material_find(json_string_value(material));
    if (!found) {
      return error_set(reader->error, STATUS_INTERNAL, "/material",
                       "a material of the schema has no record");
    }
    *spec = *found;
    return STATUS_OK;
  }
  const char *model = json_string_value(json_object_get(material, "model"));
  *spec = (struct material_spec){.terms = 0};
  reader_copy(spec->name, sizeof spec->name, model);
  reader_copy(spec->source, sizeof spec->source,
              json_string_value(json_object_get(material, "source")));
  spec->density_kg_m3 = reader_member(reader, material, "density", "kg/m3", 0.0);
  spec->bulk_ratio = json_number_value(json_object_get(material, "bulk_ratio"));
  spec->fit_stretch_max = json_number_value(json_object_get(material, "fit_stretch_max"));
  enum status status = read_law(reader, material, model, spec);
  if (status != STATUS_OK) {
    return status;
  }
  double modulus = material_shear_modulus(spec);
  if (!(modulus >= 1.0)) {
    return error_set(
        reader->error, STATUS_INVALID, "/material",
        "the initial shear modulus of this %s material is %.6g Pa\nit must be at least 1 Pa", model,
        modulus);
  }
  return STATUS_OK;
}
