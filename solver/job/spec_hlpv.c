#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/hlpv.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

enum { POINTER_MAX = 220, QUOTED_MAX = 60 };

static const char *const quantity_keys[HLPV_STATES] = {"h", "velocity", "pressure"};
static const char *const quantity_units[HLPV_STATES] = {"mm", "m/s", "kPa"};

/* ---- modes -------------------------------------------------------------------------------- */

static enum status read_per(const struct reader *reader, const json_t *value,
                            struct json_pointer *pointer, double *per) {
  const char *given = json_string_value(json_object_get(value, "per"));
  char quantity[QUOTED_MAX], quoted[QUOTED_MAX];
  if (!given) {
    return error_set(reader->error, STATUS_INVALID, pointer->text,
                     "the key \"per\" is missing, the unit of the set-point\na unit of "
                     "pressure\n{\"per\": \"psi\"}");
  }
  snprintf(quantity, sizeof quantity, "1 %s", given);
  if (units_read(reader->units, quantity, "kPa", per, NULL) == STATUS_OK && *per > 0.0) {
    return STATUS_OK;
  }
  json_pointer_key(pointer, "per");
  return error_set(reader->error, STATUS_INVALID, pointer->text,
                   "%s is no unit of pressure\na unit of pressure\n\"kPa\"",
                   text_quote(quoted, sizeof quoted, given));
}

/* stiffness: of the mode that `polynomial` belongs to, NULL for another coefficient. */
static enum status read_polynomial(const struct reader *reader, const json_t *value,
                                   const char *unit, const struct hlpv_spec *spec,
                                   struct json_pointer *pointer, struct hlpv_mode *stiffness,
                                   struct hlpv_polynomial *polynomial) {
  *polynomial = (struct hlpv_polynomial){.count = 1, .per = 1.0};
  if (json_is_string(value)) {
    polynomial->c[0] = reader_quantity(reader, value, unit);
    return STATUS_OK;
  }
  bool steady = json_object_get(value, "states") || json_object_get(value, "slope");
  const json_t *coefficients = json_object_get(value, "coefficients");
  enum status status = STATUS_OK;
  if (!steady && !coefficients) {
    return error_set(reader->error, STATUS_INVALID, pointer->text,
                     "the key \"coefficients\" is missing\nan array of "
                     "quantities\n{\"coefficients\": [\"3600 N/m\", \"-316 N/m\"]}");
  }
  if (!steady || json_object_get(value, "per")) {
    status = read_per(reader, value, pointer, &polynomial->per);
  }
  if (status == STATUS_OK && steady && stiffness) {
    return reader_hlpv_stiffness(reader, value, spec, pointer, polynomial->per, stiffness);
  }
  polynomial->count = (int)json_array_size(coefficients);
  for (int i = 0; i < polynomial->count; i++) {
    polynomial->c[i] = reader_quantity(reader, json_array_get(coefficients, (size_t)i), unit);
  }
  return status;
}

static enum status read_mode(const struct reader *reader, const char *name, const json_t *value,
                             const struct hlpv_spec *spec, struct hlpv_mode *mode) {
  const struct {
    const char *key, *unit;
    struct hlpv_polynomial *polynomial;
  } parts[] = {{"stiffness", "N/m", &mode->stiffness},
               {"damping", "N s/m", &mode->damping},
               {"alpha", "1/s", &mode->alpha},
               {"beta", "1/s", &mode->beta}};
  struct json_pointer pointer = {.length = 0};
  json_pointer_key(&pointer, "model");
  json_pointer_key(&pointer, "modes");
  json_pointer_key(&pointer, name);
  enum status status = STATUS_OK;
  reader_copy(mode->name, sizeof mode->name, name);
  mode->rest = reader_member(reader, value, "rest", "mm", 0.0);
  for (size_t i = 0; i < sizeof parts / sizeof *parts && status == STATUS_OK; i++) {
    size_t mark = json_pointer_key(&pointer, parts[i].key);
    status = read_polynomial(reader, json_object_get(value, parts[i].key), parts[i].unit, spec,
                             &pointer, i == 0 ? mode : NULL, parts[i].polynomial);
    json_pointer_pop(&pointer, mark);
  }
  const json_t *range = json_object_get(value, "range");
  mode->from = range ? reader_quantity(reader, json_array_get(range, 0), "kPa") : -INFINITY;
  mode->to = range ? reader_quantity(reader, json_array_get(range, 1), "kPa") : INFINITY;
  if (status == STATUS_OK && !(mode->from < mode->to)) {
    json_pointer_key(&pointer, "range");
    status = error_set(reader->error, STATUS_INVALID, pointer.text,
                       "the range does not rise\nthe first value must be below the second\n[\"0 "
                       "psi\", \"8 psi\"]");
  }
  return status;
}

static enum status read_modes(const struct reader *reader, const json_t *modes,
                              struct hlpv_spec *spec) {
  const char *name;
  json_t *value;
  if (json_object_size(modes) == 0) {
    return error_set(reader->error, STATUS_INVALID, "/model/modes",
                     "the model has no mode\nat least one mode, for example \"compressed\"");
  }
  json_object_foreach((json_t *)modes, name, value) {
    enum status status = read_mode(reader, name, value, spec, &spec->mode[spec->mode_count++]);
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* The index of the mode of that name. */
static enum status find_mode(const struct reader *reader, const struct hlpv_spec *spec,
                             const char *name, const char *pointer, int *index) {
  const char *words[HLPV_MODES_MAX];
  for (*index = 0; *index < spec->mode_count; ++*index) {
    words[*index] = spec->mode[*index].name;
    if (strcmp(words[*index], name) == 0) {
      return STATUS_OK;
    }
  }
  char quoted[QUOTED_MAX], known[QUOTED_MAX];
  const char *near = text_nearest(name, words, (size_t)spec->mode_count);
  return error_nearest(
      reader->error,
      error_set(reader->error, STATUS_INVALID, pointer,
                "there is no mode %s\none of the model's modes, of which %s is one",
                text_quote(quoted, sizeof quoted, name),
                text_quote(known, sizeof known, near ? near : words[0])),
      near);
}

/* ---- transitions -------------------------------------------------------------------------- */

static enum status read_guard(const struct reader *reader, const json_t *when, const char *pointer,
                              const struct hlpv_spec *spec, struct hlpv_transition *transition) {
  int given = 0;
  for (int i = 0; i < HLPV_STATES; i++) {
    const json_t *level = json_object_get(when, quantity_keys[i]);
    const json_t *steady = json_object_get(level, "steady");
    if (level) {
      given++;
      transition->quantity = (enum hlpv_quantity)i;
      transition->level =
          steady ? hlpv_rest(spec, transition->from, reader_quantity(reader, steady, "kPa"))
                 : reader_quantity(reader, level, quantity_units[i]);
    }
  }
  transition->direction =
      strcmp(json_string_value(json_object_get(when, "direction")), "rising") == 0 ? 1 : -1;
  if (given != 1) {
    return error_set(reader->error, STATUS_INVALID, pointer,
                     "%d quantities are compared\none of \"h\", \"velocity\" and \"pressure\"\n{ "
                     "\"h\": \"14 mm\", \"direction\": \"rising\" }",
                     given);
  }
  return isfinite(transition->level)
             ? STATUS_OK
             : error_set(reader->error, STATUS_INVALID, pointer,
                         "the mode has no state of rest there, for its stiffness vanishes\na "
                         "set-point with a stiffness");
}

static enum status read_reset(const struct reader *reader, const json_t *reset, const char *pointer,
                              const struct hlpv_spec *spec, struct hlpv_transition *transition) {
  for (int i = 0; i < HLPV_STATES; i++) {
    const json_t *value = json_object_get(reset, quantity_keys[i]);
    const json_t *factor = json_object_get(value, "times");
    const json_t *steady = json_object_get(value, "steady");
    struct hlpv_reset *map = &transition->reset[i];
    *map = (struct hlpv_reset){.factor = 1.0};
    if (factor && !steady) {
      map->factor = json_number_value(factor);
    } else if (steady && !factor) {
      double u = reader_quantity(reader, steady, "kPa");
      *map = (struct hlpv_reset){.value = hlpv_rest(spec, transition->to, u)};
    } else if (json_is_string(value)) {
      *map = (struct hlpv_reset){.value = reader_quantity(reader, value, quantity_units[i])};
    }
    if (json_is_object(value) && (!factor == !steady || !isfinite(map->value))) {
      return error_set(
          reader->error, STATUS_INVALID, pointer,
          "the reset has no value\na value, { \"times\": -0.8 } of the one before, or for h { "
          "\"steady\": \"4 psi\" }, a state of rest that the mode has");
    }
  }
  return STATUS_OK;
}

static enum status read_transitions(const struct reader *reader, const json_t *transitions,
                                    struct hlpv_spec *spec) {
  size_t index;
  json_t *value;
  enum status status = STATUS_OK;
  json_array_foreach(transitions, index, value) {
    struct hlpv_transition *transition = &spec->transition[spec->transition_count++];
    char pointer[POINTER_MAX];
    snprintf(pointer, sizeof pointer, "/model/transitions/%zu/from", index);
    status = find_mode(reader, spec, json_string_value(json_object_get(value, "from")), pointer,
                       &transition->from);
    if (status == STATUS_OK) {
      snprintf(pointer, sizeof pointer, "/model/transitions/%zu/to", index);
      status = find_mode(reader, spec, json_string_value(json_object_get(value, "to")), pointer,
                         &transition->to);
    }
    if (status == STATUS_OK) {
      snprintf(pointer, sizeof pointer, "/model/transitions/%zu/when", index);
      status = read_guard(reader, json_object_get(value, "when"), pointer, spec, transition);
    }
    if (status == STATUS_OK) {
      snprintf(pointer, sizeof pointer, "/model/transitions/%zu/reset", index);
      status = read_reset(reader, json_object_get(value, "reset"), pointer, spec, transition);
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}

/* ---- the whole ---------------------------------------------------------------------------- */

static enum status read_initial(const struct reader *reader, const json_t *value,
                                struct hlpv_spec *spec) {
  const char *mode = json_string_value(json_object_get(value, "mode"));
  enum status status = find_mode(reader, spec, mode, "/initial/mode", &spec->initial_mode);
  for (int i = 0; i < HLPV_STATES; i++) {
    spec->initial[i] = reader_member(reader, value, quantity_keys[i], quantity_units[i], 0.0);
  }
  return status;
}

static enum status check_start(const struct reader *reader, const struct hlpv_spec *spec) {
  for (int i = 0; i < spec->transition_count; i++) {
    const struct hlpv_transition *transition = &spec->transition[i];
    char pointer[40];
    snprintf(pointer, sizeof pointer, "/initial/%s", quantity_keys[transition->quantity]);
    if (transition->from == spec->initial_mode &&
        hlpv_is_crossed(spec, transition, hlpv_set_point(&spec->input, 0.0), spec->initial)) {
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "the start lies beyond the guard of /model/transitions/%d, which leaves the "
                       "mode \"%.40s\"\nstart on its other side, or in the mode \"%.40s\"",
                       i, spec->mode[transition->from].name, spec->mode[transition->to].name);
    }
  }
  return STATUS_OK;
}

/* The set-point, or what makes it. */
static enum status read_drive(const struct reader *reader, const json_t *document,
                              struct hlpv_spec *spec) {
  const json_t *input = json_object_get(document, "input");
  const json_t *control = json_object_get(document, "control");
  if (!input == !control) {
    return error_set(reader->error, STATUS_INVALID, control ? "/control" : NULL,
                     "one of \"input\" and \"control\" is wanted, %s\na set-point over time, or a "
                     "controller that makes it\n{\"input\": { \"hold\": [[\"0 s\", \"3 psi\"]] }}",
                     control ? "not both" : "and none is there");
  }
  return input ? reader_set_point(reader, input, "/input", &spec->input)
               : reader_hlpv_control(reader, control, spec);
}

enum status reader_hlpv(const struct reader *reader, const json_t *document, struct job_spec *job) {
  const json_t *model = json_object_get(document, "model");
  struct hlpv_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the model");
  }
  job->kind = JOB_HLPV;
  job->hlpv = spec;
  reader_copy(job->name, sizeof job->name, json_string_value(json_object_get(document, "name")));
  job->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
  spec->mass = reader_member(reader, model, "mass", "kg", 0.0);
  spec->gamma = reader_member(reader, model, "gamma", "N/kPa", 0.0);
  spec->rest_length = reader_member(reader, model, "rest_length", "mm", 0.0);
  spec->end = reader_member(reader, document, "end", "s", 0.0);
  spec->sample_rate = reader_member(reader, document, "sample_rate", "Hz", 0.0);
  spec->tolerance = json_number_value(json_object_get(document, "tolerance"));
  enum status status = read_modes(reader, json_object_get(model, "modes"), spec);
  if (status == STATUS_OK) {
    status = read_transitions(reader, json_object_get(model, "transitions"), spec);
  }
  if (status == STATUS_OK) {
    status = read_initial(reader, json_object_get(document, "initial"), spec);
  }
  if (status == STATUS_OK) {
    status = read_drive(reader, document, spec);
  }
  if (status == STATUS_OK) {
    status = reader_check_samples(reader, spec->end, spec->sample_rate, HLPV_SAMPLES_MAX);
  }
  return status == STATUS_OK ? check_start(reader, spec) : status;
}
