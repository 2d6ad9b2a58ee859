#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/reader.h"
#include "solver/job/snap.h"

static bool has_word(const json_t *object, const char *key, const char *word) {
  const char *given = json_string_value(json_object_get(object, key));
  return given && strcmp(given, word) == 0;
}

/* ---- actuator ----------------------------------------------------------------------------- */

static enum status read_factors(const struct reader *reader, const json_t *imperfection,
                                const char *key, int pair_count, double factor[SNAP_PAIRS_MAX]) {
  const json_t *given = json_object_get(imperfection, key);
  for (int k = 0; k < SNAP_PAIRS_MAX; k++) {
    const json_t *value = json_array_get(given, (size_t)k);
    factor[k] = value ? json_number_value(value) : 1.0;
  }
  if (!given || (int)json_array_size(given) == pair_count) {
    return STATUS_OK;
  }
  char pointer[80];
  snprintf(pointer, sizeof pointer, "/actuator/imperfection/%s", key);
  return error_set(reader->error, STATUS_INVALID, pointer,
                   "there are %zu factors for %d pair%s\ngive one for each, from below",
                   json_array_size(given), pair_count, pair_count == 1 ? "" : "s");
}

static enum status read_bellows(const struct reader *reader, const json_t *actuator,
                                struct snap_spec *spec) {
  struct snap_given *g = &spec->given;
  spec->pair_count = reader_count(actuator, "pairs", 1);
  spec->ends = has_word(actuator, "ends", "plates") ? SNAP_PLATES : SNAP_PERIODIC;
  spec->rest_length = reader_member(reader, actuator, "rest_length", "mm", 0.0);
  g->outer_diameter = reader_member(reader, actuator, "outer_diameter", "mm", 0.0);
  g->wall = reader_member(reader, actuator, "wall", "mm", 0.0);
  g->hinge_length = reader_member(reader, actuator, "hinge_length", "mm", 0.0);
  g->hinge_wall = reader_member(reader, actuator, "hinge_wall", "mm", NAN);
  g->snapping_angle = reader_member(reader, actuator, "snapping_angle", "deg", 0.0);
  g->supporting_angle = reader_member(reader, actuator, "supporting_angle", "deg", 0.0);
  g->snapping_slant = reader_member(reader, actuator, "snapping_slant", "mm", 0.0);
  g->supporting_slant = reader_member(reader, actuator, "supporting_slant", "mm", NAN);
  g->supporting_pet = reader_member(reader, actuator, "supporting_pet", "mm", NAN);
  g->pet_thickness = reader_member(reader, actuator, "pet_thickness", "mm", 0.0);
  const json_t *imperfection = json_object_get(actuator, "imperfection");
  enum status status =
      read_factors(reader, imperfection, "snapping_angle", spec->pair_count, g->angle_factor);
  if (status == STATUS_OK) {
    status =
        read_factors(reader, imperfection, "snapping_slant", spec->pair_count, g->slant_factor);
  }
  return status == STATUS_OK
             ? read_factors(reader, imperfection, "pet_thickness", spec->pair_count, g->pet_factor)
             : status;
}

/* ---- materials ---------------------------------------------------------------------------- */

static enum status read_silicone(const struct reader *reader, const json_t *value,
                                 struct material_spec *silicone) {
  static const char place[] = "/material";
  enum status status = reader_material(reader, value, silicone);
  struct error *error = reader->error;
  if (status != STATUS_OK && strncmp(error->pointer, place, sizeof place - 1) == 0) {
    char rest[sizeof error->pointer];
    snprintf(rest, sizeof rest, "%s", error->pointer + sizeof place - 1);
    snprintf(error->pointer, sizeof error->pointer, "/silicone%.180s", rest);
  }
  return status;
}

static void read_pet(const struct reader *reader, const json_t *value, struct snap_spec *spec) {
  spec->given.pet_modulus = reader_member(reader, value, "modulus", "GPa", 0.0);
  spec->given.pet_poisson = json_number_value(json_object_get(value, "poisson_ratio"));
  spec->pet_yield_strain = json_number_value(json_object_get(value, "yield_strain"));
  spec->pet.density_kg_m3 = reader_member(reader, value, "density", "kg/m3", 0.0);
  reader_copy(spec->pet.name, sizeof spec->pet.name, "PET");
}

/* ---- load --------------------------------------------------------------------------------- */

static enum status read_law(const struct reader *reader, const json_t *law,
                            struct snap_spec *spec) {
  size_t index;
  const json_t *value;
  json_array_foreach(law, index, value) {
    double pressure = reader_quantity(reader, value, "kPa");
    if (spec->law_count > 0 && pressure <= spec->law[spec->law_count - 1]) {
      char pointer[40];
      snprintf(pointer, sizeof pointer, "/load/law/%zu", index);
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "%.6g kPa is not above %.6g kPa\nthey must rise", pressure / 1e3,
                       spec->law[spec->law_count - 1] / 1e3);
    }
    spec->law[spec->law_count++] = pressure;
  }
  if (spec->law_count > 0 && spec->pair_count > 1) {
    return error_set(
        reader->error, STATUS_INVALID, "/load/law",
        "the law is that of one pair, and there are %d\nleave it out, or give \"pairs\": 1",
        spec->pair_count);
  }
  return STATUS_OK;
}

static enum status read_snap_load(const struct reader *reader, const json_t *load,
                                  struct snap_spec *spec) {
  spec->pressure_to = reader_member(reader, load, "pressure_to", "kPa", 0.0);
  spec->vacuum_to = reader_member(reader, load, "vacuum_to", "kPa", 0.0);
  spec->extension_at = reader_member(reader, load, "extension_at", "kPa", spec->pressure_to);
  if (spec->extension_at < 0.0 || spec->extension_at > spec->pressure_to * (1.0 + 1e-9)) {
    return error_set(reader->error, STATUS_INVALID, "/load/extension_at",
                     "%.6g kPa is not on the way\n0 to %.6g kPa, the largest pressure",
                     spec->extension_at / 1e3, spec->pressure_to / 1e3);
  }
  return read_law(reader, json_object_get(load, "law"), spec);
}

/* ---- calibration -------------------------------------------------------------------------- */

static const struct {
  const char *pointer, *unit;
  double unit_si;
  size_t offset;
} calibrated[] = {
    {"/actuator/snapping_slant", "mm", 1e-3, offsetof(struct snap_given, snapping_slant)},
    {"/actuator/supporting_pet", "mm", 1e-3, offsetof(struct snap_given, supporting_pet)},
    {"/actuator/hinge_length", "mm", 1e-3, offsetof(struct snap_given, hinge_length)},
    {"/actuator/hinge_wall", "mm", 1e-3, offsetof(struct snap_given, hinge_wall)},
    {"/actuator/pet_thickness", "mm", 1e-3, offsetof(struct snap_given, pet_thickness)},
    {"/actuator/snapping_angle", "deg", M_PI / 180.0, offsetof(struct snap_given, snapping_angle)},
    {"/actuator/supporting_angle", "deg", M_PI / 180.0,
     offsetof(struct snap_given, supporting_angle)},
    {"/pet/modulus", "GPa", 1e9, offsetof(struct snap_given, pet_modulus)},
};

static enum status read_value(const struct reader *reader, const json_t *calibrate, const char *key,
                              const char *unit, double *value) {
  const char *text = json_string_value(json_object_get(calibrate, key));
  enum status status = units_read(reader->units, text, unit, value, reader->error);
  if (status != STATUS_OK) {
    snprintf(reader->error->pointer, sizeof reader->error->pointer, "/calibrate/%s", key);
  }
  return status;
}

/* Whether the body can exist with one end of the range. */
static enum status check_end(const struct reader *reader, const struct snap_spec *spec,
                             const char *key, double value) {
  struct snap_spec copy = *spec;
  struct error error = {.status = STATUS_OK};
  if (value > 0.0 && snap_set(&copy, value, &error) == STATUS_OK) {
    return STATUS_OK;
  }
  char pointer[40];
  snprintf(pointer, sizeof pointer, "/calibrate/%s", key);
  return error_set(reader->error, STATUS_GEOMETRY, pointer,
                   "there is no body with %s = %.6g %s\n%s", spec->calibrate.pointer,
                   value / spec->calibrate.unit_si, spec->calibrate.unit,
                   error.message[0] ? error.message : "a positive number");
}

static enum status read_calibrate(const struct reader *reader, const json_t *calibrate,
                                  struct snap_spec *spec) {
  struct snap_calibrate *c = &spec->calibrate;
  if (!calibrate) {
    return STATUS_OK;
  }
  c->asked = true;
  reader_copy(c->pointer, sizeof c->pointer,
              json_string_value(json_object_get(calibrate, "pointer")));
  reader_copy(c->metric, sizeof c->metric, json_string_value(json_object_get(calibrate, "metric")));
  for (size_t i = 0; i < sizeof calibrated / sizeof *calibrated; i++) {
    if (strcmp(c->pointer, calibrated[i].pointer) == 0) {
      c->unit = calibrated[i].unit;
      c->unit_si = calibrated[i].unit_si;
      c->offset = calibrated[i].offset;
    }
  }
  const char *of_metric = strstr(c->metric, "_kPa") ? "kPa" : "mm";
  enum status status = read_value(reader, calibrate, "target", of_metric, &c->target);
  if (status == STATUS_OK) {
    status = read_value(reader, calibrate, "from", c->unit, &c->from);
  }
  if (status == STATUS_OK) {
    status = read_value(reader, calibrate, "to", c->unit, &c->to);
  }
  if (status == STATUS_OK && c->from >= c->to) {
    return error_set(reader->error, STATUS_INVALID, "/calibrate/to",
                     "%.6g %s is not above %.6g %s\nthe first value must be below the second",
                     c->to / c->unit_si, c->unit, c->from / c->unit_si, c->unit);
  }
  if (status == STATUS_OK) {
    status = check_end(reader, spec, "from", c->from);
  }
  return status == STATUS_OK ? check_end(reader, spec, "to", c->to) : status;
}

/* ---- the job ------------------------------------------------------------------------------ */

static void read_options(const json_t *document, struct snap_spec *spec) {
  spec->model = has_word(document, "model", "shell") ? SNAP_SHELL : SNAP_SOLID;
  spec->contact = json_is_true(json_object_get(document, "contact"));
  spec->harmonics_to = reader_count(json_object_get(document, "harmonics"), "to", 0);
  spec->element_length = 1.0;
  spec->accuracy = has_word(document, "accuracy", "fast")   ? ACCURACY_FAST
                   : has_word(document, "accuracy", "fine") ? ACCURACY_FINE
                                                            : ACCURACY_STANDARD;
}

enum status reader_snap(const struct reader *reader, const json_t *document, struct job_spec *job) {
  struct snap_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the bellows");
  }
  job->kind = JOB_SNAP;
  job->snap = spec;
  reader_copy(job->name, sizeof job->name, json_string_value(json_object_get(document, "name")));
  job->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  read_options(document, spec);
  read_pet(reader, json_object_get(document, "pet"), spec);
  enum status status = read_bellows(reader, json_object_get(document, "actuator"), spec);
  if (status == STATUS_OK) {
    status = read_silicone(reader, json_object_get(document, "silicone"), &spec->silicone);
  }
  if (status == STATUS_OK) {
    status = read_snap_load(reader, json_object_get(document, "load"), spec);
  }
  if (status == STATUS_OK) {
    status = snap_derive(spec, reader->error);
  }
  return status == STATUS_OK ? read_calibrate(reader, json_object_get(document, "calibrate"), spec)
                             : status;
}
