#include "solver/job/study_sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/latin.h"
#include "solver/explore/sequence.h"
#include "solver/job/study_constraint.h"
#include "solver/job/study_optimise.h"
#include "solver/job/study_range.h"
#include "solver/job/study_size.h"

/* Points that are tried for each member before constraints are called too tight; digits of values:
 * what is measured has fewer. */
enum { TRIES_PER_MEMBER = 200, VALUE_DIGITS = 7 };

/* The points of a study in the making. */
struct spread {
  const struct reader *reader;
  json_t *document;
  size_t parameters, members;
  struct study_range range[SEQUENCE_DIMENSIONS_MAX];
  struct study_constraints constraints;
};

static const char *sampling_of(const json_t *document) {
  return json_string_value(json_object_get(document, "sampling"));
}

static enum status refuse(const struct spread *s, size_t parameter, const char *sentence) {
  return study_range_refuse(s->reader, parameter, NULL, sentence);
}

/* ---- points ------------------------------------------------------------------------------- */

/* Adds one member to the lists of values. */
static enum status add_point(struct spread *s, const double *u, json_t *const *lists) {
  for (size_t k = 0; k < s->parameters; k++) {
    if (json_array_append_new(lists[k], study_range_value(&s->range[k], u[k], VALUE_DIGITS)) != 0) {
      return error_set(s->reader->error, STATUS_NO_MEMORY, NULL, "no memory for the members");
    }
  }
  return STATUS_OK;
}

static void drop_point(const struct spread *s, json_t *const *lists) {
  for (size_t k = 0; k < s->parameters; k++) {
    json_array_remove(lists[k], json_array_size(lists[k]) - 1);
  }
}

static enum status draw_sequence(struct spread *s, uint64_t seed, json_t *const *lists) {
  double u[SEQUENCE_DIMENSIONS_MAX];
  struct sequence *sequence = NULL;
  bool sobol = strcmp(sampling_of(s->document), "sobol") == 0;
  enum status status = sequence_create(sobol ? SEQUENCE_SOBOL : SEQUENCE_HALTON, (int)s->parameters,
                                       true, seed, &sequence, s->reader->error);
  size_t taken = 0;
  for (size_t tried = 0; status == STATUS_OK && taken < s->members; tried++) {
    bool met = true;
    sequence_next(sequence, u);
    status = add_point(s, u, lists);
    if (status == STATUS_OK) {
      status = study_constraints_check(&s->constraints, s->reader, lists, &met);
    }
    if (status == STATUS_OK && met) {
      taken++;
    } else if (status == STATUS_OK) {
      drop_point(s, lists);
    }
    if (status == STATUS_OK && tried + 1 == TRIES_PER_MEMBER * s->members && taken < s->members) {
      status = error_set(s->reader->error, STATUS_INVALID, "/constraints",
                         "of %zu points only %zu meet the constraints, and %zu members are wanted\n"
                         "widen the constraints or narrow the ranges",
                         tried + 1, taken, s->members);
    }
  }
  sequence_destroy(sequence);
  return status;
}

static enum status draw_hypercube(struct spread *s, uint64_t seed, json_t *const *lists) {
  double *x = malloc(s->members * s->parameters * sizeof *x);
  enum status status =
      x ? latin_hypercube((int)s->members, (int)s->parameters, seed, x, s->reader->error)
        : error_set(s->reader->error, STATUS_NO_MEMORY, NULL, "no memory for the members");
  for (size_t i = 0; status == STATUS_OK && i < s->members; i++) {
    status = add_point(s, x + i * s->parameters, lists);
  }
  free(x);
  return status;
}

/* Puts the lists into the document in place of choices. */
static enum status give_values(struct spread *s, json_t *const *lists) {
  json_t *parameters = json_object_get(s->document, "parameters");
  for (size_t k = 0; k < s->parameters; k++) {
    if (json_object_set(json_array_get(parameters, k), "values", lists[k]) != 0) {
      return error_set(s->reader->error, STATUS_NO_MEMORY, NULL, "no memory for the members");
    }
  }
  return STATUS_OK;
}

static enum status draw(struct spread *s) {
  json_t *lists[SEQUENCE_DIMENSIONS_MAX] = {NULL};
  uint64_t seed = (uint64_t)json_integer_value(json_object_get(s->document, "seed"));
  enum status status = STATUS_OK;
  for (size_t k = 0; k < s->parameters; k++) {
    lists[k] = json_array();
    if (!lists[k]) {
      status = error_set(s->reader->error, STATUS_NO_MEMORY, NULL, "no memory for the members");
    }
  }
  if (status == STATUS_OK) {
    status = strcmp(sampling_of(s->document), "latin-hypercube") == 0
                 ? draw_hypercube(s, seed, lists)
                 : draw_sequence(s, seed, lists);
  }
  if (status == STATUS_OK) {
    status = give_values(s, lists);
  }
  for (size_t k = 0; k < s->parameters; k++) {
    json_decref(lists[k]);
  }
  return status;
}

/* Without ranges: every parameter has its values. */
static enum status check_values(struct spread *s) {
  const char *sampling = sampling_of(s->document);
  size_t k;
  json_t *parameter;
  json_array_foreach(json_object_get(s->document, "parameters"), k, parameter) {
    char sentence[240];
    snprintf(
        sentence, sizeof sentence,
        "there are no values, or a range beside them\nthe sampling \"%s\" takes \"values\", and "
        "neither \"from\", \"to\" nor \"scale\"\n{\"pointer\": \"/actuator/chamber_gap\", "
        "\"values\": [\"1 mm\", "
        "\"2 mm\"]}",
        sampling);
    if (!json_object_get(parameter, "values") || json_object_get(parameter, "from") ||
        json_object_get(parameter, "to") || json_object_get(parameter, "scale")) {
      return refuse(s, k, sentence);
    }
  }
  return STATUS_OK;
}

/* A search has ranges alone. */
static enum status check_search(const struct spread *s) {
  for (size_t k = 0; k < s->parameters; k++) {
    if (s->range[k].values) {
      return refuse(
          s, k,
          "there are values to choose from\nthe sampling \"optimise\" takes a range\n"
          "{\"pointer\": \"/actuator/chamber_gap\", \"from\": \"1 mm\", \"to\": \"3 mm\"}");
    }
  }
  return STATUS_OK;
}

/* What only a search has a use for. */
static enum status check_starts(const struct reader *reader, const json_t *document) {
  size_t k;
  json_t *parameter;
  json_array_foreach(json_object_get(document, "parameters"), k, parameter) {
    if (json_object_get(parameter, "start") && !study_is_search(document)) {
      return study_range_refuse(reader, k, "start",
                                "only the sampling \"optimise\" has starts\nleave it out");
    }
  }
  return STATUS_OK;
}

enum status study_sample(const struct reader *reader, json_t *document) {
  enum status status = study_check_size(document, reader->error);
  const json_t *parameters = json_object_get(document, "parameters");
  struct spread s = {
      .reader = reader, .document = document, .parameters = json_array_size(parameters)};
  if (status == STATUS_OK) {
    status = check_starts(reader, document);
  }
  if (status != STATUS_OK || !study_is_spread(document)) {
    return status == STATUS_OK ? check_values(&s) : status;
  }
  s.members = study_count(document);
  for (size_t k = 0; k < s.parameters && status == STATUS_OK; k++) {
    status = study_range_read(s.reader, k, json_array_get(parameters, k), &s.range[k]);
  }
  if (status == STATUS_OK && study_is_search(document)) {
    return check_search(&s);
  }
  if (status == STATUS_OK) {
    status = study_constraints_read(reader, document, &s.constraints);
  }
  return status == STATUS_OK ? draw(&s) : status;
}
