#include <math.h>
#include <sha2.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/reader.h"

/* Where in the document a value stands: two places hold whole jobs. */
enum place { PLACE_JOB, PLACE_BASE, PLACE_INSIDE };

/* Whether a member has no influence on the result: what only people read, and what only the queue
 * does. The names of members of a study begin with that of its base. */
static bool is_remark(enum place place, const char *key) {
  static const char *const queue[] = {"memory", "priority", "reuse"};
  bool remark = strcmp(key, "comment") == 0;
  for (size_t i = 0; i < sizeof queue / sizeof *queue; i++) {
    remark = remark || (place != PLACE_INSIDE && strcmp(key, queue[i]) == 0);
  }
  return remark || (place == PLACE_JOB && (strcmp(key, "name") == 0 || strcmp(key, "labels") == 0));
}

/* 10 and 10.0 mean the same, so both are written as 10. Remarks go. */
static json_t *canonical(const json_t *value, enum place place) {
  size_t index;
  json_t *item;
  const char *key;
  json_t *copy = NULL;
  if (json_is_real(value) && json_real_value(value) == floor(json_real_value(value)) &&
      fabs(json_real_value(value)) < 1e15) {
    return json_integer((json_int_t)json_real_value(value));
  }
  if (json_is_array(value)) {
    copy = json_array();
    json_array_foreach(value, index, item) {
      if (json_array_append_new(copy, canonical(item, PLACE_INSIDE)) != 0) {
        json_decref(copy);
        return NULL;
      }
    }
    return copy;
  }
  if (json_is_object(value)) {
    copy = json_object();
    json_object_foreach((json_t *)value, key, item) {
      bool base = place == PLACE_JOB && strcmp(key, "base") == 0;
      if (!is_remark(place, key) &&
          json_object_set_new(copy, key, canonical(item, base ? PLACE_BASE : PLACE_INSIDE)) != 0) {
        json_decref(copy);
        return NULL;
      }
    }
    return copy;
  }
  return json_deep_copy(value);
}

enum status job_hash(const json_t *document, char hash[65], struct error *error) {
  json_t *plain = canonical(document, PLACE_JOB);
  char *text = plain ? json_dumps(plain, JSON_SORT_KEYS | JSON_COMPACT) : NULL;
  json_decref(plain);
  if (!text) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the hash of the job");
  }
  SHA256Data((const uint8_t *)text, strlen(text), hash);
  free(text);
  return STATUS_OK;
}
