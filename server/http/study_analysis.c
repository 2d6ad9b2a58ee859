#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/analyst.h"
#include "server/http/handlers.h"
#include "server/http/study_table.h"
#include "solver/job/json.h"

enum { DESIGNS = 20, LAYERS = 1, RESOLUTION = 33 };

static const char *query_of(const struct request *request, const char *name) {
  return url_query(&request->url, name);
}

/* ---- over what is stored ------------------------------------------------------------------- */

/* By the study's own ranking. */
static enum status rank_stored(const struct request *request, const struct study_table *table,
                               size_t limit, json_t **answer, struct error *error) {
  char *text = NULL;
  enum status status = store_result(request->service->store, table->study_id, &text, NULL, error);
  json_t *result = status == STATUS_OK ? json_read(text, strlen(text), 0, NULL) : NULL;
  if (status == STATUS_NOT_FOUND) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "The study has not ended; its ranking comes with its result.");
  } else if (status == STATUS_OK) {
    status = analysis_ranking_stored(table, result, limit, answer, error);
  }
  json_decref(result);
  free(text);
  return status;
}

void study_ranking(struct request *request, struct reply *reply) {
  struct criterion criteria[CRITERIA_MAX];
  struct error error = {.status = STATUS_OK};
  const char *preset = query_of(request, "preset");
  json_t *answer = NULL;
  size_t count;
  int64_t limit;
  if (!request_query_integer(request, reply, "limit", 1, ANALYSIS_DESIGNS_MAX, DESIGNS, &limit)) {
    return;
  }
  if (preset && (strcmp(preset, "taper") != 0 || query_of(request, "criteria"))) {
    reply_problem(reply, 400, "invalid_query",
                  "preset=%.40s: expected preset=taper and no criteria, or criteria alone.",
                  preset);
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  enum status status;
  if (preset) {
    status = rank_stored(request, table, (size_t)limit, &answer, &error);
  } else {
    status = criteria_read(table, query_of(request, "criteria"), criteria, &count, &error);
    if (status == STATUS_OK) {
      status = analysis_ranking(table, criteria, count, (size_t)limit, &answer, &error);
    }
  }
  study_reply(reply, status, answer, &error);
  study_table_close(request, table);
}

static void show_pareto(struct request *request, struct reply *reply) {
  struct criterion objectives[CRITERIA_MAX];
  struct error error = {.status = STATUS_OK};
  json_t *answer = NULL;
  size_t count;
  int64_t layers;
  if (!request_query_integer(request, reply, "layers", 1, ANALYSIS_LAYERS_MAX, LAYERS, &layers)) {
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  enum status status =
      criteria_read(table, query_of(request, "objectives"), objectives, &count, &error);
  if (status == STATUS_OK) {
    status = analysis_pareto(table, objectives, count, (int)layers, &answer, &error);
  }
  study_reply(reply, status, answer, &error);
  study_table_close(request, table);
}

void study_pareto(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_pareto);
}

/* ---- by a surrogate ------------------------------------------------------------------------ */

typedef enum status analysis(const struct study_table *table, const struct model *model,
                             size_t metric, json_t **answer, struct error *error);

/* Answers with what `make` says of the metric of the query. */
static void reply_by_model(struct request *request, struct reply *reply, analysis *make) {
  struct error error = {.status = STATUS_OK};
  struct model *model = NULL;
  json_t *answer = NULL;
  size_t metric;
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  enum status status = criteria_metric(table, query_of(request, "metric"), &metric, &error);
  if (status == STATUS_OK) {
    status = models_get(request->service->models, table, metric, &model, &error);
  }
  if (status == STATUS_OK) {
    status = make(table, model, metric, &answer, &error);
  }
  study_reply(reply, status, answer, &error);
  model_release(model);
  study_table_close(request, table);
}

static void show_importance(struct request *request, struct reply *reply) {
  reply_by_model(request, reply, analysis_importance);
}

void study_importance(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_importance);
}

static void show_effects(struct request *request, struct reply *reply) {
  reply_by_model(request, reply, analysis_effects);
}

void study_effects(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_effects);
}

static void show_surrogate(struct request *request, struct reply *reply) {
  reply_by_model(request, reply, analysis_surrogate);
}

void study_surrogate(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_surrogate);
}

/* ---- slices -------------------------------------------------------------------------------- */

/* What a slice is asked for. */
struct slice {
  size_t metric, x;
  int y; /* -1: none */
  int resolution;
  double at[SURROGATE_PARAMETERS_MAX]; /* NaN: the middle */
};

static enum status read_slice(const struct request *request, const struct study_table *table,
                              struct slice *slice, struct error *error) {
  const char *y = query_of(request, "y");
  size_t column;
  enum status status = criteria_metric(table, query_of(request, "metric"), &slice->metric, error);
  if (status == STATUS_OK) {
    status = criteria_parameter(table, query_of(request, "x"), &slice->x, error);
  }
  slice->y = -1;
  if (status == STATUS_OK && y) {
    status = criteria_parameter(table, y, &column, error);
    slice->y = (int)column;
  }
  if (status == STATUS_OK && slice->y == (int)slice->x) {
    status = error_set(error, STATUS_INVALID, NULL,
                       "x and y are the same parameter\ntwo different ones, or x alone");
  }
  return status == STATUS_OK ? study_fixed_read(request, table, slice->at, error) : status;
}

static void show_slice(struct request *request, struct reply *reply) {
  struct error error = {.status = STATUS_OK};
  struct model *model = NULL;
  struct slice slice;
  json_t *answer = NULL;
  int64_t resolution;
  if (!request_query_integer(request, reply, "resolution", 2, ANALYSIS_RESOLUTION_MAX, RESOLUTION,
                             &resolution)) {
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  enum status status = read_slice(request, table, &slice, &error);
  if (status == STATUS_OK) {
    status = models_get(request->service->models, table, slice.metric, &model, &error);
  }
  if (status == STATUS_OK) {
    status = analysis_slice(table, model, slice.metric, slice.x, slice.y, (int)resolution, slice.at,
                            &answer, &error);
  }
  study_reply(reply, status, answer, &error);
  model_release(model);
  study_table_close(request, table);
}

void study_slice(struct request *request, struct reply *reply) {
  analyst_defer(request, reply, show_slice);
}
