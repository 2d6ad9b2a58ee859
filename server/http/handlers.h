/* The handlers of the route table, by file. Each answers one request completely. */
#ifndef PNEULAB_HTTP_HANDLERS_H
#define PNEULAB_HTTP_HANDLERS_H

#include "server/http/service.h"

/* jobs.c: the collection */
handler jobs_list, jobs_submit, jobs_validate;

/* job.c: one job */
handler job_show, job_delete, job_cancel, job_hold, job_release, job_document;

/* retry.c, patch.c */
handler job_retry, job_patch;

/* study.c */
handler study_show, study_designs, study_extend;

/* events.c: the stream of news */
handler events_show;

/* result.c: what came out of a job */
handler result_show, result_metrics, result_samples, result_artifact;

/* attempts.c */
handler attempts_list, attempts_log;

/* plots.c */
handler plot_job, plot_overlay;

/* study_picture.c */
handler study_picture;

/* compare.c */
handler compare_show;

/* study_analysis.c, study_search.c, study_export.c: what the members of a study say together */
handler study_ranking, study_pareto, study_importance, study_effects, study_surrogate, study_slice,
    study_search, study_confirm, study_export;

/* catalogue.c: what the program knows by itself */
handler catalogue_materials, catalogue_schema, catalogue_openapi_json, catalogue_openapi_yaml;

/* database.c */
handler database_show;

/* health.c */
handler health_live, health_ready;

/* metrics.c */
handler metrics_show;

/* session.c: signing in and out with a browser */
handler session_open, session_close, session_caller;

/* pages.c */
handler page_show;
/* Whether the request's path names a file of the table static_files, or the start page. */
bool page_exists(const struct request *request);

/* page_index.c and its like: pages with data in them */
handler page_index, page_job, page_study, page_compare, page_submit;

#endif
