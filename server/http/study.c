/* One study: what it is and how far, its designs, and a longer one. */
#include <stdlib.h>
#include <string.h>

#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/http/study_table.h"
#include "server/http/submission.h"
#include "server/study/conductor.h"
#include "server/study/designs.h"
#include "server/study/tables.h"
#include "solver/job/json.h"

enum { REASONS_MAX = 20, REASON_JOBS = 5, LIMIT = 50, LIMIT_MAX = 500 };

/* ---- the study ---------------------------------------------------------------------------- */

static json_t *counts_view(const struct study_table *table) {
  int counts[JOB_STATE_COUNT] = {0};
  json_t *view = json_object();
  for (size_t i = 0; i < table->members; i++) {
    counts[table->state[i]]++;
  }
  for (int s = 0; s < JOB_STATE_COUNT; s++) {
    if (counts[s] > 0) {
      json_object_set_new(view, job_state_word((enum job_state)s), json_integer(counts[s]));
    }
  }
  return view;
}

/* The entry of a reason in the list, which is made when it is new; NULL when there are too many. */
static json_t *reason_entry(json_t *list, const char *reason) {
  size_t index;
  json_t *entry;
  json_array_foreach(list, index, entry) {
    if (strcmp(json_string_value(json_object_get(entry, "reason_code")), reason) == 0) {
      return entry;
    }
  }
  if (json_array_size(list) == REASONS_MAX) {
    return NULL;
  }
  json_array_append_new(list,
                        json_pack("{s:s, s:i, s:[]}", "reason_code", reason, "count", 0, "jobs"));
  return json_array_get(list, json_array_size(list) - 1);
}

json_t *study_failures(const struct study_table *table) {
  json_t *list = json_array();
  for (size_t i = 0; i < table->members; i++) {
    enum job_state state = (enum job_state)table->state[i];
    json_t *entry = job_state_terminal(state) && state != JOB_STATE_SUCCEEDED
                        ? reason_entry(list, table->reason[i])
                        : NULL;
    if (entry) {
      json_t *count = json_object_get(entry, "count"), *jobs = json_object_get(entry, "jobs");
      json_integer_set(count, json_integer_value(count) + 1);
      if (json_array_size(jobs) < REASON_JOBS) {
        json_array_append_new(jobs, json_integer(table->job_id[i]));
      }
    }
  }
  return list;
}

static json_t *columns_view(const struct study_column *column, size_t count, const char *role) {
  json_t *list = json_array();
  for (size_t k = 0; k < count; k++) {
    json_array_append_new(list, designs_column(&column[k], role));
  }
  return list;
}

static bool can_extend(const char *sampling) {
  return strcmp(sampling, "sobol") == 0 || strcmp(sampling, "halton") == 0;
}

static json_t *links_view(int64_t id) {
  json_t *links = json_object();
  json_object_set_new(links, "self", json_sprintf("/api/v1/studies/%lld", (long long)id));
  json_object_set_new(links, "job", json_sprintf("/api/v1/jobs/%lld", (long long)id));
  json_object_set_new(links, "members", json_sprintf("/api/v1/jobs?study=%lld", (long long)id));
  json_object_set_new(links, "designs",
                      json_sprintf("/api/v1/studies/%lld/designs", (long long)id));
  return links;
}

static json_t *study_view(const struct service *service, const struct study_table *table) {
  struct job_record record;
  if (store_job(service->store, table->study_id, &record, NULL) != STATUS_OK) {
    return NULL;
  }
  json_t *job = job_view(service, &record, false);
  json_t *view = json_pack(
      "{s:I, s:s, s:s, s:O, s:O, s:s, s:b, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "id",
      (json_int_t)table->study_id, "name", record.name, "state", job_state_word(record.state),
      "progress", json_object_get(job, "progress"), "progress_detail",
      json_object_get(job, "progress_detail"), "sampling", table->sampling, "extendable",
      can_extend(table->sampling), "members", (json_int_t)table->wanted, "stored",
      (json_int_t)table->members, "counts", counts_view(table), "failures", study_failures(table),
      "parameters", columns_view(table->parameter, table->parameters, "parameter"), "metrics",
      columns_view(table->metric, table->metrics, "metric"), "view",
      json_sprintf("study_%lld", (long long)table->study_id), "links", links_view(table->study_id));
  if (view && record.extends != 0) {
    json_object_set_new(view, "extends", json_integer(record.extends));
  }
  json_decref(job);
  job_record_clear(&record);
  return view;
}

void study_show(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  const struct study_table *table;
  struct error error;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (tables_use(service->tables, id, &table, NULL, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  reply_json(reply, 200, study_view(service, table));
  tables_release(service->tables, table);
}

/* ---- its designs -------------------------------------------------------------------------- */

static void designs_reply_columns(const struct request *request, struct reply *reply, int64_t id,
                                  const struct study_table *table, uint64_t stamp) {
  uint64_t tag = cache_tag_add(cache_tag_add(cache_tag(), &id, sizeof id), &stamp, sizeof stamp);
  size_t size = 0;
  if (cache_fresh(request, reply, tag)) {
    return;
  }
  const char *columns = tables_columns(request->service->tables, table, &size);
  char *text = columns ? malloc(size + 1) : NULL;
  if (text) {
    memcpy(text, columns, size + 1);
  }
  reply_text(reply, "application/json", text, size);
  if (text) {
    cache_mark(reply, tag);
  }
}

static void designs_reply_rows(const struct request *request, struct reply *reply,
                               const struct study_table *table) {
  const char *sort = url_query(&request->url, "sort");
  struct designs_order order;
  int64_t limit, from;
  if (!designs_order(table, sort ? sort : "member", &order)) {
    reply_problem(reply, 400, "invalid_query",
                  "sort=%.60s: expected member, name, state, the pointer of a parameter or the "
                  "name of a metric, with a leading minus for the largest first, for example "
                  "sort=-%.60s.",
                  sort, table->metrics > 0 ? table->metric[0].key : "member");
    return;
  }
  if (!request_query_integer(request, reply, "limit", 1, LIMIT_MAX, LIMIT, &limit) ||
      !request_query_integer(request, reply, "cursor", 0, INT32_MAX, 0, &from)) {
    return;
  }
  size_t end = (size_t)from + (size_t)limit;
  json_t *rows = designs_rows(table, &order, (size_t)from, (size_t)limit);
  json_t *next = end < table->members ? json_sprintf("%zu", end) : json_null();
  reply_json(reply, 200,
             rows ? json_pack("{s:o, s:I, s:o}", "designs", rows, "stored",
                              (json_int_t)table->members, "next", next)
                  : NULL);
}

void study_designs(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  const char *format = url_query(&request->url, "format");
  const struct study_table *table;
  struct error error;
  uint64_t stamp;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (format && strcmp(format, "rows") != 0 && strcmp(format, "columns") != 0) {
    reply_problem(reply, 400, "invalid_query",
                  "format=%.40s: expected rows or columns, for example format=columns.", format);
    return;
  }
  if (tables_use(service->tables, id, &table, &stamp, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  if (format && strcmp(format, "columns") == 0) {
    designs_reply_columns(request, reply, id, table, stamp);
  } else {
    designs_reply_rows(request, reply, table);
  }
  tables_release(service->tables, table);
}

/* ---- a longer one ------------------------------------------------------------------------- */

/* The "size" of the request's body. */
static enum status size_read(const struct request *request, json_int_t *size, struct error *error) {
  const char *text = request->body ? request->body : "";
  json_t *body = NULL;
  enum status status = json_text_read(text, request->body_size, &body, error);
  if (status == STATUS_OK && (!json_is_object(body) || json_object_size(body) != 1 ||
                              !json_is_integer(json_object_get(body, "size")))) {
    status = error_set(error, STATUS_INVALID, "",
                       "the body is not {\"size\": N}\nan object with the number of members that "
                       "the study is to have\n{\"size\": 512}");
  }
  *size = json_integer_value(json_object_get(body, "size"));
  json_decref(body);
  return status;
}

/* The document of the study with another size; malloc'd. */
static enum status document_extend(struct store *store, int64_t id, json_int_t size, char **text,
                                   struct error *error) {
  json_t *root = NULL;
  enum status status = store_document(store, id, text, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = json_text_read(*text, strlen(*text), &root, error);
  const char *kind = json_string_value(json_object_get(root, "kind"));
  const char *sampling = json_string_value(json_object_get(root, "sampling"));
  json_int_t before = json_integer_value(json_object_get(root, "size"));
  free(*text);
  *text = NULL;
  if (status != STATUS_OK) {
    return status;
  }
  if (!kind || strcmp(kind, "study") != 0) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "There is no study %lld.", (long long)id);
  } else if (!sampling || !can_extend(sampling)) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "Study %lld has the sampling \"%s\"; only those of the sampling \"sobol\" "
                       "or \"halton\" can be extended.",
                       (long long)id, sampling ? sampling : "");
  } else if (size <= before) {
    status = error_set(error, STATUS_INVALID, "/size",
                       "%lld is not more than the study has\nmore than %lld members\n%lld",
                       (long long)size, (long long)before, 2 * (long long)before);
  } else {
    json_object_set_new(root, "size", json_integer(size));
    *text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    status = *text ? STATUS_OK : error_set(error, STATUS_NO_MEMORY, NULL, "No memory.");
  }
  json_decref(root);
  return status;
}

static enum status extend(const struct request *request, int64_t id, int64_t *new_id,
                          struct error *error) {
  struct job_document document = {.root = NULL};
  json_int_t size = 0;
  char *text = NULL;
  bool replayed;
  enum status status = size_read(request, &size, error);
  if (status == STATUS_OK) {
    status = document_extend(request->service->store, id, size, &text, error);
  }
  if (status == STATUS_OK) {
    status = document_read(request, text, strlen(text), &document, error);
  }
  if (status == STATUS_OK) {
    document.submission.extends = id;
    status = document_store(request, &document, new_id, &replayed, error);
    document_release(&document);
  }
  free(text);
  return status;
}

void study_extend(struct request *request, struct reply *reply) {
  struct error error = {.status = STATUS_OK};
  int64_t id, new_id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (!submission_open(request, reply)) {
    return;
  }
  if (extend(request, id, &new_id, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  conductor_wake(request->service->conductor);
  job_view_reply_waiting(request, reply, 202, new_id, true);
}
