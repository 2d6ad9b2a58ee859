#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/http/cache.h"
#include "server/http/handlers.h"
#include "server/http/picture.h"
#include "server/http/study_bodies.h"
#include "server/http/study_table.h"
#include "server/plot/study_answer.h"
#include "server/plot/study_axis.h"
#include "solver/job/json.h"

enum { BEST = 15, RESOLUTION = 41 };

/* A picture on its way: the study and what is asked of it. */
struct drawing {
  struct request *request;
  const char *plot;
  const struct study_table *table;
  struct study_plot_options options;
};

static const char *query_of(const struct drawing *drawing, const char *name) {
  return url_query(&drawing->request->url, name);
}

/* ---- analyses ------------------------------------------------------------------------------ */

typedef enum status analyse(const struct drawing *drawing, json_t **answer, struct error *error);

static analyse ask_pareto, ask_ranking, ask_importance, ask_effects, ask_left_out, ask_slice,
    ask_history;

static enum status ask_pareto(const struct drawing *drawing, json_t **answer, struct error *error) {
  struct criterion objectives[CRITERIA_MAX];
  size_t count;
  enum status status =
      criteria_read(drawing->table, query_of(drawing, "objectives"), objectives, &count, error);
  return status == STATUS_OK ? analysis_pareto(drawing->table, objectives, count, 1, answer, error)
                             : status;
}

/* The result of the study; STATUS_CONFLICT while it has none. */
static enum status read_result(const struct drawing *drawing, json_t **result,
                               struct error *error) {
  char *text = NULL;
  const struct study_table *table = drawing->table;
  enum status status =
      store_result(drawing->request->service->store, table->study_id, &text, NULL, error);
  if (status == STATUS_NOT_FOUND) {
    status = error_set(error, STATUS_CONFLICT, NULL,
                       "The study has not ended; this plot comes with its result.");
  } else if (status == STATUS_OK) {
    status = json_text_read(text, strlen(text), result, error);
  }
  free(text);
  return status;
}

static enum status ask_ranking(const struct drawing *drawing, json_t **answer,
                               struct error *error) {
  struct criterion criteria[CRITERIA_MAX];
  size_t count;
  json_t *result = NULL;
  enum status status;
  if (query_of(drawing, "criteria")) {
    status = criteria_read(drawing->table, query_of(drawing, "criteria"), criteria, &count, error);
    return status == STATUS_OK
               ? analysis_ranking(drawing->table, criteria, count, BEST, answer, error)
               : status;
  }
  status = read_result(drawing, &result, error);
  if (status == STATUS_OK) {
    status = analysis_ranking_stored(drawing->table, result, BEST, answer, error);
  }
  json_decref(result);
  return status;
}

/* The metric that is asked for, and its surrogate. */
static enum status get_model(const struct drawing *drawing, size_t *metric, struct model **model,
                             struct error *error) {
  struct study_axis axis;
  enum status status =
      study_axis_choose_metric(drawing->table, drawing->options.metric, &axis, error);
  if (status == STATUS_OK && !axis.table) {
    status = error_set(error, STATUS_NOT_FOUND, NULL, "no member of this study is solved yet");
  }
  *metric = axis.index;
  return status == STATUS_OK
             ? models_get(drawing->request->service->models, drawing->table, *metric, model, error)
             : status;
}

static enum status ask_model(const struct drawing *drawing,
                             enum status (*make)(const struct study_table *, const struct model *,
                                                 size_t, json_t **, struct error *),
                             json_t **answer, struct error *error) {
  struct model *model = NULL;
  size_t metric;
  enum status status = get_model(drawing, &metric, &model, error);
  if (status == STATUS_OK) {
    status = make(drawing->table, model, metric, answer, error);
  }
  model_release(model);
  return status;
}

static enum status ask_importance(const struct drawing *drawing, json_t **answer,
                                  struct error *error) {
  return ask_model(drawing, analysis_importance, answer, error);
}

static enum status ask_effects(const struct drawing *drawing, json_t **answer,
                               struct error *error) {
  return ask_model(drawing, analysis_effects, answer, error);
}

static enum status ask_left_out(const struct drawing *drawing, json_t **answer,
                                struct error *error) {
  return ask_model(drawing, analysis_surrogate, answer, error);
}

static enum status ask_slice(const struct drawing *drawing, json_t **answer, struct error *error) {
  struct study_axis x = {0}, y = {0};
  double at[SURROGATE_PARAMETERS_MAX];
  struct model *model = NULL;
  size_t metric;
  const struct study_plot_options *options = &drawing->options;
  enum status status =
      study_axis_choose_parameter(drawing->table, options->x, NULL, true, &x, error);
  if (status == STATUS_OK) {
    status = study_axis_choose_parameter(drawing->table, options->y, &x, true, &y, error);
  }
  if (status == STATUS_OK && (!x.table || !y.table || x.index == y.index)) {
    status = error_set(error, STATUS_NOT_FOUND, NULL,
                       "a slice needs two different parameters that vary, as in ?x=/a&y=/b");
  }
  if (status == STATUS_OK && (x.column->categorical || y.column->categorical)) {
    status = error_set(error, STATUS_NOT_FOUND, NULL,
                       "a slice runs over numbers, and %s has words; see \"effects\"",
                       x.column->categorical ? x.column->key : y.column->key);
  }
  if (status == STATUS_OK) {
    status = study_fixed_read(drawing->request, drawing->table, at, error);
  }
  if (status == STATUS_OK) {
    status = get_model(drawing, &metric, &model, error);
  }
  if (status == STATUS_OK) {
    status = analysis_slice(drawing->table, model, metric, x.index, (int)y.index, RESOLUTION, at,
                            answer, error);
  }
  model_release(model);
  return status;
}

/* Only of optimisations that have ended; others show a metric. */
static enum status ask_history(const struct drawing *drawing, json_t **answer,
                               struct error *error) {
  json_t *document = NULL, *result = NULL;
  if (strcmp(drawing->table->sampling, "optimise") != 0 || drawing->options.metric) {
    return STATUS_OK;
  }
  enum status status =
      study_document_read(drawing->request, drawing->table->study_id, &document, error);
  if (status == STATUS_OK) {
    status = read_result(drawing, &result, error);
  }
  if (status == STATUS_OK) {
    *answer = json_pack("{s:O?, s:O?}", "objective", json_object_get(document, "objective"),
                        "history", json_object_get(result, "history"));
    status = analysis_made(*answer, error);
  } else if (status == STATUS_CONFLICT) {
    status = STATUS_OK;
  }
  json_decref(document);
  json_decref(result);
  return status;
}

static enum status ask(const struct drawing *drawing, json_t **answer, struct error *error) {
  static const struct {
    const char *plot;
    analyse *analyse;
  } entries[] = {{"pareto", ask_pareto},         {"ranking", ask_ranking},
                 {"importance", ask_importance}, {"effects", ask_effects},
                 {"surrogate", ask_left_out},    {"contour", ask_slice},
                 {"history", ask_history}};
  for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
    if (strcmp(entries[i].plot, drawing->plot) == 0) {
      return entries[i].analyse(drawing, answer, error);
    }
  }
  return STATUS_OK;
}

/* ---- the picture --------------------------------------------------------------------------- */

/* Of all that the picture follows from: the table and the question. */
static uint64_t tag_of(const struct drawing *drawing) {
  const struct study_table *t = drawing->table;
  uint64_t tag = cache_tag();
  tag = cache_tag_add(tag, drawing->plot, strlen(drawing->plot));
  for (size_t i = 0; i < drawing->request->url.query_count; i++) {
    const struct url_pair *pair = &drawing->request->url.query[i];
    tag = cache_tag_add(tag, pair->name, strlen(pair->name) + 1);
    tag = cache_tag_add(tag, pair->value, strlen(pair->value) + 1);
  }
  tag = cache_tag_add(tag, &t->study_id, sizeof t->study_id);
  tag = cache_tag_add(tag, &t->own_state, sizeof t->own_state);
  tag = cache_tag_add(tag, &t->wanted, sizeof t->wanted);
  tag = cache_tag_add(tag, t->name, strlen(t->name));
  tag = cache_tag_add(tag, t->state, t->members * sizeof *t->state);
  tag = cache_tag_add(tag, t->job_id, t->members * sizeof *t->job_id);
  tag = cache_tag_add(tag, t->value, t->members * t->parameters * sizeof *t->value);
  return cache_tag_add(tag, t->result, t->members * t->metrics * sizeof *t->result);
}

static enum status draw(const struct drawing *drawing, const struct plot_sheet *sheet,
                        unsigned char **png, size_t *size, struct error *error) {
  struct study_plot_input input = {.table = drawing->table};
  struct study_answer *read = NULL;
  struct study_bodies bodies = {0};
  json_t *answer = NULL;
  enum status status = ask(drawing, &answer, error);
  if (status == STATUS_OK && answer) {
    status = study_answer_read(drawing->plot, answer, drawing->table, &input, &read, error);
  }
  if (status == STATUS_OK && strcmp(drawing->plot, "shapes") == 0) {
    status = study_bodies_read(drawing->request->service->store, drawing->table, &drawing->options,
                               &bodies, error);
    input.shapes = bodies.shape;
    input.shape_count = bodies.count;
  }
  if (status == STATUS_OK) {
    status = study_plot_render(drawing->plot, &input, &drawing->options, sheet, png, size, error);
  }
  study_bodies_clear(&bodies);
  study_answer_destroy(read);
  json_decref(answer);
  return status;
}

void study_picture(struct request *request, struct reply *reply) {
  struct error error = {.status = STATUS_OK};
  struct plot_sheet sheet;
  unsigned char *png = NULL;
  size_t size = 0;
  struct drawing drawing = {.request = request, .plot = request->parameters[1]};
  if (!picture_query(request, reply, &sheet)) {
    return;
  }
  const struct study_table *table = study_table_open(request, reply);
  if (!table) {
    return;
  }
  drawing.table = table;
  drawing.options = (struct study_plot_options){.metric = query_of(&drawing, "metric"),
                                                .x = query_of(&drawing, "x"),
                                                .y = query_of(&drawing, "y"),
                                                .colour = query_of(&drawing, "colour"),
                                                .columns = query_of(&drawing, "columns")};
  uint64_t tag = tag_of(&drawing);
  if (!cache_fresh(request, reply, tag)) {
    enum status status = draw(&drawing, &sheet, &png, &size, &error);
    if (status == STATUS_OK) {
      reply_text(reply, "image/png", (char *)png, size);
      cache_mark(reply, tag);
    } else {
      study_reply(reply, status, NULL, &error);
    }
  }
  study_table_close(request, table);
}
