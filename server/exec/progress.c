#include "server/exec/progress.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/follow.h"
#include "solver/job/json.h"

enum { PACE_FIRST_MS = 300 }; /* earlier a rate means nothing */

struct progress progress_none(void) {
  return (struct progress){.fraction = -1, .pressure_kPa = NAN};
}

double progress_left_s(const struct progress *progress, int64_t now_ms) {
  double gained = progress->fraction - progress->since.fraction;
  int64_t passed_ms = now_ms - progress->since.at_ms;
  return gained > 0 && passed_ms >= PACE_FIRST_MS
             ? 1e-3 * (double)passed_ms * (1 - progress->fraction) / gained
             : -1;
}

/* A count from a report; 0 when it is absent or makes no sense. */
static int64_t count_read(const json_t *event, const char *name) {
  json_int_t value = json_integer_value(json_object_get(event, name));
  return value > 0 ? value : 0;
}

void progress_take_line(const char *line, size_t size, struct progress *progress) {
  json_t *event = json_read(line, size, JSON_REJECT_DUPLICATES, NULL);
  const char *word = json_string_value(json_object_get(event, "event"));
  const json_t *fraction = json_object_get(event, "fraction");
  const json_t *pressure = json_object_get(event, "pressure_kPa");
  if (word && strcmp(word, "progress") == 0 && json_is_number(fraction)) {
    double value = json_number_value(fraction);
    if (value >= 0 && value <= 1) {
      progress->fraction = value;
      progress->pressure_kPa = json_is_number(pressure) ? json_number_value(pressure) : NAN;
      progress->step = count_read(event, "step");
      progress->steps = count_read(event, "steps");
      progress->iteration = count_read(event, "iteration");
    }
  }
  json_decref(event);
}

/* Whether two reports differ. */
static bool progress_differs(const struct progress *a, const struct progress *b) {
  bool pressure =
      a->pressure_kPa != b->pressure_kPa && !(isnan(a->pressure_kPa) && isnan(b->pressure_kPa));
  return a->fraction != b->fraction || pressure || a->step != b->step || a->steps != b->steps ||
         a->iteration != b->iteration;
}

static void take_line(void *context, const char *line, size_t size) {
  progress_take_line(line, size, context);
}

bool progress_poll(struct progress_reader *reader, struct progress *progress) {
  struct progress before = *progress;
  if (!follow_lines(reader->path, &reader->offset, take_line, progress)) {
    return false;
  }
  int64_t now = clock_monotonic_ms();
  if (reader->pace.count == 0 || progress->fraction < before.fraction) { /* another stage */
    pace_start(&reader->pace, now);
  }
  if (before.fraction != progress->fraction) {
    pace_take(&reader->pace, now, progress->fraction);
    progress->since = pace_reference(&reader->pace, now);
  }
  return progress_differs(&before, progress);
}
