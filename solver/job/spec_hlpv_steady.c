/* Numbers of a hybrid model that follow from its states of rest, where gamma u = k(u) (h - rest).
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/job/hlpv.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

enum { STATES_MAX = 4 };

/* A set-point and the elongation at which it rests. */
struct state {
  double u, h;
};

/* sentence: what was found, what is allowed and an example, each in a line. */
static enum status refuse(const struct reader *reader, const struct json_pointer *pointer,
                          const char *sentence) {
  return error_set(reader->error, STATUS_INVALID, pointer->text, "%s", sentence);
}

/* Reads [set-point, elongation]; the elongation is a length, or a number: of the rest length. */
static enum status read_state(const struct reader *reader, const struct hlpv_spec *spec,
                              const json_t *pair, struct json_pointer *pointer,
                              struct state *state) {
  const json_t *u = json_array_get(pair, 0), *h = json_array_get(pair, 1);
  enum status status = STATUS_OK;
  if (!json_is_string(u)) {
    return refuse(reader, pointer,
                  "the first item is no set-point\na set-point comes first, and then the "
                  "elongation\n[\"3 psi\", \"5 mm\"]");
  }
  status = units_read(reader->units, json_string_value(u), "kPa", &state->u, reader->error);
  if (status == STATUS_OK && json_is_string(h)) {
    status = units_read(reader->units, json_string_value(h), "mm", &state->h, reader->error);
  } else if (status == STATUS_OK) {
    state->h = json_number_value(h) * spec->rest_length;
    if (spec->rest_length == 0.0) {
      return refuse(reader, pointer,
                    "an elongation without a unit is a part of rest_length, which the model does "
                    "not give\nan elongation with its unit, or a model with rest_length\n[\"3 "
                    "psi\", \"5 mm\"]");
    }
  }
  if (status != STATUS_OK) {
    reader_copy(reader->error->pointer, sizeof reader->error->pointer, pointer->text);
  }
  return status;
}

/* The polynomial of least degree through k[i] at u[i]: Newton's divided differences, expanded into
 * powers. */
static void interpolate(int count, const double u[], const double k[],
                        struct hlpv_polynomial *polynomial) {
  double difference[STATES_MAX], *c = polynomial->c;
  memcpy(difference, k, (size_t)count * sizeof *k);
  for (int order = 1; order < count; order++) {
    for (int i = count - 1; i >= order; i--) {
      difference[i] = (difference[i] - difference[i - 1]) / (u[i] - u[i - order]);
    }
  }
  memset(c, 0, HLPV_TERMS_MAX * sizeof *c);
  for (int n = count - 1; n >= 0; n--) {
    for (int i = count - 1; i > 0; i--) {
      c[i] = c[i - 1] - u[n] * c[i];
    }
    c[0] = difference[n] - u[n] * c[0];
  }
  polynomial->count = count;
}

/* Stiffness from `count` states, rest being given. */
static enum status through_states(const struct reader *reader, const struct hlpv_spec *spec,
                                  const struct json_pointer *pointer, const struct state *state,
                                  int count, double per, struct hlpv_mode *mode) {
  double u[STATES_MAX], k[STATES_MAX];
  for (int i = 0; i < count; i++) {
    for (int j = 0; j < i; j++) {
      if (state[i].u == state[j].u) {
        return refuse(
            reader, pointer,
            "two states of rest have the same set-point\neach has a set-point of its own\n"
            "[[\"3 psi\", \"5 mm\"], [\"5 psi\", \"14 mm\"]]");
      }
    }
    u[i] = state[i].u / per;
    k[i] = spec->gamma * state[i].u / (state[i].h - mode->rest);
    if (!(k[i] > 0.0 && isfinite(k[i]))) {
      return refuse(
          reader, pointer,
          "a state of rest has no positive stiffness\nset-point and elongation from the rest "
          "have one sign, and neither is 0\n[[\"3 psi\", \"5 mm\"]]");
    }
  }
  interpolate(count, u, k, &mode->stiffness);
  return STATUS_OK;
}

/* A constant stiffness from the change of set-point and elongation, and the rest from one state. */
static enum status along_slope(const struct reader *reader, const struct hlpv_spec *spec,
                               const struct json_pointer *pointer, const struct state *slope,
                               const struct state *state, int count, struct hlpv_mode *mode) {
  double k = spec->gamma * slope->u / slope->h;
  if (!(k > 0.0 && isfinite(k))) {
    return refuse(
        reader, pointer,
        "the slope has no positive stiffness, gamma times its change of set-point over its "
        "change of elongation\nchanges of one sign, neither of them 0\n[\"3 psi\", \"5 mm\"]");
  }
  if (count > 1) {
    return refuse(
        reader, pointer,
        "more than one state of rest stands beside \"slope\"\none, which gives the rest of "
        "the mode\n[[\"3 psi\", \"5 mm\"]]");
  }
  mode->stiffness.count = 1;
  mode->stiffness.c[0] = k;
  if (count == 1) {
    mode->rest = state->h - spec->gamma * state->u / k;
  }
  return STATUS_OK;
}

enum status reader_hlpv_stiffness(const struct reader *reader, const json_t *value,
                                  const struct hlpv_spec *spec, struct json_pointer *pointer,
                                  double per, struct hlpv_mode *mode) {
  const json_t *states = json_object_get(value, "states"), *slope = json_object_get(value, "slope");
  const json_t *times = json_object_get(value, "times");
  struct state state[STATES_MAX], change = {0};
  int count = (int)json_array_size(states);
  enum status status = STATUS_OK;
  if (json_object_get(value, "coefficients")) {
    return refuse(
        reader, pointer,
        "coefficients are given beside states of rest that they follow from\none of the two");
  }
  for (int i = 0; i < count && status == STATUS_OK; i++) {
    size_t mark = json_pointer_key(pointer, "states");
    json_pointer_index(pointer, (size_t)i);
    status = read_state(reader, spec, json_array_get(states, (size_t)i), pointer, &state[i]);
    json_pointer_pop(pointer, mark);
  }
  if (status == STATUS_OK && slope) {
    size_t mark = json_pointer_key(pointer, "slope");
    status = read_state(reader, spec, slope, pointer, &change);
    json_pointer_pop(pointer, mark);
  }
  if (status == STATUS_OK) {
    status = slope ? along_slope(reader, spec, pointer, &change, state, count, mode)
                   : through_states(reader, spec, pointer, state, count, per, mode);
  }
  for (int i = 0; times && status == STATUS_OK && i < mode->stiffness.count; i++) {
    mode->stiffness.c[i] *= json_number_value(times);
  }
  return status;
}
