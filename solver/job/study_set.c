/* Changes of a job document by JSON pointer. */
#include <stdlib.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/study.h"

enum { PART_MAX = 128 };

/* Takes the first part off *pointer, which begins with '/'. False when it is too long or has an
 * escape that RFC 6901 does not know. */
static bool take_part(const char **pointer, char part[PART_MAX]) {
  size_t length = 0;
  const char *at = *pointer + 1;
  for (; *at && *at != '/'; at++) {
    char c = *at;
    if (c == '~') {
      at++;
      if (*at != '0' && *at != '1') {
        return false;
      }
      c = *at == '0' ? '~' : '/';
    }
    if (length + 1 >= PART_MAX) {
      return false;
    }
    part[length++] = c;
  }
  part[length] = '\0';
  *pointer = at;
  return true;
}

/* The index that `part` is, or -1. */
static int array_index(const json_t *array, const char *part) {
  size_t length = strlen(part);
  if (length == 0 || length > 6 || strspn(part, "0123456789") != length) {
    return -1;
  }
  unsigned long index = strtoul(part, NULL, 10);
  return index < json_array_size(array) ? (int)index : -1;
}

/* The container that `part` names within `at`; an object that is missing is made. */
static json_t *enter(json_t *at, const char *part) {
  if (json_is_array(at)) {
    int index = array_index(at, part);
    return index >= 0 ? json_array_get(at, (size_t)index) : NULL;
  }
  json_t *member = json_object_get(at, part);
  if (!member && json_is_object(at) && json_object_set_new(at, part, json_object()) == 0) {
    member = json_object_get(at, part);
  }
  return member;
}

/* Sets or removes the member `part` of the container. */
static enum status set_member(json_t *at, const char *part, json_t *value, const char *pointer,
                              struct error *error) {
  bool remove = !value || json_is_null(value);
  char quoted[80];
  if (json_is_array(at)) {
    int index = array_index(at, part);
    if (index < 0) {
      return error_set(error, STATUS_INVALID, NULL,
                       "%s names an item that the base does not have\none of the %zu items of the "
                       "array, counted from 0",
                       text_quote(quoted, sizeof quoted, pointer), json_array_size(at));
    }
    int failed = remove ? json_array_remove(at, (size_t)index)
                        : json_array_set_new(at, (size_t)index, json_deep_copy(value));
    return failed ? error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a member") : STATUS_OK;
  }
  if (remove) {
    json_object_del(at, part);
    return STATUS_OK;
  }
  return json_object_set_new(at, part, json_deep_copy(value)) == 0
             ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a member");
}

enum status study_set(json_t *document, const char *pointer, json_t *value, struct error *error) {
  char part[PART_MAX], quoted[80];
  const char *rest = pointer;
  json_t *at = document;
  text_quote(quoted, sizeof quoted, pointer);
  if (*rest != '/') {
    return error_set(
        error, STATUS_INVALID, NULL,
        "%s is no JSON pointer\ntext that begins with a slash\n\"/actuator/chamber_gap\"", quoted);
  }
  for (;;) {
    if (!take_part(&rest, part)) {
      return error_set(
          error, STATUS_INVALID, NULL,
          "%s is no JSON pointer that a job can have\na ~ is written ~0, a slash within a key ~1",
          quoted);
    }
    if (*rest == '\0') {
      break;
    }
    at = enter(at, part);
    if (!json_is_object(at) && !json_is_array(at)) {
      return error_set(error, STATUS_INVALID, NULL,
                       "%s leads nowhere\na way through objects and arrays of the base; its part "
                       "\"%.60s\" is no object or array of the base",
                       quoted, part);
    }
  }
  if (at == document && strcmp(part, "kind") == 0) {
    return error_set(error, STATUS_INVALID, NULL,
                     "the kind cannot be changed\nmembers of the kind of its base");
  }
  return set_member(at, part, value, pointer, error);
}
