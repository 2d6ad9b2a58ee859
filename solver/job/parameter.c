#include "solver/job/parameter.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "solver/base/text.h"
#include "solver/job/reader.h"

static double unit_in_si(const char *unit) {
  return strcmp(unit, "mm") == 0    ? 1e-3
         : strcmp(unit, "deg") == 0 ? acos(-1.0) / 180
         : strcmp(unit, "MPa") == 0 ? 1e6
                                    : 1; /* kg/m3 and plain numbers */
}

/* Appends a parameter; the pointer is printed from `format`. */
static void append(struct job_parameter *list, int *count, const char *unit, size_t offset,
                   const char *format, ...) __attribute__((format(printf, 5, 6)));

static void append(struct job_parameter *list, int *count, const char *unit, size_t offset,
                   const char *format, ...) {
  struct job_parameter *added = &list[(*count)++];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(added->pointer, sizeof added->pointer, format, arguments);
  va_end(arguments);
  added->unit = unit;
  added->unit_si = unit_in_si(unit);
  added->offset = offset;
}

/* Whether a dimension that is given says anything about the body. */
static bool has_effect(const struct job_spec *spec, const char *group, const char *key) {
  const struct pneunet_spec *p = &spec->pneunet;
  bool detached = false;
  for (int r = 0; r < p->run_count; r++) {
    detached = detached || p->runs[r].config == CHAMBER_C;
  }
  if (strncmp(key, "slit", 4) == 0 || strcmp(key, "stem") == 0) {
    return detached;
  }
  if (strcmp(key, "chamber_gap") == 0) {
    return p->chamber_gap > 0;
  }
  if (strcmp(key, "gap_root") == 0) {
    return p->chamber_gap > 0 && p->gap_shape != GAP_RECTANGULAR;
  }
  if (strcmp(key, "gap_round") == 0) {
    return p->chamber_gap > 0 && p->gap_shape == GAP_U;
  }
  if (!group && strcmp(key, "length") == 0) {
    return isnan(spec->given.chamber_length);
  }
  /* Two heights exclude the tapers of top and bottom. */
  bool slope = group && strcmp(group, "taper") == 0 &&
               (strcmp(key, "top") == 0 || strcmp(key, "bottom") == 0);
  return !slope || !isnan(spec->given.height);
}

static void list_dimensions(const struct job_spec *spec, struct job_parameter *list, int *count) {
  for (int d = 0; d < PNEUNET_DIMENSIONS; d++) {
    const struct pneunet_dimension *dimension = &pneunet_dimensions[d];
    const char *group = dimension->group;
    size_t offset = offsetof(struct job_spec, given) + dimension->offset;
    if (!isnan(*(const double *)((const char *)spec + offset)) &&
        has_effect(spec, group, dimension->key)) {
      append(list, count, dimension->unit, offset, "/actuator/%s%s%s", group ? group : "",
             group ? "/" : "", dimension->key);
    }
  }
}

int parameter_list(const struct job_spec *spec, struct job_parameter list[PARAMETERS_MAX]) {
  const struct material_spec *m = &spec->material;
  const size_t material = offsetof(struct job_spec, material);
  const size_t c = material + offsetof(struct material_spec, c);
  const size_t alpha = material + offsetof(struct material_spec, alpha);
  int count = 0;
  if (spec->family == FAMILY_PNEUNET) {
    list_dimensions(spec, list, &count);
  }
  switch (m->model) {
  case MATERIAL_NEO_HOOKE:
    append(list, &count, "MPa", c, "/material/mu");
    break;
  case MATERIAL_MOONEY_RIVLIN:
    append(list, &count, "MPa", c, "/material/C10");
    append(list, &count, "MPa", c + sizeof(double), "/material/C01");
    break;
  case MATERIAL_YEOH:
  case MATERIAL_OGDEN:
    for (int i = 0; i < m->terms; i++) {
      append(list, &count, "MPa", c + (size_t)i * sizeof(double), "/material/%s/%d",
             m->model == MATERIAL_YEOH ? "C" : "mu", i);
    }
    for (int i = 0; m->model == MATERIAL_OGDEN && i < m->terms; i++) {
      append(list, &count, "1", alpha + (size_t)i * sizeof(double), "/material/alpha/%d", i);
    }
    break;
  }
  append(list, &count, "kg/m3", material + offsetof(struct material_spec, density_kg_m3),
         "/material/density");
  append(list, &count, "1", material + offsetof(struct material_spec, bulk_ratio),
         "/material/bulk_ratio");
  return count;
}

double parameter_value(const struct job_spec *spec, const struct job_parameter *parameter) {
  return *(const double *)((const char *)spec + parameter->offset);
}

enum status parameter_set(struct job_spec *spec, const struct job_parameter *parameter,
                          double value, struct error *error) {
  *(double *)((char *)spec + parameter->offset) = value;
  enum status status = spec->family == FAMILY_PNEUNET
                           ? pneunet_derive(&spec->given, &spec->pneunet, error)
                           : STATUS_OK;
  spec->half_model = reader_half_model(spec);
  return status;
}

/* ---- the key "sensitivity" -------------------------------------------------------------- */

static enum status refuse(const struct reader *reader, const char *place, const char *pointer,
                          const struct job_parameter *known, int count) {
  char quoted[60], list[240] = "";
  const char *words[PARAMETERS_MAX];
  size_t length = 0;
  for (int i = 0; i < count; i++) {
    words[i] = known[i].pointer;
  }
  for (int i = 0; i < count; i++) {
    char more[sizeof known->pointer + 2];
    size_t size = (size_t)snprintf(more, sizeof more, "%s%s", i ? ", " : "", words[i]);
    if (length + size + sizeof " ..." > sizeof list) {
      memcpy(list + length, " ...", sizeof " ...");
      break;
    }
    memcpy(list + length, more, size + 1);
    length += size;
  }
  const char *near = text_nearest(pointer, words, (size_t)count);
  return error_nearest(
      reader->error,
      error_set(reader->error, STATUS_INVALID, place,
                "%s names no dimension or coefficient that this job gives%s%s%s\none of %s",
                text_quote(quoted, sizeof quoted, pointer), near ? ", did you mean \"" : "",
                near ? near : "", near ? "\"?" : "", list),
      near);
}

static const struct job_parameter *find(const struct job_parameter *list, int count,
                                        const char *pointer) {
  for (int i = 0; i < count; i++) {
    if (strcmp(list[i].pointer, pointer) == 0) {
      return &list[i];
    }
  }
  return NULL;
}

enum status reader_sensitivity(const struct reader *reader, const json_t *value,
                               struct job_spec *spec) {
  struct sensitivity_spec *s = &spec->sensitivity;
  struct job_parameter known[PARAMETERS_MAX];
  int count = parameter_list(spec, known);
  size_t index;
  json_t *item;
  s->count = 0;
  s->midline = json_is_true(json_object_get(value, "midline"));
  if (json_is_true(value)) {
    s->count = count;
    memcpy(s->parameter, known, (size_t)count * sizeof *known);
    return STATUS_OK;
  }
  json_array_foreach(json_object_get(value, "parameters"), index, item) {
    char place[60];
    const char *pointer = json_string_value(item);
    const struct job_parameter *parameter = find(known, count, pointer);
    snprintf(place, sizeof place, "/sensitivity/parameters/%zu", index);
    if (!parameter) {
      return refuse(reader, place, pointer, known, count);
    }
    if (find(s->parameter, s->count, pointer)) {
      return error_set(reader->error, STATUS_INVALID, place,
                       "\"%s\" stands here twice\neach pointer once", pointer);
    }
    s->parameter[s->count++] = *parameter;
  }
  return STATUS_OK;
}
