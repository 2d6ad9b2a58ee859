/* The page of a job: what is known of it in numbers and words. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/page_job.h"
#include "server/http/page_text.h"

enum { SAMPLES_SHOWN = 200 };

/* Opens a card with its heading; `part` names it and is the id of the section. */
static void card_open(struct html *html, const char *part, const char *title, bool table) {
  char heading[PAGE_TEXT];
  snprintf(heading, sizeof heading, "%s-title", part);
  html_open(html, "section", "class", "card", "id", part, "aria-labelledby", heading, NULL);
  html_leaf(html, "h2", title, "id", heading, NULL);
  if (table) {
    html_open(html, "div", "class", "scroll", "tabindex", "0", "role", "region", "aria-labelledby",
              heading, NULL);
  }
}

static void column_write(struct html *html, const char *text, const char *class) {
  html_leaf(html, "th", text, "scope", "col", "class", class, NULL);
}

void job_page_warnings(struct html *html, const struct job_page *page) {
  json_t *warnings = json_object_get(page->result, "warnings"), *warning;
  size_t index;
  if (json_array_size(warnings) == 0) {
    return;
  }
  card_open(html, "warnings", "Warnings", false);
  html_open(html, "ul", "id", "warning-list", NULL);
  json_array_foreach(warnings, index, warning) {
    const char *text = json_string_value(warning);
    html_leaf(html, "li", text ? text : "", NULL);
  }
  html_close(html);
  html_close(html);
}

static void metric_write(struct html *html, const json_t *metrics, const char *key) {
  char text[PAGE_TEXT];
  html_open(html, "tr", "data-metric", key, NULL);
  page_label(key, text);
  html_leaf(html, "th", text, "scope", "row", NULL);
  page_number(json_number_value(json_object_get(metrics, key)), text);
  html_leaf(html, "td", text, "class", "number", NULL);
  double error = page_metric_error(metrics, key);
  html_open(html, "td", "class", "uncertainty", NULL);
  if (isfinite(error)) { /* two digits are enough for an estimate */
    double digit = error > 0 ? pow(10, floor(log10(error)) - 1) : 1;
    page_number(error > 0 ? round(error / digit) * digit : 0, text);
    html_format(html, "±\u00a0%s", text);
  }
  html_close(html);
  page_unit(key, text);
  html_leaf(html, "td", text, "class", "unit", NULL);
  html_close(html);
  html_text(html, "\n");
}

void job_page_metrics(struct html *html, const struct job_page *page) {
  json_t *metrics = page->record.metrics;
  if (json_object_size(metrics) == 0) {
    return;
  }
  const char **keys = page_metric_order(metrics);
  card_open(html, "metrics", "Metrics", true);
  html_open(html, "table", "id", "metric-table", NULL);
  html_open(html, "thead", NULL);
  html_open(html, "tr", NULL);
  column_write(html, "Metric", NULL);
  column_write(html, "Value", "number");
  column_write(html, "Error", "uncertainty");
  column_write(html, "Unit", NULL);
  html_close(html);
  html_close(html);
  html_open(html, "tbody", NULL);
  for (size_t i = 0; keys && keys[i]; i++) {
    metric_write(html, metrics, keys[i]);
  }
  html_close(html);
  html_close(html);
  html_close(html);
  html_close(html);
  free(keys);
}

static void term_write(struct html *html, const char *term) {
  html_leaf(html, "dt", term, NULL);
  html_open(html, "dd", NULL);
}

static void time_write(struct html *html, const char *term, int64_t unix_ms) {
  term_write(html, term);
  page_time(html, unix_ms, 0);
  html_close(html);
}

static void labels_write(struct html *html, json_t *labels) {
  const char *name, *between = "";
  json_t *value;
  if (json_object_size(labels) == 0) {
    return;
  }
  term_write(html, "Labels");
  json_object_foreach(labels, name, value) {
    html_format(html, "%s%s: %s", between, name, json_string_value(value));
    between = " · ";
  }
  html_close(html);
}

/* Another job that this one has to do with. */
static void relative_write(struct html *html, const char *term, int64_t id) {
  char href[PAGE_TEXT];
  if (id == 0) {
    return;
  }
  snprintf(href, sizeof href, "/jobs/%lld", (long long)id);
  term_write(html, term);
  html_open(html, "a", "href", href, NULL);
  html_format(html, "job %lld", (long long)id);
  html_close(html);
  html_close(html);
}

void job_page_facts(struct html *html, const struct job_page *page) {
  const struct job_record *job = &page->record;
  char text[PAGE_TEXT];
  card_open(html, "about", "About this job", false);
  html_open(html, "dl", "id", "facts", NULL);
  time_write(html, "Created", job->created_ms);
  time_write(html, "Started", job->started_ms);
  time_write(html, "Finished", job->finished_ms);
  if (job->started_ms && job->finished_ms) {
    page_quantity("duration_s", 1e-3 * (double)(job->finished_ms - job->started_ms), text);
    term_write(html, "Duration");
    html_text(html, text);
    html_close(html);
  }
  labels_write(html, job->labels);
  relative_write(html, "Retry of", job->retry_of);
  relative_write(html, "Result of", job->reused_from);
  relative_write(html, "Waits for", job->waits_for);
  html_close(html);
  html_close(html);
}

void job_page_statistics(struct html *html, const struct job_page *page) {
  json_t *statistics = json_object_get(page->result, "statistics"), *value;
  const char *key;
  char text[PAGE_TEXT];
  if (json_object_size(statistics) == 0) {
    return;
  }
  card_open(html, "statistics", "Effort", false);
  html_open(html, "dl", "id", "statistic-list", NULL);
  json_object_foreach(statistics, key, value) {
    if (json_is_number(value)) {
      page_label(key, text);
      term_write(html, text);
      page_quantity(key, json_number_value(value), text);
      html_text(html, text);
      html_close(html);
    }
  }
  html_close(html);
  html_close(html);
}

static void sample_write(struct html *html, json_t *columns, const json_t *sample) {
  const char *key;
  json_t *ignored;
  char text[PAGE_TEXT];
  html_open(html, "tr", NULL);
  json_object_foreach(columns, key, ignored) {
    const json_t *value = json_object_get(sample, key);
    if (json_is_string(value)) {
      html_leaf(html, "td", json_string_value(value), NULL);
    } else {
      page_number(json_is_number(value) ? json_number_value(value) : NAN, text);
      html_leaf(html, "td", text, "class", "number", NULL);
    }
  }
  html_close(html);
  html_text(html, "\n");
}

static void sample_head_write(struct html *html, json_t *columns) {
  const char *key;
  json_t *ignored;
  char label[PAGE_TEXT], unit[PAGE_TEXT];
  html_open(html, "tr", NULL);
  json_object_foreach(columns, key, ignored) {
    page_label(key, label);
    page_unit(key, unit);
    html_open(html, "th", "scope", "col", "class", "number", NULL);
    html_format(html, unit[0] ? "%s (%s)" : "%s", label, unit);
    html_close(html);
  }
  html_close(html);
}

void job_page_samples(struct html *html, const struct job_page *page) {
  json_t *samples = json_object_get(page->result, "samples"), *columns = json_object();
  const char *key;
  json_t *value;
  size_t count = json_array_size(samples);
  json_object_foreach(json_array_get(samples, 0), key, value) {
    if (json_is_number(value) || strcmp(key, "stage") == 0) {
      json_object_set_new(columns, key, json_true());
    }
  }
  if (json_object_size(columns) > 0) {
    card_open(html, "samples", "Recorded states", true);
    html_open(html, "table", "class", "samples", NULL);
    html_open(html, "thead", NULL);
    sample_head_write(html, columns);
    html_close(html);
    html_open(html, "tbody", NULL);
    for (size_t i = 0; i < count && i < SAMPLES_SHOWN; i++) {
      sample_write(html, columns, json_array_get(samples, i));
    }
    html_close(html);
    html_close(html);
    html_close(html);
    if (count > SAMPLES_SHOWN) {
      html_open(html, "p", "class", "muted", NULL);
      html_format(html, "The first %d of %zu; all of them are in the CSV file.", SAMPLES_SHOWN,
                  count);
      html_close(html);
    }
    html_close(html);
  }
  json_decref(columns);
}
