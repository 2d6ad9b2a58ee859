#include "solver/job/study_size.h"

#include <stdio.h>
#include <string.h>

#include "solver/job/study_optimise.h"

bool study_is_list(const json_t *document) {
  return strcmp(json_string_value(json_object_get(document, "sampling")), "list") == 0;
}

bool study_is_grid(const json_t *document) {
  return strcmp(json_string_value(json_object_get(document, "sampling")), "grid") == 0;
}

bool study_is_spread(const json_t *document) {
  const char *sampling = json_string_value(json_object_get(document, "sampling"));
  return strcmp(sampling, "latin-hypercube") == 0 || strcmp(sampling, "sobol") == 0 ||
         strcmp(sampling, "halton") == 0 || study_is_search(document);
}

size_t study_value_count(const json_t *parameter) {
  return json_array_size(json_object_get(parameter, "values"));
}

const char *study_base_kind(const json_t *document) {
  return json_string_value(json_object_get(json_object_get(document, "base"), "kind"));
}

bool study_has_light_members(const json_t *document) {
  return strcmp(study_base_kind(document), "hlpv") == 0;
}

static size_t members_max(const json_t *document) {
  return study_has_light_members(document) ? STUDY_LIGHT_MAX : STUDY_MEMBERS_MAX;
}

/* Number of members, not more than members_max + 1. */
size_t study_count(const json_t *document) {
  if (study_is_list(document)) {
    return json_array_size(json_object_get(document, "designs"));
  }
  if (study_is_search(document)) {
    return study_value_count(json_array_get(json_object_get(document, "parameters"), 0));
  }
  if (study_is_spread(document)) {
    return (size_t)json_integer_value(json_object_get(document, "size"));
  }
  size_t index, sum = 0, product = 1, most = members_max(document);
  json_t *parameter;
  json_array_foreach(json_object_get(document, "parameters"), index, parameter) {
    sum += study_value_count(parameter);
    product = product > most ? product : product * study_value_count(parameter);
  }
  size_t count = study_is_grid(document) ? product : sum;
  return count > most ? most + 1 : count;
}

static size_t text_size(const json_t *value) {
  return value ? json_dumpb(value, NULL, 0, JSON_COMPACT) : 0;
}

/* Text that one member has at most beside its base: the longest value of each parameter. */
static size_t longest_change(const json_t *document) {
  size_t index, place, sum = 0;
  json_t *parameter, *value;
  json_array_foreach(json_object_get(document, "parameters"), index, parameter) {
    size_t longest = 0;
    json_array_foreach(json_object_get(parameter, "values"), place, value) {
      size_t size = json_dumpb(value, NULL, 0, JSON_COMPACT | JSON_ENCODE_ANY);
      longest = size > longest ? size : longest;
    }
    sum += longest + json_string_length(json_object_get(parameter, "pointer"));
  }
  return sum;
}

static enum status check_text(const json_t *document, size_t count, struct error *error) {
  size_t base =
      text_size(json_object_get(document, "base")) + text_size(json_object_get(document, "set"));
  size_t change = study_has_light_members(document) || study_is_spread(document)
                      ? longest_change(document)
                      : text_size(json_object_get(document, "parameters"));
  int most = study_has_light_members(document) ? STUDY_LIGHT_TEXT_MAX : STUDY_TEXT_MAX;
  if ((base + change) * count > (size_t)most) {
    return error_set(error, STATUS_TOO_LARGE, "/base",
                     "%zu members of %zu bytes are %zu bytes\nat most %d (%d MiB): use a shorter "
                     "base or fewer members",
                     count, base + change, (base + change) * count, most, most >> 20);
  }
  if (study_has_light_members(document) && change * count > STUDY_TEXT_MAX) {
    return error_set(error, STATUS_TOO_LARGE, "/parameters",
                     "the values of %zu members are %zu bytes\nat most %d (16 MiB): use shorter "
                     "values or fewer members",
                     count, change * count, STUDY_TEXT_MAX);
  }
  return STATUS_OK;
}

/* The keys that only some samplings have. */
static enum status check_keys(const json_t *document, struct error *error) {
  const char *sampling = json_string_value(json_object_get(document, "sampling"));
  bool list = study_is_list(document), spread = study_is_spread(document);
  bool search = study_is_search(document), sized = spread && !search;
  bool sequence = spread && strcmp(sampling, "latin-hypercube") != 0;
  const struct {
    const char *key, *example;
    bool needed, allowed;
  } keys[] = {
      {"designs", "[{\"set\": {\"/actuator/taper/top\": \"1 deg\"}}]", list, list},
      {"parameters",
       spread ? "[{\"pointer\": \"/actuator/chamber_gap\", \"from\": \"1 mm\", \"to\": \"3 mm\"}]"
              : "[{\"pointer\": \"/actuator/chamber_gap\", \"values\": [\"1 mm\"]}]",
       !list, !list},
      {"size", "64", sized, sized},
      {"objective", "{\"target\": {\"bending_angle_deg\": 60}}", search, search},
      {"starts", "4", false, search},
      {"budget", "40", false, search},
      {"method", "\"slsqp\"", false, search},
      {"tolerance", "0.001", false, search},
      {"seed", "1", false, spread},
      {"constraints", "[{\"sum\": {\"/actuator/top_wall\": 1}, \"at_most\": \"3 mm\"}]", false,
       sequence},
  };
  char pointer[32];
  for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
    bool there = json_object_get(document, keys[i].key) != NULL;
    if (keys[i].needed && !there) {
      return error_set(
          error, STATUS_INVALID, NULL,
          "the key \"%s\" is missing, which the sampling \"%s\" needs\nits value\n{\"%s\": %s}",
          keys[i].key, sampling, keys[i].key, keys[i].example);
    }
    if (there && !keys[i].allowed) {
      snprintf(pointer, sizeof pointer, "/%s", keys[i].key);
      return error_set(error, STATUS_INVALID, pointer,
                       "the sampling \"%s\" has no use for \"%s\"\nleave it out, or choose another "
                       "sampling",
                       sampling, keys[i].key);
    }
  }
  return STATUS_OK;
}

enum status study_check_size(const json_t *document, struct error *error) {
  enum status status = check_keys(document, error);
  if (status != STATUS_OK) {
    return status;
  }
  size_t count = study_count(document), most = members_max(document);
  if (count > most) {
    return error_set(error, STATUS_TOO_LARGE,
                     study_is_list(document)     ? "/designs"
                     : study_is_spread(document) ? "/size"
                                                 : "/parameters",
                     "the study has more than %zu members\nat most %zu of the kind \"%s\"", most,
                     most, study_base_kind(document));
  }
  return check_text(document, count, error);
}
