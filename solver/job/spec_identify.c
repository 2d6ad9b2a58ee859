#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/identify.h"
#include "solver/job/reader.h"
#include "solver/job/steps.h"

static enum status read_columns(const struct reader *reader, const json_t *columns,
                                struct identify_spec *spec) {
  static const char at[] = "/columns";
  const struct {
    const char *key, *unit, *example;
    struct column_spec *column;
  } parts[] = {{"time", "s", "\"s\" or \"ms\"", &spec->time},
               {"set_point", "kPa", "\"kPa\" or \"psi\"", &spec->set_point},
               {"h", "mm", "\"mm\"", &spec->h},
               {"pressure", "kPa", "\"kPa\" or \"psi\"", &spec->pressure},
               {"trial", "1", "\"1\"", &spec->trial}};
  enum status status = STATUS_OK;
  spec->has_trial = json_object_get(columns, "trial") != NULL;
  for (size_t i = 0; i < (spec->has_trial ? 5 : 4) && status == STATUS_OK; i++) {
    status = reader_column(reader, columns, at, parts[i].key, parts[i].unit, parts[i].example,
                           parts[i].column);
  }
  return status;
}

static enum status read_modes(const struct reader *reader, const json_t *modes,
                              struct identify_spec *spec) {
  size_t index;
  const json_t *value;
  json_array_foreach(modes, index, value) {
    struct identify_mode *mode = &spec->mode[spec->mode_count++];
    reader_copy(mode->name, sizeof mode->name, json_string_value(json_object_get(value, "name")));
    mode->rest = reader_member(reader, value, "rest", "mm", NAN);
    for (size_t k = 0; k < index; k++) {
      if (strcmp(spec->mode[k].name, mode->name) == 0) {
        char pointer[40];
        snprintf(pointer, sizeof pointer, "/modes/%zu/name", index);
        return error_set(reader->error, STATUS_INVALID, pointer,
                         "two modes have the same name\nthe names must differ, for example "
                         "\"compressed\" and \"stretched\"");
      }
    }
  }
  return STATUS_OK;
}

static enum status read_levels(const struct reader *reader, const json_t *levels,
                               struct identify_spec *spec) {
  spec->level_count = (int)json_array_size(levels);
  if (spec->level_count > 0 && spec->level_count != spec->mode_count - 1) {
    return error_set(reader->error, STATUS_INVALID, "/levels",
                     "%d modes are parted by %d levels, not %d\none level between two modes, for "
                     "example [\"21 mm\"]",
                     spec->mode_count, spec->mode_count - 1, spec->level_count);
  }
  for (int i = 0; i < spec->level_count; i++) {
    spec->level[i] = reader_quantity(reader, json_array_get(levels, (size_t)i), "mm");
    if (i > 0 && !(spec->level[i] > spec->level[i - 1])) {
      char pointer[40];
      snprintf(pointer, sizeof pointer, "/levels/%d", i);
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "the levels do not rise\nthey must rise as the modes do, from short to "
                       "long\n[\"21 mm\", \"50 mm\"]");
    }
  }
  return STATUS_OK;
}

static void read_degrees(const json_t *degree, struct identify_spec *spec) {
  static const char *const keys[IDENTIFY_COEFFICIENTS] = {"stiffness", "damping", "alpha", "beta"};
  for (int i = 0; i < IDENTIFY_COEFFICIENTS; i++) {
    const json_t *value = json_is_object(degree) ? json_object_get(degree, keys[i]) : degree;
    spec->degree[i] = json_is_number(value) ? (int)json_number_value(value) : IDENTIFY_DEGREE_AUTO;
  }
}

static enum status read_per(const struct reader *reader, const json_t *document,
                            struct identify_spec *spec) {
  char quantity[80], quoted[60];
  reader_copy(spec->per_name, sizeof spec->per_name,
              json_string_value(json_object_get(document, "per")));
  snprintf(quantity, sizeof quantity, "1 %s", spec->per_name);
  if (units_read(reader->units, quantity, "kPa", &spec->per, NULL) == STATUS_OK &&
      spec->per > 0.0) {
    return STATUS_OK;
  }
  return error_set(reader->error, STATUS_INVALID, "/per",
                   "%s is no unit of pressure\na unit of pressure\n\"kPa\"",
                   text_quote(quoted, sizeof quoted, spec->per_name));
}

static enum status check_tables(const struct reader *reader, const json_t *document) {
  bool data = json_object_get(document, "data"), tables = json_object_get(document, "tables");
  return data != tables
             ? STATUS_OK
             : error_set(reader->error, STATUS_INVALID, data ? "/tables" : "",
                         "none or both of \"data\", a table, and \"tables\", several of them, are "
                         "given\none of them, for example \"data\": { \"file\": \"trials.csv\" }");
}

enum status reader_identify(const struct reader *reader, const json_t *document,
                            struct job_spec *job) {
  struct identify_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the job");
  }
  const json_t *noise = json_object_get(document, "noise");
  job->kind = JOB_IDENTIFY;
  job->identify = spec;
  reader_copy(job->name, sizeof job->name, json_string_value(json_object_get(document, "name")));
  job->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  spec->mass = reader_member(reader, document, "mass", "kg", NAN);
  spec->gamma = reader_member(reader, document, "gamma", "N/kPa", NAN);
  spec->rest_length = reader_member(reader, document, "rest_length", "mm", 0.0);
  spec->transit = reader_member(reader, document, "transit", "s", 0.0);
  spec->free_start = strcmp(json_string_value(json_object_get(document, "initial")), "free") == 0;
  spec->noise[0] = reader_member(reader, noise, "h", "mm", 0.0);
  spec->noise[1] = reader_member(reader, noise, "pressure", "kPa", 0.0);
  spec->tolerance = json_number_value(json_object_get(document, "tolerance"));
  spec->held_out_share = json_number_value(json_object_get(document, "held_out"));
  read_degrees(json_object_get(document, "degree"), spec);
  enum status status = check_tables(reader, document);
  if (status == STATUS_OK) {
    status = read_columns(reader, json_object_get(document, "columns"), spec);
  }
  if (status == STATUS_OK) {
    status = read_modes(reader, json_object_get(document, "modes"), spec);
  }
  if (status == STATUS_OK) {
    status = read_levels(reader, json_object_get(document, "levels"), spec);
  }
  if (status == STATUS_OK) {
    status = read_per(reader, document, spec);
  }
  struct trials trials;
  if (status == STATUS_OK) {
    status = trials_read(document, spec, &trials, reader->error);
  }
  if (status == STATUS_OK) {
    struct steps steps;
    status = steps_part(spec, &trials, &steps, reader->error);
    if (status == STATUS_OK) {
      steps_release(&steps);
    }
    trials_release(&trials);
  }
  return status;
}
