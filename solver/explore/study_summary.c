/* What many members come to: extremes and means of their metrics, and less text. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "solver/base/text.h"
#include "solver/explore/study_document.h"

/* The members keep their warnings as long as these are no more bytes than this together. */
enum { WARNING_BYTES_MAX = 1 << 20 };

/* One metric over the members that have it. */
struct spread {
  size_t count, lowest, highest;
  double low, high, mean, squares; /* squares: sum of squared differences from the mean */
};

/* Mean and squares are brought up to date by Welford (1962). */
static void spread_add(struct spread *spread, size_t member, double value) {
  spread->count++;
  if (spread->count == 1 || value < spread->low) {
    spread->low = value;
    spread->lowest = member;
  }
  if (spread->count == 1 || value > spread->high) {
    spread->high = value;
    spread->highest = member;
  }
  double before = value - spread->mean;
  spread->mean += before / (double)spread->count;
  spread->squares += before * (value - spread->mean);
}

static struct spread spread_of(const json_t *members, const char *key) {
  struct spread spread = {0};
  size_t index;
  json_t *member;
  json_array_foreach(members, index, member) {
    const json_t *value = json_object_get(json_object_get(member, "metrics"), key);
    if (json_is_number(value)) {
      spread_add(&spread, index, json_number_value(value));
    }
  }
  return spread;
}

json_t *study_summary(const json_t *members) {
  json_t *summary = json_object(), *member, *value;
  size_t index;
  const char *key;
  json_array_foreach(members, index, member) {
    json_object_foreach(json_object_get(member, "metrics"), key, value) {
      if (!json_is_number(value) || json_object_get(summary, key)) {
        continue;
      }
      struct spread s = spread_of(members, key);
      double deviation = s.count > 1 ? sqrt(s.squares / (double)(s.count - 1)) : 0.0;
      json_object_set_new(summary, key,
                          json_pack("{s:i, s:f, s:i, s:f, s:i, s:f, s:f}", "members", (int)s.count,
                                    "lowest", s.low, "lowest_member", (int)s.lowest, "highest",
                                    s.high, "highest_member", (int)s.highest, "mean", s.mean,
                                    "standard_deviation", deviation));
    }
  }
  return summary;
}

static size_t text_bytes(const json_t *list) {
  size_t index, sum = 0;
  json_t *text;
  json_array_foreach(list, index, text) {
    sum += json_string_length(text);
  }
  return sum;
}

void study_thin_warnings(json_t *members, json_t *warnings) {
  size_t index, bytes = 0, warned = 0;
  json_t *member, *first = NULL;
  json_array_foreach(members, index, member) {
    json_t *list = json_object_get(member, "warnings");
    bytes += text_bytes(list);
    warned += json_array_size(list) > 0;
    first = first ? first : json_array_get(list, 0);
  }
  if (warned == 0) {
    return;
  }
  char sentence[500];
  snprintf(sentence, sizeof sentence, "%zu of %zu members have warnings%s; the first: %.300s",
           warned, json_array_size(members),
           bytes > WARNING_BYTES_MAX ? ", too many to keep them all" : "",
           json_string_value(first));
  text_repair(sentence); /* the first one may be cut within a character */
  json_array_append_new(warnings, json_string(sentence));
  for (index = 0; bytes > WARNING_BYTES_MAX && index < json_array_size(members); index++) {
    json_object_del(json_array_get(members, index), "warnings");
  }
}
