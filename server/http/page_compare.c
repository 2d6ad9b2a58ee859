/* The page that compares jobs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/compare.h"
#include "server/http/handlers.h"
#include "server/http/page.h"
#include "server/http/page_text.h"

enum { JOBS_MAX = 12, ADDRESS = 400 };

struct compare_page {
  int64_t ids[JOBS_MAX];
  size_t count;
  json_t *view; /* NULL: fewer than two jobs */
  char plot[ADDRESS];
};

/* ---- tables ------------------------------------------------------------------------------ */

static void head_write(struct html *html, json_t *jobs) {
  size_t index;
  json_t *job;
  char href[PAGE_TEXT], id[PAGE_TEXT];
  html_open(html, "thead", NULL);
  html_open(html, "tr", NULL);
  html_leaf(html, "th", "Quantity", "scope", "col", NULL);
  html_leaf(html, "th", "Unit", "scope", "col", NULL);
  json_array_foreach(jobs, index, job) {
    long long number = json_integer_value(json_object_get(job, "id"));
    const char *name = json_string_value(json_object_get(job, "name"));
    snprintf(href, sizeof href, "/jobs/%lld", number);
    snprintf(id, sizeof id, "Job %lld", number);
    html_open(html, "th", "scope", "col", "class", "number", "data-job", href + 6, NULL);
    html_leaf(html, "a", id, "href", href, NULL);
    html_leaf(html, "span", name, "class", "job-name clamp", "title", name, NULL);
    html_close(html);
  }
  html_close(html);
  html_close(html);
}

static void group_open(struct html *html, const char *title, size_t jobs) {
  char columns[PAGE_TEXT];
  snprintf(columns, sizeof columns, "%zu", jobs + 2);
  html_open(html, "tbody", "class", "group", NULL);
  html_open(html, "tr", NULL);
  html_leaf(html, "th", title, "scope", "rowgroup", "colspan", columns, NULL);
  html_close(html);
}

/* A parameter as it was written in each job. Where they differ, what is unlike the first stands
 * out. */
static void parameter_write(struct html *html, const json_t *row) {
  const char *pointer = json_string_value(json_object_get(row, "pointer"));
  json_t *texts = json_object_get(row, "texts"), *text;
  const json_t *first = json_array_get(texts, 0);
  size_t index;
  html_open(html, "tr", "data-pointer", pointer, NULL);
  html_open(html, "th", "scope", "row", NULL);
  html_leaf(html, "code", pointer, NULL);
  html_close(html);
  html_leaf(html, "td", "", NULL);
  json_array_foreach(texts, index, text) {
    const char *shown = json_is_string(text) ? json_string_value(text) : "default";
    bool unlike = index > 0 && !json_equal(text, first);
    html_open(html, "td", "class", "number", NULL);
    html_leaf(html, unlike ? "mark" : "span", shown, NULL);
    html_close(html);
  }
  html_close(html);
  html_text(html, "\n");
}

static void parameters_write(struct html *html, const char *title, json_t *rows, size_t jobs) {
  size_t index;
  json_t *row;
  if (json_array_size(rows) == 0) {
    return;
  }
  group_open(html, title, jobs);
  json_array_foreach(rows, index, row) {
    const char *pointer = json_string_value(json_object_get(row, "pointer"));
    if (strncmp(pointer, "/comment", 8) != 0) { /* words about the job, not part of it */
      parameter_write(html, row);
    }
  }
  html_close(html);
}

/* The difference of a value to that of the first job, in per cent of it. */
static void difference_write(struct html *html, const json_t *value, const json_t *first) {
  if (!json_is_number(value) || !json_is_number(first) || json_number_value(first) == 0) {
    return;
  }
  double share = 100 * (json_number_value(value) / json_number_value(first) - 1);
  if (!(fabs(share) < 1000)) { /* next to nothing tells nothing of a difference */
    return;
  }
  html_open(html, "span", "class", "difference", NULL);
  if (fabs(share) < 0.05) {
    html_text(html, "±0\u00a0%");
  } else {
    html_format(html, "%s%.*f\u00a0%%", share < 0 ? "−" : "+", fabs(share) < 99.95 ? 1 : 0,
                fabs(share));
  }
  html_close(html);
}

static void metric_write(struct html *html, const char *name, const json_t *values) {
  char text[PAGE_TEXT];
  html_open(html, "tr", "data-metric", name, NULL);
  page_label(name, text);
  html_leaf(html, "th", text, "scope", "row", NULL);
  page_unit(name, text);
  html_leaf(html, "td", text, "class", "unit", NULL);
  for (size_t i = 0; i < json_array_size(values); i++) {
    const json_t *value = json_array_get(values, i);
    page_number(json_is_number(value) ? json_number_value(value) : NAN, text);
    html_open(html, "td", "class", "number", NULL);
    html_text(html, text);
    if (i > 0) {
      difference_write(html, value, json_array_get(values, 0));
    }
    html_close(html);
  }
  html_close(html);
  html_text(html, "\n");
}

static void metrics_write(struct html *html, json_t *rows, size_t jobs) {
  json_t *by_name = json_object(), *row;
  size_t index;
  json_array_foreach(rows, index, row) {
    json_object_set(by_name, json_string_value(json_object_get(row, "name")),
                    json_object_get(row, "values"));
  }
  if (json_object_size(by_name) == 0) {
    json_decref(by_name);
    return;
  }
  const char **names = page_metric_order(by_name);
  group_open(html, "Results, and their difference to the first job", jobs);
  for (size_t i = 0; names && names[i]; i++) {
    metric_write(html, names[i], json_object_get(by_name, names[i]));
  }
  html_close(html);
  free(names);
  json_decref(by_name);
}

static void table_write(struct html *html, void *context) {
  const struct compare_page *page = context;
  if (!page->view) {
    return;
  }
  html_open(html, "section", "class", "card", "aria-labelledby", "table-title", NULL);
  html_leaf(html, "h2", "Parameters and results", "id", "table-title", NULL);
  html_open(html, "div", "class", "scroll", "tabindex", "0", "role", "region", "aria-labelledby",
            "table-title", NULL);
  html_open(html, "table", "id", "compare-table", NULL);
  head_write(html, json_object_get(page->view, "jobs"));
  parameters_write(html, "Where the jobs differ", json_object_get(page->view, "parameters"),
                   page->count);
  metrics_write(html, json_object_get(page->view, "metrics"), page->count);
  parameters_write(html, "What all have alike", json_object_get(page->view, "same"), page->count);
  html_close(html);
  html_close(html);
  html_close(html);
}

/* ---- pictures ---------------------------------------------------------------------------- */

static size_t count_kind(json_t *jobs, const char *kind) {
  size_t index, count = 0;
  json_t *job;
  json_array_foreach(jobs, index, job) {
    count += strcmp(json_string_value(json_object_get(job, "kind")), kind) == 0;
  }
  return count;
}

static void curves_write(struct html *html, void *context) {
  const struct compare_page *page = context;
  if (!page->view) {
    html_leaf(html, "p", "Tick two to twelve jobs in the list of jobs, then press Compare.",
              "class", "card", NULL);
    return;
  }
  html_open(html, "section", "class", "card", "id", "curves", "aria-labelledby", "curves-title",
            NULL);
  html_open(html, "div", "class", "bar", "id", "curves-bar", NULL);
  html_leaf(html, "h2", "Curves", "id", "curves-title", NULL);
  html_close(html);
  html_open(html, "figure", "class", "plot wide-plot", NULL);
  bool grasps = count_kind(json_object_get(page->view, "jobs"), "grasp") == page->count;
  page_picture(html, page->plot,
               grasps ? "Forces of the grasps against displacement"
                      : "Curves of the jobs against pressure",
               1000, 500);
  html_close(html);
  html_close(html);
}

/* A body that can be turned with the others, or the picture of a grasp. */
static void shape_write(struct html *html, const json_t *job, bool grasp) {
  long long id = json_integer_value(json_object_get(job, "id"));
  const char *name = json_string_value(json_object_get(job, "name"));
  char data[PAGE_TEXT], plot[PAGE_TEXT], href[PAGE_TEXT], text[PAGE_TEXT];
  snprintf(data, sizeof data, "/api/v1/jobs/%lld/artifacts/surface.bin", id);
  snprintf(plot, sizeof plot, "/api/v1/jobs/%lld/plots/%s.png", id,
           grasp ? "snapshots" : "surface");
  snprintf(href, sizeof href, "/jobs/%lld", id);
  snprintf(text, sizeof text, grasp ? "Grasp of job %lld" : "Deformed body of job %lld", id);
  html_open(html, "figure", "class", "plot small-plot", "data-surface", grasp ? NULL : data, NULL);
  page_picture(html, plot, text, 400, 320);
  html_open(html, "figcaption", NULL);
  html_leaf(html, "a", name[0] ? name : text, "href", href, "class", "clamp", NULL);
  html_leaf(html, "span", "", "class", "at muted", NULL);
  html_close(html);
  html_close(html);
}

static void shapes_write(struct html *html, void *context) {
  const struct compare_page *page = context;
  size_t index;
  json_t *job;
  if (!page->view) {
    return;
  }
  json_t *jobs = json_object_get(page->view, "jobs");
  size_t bodies = count_kind(jobs, "response"), grasps = count_kind(jobs, "grasp");
  html_open(html, "section", "class", "card", "id", "shapes", "aria-labelledby", "shapes-title",
            NULL);
  html_leaf(html, "h2", bodies || !grasps ? "Deformed bodies" : "Grasps", "id", "shapes-title",
            NULL);
  if (bodies || !grasps) {
    html_leaf(html, "div", "", "class", "bodies-tools scripted", NULL);
  }
  html_open(html, "div", "class", "small-plots", NULL);
  json_array_foreach(jobs, index, job) {
    const char *kind = json_string_value(json_object_get(job, "kind"));
    bool grasp = strcmp(kind, "grasp") == 0;
    if (grasp || strcmp(kind, "response") == 0) {
      shape_write(html, job, grasp);
    }
  }
  html_close(html);
  html_close(html);
}

/* ---- which jobs -------------------------------------------------------------------------- */

static bool take_id(struct compare_page *page, long long id) {
  for (size_t i = 0; i < page->count; i++) {
    if (page->ids[i] == id) {
      return true;
    }
  }
  if (id <= 0 || page->count == JOBS_MAX) {
    return false;
  }
  page->ids[page->count++] = id;
  return true;
}

/* Takes ids that are separated by commas. */
static bool take_list(struct compare_page *page, const char *rest) {
  while (*rest) {
    size_t digits = strspn(rest, "0123456789");
    char after = rest[digits];
    if (digits == 0 || digits > 15 || (after != '\0' && after != ',') ||
        !take_id(page, atoll(rest))) {
      return false;
    }
    rest += digits + (after == ',');
  }
  return true;
}

/* jobs=1,2,3 or, as the form with the list of jobs sends it, job.1=1&job.2=2&job.3=3. */
static bool ids_read(const struct request *request, struct compare_page *page) {
  const char *list = url_query(&request->url, "jobs");
  bool fine = !list || take_list(page, list);
  for (size_t i = 0; i < request->url.query_count; i++) {
    if (strncmp(request->url.query[i].name, "job.", 4) == 0) {
      fine = fine && take_list(page, request->url.query[i].name + 4);
    }
  }
  return fine;
}

static void plot_address(struct compare_page *page) {
  size_t used = (size_t)snprintf(page->plot, ADDRESS, "/api/v1/plots/overlay.png?jobs=");
  for (size_t i = 0; i < page->count; i++) {
    used += (size_t)snprintf(page->plot + used, ADDRESS - used, "%s%lld", i > 0 ? "," : "",
                             (long long)page->ids[i]);
  }
}

void page_compare(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {
      {"curves", curves_write}, {"shapes", shapes_write}, {"table", table_write}};
  struct compare_page page = {.count = 0};
  struct error error = {.status = STATUS_OK};
  if (!page_allowed(request, reply)) {
    return;
  }
  if (!ids_read(request, &page)) {
    reply_problem(reply, 400, "invalid_query",
                  "jobs: expected up to %d ids, for example jobs=1,2,3.", JOBS_MAX);
    page_problem(request, reply);
    return;
  }
  plot_address(&page);
  if (page.count < 2 || compare_read(request->service->store, page.ids, page.count, true,
                                     &page.view, &error) == STATUS_OK) {
    page_reply(request, reply, "compare", "Comparison", slots, sizeof slots / sizeof *slots, &page);
  } else {
    reply_error(reply, &error);
    page_problem(request, reply);
  }
  json_decref(page.view);
}
