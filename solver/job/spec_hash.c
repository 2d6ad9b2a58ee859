#include <math.h>
#include <sha2.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/reader.h"

/* 10 and 10.0 mean the same, so both are written as 10. Members that only people read go. */
static json_t *canonical(const json_t *value, bool top) {
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
      if (json_array_append_new(copy, canonical(item, false)) != 0) {
        json_decref(copy);
        return NULL;
      }
    }
    return copy;
  }
  if (json_is_object(value)) {
    copy = json_object();
    json_object_foreach((json_t *)value, key, item) {
      bool remark = strcmp(key, "comment") == 0 ||
                    (top && (strcmp(key, "name") == 0 || strcmp(key, "labels") == 0));
      if (!remark && json_object_set_new(copy, key, canonical(item, false)) != 0) {
        json_decref(copy);
        return NULL;
      }
    }
    return copy;
  }
  return json_deep_copy(value);
}

enum status job_hash(const json_t *document, char hash[65], struct error *error) {
  json_t *plain = canonical(document, true);
  char *text = plain ? json_dumps(plain, JSON_SORT_KEYS | JSON_COMPACT) : NULL;
  json_decref(plain);
  if (!text) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the hash of the job");
  }
  SHA256Data((const uint8_t *)text, strlen(text), hash);
  free(text);
  return STATUS_OK;
}
