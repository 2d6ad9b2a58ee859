#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/csv.h"
#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "solver/job/json.h"

/* The job's result document; otherwise replies why there is none and returns false. */
static bool result_read(const struct request *request, struct reply *reply, int64_t *id,
                        char **text, char **directory) {
  struct job_record record;
  struct error error;
  if (!request_id(request, reply, id)) {
    return false;
  }
  enum status status = store_result(request->service->store, *id, text, directory, &error);
  if (status == STATUS_OK) {
    return true;
  }
  if (status == STATUS_NOT_FOUND &&
      store_job(request->service->store, *id, &record, &error) == STATUS_OK) {
    reply_problem(reply, 404, "no_result", "Job %lld is %s and has no result.", (long long)*id,
                  job_state_word(record.state));
    job_record_clear(&record);
    return false;
  }
  reply_error(reply, &error);
  return false;
}

void result_show(struct request *request, struct reply *reply) {
  int64_t id;
  char *text;
  if (!result_read(request, reply, &id, &text, NULL)) {
    return;
  }
  cache_reply_text(request, reply, "application/json", text);
}

void result_metrics(struct request *request, struct reply *reply) {
  struct job_record record;
  struct error error;
  int64_t id;
  if (!request_id(request, reply, &id)) {
    return;
  }
  if (store_job(request->service->store, id, &record, &error) != STATUS_OK) {
    reply_error(reply, &error);
    return;
  }
  reply_json(reply, 200, json_pack("{s:O}", "metrics", record.metrics));
  job_record_clear(&record);
}

static void csv_row(FILE *out, const json_t *columns, const json_t *sample) {
  const char *name;
  json_t *ignored;
  const char *between = "";
  json_object_foreach((json_t *)columns, name, ignored) {
    const json_t *value = json_object_get(sample, name);
    fputs(between, out);
    if (!sample) {
      csv_text(out, name);
    } else if (json_is_number(value)) {
      fprintf(out, "%.15g", json_number_value(value));
    } else if (json_is_string(value)) {
      csv_text(out, json_string_value(value));
    }
    between = ",";
  }
  fputs("\r\n", out);
}

/* The samples as a table: the columns are the keys of all samples in the order they appear. */
static char *samples_csv(const json_t *samples, size_t *size) {
  char *text = NULL;
  json_t *columns = json_object();
  FILE *out = open_memstream(&text, size);
  if (!out || !columns) {
    json_decref(columns);
    return NULL;
  }
  for (size_t i = 0; i < json_array_size(samples); i++) {
    json_object_update_missing(columns, json_array_get(samples, i));
  }
  csv_row(out, columns, NULL);
  for (size_t i = 0; i < json_array_size(samples); i++) {
    csv_row(out, columns, json_array_get(samples, i));
  }
  json_decref(columns);
  if (fclose(out) != 0) {
    free(text);
    text = NULL;
  }
  return text;
}

void result_samples(struct request *request, struct reply *reply) {
  int64_t id;
  char *text;
  size_t size = 0;
  if (!result_read(request, reply, &id, &text, NULL)) {
    return;
  }
  uint64_t tag = cache_tag_add(cache_tag(), text, strlen(text));
  if (cache_fresh(request, reply, tag)) {
    free(text);
    return;
  }
  json_t *result = json_read(text, strlen(text), 0, NULL);
  free(text);
  char *csv = result ? samples_csv(json_object_get(result, "samples"), &size) : NULL;
  json_decref(result);
  reply_text(reply, "text/csv; charset=utf-8", csv, size);
  if (csv) {
    cache_mark(reply, tag);
    reply_header(reply, "Content-Disposition", "attachment; filename=\"job-%lld-samples.csv\"",
                 (long long)id);
  }
}

/* Only types that no browser runs: XML, for one, may carry scripts. */
static const char *artifact_type(const char *name) {
  const char *dot = strrchr(name, '.');
  if (dot && strcmp(dot, ".json") == 0) {
    return "application/json";
  }
  if (dot && strcmp(dot, ".csv") == 0) {
    return "text/csv; charset=utf-8";
  }
  if (dot && strcmp(dot, ".inp") == 0) {
    return "text/plain; charset=utf-8";
  }
  return "application/octet-stream";
}

/* The file of an attempt is written once: its place and its time name its content. */
static void artifact_mark(const struct request *request, struct reply *reply) {
  struct stat info;
  if (reply->fd < 0 || fstat(reply->fd, &info) != 0) {
    return;
  }
  uint64_t tag = cache_tag_add(cache_tag(), &info.st_ino, sizeof info.st_ino);
  tag = cache_tag_add(tag, &info.st_size, sizeof info.st_size);
  tag = cache_tag_add(tag, &info.st_mtim, sizeof info.st_mtim);
  if (cache_fresh(request, reply, tag)) {
    close(reply->fd);
    reply->fd = -1;
    reply->size = 0;
    reply->content_type = NULL;
  } else {
    cache_mark(reply, tag);
  }
}

void result_artifact(struct request *request, struct reply *reply) {
  struct service *service = request->service;
  const char *name = request->parameters[1];
  char path[PATH_MAX];
  struct error error;
  char *text, *directory;
  int64_t id;
  if (!result_read(request, reply, &id, &text, &directory)) {
    return;
  }
  free(text);
  /* Only names of the table are served: what a request says never reaches the file system. */
  if (store_artifact(service->store, id, name, &error) != STATUS_OK) {
    reply_error(reply, &error);
  } else {
    int length = snprintf(path, sizeof path, "%s/out/%s", directory, name);
    if (length > 0 && (size_t)length < sizeof path) {
      reply_job_file(request, reply, artifact_type(name), id, path);
      artifact_mark(request, reply);
      if (reply->status == 200) {
        reply_header(reply, "Content-Disposition", "attachment; filename=\"%s\"", name);
      }
    }
  }
  free(directory);
}
