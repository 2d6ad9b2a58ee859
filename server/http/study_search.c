#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/analyst.h"
#include "server/http/handlers.h"
#include "server/http/study_table.h"
#include "server/http/submission.h"
#include "server/study/design.h"
#include "server/study/search.h"
#include "solver/job/json.h"

enum { FOUND = 5, NAME_MAX_BYTES = 200 };

/* ---- search -------------------------------------------------------------------------------- */

/* "chance=0.9"; otherwise replies why not and returns false. */
static bool read_chance(const struct request *request, struct reply *reply, double *chance) {
  const char *text = url_query(&request->url, "chance");
  char *end;
  *chance = 0.5;
  if (!text) {
    return true;
  }
  *chance = strtod(text, &end);
  if (end != text && *end == '\0' && *chance >= 0.0 && *chance <= 1.0) {
    return true;
  }
  reply_problem(reply, 400, "invalid_query",
                "chance=%.40s: expected a number from 0 to 1, for example chance=0.9.", text);
  return false;
}

static enum status read_query(const struct request *request, const struct study_table *table,
                              struct search_query *query, struct error *error) {
  const char *least = url_query(&request->url, "least"), *most = url_query(&request->url, "most");
  if (!least == !most) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%s\none of least=KEY and most=KEY, as in "
                     "where=bending_angle_deg>=60&least=mass_g",
                     least ? "there are two goals, least and most" : "there is no goal");
  }
  query->most = most != NULL;
  enum status status = criteria_quantity(table, most ? most : least, &query->goal, error);
  return status == STATUS_OK ? conditions_read(table, url_query(&request->url, "where"),
                                               query->condition, &query->conditions, error)
                             : status;
}

static void show_search(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  struct search_query query;
  struct error error = {.status = STATUS_OK};
  json_t *answer = NULL, *document = NULL;
  int64_t limit;
  if (!request_query_integer(request, reply, "limit", 1, ANALYSIS_FOUND_MAX, FOUND, &limit) ||
      !read_chance(request, reply, &query.chance)) {
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  query.limit = (size_t)limit;
  enum status status = read_query(request, table, &query, &error);
  if (status == STATUS_OK) {
    status = study_document_read(request, table->study_id, &document, &error);
  }
  if (status == STATUS_OK) {
    struct search_means means = {.models = service->models,
                                 .store = service->store,
                                 .reader = service->reader,
                                 .document = document};
    status = search_run(table, &means, &query, &answer, &error);
  }
  study_reply(reply, status, answer, &error);
  json_decref(document);
  study_table_close(request, table);
}

void study_search(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_search);
}

/* ---- confirm ------------------------------------------------------------------------------- */

/* The members of the request: its values, and a name if it has one, both borrowed. */
static enum status read_body(const struct request *request, json_t **body, const json_t **values,
                             const char **name, struct error *error) {
  const char *text = request->body ? request->body : "", *key;
  json_t *value;
  enum status status = json_text_read(text, request->body_size, body, error);
  if (status != STATUS_OK) {
    return status;
  }
  json_object_foreach(*body, key, value) {
    if (strcmp(key, "values") != 0 && strcmp(key, "name") != 0) {
      return error_set(error, STATUS_INVALID, "",
                       "the member %.60s is not known\nvalues, and name if wanted\n{\"values\": "
                       "{\"/actuator/side_wall\": 2.1}}",
                       key);
    }
  }
  *values = json_object_get(*body, "values");
  *name = json_string_value(json_object_get(*body, "name"));
  if (!json_is_object(*values)) {
    return error_set(error, STATUS_INVALID, "/values",
                     "there are no values\nan object: pointer of a parameter, value\n{\"values\": "
                     "{\"/actuator/side_wall\": 2.1}}");
  }
  if (json_object_get(*body, "name") && (!*name || strlen(*name) > NAME_MAX_BYTES)) {
    return error_set(error, STATUS_INVALID, "/name",
                     "the name is no text, or too long\na text of at most %d bytes\n\"design B\"",
                     NAME_MAX_BYTES);
  }
  return STATUS_OK;
}

/* The text of the job that solves the design of the request, malloc'd; NULL with the error. */
static char *confirming_job(const struct request *request, const struct study_table *table,
                            struct error *error) {
  json_t *body = NULL, *study = NULL, *document = NULL;
  const json_t *values = NULL;
  const char *name = NULL;
  char *text = NULL;
  enum status status = read_body(request, &body, &values, &name, error);
  if (status == STATUS_OK) {
    status = study_document_read(request, table->study_id, &study, error);
  }
  if (status == STATUS_OK) {
    char made[NAME_MAX_BYTES + 40];
    snprintf(made, sizeof made, "%.150s: a confirmed design", table->name);
    status = design_document(study, table, values, name ? name : made, &document, error);
  }
  if (status == STATUS_OK) {
    json_object_set_new(document, "reuse", json_true());
    text = json_dumps(document, JSON_COMPACT);
    if (!text) {
      error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the job.");
    }
  }
  json_decref(body);
  json_decref(study);
  json_decref(document);
  return text;
}

void study_confirm(struct request *request, struct reply *reply) {
  struct error error = {.status = STATUS_OK};
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  char *text = confirming_job(request, table, &error);
  study_table_close(request, table);
  if (text) {
    submission_take(request, reply, text, strlen(text));
  } else {
    reply_error(reply, &error);
  }
  free(text);
}
