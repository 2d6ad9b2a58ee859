/* The page of a study, for readers without scripts: its plots, and its designs as a table that
 * links sort and turn over. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/handlers.h"
#include "server/http/job_view.h"
#include "server/http/page.h"
#include "server/http/page_text.h"
#include "server/http/study_table.h"
#include "server/study/tables.h"

enum { PAGE_ROWS = 100, METRICS_SHOWN = 12, ADDRESS = 600 };

/* A longer name of a member, which repeats its parameters, is a number in the table. */
enum { NAME_MOST = 40 };

struct study_page {
  const struct request *request;
  const struct study_table *table;
  json_t *view;                  /* the study's job as the API shows it */
  size_t metrics[METRICS_SHOWN]; /* columns that are shown */
  size_t metric_count;
  const char *sort; /* key of the column that the rows are sorted by, "" for none */
  bool descending;
  size_t *order; /* rows as they are shown */
  size_t page;   /* from 0 */
};

/* ---- which rows, in which order ---------------------------------------------------------- */

static const double *column_values(const struct study_page *page, const char *key, size_t *stride) {
  const struct study_table *table = page->table;
  for (size_t k = 0; k < table->parameters; k++) {
    if (strcmp(table->parameter[k].key, key) == 0) {
      *stride = table->parameters;
      return table->value + k;
    }
  }
  for (size_t k = 0; k < table->metrics; k++) {
    if (strcmp(table->metric[k].key, key) == 0) {
      *stride = table->metrics;
      return table->result + k;
    }
  }
  return NULL;
}

/* Rows and what they are sorted by. */
struct sorted {
  double value; /* NAN comes last */
  size_t row;
};

static int compare_rows(const void *left, const void *right) {
  const struct sorted *a = left, *b = right;
  if (isnan(a->value) != isnan(b->value)) {
    return isnan(a->value) ? 1 : -1;
  }
  if (!isnan(a->value) && a->value != b->value) {
    return a->value < b->value ? -1 : 1;
  }
  return a->row < b->row ? -1 : a->row > b->row;
}

static bool rows_sort(struct study_page *page) {
  size_t rows = page->table->members, stride = 0;
  const double *values = column_values(page, page->sort, &stride);
  struct sorted *sorted = malloc((rows + 1) * sizeof *sorted);
  page->order = malloc((rows + 1) * sizeof *page->order);
  bool fine = sorted && page->order;
  for (size_t i = 0; fine && i < rows; i++) {
    double value = values ? values[i * stride] : NAN;
    sorted[i] = (struct sorted){page->descending ? -value : value, i};
  }
  if (fine) {
    qsort(sorted, rows, sizeof *sorted, compare_rows);
  }
  for (size_t i = 0; fine && i < rows; i++) {
    page->order[i] = sorted[i].row;
  }
  free(sorted);
  return fine;
}

/* The metrics that people look for first and that some member has. */
static bool metrics_choose(struct study_page *page) {
  const struct study_table *table = page->table;
  json_t *columns = json_object();
  for (size_t k = 0; k < table->metrics; k++) {
    json_object_set_new(columns, table->metric[k].key, json_integer((json_int_t)k));
  }
  const char **keys = page_metric_order(columns);
  for (size_t i = 0; keys && keys[i] && page->metric_count < METRICS_SHOWN; i++) {
    page->metrics[page->metric_count++] =
        (size_t)json_integer_value(json_object_get(columns, keys[i]));
  }
  bool fine = keys != NULL;
  free(keys);
  json_decref(columns);
  return fine;
}

/* ---- writing ----------------------------------------------------------------------------- */

/* The address of this page with rows sorted by `key`. */
static void address_write(const struct study_page *page, const char *key, bool descending,
                          size_t number, char text[ADDRESS]) {
  size_t used = (size_t)snprintf(text, ADDRESS, "/studies/%lld?page=%zu",
                                 (long long)page->table->study_id, number);
  if (key[0]) {
    used += (size_t)snprintf(text + used, ADDRESS - used, "&sort=%s", descending ? "-" : "");
    for (; *key && used + 4 < ADDRESS; key++) {
      bool plain = strchr("%&+#?\"<> ", *key) == NULL;
      used += (size_t)snprintf(text + used, ADDRESS - used, plain ? "%c" : "%%%02X",
                               (unsigned char)*key);
    }
  }
}

static void head_write(struct html *html, const struct study_page *page,
                       const struct study_column *column) {
  char address[ADDRESS];
  bool chosen = strcmp(page->sort, column->key) == 0;
  address_write(page, column->key, chosen && !page->descending, 1, address);
  html_open(html, "th", "scope", "col", "class", column->categorical ? NULL : "number", "aria-sort",
            !chosen            ? NULL
            : page->descending ? "descending"
                               : "ascending",
            NULL);
  html_open(html, "a", "href", address, NULL);
  html_format(html, column->unit[0] ? "%s (%s)" : "%s", column->title, column->unit);
  html_close(html);
  html_close(html);
}

static void cell_write(struct html *html, const struct study_column *column, double value) {
  char text[PAGE_TEXT];
  if (column->categorical) {
    bool known = value >= 0 && value < (double)column->word_count;
    html_leaf(html, "td", known ? column->words[(size_t)value] : "–", NULL);
  } else {
    page_number(value, text);
    html_leaf(html, "td", text, "class", "number", NULL);
  }
}

static void row_write(struct html *html, const struct study_page *page, size_t row) {
  const struct study_table *table = page->table;
  char href[PAGE_TEXT], word[PAGE_TEXT], label[32];
  snprintf(href, sizeof href, "/jobs/%lld", (long long)table->job_id[row]);
  html_open(html, "tr", "data-member", href + 6, NULL);
  html_open(html, "td", NULL);
  const char *name = table->member_name[row];
  bool plain = name[0] && (strlen(name) <= NAME_MOST || table->parameters == 0);
  snprintf(label, sizeof label, "design %d", table->member[row]);
  html_leaf(html, "a", plain ? name : label, "href", href, "title", name[0] ? name : NULL, NULL);
  html_close(html);
  html_open(html, "td", NULL);
  page_state(html, (enum job_state)table->state[row], NULL);
  if (table->reason[row][0]) {
    page_word(table->reason[row], word);
    html_leaf(html, "span", word, "class", "why", NULL);
  }
  html_close(html);
  for (size_t k = 0; k < table->parameters; k++) {
    cell_write(html, &table->parameter[k], table->value[row * table->parameters + k]);
  }
  for (size_t k = 0; k < page->metric_count; k++) {
    size_t metric = page->metrics[k];
    cell_write(html, &table->metric[metric], table->result[row * table->metrics + metric]);
  }
  html_close(html);
  html_text(html, "\n");
}

static void turn_write(struct html *html, const struct study_page *page) {
  size_t pages = (page->table->members + PAGE_ROWS - 1) / PAGE_ROWS;
  char address[ADDRESS];
  html_open(html, "div", "class", "bar foot", NULL);
  if (page->page > 0) {
    address_write(page, page->sort, page->descending, page->page, address);
    html_leaf(html, "a", "Earlier", "class", "button", "rel", "prev", "href", address, NULL);
  }
  if (page->page + 1 < pages) {
    address_write(page, page->sort, page->descending, page->page + 2, address);
    html_leaf(html, "a", "Later", "class", "button", "rel", "next", "href", address, NULL);
  }
  html_open(html, "span", "class", "muted", NULL);
  html_format(html, "Page %zu of %zu; %zu designs", page->page + 1, pages > 0 ? pages : 1,
              page->table->members);
  html_close(html);
  html_close(html);
}

static void table_write(struct html *html, const struct study_page *page) {
  const struct study_table *table = page->table;
  html_open(html, "section", "class", "card", "aria-labelledby", "reading-title", NULL);
  html_leaf(html, "h2", "Designs", "id", "reading-title", NULL);
  html_open(html, "div", "class", "scroll", "tabindex", "0", "role", "region", "aria-labelledby",
            "reading-title", NULL);
  html_open(html, "table", "class", "samples", "id", "reading-table", NULL);
  html_open(html, "thead", NULL);
  html_open(html, "tr", NULL);
  html_leaf(html, "th", "Design", "scope", "col", NULL);
  html_leaf(html, "th", "State", "scope", "col", NULL);
  for (size_t k = 0; k < table->parameters; k++) {
    head_write(html, page, &table->parameter[k]);
  }
  for (size_t k = 0; k < page->metric_count; k++) {
    head_write(html, page, &table->metric[page->metrics[k]]);
  }
  html_close(html);
  html_close(html);
  html_open(html, "tbody", NULL);
  for (size_t i = PAGE_ROWS * page->page; i < table->members && i < PAGE_ROWS * (page->page + 1);
       i++) {
    row_write(html, page, page->order[i]);
  }
  html_close(html);
  html_close(html);
  html_close(html);
  turn_write(html, page);
  html_close(html);
}

static void plots_write(struct html *html, const struct study_page *page) {
  json_t *plots = json_object_get(json_object_get(page->view, "links"), "plots"), *link;
  size_t index;
  if (json_array_size(plots) == 0) {
    return;
  }
  html_open(html, "section", "class", "card", "aria-label", "Plots", NULL);
  html_open(html, "div", "class", "plots", NULL);
  json_array_foreach(plots, index, link) {
    html_open(html, "figure", "class", "plot", NULL);
    page_picture(html, json_string_value(link), "Plot of the study", 800, 600);
    html_close(html);
  }
  html_close(html);
  html_close(html);
}

static void failure_write(struct html *html, const json_t *failure) {
  char word[PAGE_TEXT], href[PAGE_TEXT], text[32];
  const char *reason = json_string_value(json_object_get(failure, "reason_code"));
  const char *advice = page_advice(reason);
  size_t index;
  json_t *job;
  page_word(reason[0] ? reason : "failed", word);
  html_open(html, "tr", "data-reason", reason, NULL);
  html_leaf(html, "th", word, "scope", "row", NULL);
  html_open(html, "td", "class", "number", NULL);
  html_format(html, "%lld", (long long)json_integer_value(json_object_get(failure, "count")));
  html_close(html);
  html_open(html, "td", NULL);
  json_array_foreach(json_object_get(failure, "jobs"), index, job) {
    snprintf(text, sizeof text, "%lld", (long long)json_integer_value(job));
    snprintf(href, sizeof href, "/jobs/%s", text);
    html_text(html, index > 0 ? ", " : "");
    html_leaf(html, "a", text, "href", href, NULL);
  }
  html_close(html);
  html_leaf(html, "td", advice ? advice : "", "class", "wide", NULL);
  html_close(html);
  html_text(html, "\n");
}

static void failures_write(struct html *html, const struct study_page *page) {
  json_t *failures = study_failures(page->table), *failure;
  size_t index;
  if (json_array_size(failures) > 0) {
    html_open(html, "section", "class", "card", "aria-labelledby", "reasons-title", NULL);
    html_leaf(html, "h2", "Failures by reason", "id", "reasons-title", NULL);
    html_open(html, "table", "id", "reasons", NULL);
    html_open(html, "tbody", NULL);
    json_array_foreach(failures, index, failure) {
      failure_write(html, failure);
    }
    html_close(html);
    html_close(html);
    html_close(html);
  }
  json_decref(failures);
}

static void files_write(struct html *html, const struct study_page *page) {
  static const struct {
    const char *name, *of, *part;
  } files[] = {{"All designs (CSV)", "studies", "export.csv"},
               {"For Optuna (CSV)", "studies", "export.csv?format=optuna"},
               {"All designs (JSON)", "studies", "designs?format=columns"},
               {"Document (JSON)", "jobs", "document"}};
  char href[PAGE_TEXT];
  html_open(html, "section", "class", "card", "aria-labelledby", "reading-files", NULL);
  html_leaf(html, "h2", "Files", "id", "reading-files", NULL);
  html_open(html, "ul", "class", "plain", NULL);
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    html_open(html, "li", NULL);
    snprintf(href, sizeof href, "/api/v1/%s/%lld/%s", files[i].of, (long long)page->table->study_id,
             files[i].part);
    html_leaf(html, "a", files[i].name, "href", href, NULL);
    html_close(html);
  }
  html_close(html);
  html_close(html);
}

static void reading_write(struct html *html, void *context) {
  const struct study_page *page = context;
  html_open(html, "div", "class", "bar", NULL);
  page_state(html, page->table->own_state, NULL);
  html_open(html, "span", "class", "muted", NULL);
  html_format(html, "Study %lld · %s · %zu of %zu designs are jobs",
              (long long)page->table->study_id, page->table->sampling, page->table->members,
              page->table->wanted);
  html_close(html);
  html_close(html);
  failures_write(html, page);
  plots_write(html, page);
  table_write(html, page);
  files_write(html, page);
}

/* ---- the page ---------------------------------------------------------------------------- */

/* The study's job as the API shows it, NULL when it cannot be read. */
static json_t *view_read(const struct request *request, int64_t id) {
  struct job_record record;
  if (store_job(request->service->store, id, &record, NULL) != STATUS_OK) {
    return NULL;
  }
  json_t *view = job_view(request->service, &record, true);
  job_record_clear(&record);
  return view;
}

void page_study(struct request *request, struct reply *reply) {
  static const struct page_slot slots[] = {{"reading", reading_write}};
  struct study_page page = {.request = request};
  struct error error = {.status = STATUS_OK};
  const char *sort = url_query(&request->url, "sort");
  int64_t id, number;
  if (!page_allowed(request, reply)) {
    return;
  }
  if (!request_id(request, reply, &id) ||
      !request_query_integer(request, reply, "page", 1, 1000000, 1, &number)) {
    page_problem(request, reply);
    return;
  }
  page.page = (size_t)number - 1;
  page.descending = sort && sort[0] == '-';
  page.sort = sort ? sort + page.descending : "";
  if (tables_use(request->service->tables, id, &page.table, NULL, &error) != STATUS_OK) {
    reply_error(reply, &error);
    page_problem(request, reply);
    return;
  }
  page.view = view_read(request, id);
  if (metrics_choose(&page) && rows_sort(&page)) {
    page_reply(request, reply, "study", page.table->name[0] ? page.table->name : "Study", slots,
               sizeof slots / sizeof *slots, &page);
  } else {
    reply_problem(reply, 503, "no_memory", "No memory for the page of a study.");
  }
  tables_release(request->service->tables, page.table);
  json_decref(page.view);
  free(page.order);
}
