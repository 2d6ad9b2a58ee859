/* The page of all jobs. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/http/handlers.h"
#include "server/http/jobs.h"
#include "server/http/page.h"
#include "server/http/page_text.h"
#include "server/store/failures.h"
#include "server/study/conductor.h"

enum { ADDRESS = 2048 };

struct index {
  const struct request *request;
  struct job_record *records;
  size_t count;
  char *next; /* cursor, NULL: none */
  struct failure_group failures[FAILURE_GROUPS];
  size_t failure_count;
  int64_t now;
};

/* ---- addresses --------------------------------------------------------------------------- */

/* Writes text as a value of a query. */
static void escape(FILE *out, const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    if (isalnum(*c) || strchr("-._~,", *c)) {
      fputc(*c, out);
    } else {
      fprintf(out, "%%%02X", *c);
    }
  }
}

/* The address of this list with another cursor (NULL: from its beginning). */
static void list_address(const struct index *page, const char *cursor, char text[ADDRESS]) {
  FILE *out = fmemopen(text, ADDRESS, "w");
  char between = '?';
  text[0] = '\0';
  if (!out) {
    return;
  }
  fputc('/', out);
  for (size_t i = 0; i < page->request->url.query_count; i++) {
    const struct url_pair *pair = &page->request->url.query[i];
    if (strcmp(pair->name, "cursor") != 0 && pair->value[0]) {
      fprintf(out, "%c", between);
      escape(out, pair->name);
      fputc('=', out);
      escape(out, pair->value);
      between = '&';
    }
  }
  if (cursor) {
    fprintf(out, "%ccursor=", between);
    escape(out, cursor);
  }
  fclose(out);
}

/* ---- the list ---------------------------------------------------------------------------- */

static void labels_write(struct html *html, json_t *labels) {
  const char *name, *between = "";
  json_t *value;
  if (json_object_size(labels) == 0) {
    return;
  }
  html_open(html, "span", "class", "labels", NULL);
  json_object_foreach(labels, name, value) {
    html_format(html, "%s%s: %s", between, name, json_string_value(value));
    between = " · ";
  }
  html_close(html);
}

static void progress_write(struct html *html, const struct index *page,
                           const struct job_record *job) {
  struct progress progress = progress_none();
  char text[PAGE_TEXT], label[PAGE_TEXT];
  if (job->state != JOB_STATE_RUNNING && job->state != JOB_STATE_STARTING) {
    return;
  }
  const struct service *service = page->request->service;
  if (!executor_progress(service->executor, job->id, &progress)) {
    conductor_progress(service->conductor, job->id, &progress);
  }
  if (progress.steps > 0 && strcmp(job->kind, "study") == 0) {
    html_open(html, "span", "class", "why", NULL);
    html_format(html, "%lld of %lld designs", (long long)progress.step, (long long)progress.steps);
    html_close(html);
  }
  snprintf(text, sizeof text, "%.4f", fmax(progress.fraction, 0));
  snprintf(label, sizeof label, "Progress of job %lld", (long long)job->id);
  html_leaf(html, "progress", "", "max", "1", "value", text, "aria-label", label, NULL);
}

/* The figure that tells most of a job: a force of a grasp, else the angle. "" when it has none. */
static void figure_of(const struct job_record *job, char text[PAGE_TEXT]) {
  static const char *const keys[] = {"grasp_force_peak_N", "blocked_force_N", "bending_angle_deg"};
  text[0] = '\0';
  for (size_t i = 0; i < sizeof keys / sizeof *keys && !text[0]; i++) {
    const json_t *value = json_object_get(job->metrics, keys[i]);
    if (json_is_number(value)) {
      page_quantity(keys[i], json_number_value(value), text);
    }
  }
}

static void state_write(struct html *html, const struct index *page, const struct job_record *job,
                        const char *figure) {
  char word[PAGE_TEXT];
  html_open(html, "td", NULL);
  page_state(html, job->state, NULL);
  if (job->reason_code[0] && strcmp(job->reason_code, job_state_word(job->state)) != 0) {
    page_word(job->reason_code, word);
    html_leaf(html, "span", word, "class", "why", NULL);
  }
  html_leaf(html, "span", figure, "class", "narrow", NULL);
  progress_write(html, page, job);
  html_close(html);
}

static void box_write(struct html *html, const struct job_record *job, bool can) {
  char id[PAGE_TEXT], box[PAGE_TEXT], name[PAGE_TEXT], label[PAGE_TEXT];
  snprintf(id, sizeof id, "%lld", (long long)job->id);
  snprintf(box, sizeof box, "pick-%lld", (long long)job->id);
  snprintf(name, sizeof name, "job.%lld", (long long)job->id);
  snprintf(label, sizeof label, "Compare job %lld", (long long)job->id);
  html_open(html, "td", NULL);
  html_void(html, "input", "type", "checkbox", "name", name, "value", id, "id", box, "aria-label",
            label, "disabled", can ? NULL : "", "autocomplete", "off", NULL);
  html_close(html);
}

static void job_write(struct html *html, const struct index *page, const struct job_record *job) {
  char id[PAGE_TEXT], href[PAGE_TEXT], name[PAGE_TEXT], figure[PAGE_TEXT];
  bool study = strcmp(job->kind, "study") == 0;
  snprintf(id, sizeof id, "%lld", (long long)job->id);
  snprintf(href, sizeof href, "/%s/%lld", study ? "studies" : "jobs", (long long)job->id);
  snprintf(name, sizeof name, "job %lld", (long long)job->id);
  figure_of(job, figure);
  html_open(html, "tr", "data-id", id, "id", href + 1, NULL);
  box_write(html, job, figure[0] && !study);
  html_leaf(html, "td", id, "class", "number", NULL);
  html_open(html, "td", "class", "name", NULL);
  html_leaf(html, "a", job->name[0] ? job->name : name, "href", href, "class", "clamp", "title",
            job->name, NULL);
  labels_write(html, job->labels);
  html_close(html);
  html_leaf(html, "td", job->kind, "class", "wide", NULL);
  state_write(html, page, job, figure);
  html_leaf(html, "td", figure[0] ? figure : "–", "class", "number wide", NULL);
  html_open(html, "td", "class", "wide", NULL);
  page_time(html, job->created_ms, page->now);
  html_close(html);
  html_close(html);
  html_text(html, "\n");
}

static void jobs_write(struct html *html, void *context) {
  const struct index *page = context;
  for (size_t i = 0; i < page->count; i++) {
    job_write(html, page, &page->records[i]);
  }
}

static void empty_write(struct html *html, void *context) {
  const struct index *page = context;
  if (page->count == 0) {
    html_leaf(html, "p",
              page->request->url.query_count > 0 ? "No job is like that."
                                                 : "There are no jobs yet.",
              "class", "muted", NULL);
  }
}

static void options_write(struct html *html, void *context) {
  static const char *const options[][2] = {
      {"", "any"},
      {"queued,starting,running,cancelling,retry_wait", "waiting or running"},
      {"queued", "queued"},
      {"held", "held"},
      {"running", "running"},
      {"succeeded", "succeeded"},
      {"failed,timed_out", "failed or timed out"},
      {"cancelled", "cancelled"}};
  const struct index *page = context;
  const char *chosen = url_query(&page->request->url, "state");
  for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
    html_leaf(html, "option", options[i][1], "value", options[i][0], "selected",
              strcmp(options[i][0], chosen ? chosen : "") == 0 ? "" : NULL, NULL);
  }
}

static void pages_write(struct html *html, void *context) {
  const struct index *page = context;
  char address[ADDRESS];
  bool later = url_query(&page->request->url, "cursor") != NULL;
  if (later) {
    list_address(page, NULL, address);
    html_leaf(html, "a", "Newest", "class", "button", "id", "newest", "href", address, NULL);
  }
  if (page->next) {
    list_address(page, page->next, address);
    html_leaf(html, "a", "Older", "class", "button", "id", "older", "href", address, "rel", "next",
              NULL);
  }
}

/* ---- failures ---------------------------------------------------------------------------- */

static void failure_write(struct html *html, const struct failure_group *group) {
  char word[PAGE_TEXT], href[PAGE_TEXT];
  const char *advice = page_advice(group->reason_code);
  page_word(group->reason_code[0] ? group->reason_code : "failed", word);
  snprintf(href, sizeof href, "/jobs/%lld", (long long)group->newest);
  html_open(html, "tr", "data-reason", group->reason_code, NULL);
  html_leaf(html, "th", word, "scope", "row", NULL);
  html_open(html, "td", "class", "number", NULL);
  html_format(html, "%lld", (long long)group->count);
  html_close(html);
  html_open(html, "td", NULL);
  html_leaf(html, "a", group->newest_name[0] ? group->newest_name : "the newest", "href", href,
            "class", "clamp", NULL);
  html_close(html);
  html_open(html, "td", "class", "wide", NULL);
  html_leaf(html, "span", advice ? advice : group->newest_message, "class", "clamp", NULL);
  html_close(html);
  html_close(html);
  html_text(html, "\n");
}

static void failures_write(struct html *html, void *context) {
  const struct index *page = context;
  if (page->failure_count == 0) {
    return;
  }
  html_leaf(html, "h2", "Failures by reason", "id", "failures-title", NULL);
  html_open(html, "div", "class", "scroll", "tabindex", "0", "role", "region", "aria-labelledby",
            "failures-title", NULL);
  html_open(html, "table", "id", "failures", NULL);
  html_open(html, "thead", NULL);
  html_open(html, "tr", NULL);
  html_leaf(html, "th", "Reason", "scope", "col", NULL);
  html_leaf(html, "th", "Jobs", "scope", "col", "class", "number", NULL);
  html_leaf(html, "th", "Newest", "scope", "col", NULL);
  html_leaf(html, "th", "What helps", "scope", "col", "class", "wide", NULL);
  html_close(html);
  html_close(html);
  html_open(html, "tbody", NULL);
  for (size_t i = 0; i < page->failure_count; i++) {
    failure_write(html, &page->failures[i]);
  }
  html_close(html);
  html_close(html);
  html_close(html);
}

void page_index(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {
      {"options", options_write}, {"jobs", jobs_write},         {"empty", empty_write},
      {"pages", pages_write},     {"failures", failures_write},
  };
  struct index page = {.request = request, .now = clock_unix_ms()};
  struct list_query query;
  struct error error = {.status = STATUS_OK};
  if (!page_allowed(request, reply)) {
    return;
  }
  if (!jobs_query(request, reply, &query)) {
    page_problem(request, reply);
    return;
  }
  if (!url_query(&request->url, "study") && query.label_count == 0) {
    query.study = LIST_STUDY_NONE; /* a study is one row */
  }
  enum status status =
      store_list(request->service->store, &query, &page.records, &page.count, &page.next, &error);
  if (status == STATUS_OK) {
    status = store_failures(request->service->store, page.failures, &page.failure_count, &error);
  }
  if (status == STATUS_OK) {
    page_reply(request, reply, "index", "Jobs", slots, sizeof slots / sizeof *slots, &page);
  } else {
    reply_error(reply, &error);
    page_problem(request, reply);
  }
  for (size_t i = 0; i < page.count; i++) {
    job_record_clear(&page.records[i]);
  }
  free(page.records);
  free(page.next);
  failures_clear(page.failures, page.failure_count);
}
