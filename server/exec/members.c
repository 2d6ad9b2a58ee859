#include "server/exec/members.h"

#include <math.h>
#include <string.h>

#include "server/base/follow.h"
#include "solver/job/json.h"

struct reading {
  size_t count;
  member_taker *take;
  void *context;
};

static double number_of(const json_t *event, const char *name) {
  double value = json_number_value(json_object_get(event, name));
  return isfinite(value) && value > 0 ? value : 0;
}

static void take_line(void *context, const char *line, size_t size) {
  const struct reading *reading = context;
  json_t *event = json_read(line, size, JSON_REJECT_DUPLICATES, NULL);
  const char *word = json_string_value(json_object_get(event, "event"));
  json_int_t member = json_integer_value(json_object_get(event, "member"));
  const json_t *code = json_object_get(event, "exit");
  bool done = word && strcmp(word, "done") == 0;
  bool known = done || (word && strcmp(word, "begun") == 0);
  if (known && member >= 0 && member < (json_int_t)reading->count) {
    struct member_event told = {
        .member = (size_t)member,
        .done = done,
        .end = {.exit_code = json_is_integer(code) ? (int)json_integer_value(code) : -1,
                .cpu_s = number_of(event, "cpu_s"),
                .peak_memory_MB = number_of(event, "peak_memory_MB")}};
    reading->take(reading->context, &told);
  }
  json_decref(event);
}

bool members_follow(const char *path, off_t *offset, size_t count, member_taker *take,
                    void *context) {
  struct reading reading = {count, take, context};
  return follow_lines(path, offset, take_line, &reading);
}
