#include <math.h>

#include "solver/job/reader.h"

/* The member "key" of the pressure has to be there. */
static enum status missing(const struct reader *reader, const char *key, const char *example) {
  return error_set(reader->error, STATUS_INVALID, "/load/pressure",
                   "the key \"%s\" is missing\na pressure\n{%s}", key, example);
}

/* Pressures of two rows: the load runs to the higher one, and the cavities follow in proportion. */
static enum status read_rows(const struct reader *reader, const json_t *pressure,
                             enum actuator_family family, struct load_spec *spec) {
  static const char *const side[2] = {"left", "right"};
  static const char example[] = "\"left\": \"80 kPa\", \"right\": \"40 kPa\"";
  double row[2];
  for (int c = 0; c < 2; c++) {
    const char *place = c == 0 ? "/load/pressure/left" : "/load/pressure/right";
    if (json_object_get(pressure, side[c]) && family != FAMILY_OBLIQUE) {
      return error_set(reader->error, STATUS_INVALID, place,
                       "only the family \"oblique-pneunet\" has two rows of chambers\none "
                       "pressure\n{\"to\": \"50 kPa\"}");
    }
    if (json_object_get(pressure, side[c]) && json_object_get(pressure, "to")) {
      return error_set(
          reader->error, STATUS_INVALID, place,
          "\"to\" already is the pressure of both rows\nleave it out, or \"left\" and \"right\"");
    }
    if (!json_object_get(pressure, side[c])) {
      return missing(reader, side[c], example);
    }
    row[c] = reader_member(reader, pressure, side[c], "kPa", 0.0);
  }
  spec->pressure_to = fmax(row[0], row[1]);
  if (!(spec->pressure_to > 0.0)) {
    return error_set(reader->error, STATUS_INVALID, "/load/pressure/left",
                     "no row has a pressure\none of both above 0 kPa, for example %s", example);
  }
  for (int c = 0; c < 2; c++) {
    spec->cavity_share[c] = row[c] / spec->pressure_to;
  }
  return STATUS_OK;
}

enum status reader_load(const struct reader *reader, const json_t *load,
                        enum actuator_family family, struct load_spec *spec) {
  const json_t *pressure = json_object_get(load, "pressure");
  bool rows = json_object_get(pressure, "left") || json_object_get(pressure, "right");
  const json_t *gravity = json_object_get(load, "gravity");
  *spec = (struct load_spec){.cavity_share = {1, 1}};
  spec->pressure_to = reader_member(reader, pressure, "to", "kPa", 0.0);
  spec->steps = reader_count(pressure, "steps", 0);
  for (size_t i = 0; i < 3; i++) {
    spec->gravity[i] = reader_quantity(reader, json_array_get(gravity, i), "m/s2");
  }
  if (rows) {
    return read_rows(reader, pressure, family, spec);
  }
  return json_object_get(pressure, "to") ? STATUS_OK : missing(reader, "to", "\"to\": \"50 kPa\"");
}
