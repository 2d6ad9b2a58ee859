/* The parts of the page of a job, each a section, or nothing when the job has none of it. */
#ifndef PNEULAB_HTTP_PAGE_JOB_H
#define PNEULAB_HTTP_PAGE_JOB_H

#include <jansson.h>

#include "server/http/html.h"
#include "server/http/service.h"

struct job_page {
  const struct request *request;
  struct job_record record;
  json_t *view;    /* the job as the API shows it */
  json_t *result;  /* its result document, NULL: none */
  char title[200]; /* its name */
};

/* page_job_parts.c: numbers and words. */
void job_page_warnings(struct html *html, const struct job_page *page);
void job_page_metrics(struct html *html, const struct job_page *page);
void job_page_facts(struct html *html, const struct job_page *page);
void job_page_statistics(struct html *html, const struct job_page *page);
void job_page_samples(struct html *html, const struct job_page *page);

/* page_job_files.c: pictures, files and the commands that get them. */
void job_page_shape(struct html *html, const struct job_page *page);
void job_page_plots(struct html *html, const struct job_page *page);
void job_page_files(struct html *html, const struct job_page *page);
void job_page_commands(struct html *html, const struct job_page *page);

#endif
