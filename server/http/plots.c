#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "server/http/picture.h"
#include "server/plot/plot.h"
#include "solver/job/json.h"

enum { OVERLAY_MAX = 12 };

/* One job to draw with what plot_input points to. */
struct drawing {
  struct job_record record;
  json_t *result;
  uint64_t tag; /* of what the picture follows from */
  char artifacts_dir[PATH_MAX];
};

static void drawing_clear(struct drawing *drawing) {
  job_record_clear(&drawing->record);
  json_decref(drawing->result);
}

/* Reads a job with its result; *drawing is zeroed before. STATUS_NOT_FOUND without a result. */
static enum status drawing_read(const struct service *service, int64_t id, struct drawing *drawing,
                                struct plot_input *input, struct error *error) {
  char *text = NULL, *directory = NULL;
  enum status status = store_job(service->store, id, &drawing->record, error);
  if (status == STATUS_OK) {
    status = store_result(service->store, id, &text, &directory, error);
  }
  if (status == STATUS_OK) {
    int length = snprintf(drawing->artifacts_dir, sizeof drawing->artifacts_dir, "%s/%s/out",
                          service->data, directory);
    drawing->result = json_read(text, strlen(text), 0, NULL);
    drawing->tag = cache_tag_add(cache_tag(), text, strlen(text));
    drawing->tag = cache_tag_add(drawing->tag, drawing->record.name, strlen(drawing->record.name));
    if (!drawing->result || length < 0 || (size_t)length >= sizeof drawing->artifacts_dir) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "The result of job %lld cannot be read.",
                         (long long)id);
    }
    *input = (struct plot_input){.result = drawing->result,
                                 .artifacts_dir = drawing->artifacts_dir,
                                 .title = drawing->record.name,
                                 .job_id = drawing->record.id,
                                 .spec_hash = drawing->record.spec_hash};
  }
  free(text);
  free(directory);
  return status;
}

/* Of all that the picture follows from but the jobs: the plot and the question. */
static uint64_t tag_of_question(const struct request *request, const char *plot) {
  uint64_t tag = cache_tag_add(cache_tag(), plot, strlen(plot) + 1);
  for (size_t i = 0; i < request->url.query_count; i++) {
    const struct url_pair *pair = &request->url.query[i];
    tag = cache_tag_add(tag, pair->name, strlen(pair->name) + 1);
    tag = cache_tag_add(tag, pair->value, strlen(pair->value) + 1);
  }
  return tag;
}

/* Draws the jobs and replies with the picture or the reason why there is none. */
static void plot_reply(struct request *request, struct reply *reply, const char *plot,
                       const int64_t *ids, size_t count) {
  struct error error = {.status = STATUS_OK};
  struct plot_input inputs[OVERLAY_MAX];
  uint64_t tag = tag_of_question(request, plot);
  unsigned char *png = NULL;
  size_t size = 0;
  struct plot_sheet sheet;
  if (!picture_query(request, reply, &sheet)) {
    return;
  }
  struct drawing *drawings = calloc(count, sizeof *drawings);
  enum status status =
      drawings ? STATUS_OK : error_set(&error, STATUS_NO_MEMORY, NULL, "No memory for a picture.");
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    status = drawing_read(request->service, ids[i], &drawings[i], &inputs[i], &error);
    inputs[i].metric = url_query(&request->url, "metric");
    tag = cache_tag_add(tag, &drawings[i].tag, sizeof drawings[i].tag);
  }
  if (status == STATUS_OK && cache_fresh(request, reply, tag)) {
    goto done;
  }
  if (status == STATUS_OK) {
    status = plot_render(plot, inputs, count, &sheet, &png, &size, &error);
  }
  if (status == STATUS_OK) {
    reply_text(reply, "image/png", (char *)png, size);
    cache_mark(reply, tag);
  } else {
    reply_error(reply, &error);
  }
done:
  for (size_t i = 0; drawings && i < count; i++) {
    drawing_clear(&drawings[i]);
  }
  free(drawings);
}

void plot_job(struct request *request, struct reply *reply) {
  int64_t id;
  if (request_id(request, reply, &id)) {
    plot_reply(request, reply, request->parameters[1], &id, 1);
  }
}

void plot_overlay(struct request *request, struct reply *reply) {
  int64_t ids[OVERLAY_MAX];
  size_t count;
  if (request_query_jobs(request, reply, "jobs", OVERLAY_MAX, ids, &count)) {
    plot_reply(request, reply, "overlay", ids, count);
  }
}
