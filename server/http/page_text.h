/* Numbers, times, metrics and states as people read them on the pages. */
#ifndef PNEULAB_HTTP_PAGE_TEXT_H
#define PNEULAB_HTTP_PAGE_TEXT_H

#include <jansson.h>
#include <stdint.h>

#include "server/http/html.h"
#include "server/store/state.h"

enum { PAGE_TEXT = 128 };

/* Four significant digits, whole numbers in full, narrow spaces between thousands from five digits
 * on; a dash for what is not finite. */
void page_number(double value, char text[PAGE_TEXT]);

/* The unit of a metric or statistic by its key, "" for none. */
void page_unit(const char *key, char text[PAGE_TEXT]);

/* What a metric or statistic is called, without its unit. */
void page_label(const char *key, char text[PAGE_TEXT]);

/* A value with its unit: "12.5 mm", "37.2°". */
void page_quantity(const char *key, double value, char text[PAGE_TEXT]);

/* A word of the program with spaces: "timed out". */
void page_word(const char *word, char text[PAGE_TEXT]);

/* Writes a time element: "5 min ago" (since now, unix ms) or, with now 0, the moment in UTC, which
 * scripts put into the reader's time zone. A dash for 0. */
void page_time(struct html *html, int64_t unix_ms, int64_t now);

/* Writes the state of a job as a coloured word. */
void page_state(struct html *html, enum job_state state, const char *id);

/* Writes the picture that a plot of the API draws in that size, in the colours that the reader
 * prefers. url: without a query, or with one. */
void page_picture(struct html *html, const char *url, const char *caption, int width, int height);

/* The keys of the metrics, most telling first, without the estimates of their errors: an array
 * of json_object_size + 1 pointers into `metrics`, ended by NULL, which the caller frees; NULL
 * without memory. */
const char **page_metric_order(json_t *metrics);

/* The estimate "<key>_error" beside a metric, NAN when there is none. */
double page_metric_error(const json_t *metrics, const char *key);

/* What a person can do about a reason_code, a sentence; NULL when there is nothing to say. */
const char *page_advice(const char *reason_code);

#endif
