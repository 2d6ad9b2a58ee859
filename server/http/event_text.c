#include "server/http/event_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

void event_filter_clear(struct event_filter *filter) {
  for (size_t i = 0; i < filter->label_count; i++) {
    free(filter->labels[i].name);
    free(filter->labels[i].value);
  }
  *filter = (struct event_filter){.job_count = 0};
}

bool event_filter_match(const struct event_filter *filter, int64_t job_id, const json_t *labels) {
  bool wanted = filter->job_count == 0;
  for (size_t i = 0; i < filter->job_count && !wanted; i++) {
    wanted = filter->jobs[i] == job_id;
  }
  for (size_t i = 0; i < filter->label_count && wanted; i++) {
    const char *value = json_string_value(json_object_get(labels, filter->labels[i].name));
    wanted = value && strcmp(value, filter->labels[i].value) == 0;
  }
  return wanted;
}

/* Writes the lines of one event, the data taken over. Returns 0 when it does not fit. */
static size_t event_write(const char *head, json_t *data, char text[EVENT_TEXT_MAX]) {
  static const char middle[] = "data: ";
  size_t used = strlen(head), room = EVENT_TEXT_MAX - used - (sizeof middle - 1) - 2;
  memcpy(text, head, used);
  memcpy(text + used, middle, sizeof middle - 1);
  used += sizeof middle - 1;
  size_t size =
      data ? json_dumpb(data, text + used, room, JSON_COMPACT | JSON_REAL_PRECISION(6)) : 0;
  json_decref(data);
  if (size == 0 || size > room) {
    return 0;
  }
  used += size;
  text[used++] = '\n';
  text[used++] = '\n';
  return used;
}

size_t event_text_state(const struct job_event *event, char text[EVENT_TEXT_MAX]) {
  char head[64], at[CLOCK_TEXT_SIZE];
  clock_format(event->at_ms, at);
  snprintf(head, sizeof head, "id: %lld\nevent: state\n", (long long)event->id);
  return event_write(head,
                     json_pack("{s:I, s:s, s:s, s:I, s:s}", "job", (json_int_t)event->job_id,
                               "state", event->state, "reason_code", event->reason_code, "attempt",
                               (json_int_t)event->attempt, "at", at),
                     text);
}

static json_t *count_or_null(int64_t count) {
  return count > 0 ? json_integer(count) : json_null();
}

json_t *progress_json(const struct progress *progress) {
  double left_s = progress_left_s(progress, clock_monotonic_ms());
  return json_pack("{s:f, s:o, s:o, s:o, s:o, s:o}", "fraction", progress->fraction, "pressure_kPa",
                   isfinite(progress->pressure_kPa) ? json_real(progress->pressure_kPa)
                                                    : json_null(),
                   "step", count_or_null(progress->step), "steps", count_or_null(progress->steps),
                   "iteration", count_or_null(progress->iteration), "eta_s",
                   left_s >= 0 ? json_real(round(10 * left_s) / 10) : json_null());
}

size_t event_text_progress(int64_t job_id, int64_t attempt, const struct progress *progress,
                           char text[EVENT_TEXT_MAX]) {
  json_t *data = json_pack("{s:I, s:I}", "job", (json_int_t)job_id, "attempt", (json_int_t)attempt);
  json_t *report = progress_json(progress);
  bool failed = !data || !report || json_object_update(data, report) != 0;
  json_decref(report);
  if (failed) {
    json_decref(data);
    data = NULL;
  }
  return event_write("event: progress\n", data, text);
}
