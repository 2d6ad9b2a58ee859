/* What the search of a study has found. */
#include <math.h>
#include <string.h>

#include "solver/job/study_search.h"

static json_t *number_or_null(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

static struct objective_figures figures_of(const struct study_search *search,
                                           const struct search_design *design) {
  if (design->state != SEARCH_SOLVED) {
    return (struct objective_figures){NAN, NAN, NAN};
  }
  struct objective_figures figures = study_objective_figures(&search->objective, design->value);
  for (size_t i = 0; i < search->sides; i++) {
    figures.violation =
        fmax(figures.violation, search_side_value((void *)search, i, design->x, NULL));
  }
  return figures;
}

/* Whether a is the better one; b may be nothing. Within the limits before outside of them. */
static bool better(const struct study_search *search, const struct search_design *a,
                   const struct search_design *b) {
  if (a->state != SEARCH_SOLVED || !b) {
    return a->state == SEARCH_SOLVED;
  }
  struct objective_figures own = figures_of(search, a), other = figures_of(search, b);
  double sign = search->objective.kind == OBJECTIVE_MAXIMISE ? -1 : 1;
  if (own.violation <= search->tolerance && other.violation <= search->tolerance) {
    return sign * own.objective < sign * other.objective;
  }
  return own.violation < other.violation;
}

static json_t *values_of(const struct study_search *search, size_t member) {
  const json_t *parameters = json_object_get(search->document, "parameters");
  json_t *values = json_object();
  for (size_t k = 0; k < search->parameters; k++) {
    json_object_set(
        values, search->pointer[k],
        json_array_get(json_object_get(json_array_get(parameters, k), "values"), member));
  }
  return values;
}

/* The best member, or null. */
static json_t *optimum(const struct study_search *search, const struct search_design *best,
                       size_t start) {
  if (!best) {
    return json_null();
  }
  struct objective_figures figures = figures_of(search, best);
  json_t *object =
      json_pack("{s:i, s:i, s:s, s:o, s:o, s:b, s:o}", "member", (int)best->member, "start",
                (int)start, "objective", study_objective_name(&search->objective), "value",
                number_or_null(figures.objective), "violation", number_or_null(figures.violation),
                "within_limits", figures.violation <= search->tolerance, "values",
                values_of(search, best->member));
  if (object && search->objective.kind == OBJECTIVE_PROFILE) {
    json_object_set_new(object, "max_distance_mm", number_or_null(figures.max_distance));
    json_object_set_new(object, "profile_length_mm", json_real(search->objective.length));
  }
  return object;
}

static json_t *starts(const struct study_search *search) {
  static const char *const endings[] = {
      [OPTIMISE_REACHED] = "reached", [OPTIMISE_CONVERGED] = "converged",
      [OPTIMISE_SPENT] = "spent",     [OPTIMISE_HALTED] = "stopped",
      [OPTIMISE_LOST] = "lost",
  };
  json_t *list = json_array();
  for (size_t s = 0; s < search->starts; s++) {
    const struct search_line *line = &search->line[s];
    const struct search_design *best = NULL;
    size_t refused = 0;
    for (size_t i = 0; i < line->count; i++) {
      refused += line->design[i].state == SEARCH_REFUSED;
      best = better(search, &line->design[i], best) ? &line->design[i] : best;
    }
    json_t *value = best ? number_or_null(figures_of(search, best).objective) : json_null();
    json_array_append_new(list,
                          json_pack("{s:i, s:s, s:i, s:i, s:o, s:o}", "start", (int)s, "ending",
                                    line->ended ? endings[line->outcome.ending] : "stopped",
                                    "designs", (int)line->count, "refused", (int)refused, "member",
                                    best ? json_integer((json_int_t)best->member) : json_null(),
                                    "value", value));
  }
  return list;
}

enum status study_search_report(const struct study_search *search, json_t *document) {
  const struct search_design *best = NULL;
  size_t start = 0;
  json_t *history = json_array();
  for (size_t member = 0; member < search->members; member++) {
    size_t line = 0;
    const struct search_design *design = search_member(search, member, &line);
    if (better(search, design, best)) {
      best = design;
      start = line;
    }
    struct objective_figures figures = figures_of(search, design);
    bool allowed = best && figures_of(search, best).violation <= search->tolerance;
    json_array_append_new(
        history,
        json_pack("{s:i, s:i, s:o, s:o, s:o, s:s}", "member", (int)member, "start", (int)line,
                  "value", number_or_null(figures.objective), "violation",
                  number_or_null(figures.violation), "best",
                  allowed ? number_or_null(figures_of(search, best).objective) : json_null(),
                  "reason", design->reason));
  }
  bool stored = json_object_set_new(document, "optimum", optimum(search, best, start)) == 0 &&
                json_object_set_new(document, "starts", starts(search)) == 0 &&
                json_object_set_new(document, "history", history) == 0;
  return stored ? STATUS_OK : STATUS_NO_MEMORY;
}
