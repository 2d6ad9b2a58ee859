#include "solver/job/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/bistable.h"
#include "solver/job/hlpv.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"
#include "solver/job/study_size.h"

enum { CHANGES_MAX = 64, NAME_BYTES_MAX = 150 };

/* One value that a member has other than the base. */
struct change {
  const char *pointer; /* into the member */
  json_t *value;
  struct json_pointer origin; /* into the study */
};

/* A member in the making. */
struct draft {
  struct change change[CHANGES_MAX];
  int count;
  int common;             /* the first changes, which every member has */
  char name[200];         /* "" until it has one */
  const json_t *labels;   /* of the design, or NULL */
  struct json_pointer at; /* the design, or what decides in its place */
  bool unnamed;           /* there was no memory for the name */
};

/* ---- the changes of one member ------------------------------------------------------------ */

static void add_text(char *out, size_t size, const char *text) {
  size_t used = strlen(out);
  size_t length = used + 1 < size ? text_prefix(text, size - 1 - used) : 0;
  memcpy(out + used, text, length);
  out[used + length] = '\0';
}

/* "chamber gap 1 mm", after what the name has already. */
static void add_to_name(struct draft *draft, const char *what, const json_t *value) {
  char *made = json_is_string(value)
                   ? NULL
                   : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(15));
  const char *text = made ? made : json_string_value(value);
  draft->unnamed = draft->unnamed || !text;
  add_text(draft->name, NAME_BYTES_MAX, draft->name[0] ? ", " : "");
  add_text(draft->name, NAME_BYTES_MAX, what);
  add_text(draft->name, NAME_BYTES_MAX, " ");
  add_text(draft->name, NAME_BYTES_MAX, text ? text : "");
  free(made);
}

static const char *last_part(const char *pointer) {
  const char *slash = strrchr(pointer, '/');
  return slash ? slash + 1 : pointer;
}

static struct change *add_change(struct draft *draft, const char *pointer, json_t *value) {
  struct change *change = &draft->change[draft->count++];
  *change = (struct change){.pointer = pointer, .value = value};
  return change;
}

/* The changes of an object "set" at `at` of the study. */
static void add_set(struct draft *draft, json_t *set, const struct json_pointer *at) {
  const char *pointer;
  json_t *value;
  json_object_foreach(set, pointer, value) {
    struct change *change = add_change(draft, pointer, value);
    change->origin = *at;
    json_pointer_key(&change->origin, "set");
    json_pointer_key(&change->origin, pointer);
  }
}

static void add_parameter(struct draft *draft, const json_t *document, size_t which, size_t value) {
  const json_t *parameter = json_array_get(json_object_get(document, "parameters"), which);
  const char *pointer = json_string_value(json_object_get(parameter, "pointer"));
  const char *name = json_string_value(json_object_get(parameter, "name"));
  json_t *given = json_array_get(json_object_get(parameter, "values"), value);
  struct change *change = add_change(draft, pointer, given);
  json_pointer_key(&change->origin, "parameters");
  json_pointer_index(&change->origin, which);
  draft->at = change->origin;
  if (!study_is_spread(document)) { /* the value is in the text of the study */
    json_pointer_key(&change->origin, "values");
    json_pointer_index(&change->origin, value);
  }
  add_to_name(draft, name ? name : last_part(pointer), given);
}

static void draft_design(struct draft *draft, const json_t *document, size_t index) {
  json_t *design = json_array_get(json_object_get(document, "designs"), index);
  const char *name = json_string_value(json_object_get(design, "name"));
  json_pointer_key(&draft->at, "designs");
  json_pointer_index(&draft->at, index);
  add_set(draft, json_object_get(design, "set"), &draft->at);
  draft->labels = json_object_get(design, "labels");
  if (name) {
    add_text(draft->name, NAME_BYTES_MAX, name);
  }
  for (int c = draft->common; c < draft->count && !name; c++) {
    add_to_name(draft, last_part(draft->change[c].pointer), draft->change[c].value);
  }
  if (!draft->name[0]) {
    snprintf(draft->name, sizeof draft->name, "design %zu", index + 1);
  }
}

static void draft_member(struct draft *draft, const json_t *document, size_t index) {
  *draft = (struct draft){.count = 0};
  add_set(draft, json_object_get(document, "set"), &draft->at);
  draft->common = draft->count;
  if (study_is_list(document)) {
    draft_design(draft, document, index);
    return;
  }
  const json_t *parameters = json_object_get(document, "parameters");
  size_t count = json_array_size(parameters), rest = index;
  if (study_is_spread(document)) {
    for (size_t which = 0; which < count; which++) {
      add_parameter(draft, document, which, index);
    }
    return;
  }
  if (!study_is_grid(document)) {
    size_t which = 0;
    for (; rest >= study_value_count(json_array_get(parameters, which)); which++) {
      rest -= study_value_count(json_array_get(parameters, which));
    }
    add_parameter(draft, document, which, rest);
    return;
  }
  size_t period = study_count(document);
  for (size_t which = 0; which < count; which++) {
    period /= study_value_count(json_array_get(parameters, which));
    add_parameter(draft, document, which, rest / period);
    rest %= period;
  }
}

/* ---- from changes to a checked member ----------------------------------------------------- */

/* Whether a change at `pointer` touches what `place` names: one leads to the other. */
static bool concerns(const char *pointer, const char *place) {
  size_t a = strlen(pointer), b = strlen(place), shorter = a < b ? a : b;
  return strncmp(pointer, place, shorter) == 0 &&
         (a == b || (a < b ? place[a] : pointer[b]) == '/');
}

/* Lets an error of the member name the value of the study that has to change. */
static enum status refer(const struct draft *draft, struct error *error) {
  char inner[sizeof error->pointer];
  const struct json_pointer *origin = &draft->at;
  size_t longest = 0;
  reader_copy(inner, sizeof inner, error->pointer);
  for (int c = 0; c < draft->count && inner[0]; c++) {
    size_t length = strlen(draft->change[c].pointer);
    if (concerns(draft->change[c].pointer, inner) && length >= longest) {
      origin = &draft->change[c].origin;
      longest = length;
    }
  }
  error_carry(error, origin->text, "member \"%.80s\"%s%s: ", draft->name, inner[0] ? ", " : "",
              inner);
  return error->status;
}

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the members of the study");
}

/* The document of a member, a new reference, or NULL with the error filled. */
static json_t *build(const json_t *document, const struct draft *draft, struct error *error) {
  json_t *built = draft->unnamed ? NULL : json_deep_copy(json_object_get(document, "base"));
  if (!built) {
    no_memory(error);
    return NULL;
  }
  enum status status = STATUS_OK;
  for (int c = 0; c < draft->count && status == STATUS_OK; c++) {
    status = study_set(built, draft->change[c].pointer, draft->change[c].value, error);
    if (status != STATUS_OK) {
      error_carry(error, draft->change[c].origin.text, "%s", "");
    }
  }
  if (status == STATUS_OK) {
    json_object_del(built, "comment");
    if (json_object_set_new(built, "name", json_string(draft->name)) != 0 ||
        (draft->labels &&
         json_object_set_new(built, "labels", json_deep_copy(draft->labels)) != 0)) {
      status = no_memory(error);
    }
  }
  if (status != STATUS_OK) {
    json_decref(built);
    return NULL;
  }
  return built;
}

static enum status check_stations(const struct study_ranking *ranking, const struct draft *draft,
                                  const struct job_spec *spec, struct error *error) {
  for (int s = 0; s < ranking->station_count; s++) {
    if (ranking->station[s] > spec->pneunet.length * (1 + 1e-9)) {
      char pointer[48];
      snprintf(pointer, sizeof pointer, "/ranking/stations/%d", s);
      return error_set(error, STATUS_INVALID, pointer,
                       "the station at %.6g mm lies beyond the end of the member \"%.80s\"\nat "
                       "most its length, %.6g mm",
                       1e3 * ranking->station[s], draft->name, 1e3 * spec->pneunet.length);
    }
  }
  return STATUS_OK;
}

/* Samples of a motion; those of a body, one for each step of its load, do not count. */
static double count_samples(const struct job_spec *spec) {
  return spec->hlpv       ? spec->hlpv->end * spec->hlpv->sample_rate + 1.0
         : spec->bistable ? spec->bistable->end * spec->bistable->sample_rate + 1.0
                          : 0.0;
}

/* Checks the member as a job of its own and takes from it what the study has to know; adds to
 * *samples how many it will have. */
static enum status take_member(const struct job_reader *reader, const struct draft *draft,
                               const struct study_ranking *ranking, json_t *built,
                               struct study_member *member, double *samples, struct error *error) {
  struct job_spec spec;
  enum status status = job_reader_check(reader, built, &spec, error);
  if (status != STATUS_OK) {
    return refer(draft, error);
  }
  memcpy(member->hash, spec.hash, sizeof member->hash);
  member->timeout_s = spec.timeout_s;
  *samples += count_samples(&spec);
  status = check_stations(ranking, draft, &spec, error);
  bool body = spec.kind == JOB_RESPONSE;
  job_spec_release(&spec);
  json_t *mirrored = status == STATUS_OK && body ? job_mirror(built) : NULL;
  if (mirrored) {
    status = job_hash(mirrored, member->mirrored_hash, error);
  }
  json_decref(mirrored);
  return status;
}

static enum status make_member(const struct job_reader *reader, const json_t *document,
                               const struct study *study, bool keep, size_t index,
                               struct study_member *member, double *samples, struct error *error) {
  struct draft draft;
  draft_member(&draft, document, index);
  json_t *built = build(document, &draft, error);
  if (!built) {
    return error->status;
  }
  enum status status = take_member(reader, &draft, &study->ranking, built, member, samples, error);
  memcpy(member->name, draft.name, sizeof member->name);
  member->labels = draft.labels ? json_deep_copy(draft.labels) : json_object();
  member->values = json_object();
  for (int c = draft.common; c < draft.count; c++) {
    json_object_set(member->values, draft.change[c].pointer, draft.change[c].value);
  }
  if (keep) {
    member->document = json_incref(built);
  }
  json_decref(built);
  return status == STATUS_OK && (!member->labels || !member->values) ? no_memory(error) : status;
}

/* ---- repetitions -------------------------------------------------------------------------- */

/* Members by their hash: open addressing, twice as many places as members. */
struct hash_index {
  int *place; /* a member, or -1 */
  size_t size;
};

static bool hash_index_open(struct hash_index *index, size_t count) {
  index->size = 2 * count;
  index->place = malloc(index->size * sizeof *index->place);
  for (size_t i = 0; index->place && i < index->size; i++) {
    index->place[i] = -1;
  }
  return index->place != NULL;
}

/* The place of the first member with that hash, or the free one where it belongs. The digits of a
 * SHA-256 are as good as random. */
static int *hash_index_find(const struct hash_index *index, const struct study *study,
                            const char *hash) {
  char digits[16];
  memcpy(digits, hash, sizeof digits - 1);
  digits[sizeof digits - 1] = '\0';
  size_t at = (size_t)strtoull(digits, NULL, 16) % index->size;
  while (index->place[at] >= 0 && strcmp(study->member[index->place[at]].hash, hash) != 0) {
    at = (at + 1) % index->size;
  }
  return &index->place[at];
}

/* Finds repetitions and mirror images among the members before this one. */
static void relate(struct study *study, const struct hash_index *index, size_t which) {
  struct study_member *member = &study->member[which];
  int *own = hash_index_find(index, study, member->hash);
  member->same_as = *own;
  member->mirror_of = -1;
  if (*own < 0) {
    if (member->mirrored_hash[0]) {
      member->mirror_of = *hash_index_find(index, study, member->mirrored_hash);
    }
    *own = (int)which;
  }
  study->distinct += member->same_as < 0 && member->mirror_of < 0;
}

/* ---- the ranking -------------------------------------------------------------------------- */

static enum status read_ranking(const struct reader *reader, const json_t *document,
                                struct study_ranking *ranking) {
  const json_t *value = json_object_get(document, "ranking");
  const json_t *weights = json_object_get(value, "weights"), *station;
  size_t index;
  *ranking = (struct study_ranking){.asked = value != NULL};
  if (!value) {
    return STATUS_OK;
  }
  if (strcmp(study_base_kind(document), "response") != 0) {
    return error_set(reader->error, STATUS_INVALID, "/ranking",
                     "there is a ranking, and the base is of the kind \"%s\"\na base of the kind "
                     "\"response\", whose midline has stations; or leave it out",
                     study_base_kind(document));
  }
  json_array_foreach(json_object_get(value, "stations"), index, station) {
    ranking->station[ranking->station_count++] = reader_quantity(reader, station, "mm");
  }
  ranking->bending = json_number_value(json_object_get(weights, "bending"));
  ranking->slope = json_number_value(json_object_get(weights, "slope"));
  ranking->deflection = json_number_value(json_object_get(weights, "deflection"));
  ranking->mean_weight = json_number_value(json_object_get(value, "mean_weight"));
  const char *normalisation = json_string_value(json_object_get(value, "normalisation"));
  ranking->by_station = strcmp(normalisation, "station") == 0;
  double sum = ranking->bending + ranking->slope + ranking->deflection;
  if (fabs(sum - 1) > 1e-9) {
    return error_set(reader->error, STATUS_INVALID, "/ranking/weights",
                     "the weights add up to %.6g, not to 1\nweights that add up to "
                     "1\n{\"bending\": 0.4, \"slope\": 0.3, \"deflection\": 0.3}",
                     sum);
  }
  return STATUS_OK;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* samples: of the first `count` members together. */
static enum status check_samples(double samples, size_t count, struct error *error) {
  return samples <= STUDY_SAMPLES_MAX
             ? STATUS_OK
             : error_set(error, STATUS_TOO_LARGE, "/keep",
                         "the first %zu members have %.0f samples together\nat most %d: keep "
                         "\"metrics\", or lower the sample rate of the base",
                         count, samples, STUDY_SAMPLES_MAX);
}

enum status study_expand(const struct job_reader *job_reader, const json_t *document, bool keep,
                         struct study *study, struct error *error) {
  const char *kept = json_string_value(json_object_get(document, "keep"));
  const char *usual = strcmp(study_base_kind(document), "response") == 0 ? "samples" : "metrics";
  *study = (struct study){.light = study_has_light_members(document)};
  study->keep_samples = strcmp(kept ? kept : usual, "samples") == 0;
  struct reader reader = {job_reader_units(job_reader), error};
  enum status status = study_check_size(document, error);
  if (status == STATUS_OK) {
    status = read_ranking(&reader, document, &study->ranking);
  }
  if (status != STATUS_OK) {
    return status;
  }
  size_t count = study_count(document);
  struct hash_index index = {0};
  study->member = calloc(count, sizeof *study->member);
  if (!study->member || !hash_index_open(&index, count)) {
    return no_memory(error);
  }
  double samples = 0;
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    study->count = i + 1;
    status = make_member(job_reader, document, study, keep, i, &study->member[i], &samples, error);
    if (status == STATUS_OK) {
      relate(study, &index, i);
    }
    if (status == STATUS_OK && study->keep_samples) {
      status = check_samples(samples, i + 1, error);
    }
  }
  free(index.place);
  return status;
}

enum status study_read_member(const struct job_reader *reader, const json_t *document, size_t index,
                              json_t **member, struct job_spec *spec, struct error *error) {
  struct draft draft;
  *spec = (struct job_spec){.kind = JOB_RESPONSE};
  draft_member(&draft, document, index);
  json_t *built = build(document, &draft, error);
  if (!built) {
    return error->status;
  }
  enum status status = job_reader_check(reader, built, spec, error);
  if (member && status == STATUS_OK) {
    *member = json_incref(built);
  }
  json_decref(built);
  return status;
}

void study_release(struct study *study) {
  for (size_t i = 0; i < study->count; i++) {
    json_decref(study->member[i].document);
    json_decref(study->member[i].values);
    json_decref(study->member[i].labels);
  }
  free(study->member);
  *study = (struct study){.count = 0};
}
