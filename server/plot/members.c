#include "server/plot/members.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct member read_member(const json_t *object) {
  const char *name = json_string_value(json_object_get(object, "name"));
  const char *status = json_string_value(json_object_get(object, "status"));
  return (struct member){object, name ? name : "unnamed",
                         status && strcmp(status, "succeeded") != 0};
}

enum status members_read(const json_t *result, struct members *members, struct error *error) {
  const json_t *list = json_object_get(result, "members");
  size_t count = json_array_size(list);
  *members = (struct members){.list = calloc(count + 1, sizeof *members->list)};
  if (!members->list) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for %zu members", count);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *object = json_array_get(list, i);
    if (json_is_object(object)) {
      members->list[members->count++] = read_member(object);
    }
  }
  return STATUS_OK;
}

void members_release(struct members *members) {
  free(members->list);
  *members = (struct members){0};
}

double member_metric(const struct member *member, const char *key) {
  return data_number(json_object_get(member->object, "metrics"), key);
}

void members_subtitle(const struct plot_input *input, size_t count, char text[DATA_HEADING]) {
  data_subtitle(input, text);
  size_t used = strlen(text);
  snprintf(text + used, DATA_HEADING - used, "%s%zu member%s", used ? " · " : "", count,
           count == 1 ? "" : "s");
}

void members_notice(const struct members *members, char text[DATA_HEADING]) {
  size_t stopped = 0, used = 0;
  text[0] = '\0';
  for (size_t i = 0; i < members->count; i++) {
    stopped += members->list[i].stopped;
  }
  if (stopped == 0) {
    return;
  }
  used = (size_t)snprintf(text, DATA_HEADING, "%zu of %zu stopped early or failed:", stopped,
                          members->count);
  for (size_t i = 0; i < members->count && used < DATA_HEADING - 1; i++) {
    if (members->list[i].stopped) {
      int more = snprintf(text + used, DATA_HEADING - used, " %.160s%s", members->list[i].name,
                          --stopped > 0 ? "," : "");
      used += more > 0 ? (size_t)more : 0;
    }
  }
}
