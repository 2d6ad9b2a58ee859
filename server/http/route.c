#include "server/http/route.h"

#include <assert.h>
#include <string.h>

#include "server/http/handlers.h"

/* A segment in braces is a parameter; what follows the brace must end the segment. Whoever has at
 * least the role may use the route. */
static const struct route {
  enum http_method method;
  enum role role;
  const char *pattern;
  handler *handle;
  const char *query; /* names of its query parameters; all that start with one that ends in a dot;
                        NULL: whatever */
} routes[] = {
    {HTTP_GET, ROLE_READ, "api/v1/jobs", jobs_list, "state kind study label. sort cursor limit"},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/jobs", jobs_submit, ""},
    {HTTP_POST, ROLE_READ, "api/v1/jobs:validate", jobs_validate, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}", job_show, ""},
    {HTTP_PATCH, ROLE_SUBMIT, "api/v1/jobs/{id}", job_patch, ""},
    {HTTP_DELETE, ROLE_ADMIN, "api/v1/jobs/{id}", job_delete, ""},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/jobs/{id}/cancel", job_cancel, ""},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/jobs/{id}/retry", job_retry, ""},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/jobs/{id}/hold", job_hold, ""},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/jobs/{id}/release", job_release, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/document", job_document, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/result", result_show, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/metrics", result_metrics, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/samples.csv", result_samples, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/artifacts/{name}", result_artifact, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/attempts", attempts_list, ""},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/log", attempts_log, "attempt"},
    {HTTP_GET, ROLE_READ, "api/v1/jobs/{id}/plots/{plot}.png", plot_job,
     "width height theme metric"},
    {HTTP_GET, ROLE_READ, "api/v1/plots/overlay.png", plot_overlay, "jobs width height theme"},
    {HTTP_GET, ROLE_READ, "api/v1/compare", compare_show, "jobs"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}", study_show, ""},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/designs", study_designs, "format sort cursor limit"},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/studies/{id}/extend", study_extend, ""},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/ranking", study_ranking, "criteria preset limit"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/pareto", study_pareto, "objectives layers"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/importance", study_importance, "metric"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/effects", study_effects, "metric"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/surrogate", study_surrogate, "metric"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/slice", study_slice, "metric x y resolution at."},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/search", study_search,
     "where least most chance limit"},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/plots/{plot}.png", study_picture,
     "width height theme metric x y colour columns objectives criteria at."},
    {HTTP_POST, ROLE_SUBMIT, "api/v1/studies/{id}/confirm", study_confirm, ""},
    {HTTP_GET, ROLE_READ, "api/v1/studies/{id}/export.csv", study_export, "format objectives"},
    {HTTP_GET, ROLE_READ, "api/v1/events", events_show, "job label. after"},
    {HTTP_GET, ROLE_ADMIN, "api/v1/database", database_show, ""},
    {HTTP_GET, ROLE_READ, "api/v1/materials", catalogue_materials, ""},
    {HTTP_GET, ROLE_READ, "api/v1/schemas/{name}", catalogue_schema, ""},
    {HTTP_GET, ROLE_NONE, "openapi.json", catalogue_openapi_json, ""},
    {HTTP_GET, ROLE_NONE, "openapi.yaml", catalogue_openapi_yaml, ""},
    {HTTP_GET, ROLE_NONE, "healthz", health_live, ""},
    {HTTP_GET, ROLE_NONE, "readyz", health_ready, ""},
    {HTTP_GET, ROLE_READ, "metrics", metrics_show, ""},
    {HTTP_GET, ROLE_READ, "api/v1/caller", session_caller, ""},
    {HTTP_POST, ROLE_NONE, "sign-in", session_open, "next"},
    {HTTP_POST, ROLE_NONE, "sign-out", session_close, ""},
    {HTTP_GET, ROLE_NONE, "sign-in", page_show, "next"},
    /* Pages tell for themselves who may read: a browser is sent to where it can sign in. */
    {HTTP_GET, ROLE_NONE, "", page_index, NULL},
    {HTTP_GET, ROLE_NONE, "jobs/{id}", page_job, NULL},
    {HTTP_GET, ROLE_NONE, "studies/{id}", page_study, NULL},
    {HTTP_GET, ROLE_NONE, "compare", page_compare, NULL},
    {HTTP_GET, ROLE_NONE, "submit", page_submit, NULL},
};

/* Matches one segment; a parameter's value is put into *parameter (its suffix cut off). */
static bool segment_match(const char *pattern, size_t length, char *segment, char **cut,
                          const char **parameter) {
  if (pattern[0] != '{') {
    return strlen(segment) == length && memcmp(segment, pattern, length) == 0;
  }
  const char *suffix = memchr(pattern, '}', length);
  size_t suffix_length = length - (size_t)(++suffix - pattern);
  size_t segment_length = strlen(segment);
  if (segment_length <= suffix_length ||
      memcmp(segment + segment_length - suffix_length, suffix, suffix_length) != 0) {
    return false;
  }
  *cut = segment + segment_length - suffix_length;
  *parameter = segment;
  return true;
}

static bool route_match(const struct route *route, struct request *request) {
  const char *pattern = route->pattern;
  size_t parameter_count = 0;
  char *cuts[2] = {NULL, NULL};
  for (size_t i = 0; i < request->url.segment_count; i++) {
    size_t length = strcspn(pattern, "/");
    const char *parameter = NULL;
    if (length == 0 || !segment_match(pattern, length, (char *)request->url.segments[i],
                                      &cuts[parameter_count], &parameter)) {
      return false;
    }
    if (parameter) {
      request->parameters[parameter_count++] = parameter;
    }
    pattern += length + (pattern[length] == '/');
  }
  if (*pattern != '\0') {
    return false;
  }
  for (size_t i = 0; i < parameter_count; i++) {
    *cuts[i] = '\0';
  }
  return true;
}

static const char *const method_words[] = {[HTTP_GET] = "GET, HEAD",
                                           [HTTP_POST] = "POST",
                                           [HTTP_PATCH] = "PATCH",
                                           [HTTP_DELETE] = "DELETE"};

handler *route_find(struct request *request, struct reply *reply) {
  char allowed[40] = "";
  for (size_t i = 0; i < sizeof routes / sizeof *routes; i++) {
    if (!route_match(&routes[i], request)) {
      continue;
    }
    if (routes[i].method == request->method) {
      request->known_query = routes[i].query;
      request->least_role = routes[i].role;
      request->route = ROUTE_FIRST + (unsigned)i;
      return routes[i].handle;
    }
    strcat(allowed, allowed[0] ? ", " : "");
    strcat(allowed, method_words[routes[i].method]);
  }
  if (!allowed[0] && page_exists(request)) {
    if (request->method == HTTP_GET) {
      request->route = ROUTE_PAGES;
      request->least_role = ROLE_NONE; /* pages are the program's own: no data is in them */
      return page_show;
    }
    strcpy(allowed, "GET, HEAD");
  }
  if (allowed[0]) {
    reply_problem(reply, 405, "method_not_allowed", "This resource offers %s.", allowed);
    reply_header(reply, "Allow", "%s", allowed);
  } else {
    reply_problem(reply, 404, "not_found", "There is nothing under this path; see /openapi.yaml.");
  }
  return NULL;
}

bool route_name(unsigned number, const char **method, const char **pattern) {
  if (number < ROUTE_FIRST) {
    *method = number == ROUTE_PAGES ? "GET" : "any";
    *pattern = number == ROUTE_PAGES ? "pages" : "none";
    return true;
  }
  if (number - ROUTE_FIRST >= sizeof routes / sizeof *routes) {
    return false;
  }
  enum http_method of = routes[number - ROUTE_FIRST].method;
  *method = of == HTTP_GET      ? "GET"
            : of == HTTP_POST   ? "POST"
            : of == HTTP_DELETE ? "DELETE"
                                : "PATCH";
  *pattern = routes[number - ROUTE_FIRST].pattern;
  return true;
}

static_assert(sizeof routes / sizeof *routes + ROUTE_FIRST <= ROUTES_MAX, "room in the metrics");
