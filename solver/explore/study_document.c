#include "solver/explore/study_document.h"

#include <stdio.h>
#include <string.h>
#include "solver/base/text.h"
#include "solver/explore/ranking.h"

/* A study whose members have more points of midlines than this keeps of each the midline at the
 * last pressure only, so that the document stays below what the daemon takes. */
enum { MIDLINE_POINTS_MAX = 200000 };

/* ---- mirror images ------------------------------------------------------------------------ */

static void negate(json_t *object, const char *key) {
  json_t *value = json_object_get(object, key);
  if (json_is_number(value)) {
    json_object_set_new(object, key, json_real(-json_number_value(value)));
  }
}

static void swap_values(json_t *object, const char *left, const char *right) {
  json_t *a = json_incref(json_object_get(object, left));
  json_t *b = json_incref(json_object_get(object, right));
  if (a && b) {
    json_object_set(object, left, b);
    json_object_set(object, right, a);
  }
  json_decref(a);
  json_decref(b);
}

/* What is measured across the body or turns about its axis changes its sign. */
static void mirror_figures(json_t *figures) {
  static const char *const odd[] = {"tip_y_mm", "twist_angle_deg", "side_bending_angle_deg",
                                    "end_twist_angle_deg"};
  for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
    negate(figures, odd[i]);
  }
  swap_values(figures, "left_pressure_kPa", "right_pressure_kPa");
}

static void mirror_points(json_t *points) {
  size_t index;
  json_t *point;
  json_array_foreach(points, index, point) {
    double y = json_number_value(json_array_get(point, 1));
    json_array_set_new(point, 1, json_real(y != 0 ? -y : 0));
  }
}

/* Turns the result into that of the mirror image about y = 0, in place. */
static void mirror_result(json_t *result) {
  size_t index;
  json_t *item;
  mirror_figures(json_object_get(result, "metrics"));
  json_array_foreach(json_object_get(result, "samples"), index, item) {
    mirror_figures(item);
  }
  json_array_foreach(json_object_get(result, "midlines"), index, item) {
    mirror_points(json_object_get(item, "points_mm"));
  }
  mirror_points(json_object_get(result, "rest_midline_mm"));
}

/* ---- members ------------------------------------------------------------------------------ */

/* Takes over what the study keeps of a member's result. */
static void take_result(json_t *member, json_t *result, bool samples) {
  static const char *const always[] = {"status", "reason",     "message", "metrics",
                                       "fit",    "statistics", "warnings"};
  static const char *const course[] = {"samples", "midlines", "rest_midline_mm", "events",
                                       "holds",   "steps",    "paths",           "held"};
  for (size_t i = 0; i < sizeof always / sizeof *always; i++) {
    json_t *value = json_object_get(result, always[i]);
    if (value) {
      json_object_set(member, always[i], value);
    }
  }
  for (size_t i = 0; samples && i < sizeof course / sizeof *course; i++) {
    json_t *value = json_object_get(result, course[i]);
    if (value) {
      json_object_set(member, course[i], value);
    }
  }
}

static size_t count_points(const json_t *members) {
  size_t i, k, count = 0;
  json_t *member, *midline;
  json_array_foreach(members, i, member) {
    json_array_foreach(json_object_get(member, "midlines"), k, midline) {
      count += json_array_size(json_object_get(midline, "points_mm"));
    }
  }
  return count;
}

/* Drops midlines while they are too many: all but the last ones. */
static void thin_midlines(json_t *members, json_t *warnings) {
  size_t index;
  json_t *member;
  if (count_points(members) <= MIDLINE_POINTS_MAX) {
    return;
  }
  json_array_foreach(members, index, member) {
    json_t *midlines = json_object_get(member, "midlines");
    size_t count = json_array_size(midlines);
    if (count > 1) {
      json_t *last = json_pack("[O]", json_array_get(midlines, count - 1));
      json_object_set_new(member, "midlines", last);
    }
  }
  json_array_append_new(warnings, json_string("of each member only the last midline is kept: all "
                                              "of them have too many points together"));
}

static json_t *index_or_null(int index) {
  return index >= 0 ? json_integer(index) : json_null();
}

/* The result of a member by way of the one that was solved in its place. */
static json_t *result_of(const struct study *study, size_t index,
                         const struct study_results *results, const char **reason,
                         const char **message) {
  size_t from = index;
  if (!results->each && study->member[index].same_as >= 0) {
    from = (size_t)study->member[index].same_as;
  }
  bool mirrored = !results->each && study->member[from].mirror_of >= 0;
  from = mirrored ? (size_t)study->member[from].mirror_of : from;
  json_t *result = results->result(results->context, from, reason, message);
  if (result && mirrored) {
    mirror_result(result);
  }
  return result;
}

static json_t *member_object(const struct study *study, size_t index,
                             const struct study_results *results) {
  const struct study_member *member = &study->member[index];
  const char *reason = "", *message = "";
  json_t *object = json_pack(
      "{s:i, s:s, s:O, s:O, s:s, s:s, s:s, s:s, s:o, s:o, s:{}, s:[]}", "index", (int)index, "name",
      member->name, "labels", member->labels, "values", member->values, "spec_hash", member->hash,
      "status", "failed", "reason", "", "message", "", "same_as", index_or_null(member->same_as),
      "mirror_of", index_or_null(member->mirror_of), "metrics", "samples");
  json_t *result = result_of(study, index, results, &reason, &message);
  if (result) {
    take_result(object, result, study->keep_samples);
  } else {
    json_object_set_new(object, "reason", json_string(reason));
    json_object_set_new(object, "message", json_string(message));
  }
  json_decref(result);
  return object;
}

/* ---- the document ------------------------------------------------------------------------- */

static bool has_status(const json_t *member, const char *wanted) {
  const char *status = json_string_value(json_object_get(member, "status"));
  return status && strcmp(status, wanted) == 0;
}

static size_t count_status(const json_t *members, const char *wanted) {
  size_t index, count = 0;
  json_t *member;
  json_array_foreach(members, index, member) {
    count += has_status(member, wanted);
  }
  return count;
}

/* One row a member with its metrics: the table of the study. */
static json_t *table(const json_t *members) {
  json_t *rows = json_array(), *member;
  size_t index;
  json_array_foreach(members, index, member) {
    json_t *row = json_pack("{s:i}", "member", (int)index);
    json_object_update(row, json_object_get(member, "metrics"));
    json_array_append_new(rows, row);
  }
  return rows;
}

static json_t *parameters(const json_t *document) {
  json_t *list = json_array(), *parameter;
  size_t index;
  json_array_foreach(json_object_get(document, "parameters"), index, parameter) {
    json_t *pointer = json_object_get(parameter, "pointer");
    json_t *name = json_object_get(parameter, "name");
    const char *slash = strrchr(json_string_value(pointer), '/');
    json_array_append_new(
        list, json_pack("{s:O, s:o}", "pointer", pointer, "name",
                        name ? json_incref(name) : json_string(slash ? slash + 1 : "")));
  }
  return list;
}

static void warn_of_failures(const json_t *members, json_t *warnings) {
  size_t index, failed = 0;
  json_t *member;
  const char *reason = "", *name = "";
  json_array_foreach(members, index, member) {
    if (!has_status(member, "succeeded")) {
      failed++;
      reason = json_string_value(json_object_get(member, "reason"));
      name = json_string_value(json_object_get(member, "name"));
    }
  }
  if (failed > 0) {
    char sentence[400], quoted[100];
    snprintf(sentence, sizeof sentence,
             "%zu of %zu members did not come to their end; the last of them is %s (%s)", failed,
             json_array_size(members), text_quote(quoted, sizeof quoted, name), reason);
    json_array_append_new(warnings, json_string(sentence));
  }
}

static json_t *metrics(const struct study *study, const struct study_figures *figures,
                       const json_t *members) {
  size_t solved = count_status(members, "succeeded");
  return json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i}", "designs", (int)study->count, "solved",
                   (int)solved, "failed", (int)(study->count - solved), "distinct",
                   (int)study->distinct, "diverged", (int)count_status(members, "diverged"),
                   "computed", (int)figures->computed, "resumed", (int)figures->resumed);
}

/* Processor time of the computations behind the members, in this run or an earlier one. */
static double members_cpu_s(const struct study *study, const json_t *members) {
  double sum = 0;
  for (size_t i = 0; i < study->count; i++) {
    const json_t *statistics = json_object_get(json_array_get(members, i), "statistics");
    bool own = study->member[i].same_as < 0 && study->member[i].mirror_of < 0;
    sum += own ? json_number_value(json_object_get(statistics, "cpu_s")) : 0;
  }
  return sum;
}

static void drop_statistics(json_t *members) {
  size_t index;
  json_t *member;
  json_array_foreach(members, index, member) {
    json_object_del(member, "statistics");
  }
}

static const char *ending_message(enum status ending) {
  return ending == STATUS_OK         ? ""
         : ending == STATUS_DIVERGED ? "not a single member could be solved"
                                     : status_sentence(ending);
}

json_t *study_document(const struct job_spec *spec, const struct study *study,
                       const struct study_results *results, const struct study_figures *figures,
                       enum status ending) {
  json_t *members = json_array(), *warnings = json_array();
  for (size_t i = 0; i < study->count; i++) {
    json_array_append_new(members, member_object(study, i, results));
  }
  double cpu_s = members_cpu_s(study, members);
  warn_of_failures(members, warnings);
  thin_midlines(members, warnings);
  if (study->light) {
    study_thin_warnings(members, warnings);
    drop_statistics(members);
  }
  json_t *ranking =
      study->ranking.asked ? ranking_document(&study->ranking, members, warnings) : NULL;
  json_t *document = json_pack(
      "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:[], s:{s:f, s:f, s:f}, s:{s:s, "
      "s:s}}",
      "status", ending == STATUS_OK ? "succeeded" : "diverged", "reason",
      ending == STATUS_OK ? "" : status_word(ending), "message", ending_message(ending), "kind",
      "study", "name", spec->name, "metrics", metrics(study, figures, members), "parameters",
      parameters(spec->document), "summary", study_summary(members), "samples", table(members),
      "members", members, "warnings", warnings, "artifacts", "statistics", "wall_s",
      figures->wall_s, "cpu_s", figures->cpu_s, "members_cpu_s", cpu_s, "provenance", "version",
      PNEULAB_VERSION, "spec_hash", spec->hash);
  if (document && ranking) {
    json_object_set(document, "ranking", ranking);
  }
  json_decref(ranking);
  return document;
}
