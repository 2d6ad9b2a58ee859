#include "solver/verify/verify.h"

#include <math.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/job/json.h"

const struct verify_case *verify_find(const char *name) {
  int count;
  const struct verify_case *cases = verify_cases(&count);
  for (int i = 0; i < count; i++) {
    if (strcmp(cases[i].name, name) == 0) {
      return &cases[i];
    }
  }
  return NULL;
}

static json_t *metrics_object(const struct verify_case *c, const struct verify_report *r,
                              bool good) {
  json_t *o = json_object();
  if (good) {
    json_set_finite(o, "computed", r->computed);
    json_set_finite(o, "reference", r->reference);
    json_set_finite(o, "error_percent", 100 * r->error);
  }
  json_set_finite(o, "bound_percent", 100 * c->bound);
  for (int i = 0; i < r->metric_count; i++) {
    json_set_finite(o, r->metric[i].name, r->metric[i].value);
  }
  return o;
}

/* With points of a curve they are the samples, else the meshes are. */
static json_t *samples_array(const struct verify_case *c, const struct verify_report *r) {
  json_t *samples = json_array();
  for (int i = 0; c->point && i < r->point_count; i++) {
    const struct verify_point *p = &r->point[i];
    json_t *o = json_object();
    json_set_finite(o, c->point, p->x);
    json_set_finite(o, "computed", p->computed);
    json_set_finite(o, "reference", p->reference);
    json_set_finite(o, "error_percent", 100 * fabs(p->computed / p->reference - 1));
    json_array_append_new(samples, o);
  }
  for (int i = 0; !c->point && i < r->row_count; i++) {
    json_t *o = json_object();
    json_set_finite(o, "size", r->row[i].size);
    json_set_finite(o, "computed", r->row[i].computed);
    json_set_finite(o, "error_percent", 100 * r->row[i].error);
    json_array_append_new(samples, o);
  }
  return samples;
}

static json_t *meshes_array(const struct verify_report *r) {
  json_t *meshes = json_array();
  for (int i = 0; i < r->row_count; i++) {
    const struct verify_row *row = &r->row[i];
    json_t *o = json_pack("{s:s}", "mesh", row->label);
    json_set_finite(o, "size", row->size);
    if (row->unknowns > 0) {
      json_object_set_new(o, "unknowns", json_integer(row->unknowns));
    }
    json_set_finite(o, "computed", row->computed);
    json_set_finite(o, "error_percent", 100 * row->error);
    json_set_finite(o, "other_error_percent", 100 * row->other);
    json_array_append_new(meshes, o);
  }
  return meshes;
}

static json_t *case_object(const struct verify_case *c) {
  json_t *o = json_pack("{s:s, s:s, s:s, s:s, s:s, s:f, s:s, s:{s:s, s:i, s:s}}", "name", c->name,
                        "title", c->title, "quantity", c->quantity, "unit", c->unit, "size",
                        c->size, "order", c->order, "bound_because", c->bound_because, "source",
                        "author", c->author, "year", c->year, "work", c->source);
  if (c->norm) {
    json_object_set_new(o, "norm", json_string(c->norm));
  }
  if (c->other) {
    json_object_set_new(o, "other_norm", json_string(c->other));
    json_object_set_new(o, "other_order", json_real(c->other_order));
  }
  if (c->point) {
    json_object_set_new(o, "point", json_string(c->point));
    json_object_set_new(o, "x_label", json_string(c->x_label));
    json_object_set_new(o, "y_label", json_string(c->y_label));
  }
  return o;
}

static json_t *statistics_object(const struct verify_report *r, double wall_s, double cpu_s) {
  return json_pack("{s:i, s:i, s:i, s:i, s:f, s:f, s:f}", "unknowns", r->unknowns, "elements",
                   r->elements, "factorizations", r->factorizations, "newton_iterations",
                   r->newton_iterations, "wall_s", wall_s, "cpu_s", cpu_s, "peak_memory_MB",
                   clock_peak_memory_MB());
}

enum status verify_job(const struct job_spec *spec, const struct verify_options *options,
                       json_t **document, enum status *ending, struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  const struct verify_case *c = verify_find(spec->verify.name);
  *document = NULL;
  if (!c) {
    return error_set(error, STATUS_INVALID, "/case", "there is no case \"%s\"", spec->verify.name);
  }
  struct verify_run run = {
      .refinement = spec->verify.refinement,
      .control = {.deadline_s = spec->timeout_s > 0 ? wall + spec->timeout_s : 0,
                  .cancelled = options->cancelled},
      .events = options->events,
  };
  struct error end = {.status = STATUS_OK};
  *ending = c->run(&run, &end);
  if (*ending == STATUS_NO_MEMORY) {
    *error = end;
    return STATUS_NO_MEMORY;
  }
  bool good = *ending == STATUS_OK;
  *document = json_pack(
      "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:[], s:[], s:o, s:{s:s, s:s}}", "status",
      good ? "succeeded" : "diverged", "reason", good ? "" : status_word(*ending), "message",
      good ? "" : end.message, "kind", "verify", "name", spec->name, "case", case_object(c),
      "metrics", metrics_object(c, &run.report, good), "samples", samples_array(c, &run.report),
      "meshes", meshes_array(&run.report), "warnings", "artifacts", "statistics",
      statistics_object(&run.report, clock_wall_s() - wall, clock_cpu_s() - cpu), "provenance",
      "version", PNEULAB_VERSION, "spec_hash", spec->hash);
  return *document ? STATUS_OK
                   : error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
}
