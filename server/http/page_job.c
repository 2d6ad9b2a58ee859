/* The page of one job: what heads it, and where its parts come from. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/http/page.h"
#include "server/http/page_job.h"
#include "server/http/page_text.h"
#include "server/study/conductor.h"
#include "solver/job/json.h"

static void kind_write(struct html *html, void *context) {
  const struct job_page *page = context;
  const struct job_record *job = &page->record;
  char href[PAGE_TEXT];
  bool study = strcmp(job->kind, "study") == 0;
  html_format(html, "Job %lld · %s", (long long)job->id, job->kind);
  if (study || job->study_id != 0) {
    snprintf(href, sizeof href, "/studies/%lld", (long long)(study ? job->id : job->study_id));
    html_text(html, " · ");
    html_leaf(html, "a", study ? "explore its designs" : "the study it belongs to", "href", href,
              NULL);
  }
}

static void name_write(struct html *html, void *context) {
  const struct job_page *page = context;
  html_text(html, page->title);
}

static void progress_write(struct html *html, const struct job_page *page) {
  struct progress progress = progress_none();
  char value[PAGE_TEXT];
  if (page->record.state != JOB_STATE_RUNNING && page->record.state != JOB_STATE_STARTING) {
    return;
  }
  const struct service *service = page->request->service;
  if (!executor_progress(service->executor, page->record.id, &progress)) {
    conductor_progress(service->conductor, page->record.id, &progress);
  }
  double share = fmin(fmax(progress.fraction, 0), 1);
  snprintf(value, sizeof value, "%.4f", share);
  html_leaf(html, "progress", "", "id", "progress", "max", "1", "value", value, "aria-label",
            "Progress", NULL);
  html_open(html, "span", "id", "percent", "class", "muted", NULL);
  html_format(html, "%.0f\u00a0%%", 100 * share);
  html_close(html);
}

static void action_write(struct html *html, const char *action, const char *label) {
  html_leaf(html, "button", label, "type", "button", "data-action", action, "class", "scripted",
            NULL);
}

/* What can be done to a job in its state; all of it needs scripts. */
static void actions_write(struct html *html, const struct job_page *page) {
  enum job_state state = page->record.state;
  char href[PAGE_TEXT];
  html_open(html, "span", "class", "push", "id", "actions", NULL);
  if (state == JOB_STATE_QUEUED) {
    action_write(html, "hold", "Hold");
  }
  if (state == JOB_STATE_HELD) {
    action_write(html, "release", "Release");
  }
  if (!job_state_terminal(state) && state != JOB_STATE_CANCELLING) {
    action_write(html, "cancel", "Cancel");
  }
  if (job_state_terminal(state) && state != JOB_STATE_SUCCEEDED) {
    action_write(html, "retry", "Retry");
  }
  snprintf(href, sizeof href, "/submit?from=%lld", (long long)page->record.id);
  html_leaf(html, "a", "Edit and resubmit", "class", "button", "href", href, NULL);
  html_close(html);
}

static void state_write(struct html *html, void *context) {
  const struct job_page *page = context;
  const char *active = job_state_terminal(page->record.state) ? NULL : "";
  html_open(html, "div", "class", "bar", "id", "state-bar", "data-live", "", "data-active", active,
            NULL);
  page_state(html, page->record.state, "state");
  progress_write(html, page);
  actions_write(html, page);
  html_close(html);
}

/* The pressure of the last sample, NAN when there is none. */
static double last_pressure(const struct job_page *page) {
  json_t *samples = json_object_get(page->result, "samples");
  size_t count = json_array_size(samples);
  const json_t *value = json_object_get(json_array_get(samples, count - 1), "pressure_kPa");
  return count > 0 && json_is_number(value) ? json_number_value(value) : NAN;
}

/* Where a job is on the cluster that solves it, or why it is not there. */
static void cluster_write(struct html *html, const struct job_page *page) {
  json_t *place = job_place(page->request->service, &page->record);
  const json_t *job = json_object_get(place, "job"), *task = json_object_get(place, "task");
  const char *node = json_string_value(json_object_get(place, "node"));
  const char *message = json_string_value(json_object_get(place, "message"));
  if (place) {
    html_open(html, "p", "class", "muted", "id", "cluster", NULL);
    html_text(html, "Cluster: ");
    if (json_is_integer(job)) {
      html_format(html, "%lld_%lld, ", (long long)json_integer_value(job),
                  (long long)json_integer_value(task));
    }
    html_format(html, "%s%s%s.%s%s", json_string_value(json_object_get(place, "state")),
                node && node[0] ? " on " : "", node ? node : "", message && message[0] ? " " : "",
                message ? message : "");
    html_close(html);
  }
  json_decref(place);
}

static void reason_write(struct html *html, void *context) {
  const struct job_page *page = context;
  const struct job_record *job = &page->record;
  const char *advice = page_advice(job->reason_code);
  char text[PAGE_TEXT];
  html_open(html, "div", "id", "reason", "data-live", "", NULL);
  cluster_write(html, page);
  if (job->state != JOB_STATE_SUCCEEDED && (job->reason_code[0] || job->message[0])) {
    html_open(html, "div", "class", "notice", NULL);
    html_open(html, "p", NULL);
    page_word(job->reason_code, text);
    html_leaf(html, "strong", text, NULL);
    html_format(html, "%s%s", text[0] && job->message[0] ? ": " : "", job->message);
    html_close(html);
    double pressure = last_pressure(page);
    if (isfinite(pressure)) {
      page_quantity("pressure_kPa", pressure, text);
      html_open(html, "p", NULL);
      html_text(html, "Last converged load: ");
      html_leaf(html, "strong", text, NULL);
      html_text(html, ". What was reached up to there is below.");
      html_close(html);
    }
    if (advice) {
      html_leaf(html, "p", advice, NULL);
    }
    html_close(html);
  }
  html_close(html);
}

static void outcome_write(struct html *html, void *context) {
  const struct job_page *page = context;
  html_open(html, "div", "id", "outcome", "data-live", "", NULL);
  job_page_warnings(html, page);
  job_page_shape(html, page);
  html_open(html, "div", "class", "columns", NULL);
  job_page_metrics(html, page);
  html_open(html, "div", NULL);
  job_page_facts(html, page);
  job_page_statistics(html, page);
  job_page_files(html, page);
  html_close(html);
  html_close(html);
  job_page_plots(html, page);
  job_page_samples(html, page);
  html_close(html);
  job_page_commands(html, page);
}

/* The job with its result, where there is one. */
static enum status job_page_read(struct job_page *page, int64_t id, struct error *error) {
  const struct service *service = page->request->service;
  char *text = NULL, *directory = NULL;
  enum status status = store_job(service->store, id, &page->record, error);
  if (status != STATUS_OK) {
    return status;
  }
  snprintf(page->title, sizeof page->title, "%s", page->record.name);
  if (page->title[0] == '\0') {
    snprintf(page->title, sizeof page->title, "Job %lld", (long long)id);
  }
  page->view = job_view(service, &page->record, true);
  if (page->record.has_result &&
      store_result(service->store, id, &text, &directory, NULL) == STATUS_OK) {
    page->result = json_read(text, strlen(text), 0, NULL);
  }
  free(text);
  free(directory);
  return page->view ? STATUS_OK
                    : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the page of a job.");
}

void page_job(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {{"kind", kind_write},
                                           {"name", name_write},
                                           {"state", state_write},
                                           {"reason", reason_write},
                                           {"outcome", outcome_write}};
  struct job_page page = {.request = request};
  struct error error = {.status = STATUS_OK};
  int64_t id;
  if (!page_allowed(request, reply)) {
    return;
  }
  if (!request_id(request, reply, &id)) {
    page_problem(request, reply);
    return;
  }
  if (job_page_read(&page, id, &error) == STATUS_OK) {
    page_reply(request, reply, "job", page.title, slots, sizeof slots / sizeof *slots, &page);
  } else {
    reply_error(reply, &error);
    page_problem(request, reply);
  }
  job_record_clear(&page.record);
  json_decref(page.view);
  json_decref(page.result);
}
