#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/bistable.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

/* Exponent and atmosphere of a chamber that gives none. */
#define ADIABATIC 1.4
#define ATMOSPHERE 101325.0

enum { WHERE_MAX = 200, QUOTED_MAX = 60 };

/* ---- laws --------------------------------------------------------------------------------- */

/* A law that the snap job at `pointer` computes: its own reader fills what is its own, and this job
 * keeps kind, name and time limit. */
static enum status read_snap_law(const struct reader *reader, const char *name, const json_t *snap,
                                 const char *pointer, struct law_spec *law) {
  char where[WHERE_MAX];
  struct job_spec inner = {.kind = JOB_SNAP};
  enum status status = reader_snap(reader, snap, &inner);
  law->snap = inner.snap;
  reader_copy(law->name, sizeof law->name, name);
  reader_copy(law->pointer, sizeof law->pointer, pointer);
  law->is_table = true;
  if (status != STATUS_OK) {
    snprintf(where, sizeof where, "%.100s%.90s", pointer, reader->error->pointer);
    reader_copy(reader->error->pointer, sizeof reader->error->pointer, where);
  }
  return status;
}

static enum status read_closed_form(const struct reader *reader, const json_t *value,
                                    const char *pointer, struct law_spec *law) {
  const json_t *coefficients = json_object_get(value, "coefficients");
  const json_t *range = json_object_get(value, "range");
  const char *per = json_string_value(json_object_get(value, "per"));
  char quantity[QUOTED_MAX], quoted[QUOTED_MAX], where[WHERE_MAX];
  law->count = (int)json_array_size(coefficients);
  for (int i = 0; i < law->count; i++) {
    law->c[i] = reader_quantity(reader, json_array_get(coefficients, (size_t)i), "N");
  }
  law->area = reader_member(reader, value, "area", "cm2", 0.0);
  law->volume = reader_member(reader, value, "volume", "ml", 0.0);
  snprintf(quantity, sizeof quantity, "1 %s", per ? per : "?");
  if (units_read(reader->units, quantity, "mm", &law->per, NULL) != STATUS_OK ||
      !(law->per > 0.0)) {
    snprintf(where, sizeof where, "%.150s/per", pointer);
    return error_set(reader->error, STATUS_INVALID, per ? where : pointer,
                     "%s is no unit of the elongation in the powers\na unit of length\n\"mm\"",
                     text_quote(quoted, sizeof quoted, per ? per : ""));
  }
  law->from = range ? reader_quantity(reader, json_array_get(range, 0), "mm") : -5.0 * law->per;
  law->to = range ? reader_quantity(reader, json_array_get(range, 1), "mm") : 20.0 * law->per;
  if (!(law->from < law->to)) {
    snprintf(where, sizeof where, "%.150s/range", pointer);
    return error_set(reader->error, STATUS_INVALID, where,
                     "the range does not rise\nthe first value must be below the second\n[\"-2 "
                     "mm\", \"14 mm\"]");
  }
  return STATUS_OK;
}

static enum status read_law(const struct reader *reader, const char *name, const json_t *value,
                            struct law_spec *law) {
  const json_t *table = json_object_get(value, "table"), *snap = json_object_get(value, "snap");
  int ways = (table != NULL) + (snap != NULL) + (json_object_get(value, "coefficients") != NULL);
  static const char *const closed[] = {"coefficients", "per", "area", "volume", "range"};
  struct json_pointer pointer = {.length = 0};
  char where[WHERE_MAX + 10];
  json_pointer_key(&pointer, "laws");
  json_pointer_key(&pointer, name);
  reader_copy(law->name, sizeof law->name, name);
  reader_copy(law->pointer, sizeof law->pointer, pointer.text);
  law->is_table = table != NULL;
  if (ways != 1) {
    return error_set(reader->error, STATUS_INVALID, pointer.text,
                     "the law has none or several of its forms\none of \"table\", \"snap\" and "
                     "\"coefficients\"\n{ \"per\": \"mm\", \"coefficients\": [\"0 N\", \"5 N\"], "
                     "\"area\": \"8 cm2\" }");
  }
  for (size_t i = 0; (table || snap) && i < sizeof closed / sizeof *closed; i++) {
    if (json_object_get(value, closed[i])) {
      json_pointer_key(&pointer, closed[i]);
      return error_set(
          reader->error, STATUS_INVALID, pointer.text,
          "\"%s\" belongs to a law in closed form\na table or a snap job says it itself",
          closed[i]);
    }
  }
  if (snap) {
    json_pointer_key(&pointer, "snap");
    return read_snap_law(reader, name, snap, pointer.text, law);
  }
  snprintf(where, sizeof where, "%.180s/table", pointer.text);
  return table ? law_table_read(table, where, &law->table, reader->error)
               : read_closed_form(reader, value, pointer.text, law);
}

static enum status read_laws(const struct reader *reader, const json_t *laws,
                             struct bistable_spec *spec) {
  const char *name;
  json_t *value;
  enum status status = STATUS_OK;
  bool taken = spec->law_count > 0;
  json_object_foreach((json_t *)laws, name, value) {
    if (taken && strcmp(name, "snap") == 0) {
      return error_set(reader->error, STATUS_INVALID, "/laws/snap",
                       "the law of the job's own \"snap\" has this name\nanother name");
    }
    if (spec->law_count == BISTABLE_LAWS_MAX) {
      return error_set(reader->error, STATUS_INVALID, "/laws",
                       "there are too many laws\nat most %d, that of a snap job included",
                       BISTABLE_LAWS_MAX);
    }
    status = read_law(reader, name, value, &spec->law[spec->law_count++]);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* ---- supplies ----------------------------------------------------------------------------- */

enum status reader_pneumatics(const struct reader *reader, const json_t *value, const char *pointer,
                              struct supply_spec *supply) {
  static const struct {
    const char *key;
    enum supply_model model;
    bool needed;
  } keys[] = {{"time_constant", SUPPLY_LAG, true},
              {"dead_volume", SUPPLY_CHAMBER, true},
              {"conductance", SUPPLY_CHAMBER, true},
              {"exponent", SUPPLY_CHAMBER, false},
              {"atmosphere", SUPPLY_CHAMBER, false}};
  static const char *const models[] = {"direct", "lag", "chamber"};
  const char *word = json_string_value(json_object_get(value, "supply"));
  const json_t *exponent = json_object_get(value, "exponent");
  supply->model = strcmp(word, "chamber") == 0 ? SUPPLY_CHAMBER
                  : strcmp(word, "lag") == 0   ? SUPPLY_LAG
                                               : SUPPLY_DIRECT;
  for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
    bool given = json_object_get(value, keys[i].key) != NULL;
    bool wanted = keys[i].model == supply->model;
    char where[WHERE_MAX];
    if (given && !wanted) {
      snprintf(where, sizeof where, "%.150s/%s", pointer, keys[i].key);
      return error_set(reader->error, STATUS_INVALID, where,
                       "\"%s\" belongs to the supply \"%s\"\nthe keys of the supply \"%s\"",
                       keys[i].key, models[keys[i].model], word);
    }
    if (wanted && !given && keys[i].needed) {
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "the supply \"%s\" lacks a key\n\"%s\"; for example { \"supply\": "
                       "\"chamber\", \"dead_volume\": \"20 ml\", \"conductance\": \"5 ml/s/kPa\" } "
                       "or { \"supply\": \"lag\", \"time_constant\": \"0.1 s\" }",
                       word, keys[i].key);
    }
  }
  supply->time_constant = reader_member(reader, value, "time_constant", "s", 0.0);
  supply->dead_volume = reader_member(reader, value, "dead_volume", "ml", 0.0);
  supply->conductance = reader_member(reader, value, "conductance", "m3/s/kPa", 0.0);
  supply->exponent = exponent ? json_number_value(exponent) : ADIABATIC;
  supply->atmosphere = reader_member(reader, value, "atmosphere", "kPa", ATMOSPHERE);
  return STATUS_OK;
}

/* A chamber cannot be emptied beyond vacuum. */
static enum status check_vacuum(const struct reader *reader, const char *pointer,
                                const struct bistable_actuator *actuator) {
  const struct hlpv_input *input = &actuator->input;
  double least = input->profile == HLPV_SINE ? input->mean - fabs(input->amplitude) : INFINITY;
  for (size_t i = 0; i < input->count; i++) {
    least = fmin(least, input->value[i]);
  }
  if (actuator->supply.model != SUPPLY_CHAMBER || least >= -actuator->supply.atmosphere) {
    return STATUS_OK;
  }
  return error_set(reader->error, STATUS_INVALID, pointer,
                   "the set-point of %.6g kPa is below vacuum\nmore than %.6g kPa", 1e-3 * least,
                   -1e-3 * actuator->supply.atmosphere);
}

/* ---- actuators ---------------------------------------------------------------------------- */

static enum status find_law(const struct reader *reader, const struct bistable_spec *spec,
                            const char *name, const char *pointer, int *index) {
  const char *words[BISTABLE_LAWS_MAX];
  for (*index = 0; *index < spec->law_count; ++*index) {
    words[*index] = spec->law[*index].name;
    if (strcmp(words[*index], name) == 0) {
      return STATUS_OK;
    }
  }
  char quoted[QUOTED_MAX], known[QUOTED_MAX];
  const char *near = text_nearest(name, words, (size_t)spec->law_count);
  return error_nearest(reader->error,
                       error_set(reader->error, STATUS_INVALID, pointer, "there is no law %s\n%s%s",
                                 text_quote(quoted, sizeof quoted, name),
                                 near ? "a name of \"laws\", such as " : "a name of \"laws\"",
                                 near ? text_quote(known, sizeof known, near) : ""),
                       near);
}

static enum status read_stops(const struct reader *reader, const json_t *stops, const char *pointer,
                              struct cell_spec *cell) {
  char where[WHERE_MAX];
  cell->stop_from = reader_member(reader, stops, "from", "mm", -INFINITY);
  cell->stop_to = reader_member(reader, stops, "to", "mm", INFINITY);
  cell->stop_stiffness = reader_member(reader, stops, "stiffness", "N/m", 0.0);
  if (cell->stop_from < cell->stop_to) {
    return STATUS_OK;
  }
  snprintf(where, sizeof where, "%.150s/stops", pointer);
  return error_set(
      reader->error, STATUS_INVALID, where,
      "the stops leave no room, from %.6g mm to %.6g mm\n\"from\" must be below \"to\"",
      1e3 * cell->stop_from, 1e3 * cell->stop_to);
}

static enum status read_cell(const struct reader *reader, const json_t *value, const char *pointer,
                             struct bistable_spec *spec, struct bistable_actuator *actuator) {
  struct cell_spec cell = {.stretched = false};
  char where[WHERE_MAX];
  int count = reader_count(value, "count", 1);
  snprintf(where, sizeof where, "%.150s/law", pointer);
  enum status status =
      find_law(reader, spec, json_string_value(json_object_get(value, "law")), where, &cell.law);
  if (status == STATUS_OK) {
    status = read_stops(reader, json_object_get(value, "stops"), pointer, &cell);
  }
  if (status == STATUS_OK && spec->cell_count + count > BISTABLE_CELLS_MAX) {
    status =
        error_set(reader->error, STATUS_INVALID, pointer, "there are %d cells in all\nat most %d",
                  spec->cell_count + count, BISTABLE_CELLS_MAX);
  }
  if (status != STATUS_OK) {
    return status;
  }
  cell.stiffness = json_number_value(json_object_get(value, "stiffness_factor"));
  cell.size = json_number_value(json_object_get(value, "size_factor"));
  cell.mass = reader_member(reader, value, "mass", "kg", 0.0);
  cell.damping = reader_member(reader, value, "damping", "N s/m", 0.0);
  cell.stretched = strcmp(json_string_value(json_object_get(value, "side")), "stretched") == 0;
  cell.elongation = reader_member(reader, value, "elongation", "mm", NAN);
  for (int i = 0; i < count; i++) {
    spec->cell[spec->cell_count++] = cell;
  }
  actuator->cell_count += count;
  return STATUS_OK;
}

static enum status read_actuator(const struct reader *reader, const json_t *document,
                                 const json_t *value, const char *pointer,
                                 struct bistable_spec *spec) {
  struct bistable_actuator *actuator = &spec->actuator[spec->actuator_count++];
  const json_t *own_air = json_object_get(value, "pneumatics");
  const json_t *own_input = json_object_get(value, "input");
  const json_t *input = own_input ? own_input : json_object_get(document, "input");
  const json_t *cells = json_object_get(value, "cells");
  char where[WHERE_MAX], input_at[WHERE_MAX];
  actuator->offset = reader_member(reader, value, "offset", "mm", 0.0);
  actuator->first_cell = spec->cell_count;
  enum status status = STATUS_OK;
  for (size_t i = 0; i < json_array_size(cells) && status == STATUS_OK; i++) {
    snprintf(where, sizeof where, "%.100s/cells/%zu", pointer, i);
    status = read_cell(reader, json_array_get(cells, i), where, spec, actuator);
  }
  snprintf(where, sizeof where, "%.100s/pneumatics", own_air ? pointer : "");
  snprintf(input_at, sizeof input_at, "%.100s/input", own_input ? pointer : "");
  if (status == STATUS_OK) {
    status = reader_pneumatics(reader, own_air ? own_air : json_object_get(document, "pneumatics"),
                               where, &actuator->supply);
  }
  if (status == STATUS_OK && !input) {
    status = error_set(reader->error, STATUS_INVALID, pointer,
                       "the actuator has no set-point\n\"input\" here or in the job\n{\"input\": { "
                       "\"hold\": [[\"0 s\", \"40 kPa\"]] }");
  }
  if (status == STATUS_OK) {
    status = reader_set_point(reader, input, input_at, &actuator->input);
  }
  return status == STATUS_OK ? check_vacuum(reader, input_at, actuator) : status;
}

static enum status read_actuators(const struct reader *reader, const json_t *document,
                                  struct bistable_spec *spec) {
  const json_t *actuators = json_object_get(document, "actuators");
  bool apart = json_array_size(actuators) == 1;
  for (size_t i = 0; i < json_array_size(actuators); i++) {
    char pointer[WHERE_MAX];
    snprintf(pointer, sizeof pointer, "/actuators/%zu", i);
    enum status status =
        read_actuator(reader, document, json_array_get(actuators, i), pointer, spec);
    if (status != STATUS_OK) {
      return status;
    }
    apart = apart || spec->actuator[i].offset != spec->actuator[0].offset;
  }
  if (!apart) {
    return error_set(reader->error, STATUS_INVALID, "/actuators",
                     "all actuators have the same offset, about which the plate would be free to "
                     "turn\ndifferent offsets, for example \"-25 mm\" and \"25 mm\"");
  }
  return STATUS_OK;
}

/* ---- the whole ---------------------------------------------------------------------------- */

static void read_plate_and_load(const struct reader *reader, const json_t *document,
                                struct bistable_spec *spec) {
  const json_t *plate = json_object_get(document, "plate");
  const json_t *load = json_object_get(document, "load");
  const json_t *initial = json_object_get(document, "initial");
  spec->plate_mass = reader_member(reader, plate, "mass", "kg", 0.0);
  spec->plate_inertia = reader_member(reader, plate, "inertia", "kg m2", 0.0);
  spec->bending_stiffness = reader_member(reader, plate, "bending_stiffness", "N m", 0.0);
  spec->plate_damping = reader_member(reader, plate, "damping", "N s/m", 0.0);
  spec->has_load = load != NULL;
  spec->load_mass = reader_member(reader, load, "mass", "kg", 0.0);
  spec->load_gap = reader_member(reader, load, "gap", "mm", 0.0);
  spec->restitution = json_number_value(json_object_get(load, "restitution"));
  spec->gravity = reader_member(reader, document, "gravity", "m/s2", 0.0);
  spec->velocity = reader_member(reader, initial, "velocity", "m/s", 0.0);
  spec->tilt_rate = reader_member(reader, initial, "tilt_rate", "deg/s", 0.0);
  spec->initial_pressure = reader_member(reader, initial, "pressure", "kPa", NAN);
  spec->rest_length = reader_member(reader, document, "rest_length", "mm", 0.0);
  spec->end = reader_member(reader, document, "end", "s", 0.0);
  spec->sample_rate = reader_member(reader, document, "sample_rate", "Hz", 0.0);
  spec->tolerance = json_number_value(json_object_get(document, "tolerance"));
}

static enum status check_whole(const struct reader *reader, const struct bistable_spec *spec) {
  for (int a = 0; a < spec->actuator_count; a++) {
    const struct supply_spec *supply = &spec->actuator[a].supply;
    if (supply->model == SUPPLY_CHAMBER && spec->initial_pressure <= -supply->atmosphere) {
      return error_set(reader->error, STATUS_INVALID, "/initial/pressure",
                       "%.6g kPa is vacuum or below it\nit must be above",
                       1e-3 * spec->initial_pressure);
    }
  }
  if (spec->load_gap > 0.0 && spec->gravity != 0.0) {
    return error_set(reader->error, STATUS_INVALID, "/load/gap",
                     "a load at a distance from the plate would fall\ngive no gap, or no gravity");
  }
  return reader_check_samples(reader, spec->end, spec->sample_rate, BISTABLE_SAMPLES_MAX);
}

enum status reader_bistable(const struct reader *reader, const json_t *document,
                            struct job_spec *job) {
  const json_t *snap = json_object_get(document, "snap");
  struct bistable_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the model");
  }
  job->kind = JOB_BISTABLE;
  job->bistable = spec;
  reader_copy(job->name, sizeof job->name, json_string_value(json_object_get(document, "name")));
  job->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  enum status status =
      snap ? read_snap_law(reader, "snap", snap, "/snap", &spec->law[spec->law_count++])
           : STATUS_OK;
  if (status == STATUS_OK) {
    status = read_laws(reader, json_object_get(document, "laws"), spec);
  }
  if (status == STATUS_OK) {
    status = read_actuators(reader, document, spec);
  }
  read_plate_and_load(reader, document, spec);
  return status == STATUS_OK ? check_whole(reader, spec) : status;
}
