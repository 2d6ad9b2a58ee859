#include "solver/identify/identify_job.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>

#include "solver/base/clock.h"
#include "solver/identify/document.h"
#include "solver/identify/estimate.h"
#include "solver/identify/remarks.h"
#include "solver/material/document.h"

/* Everything one job owns. */
struct work {
  const struct job_spec *spec;
  struct trials trials;
  struct steps steps;
  struct identification id;
  struct outcome outcome;
};

static enum status prepare(struct work *work, struct error *error) {
  const struct identify_spec *spec = work->spec->identify;
  struct identification *id = &work->id;
  enum status status = trials_read(work->spec->document, spec, &work->trials, error);
  if (status == STATUS_OK) {
    status = steps_part(spec, &work->trials, &work->steps, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  id->spec = spec;
  id->trials = &work->trials;
  id->steps = &work->steps;
  /* Without either, everything is per mass. */
  id->gamma = (struct shared_estimate){.free = isnan(spec->gamma), .value = spec->gamma};
  id->mass = (struct shared_estimate){.free = isnan(spec->mass) && !isnan(spec->gamma),
                                      .value = isnan(spec->mass) ? 1.0 : spec->mass};
  id->point = calloc(work->steps.point_count, sizeof *id->point);
  id->estimate = calloc(work->steps.point_count, sizeof *id->estimate);
  id->sigma = calloc(2 * work->trials.count, sizeof *id->sigma);
  if (!id->point || !id->estimate || !id->sigma) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the identification");
  }
  for (size_t i = 0; i < work->steps.point_count && status == STATUS_OK; i++) {
    const struct step_point *point = &work->steps.point[i];
    status = point_create(id->trials, id->steps, point->mode, point->set_point, false,
                          &id->point[i], error);
    id->point_count++;
  }
  int parameters = id->gamma.free || id->mass.free ? RESPONSE_PARAMETERS : RESPONSE_BY_MASS;
  return status == STATUS_OK ? response_create(spec->tolerance, parameters, &id->response, error)
                             : status;
}

static void release(struct work *work) {
  struct identification *id = &work->id;
  outcome_release(&work->outcome);
  for (size_t i = 0; i < id->point_count; i++) {
    point_release(&id->point[i]);
  }
  for (size_t i = 0; i < id->group_count; i++) {
    free(id->group[i].covariance);
  }
  free(id->point);
  free(id->estimate);
  free(id->group);
  free(id->sigma);
  response_destroy(id->response);
  steps_release(&work->steps);
  trials_release(&work->trials);
}

/* Adds what only an identification that came to its end can tell. */
static bool add_results(const struct work *work, json_t *document) {
  const struct identification *id = &work->id;
  bool good =
      json_object_set_new(document, "modes", document_modes(id, &work->outcome)) == 0 &&
      json_object_set_new(document, "transitions", document_transitions(id, &work->outcome)) == 0 &&
      json_object_set_new(document, "trials", document_trials(id, &work->outcome)) == 0 &&
      json_object_set_new(document, "identifiability", remarks_identifiability(id)) == 0;
  return good && (!work->outcome.complete ||
                  json_object_set_new(document, "model", document_model(id, &work->outcome)) == 0);
}

enum status identify_job(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **document, enum status *ending,
                         struct error *error) {
  struct document_parts parts = {.wall_s = clock_wall_s(), .cpu_s = clock_cpu_s()};
  struct work work = {.spec = spec};
  struct error end = {.status = STATUS_OK};
  /* Failures of GSL come back as flags. */
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  *document = NULL;
  enum status status = prepare(&work, error);
  if (status != STATUS_OK) {
    goto done;
  }
  work.id.deadline_s = spec->timeout_s > 0.0 ? parts.wall_s + spec->timeout_s : 0.0;
  work.id.cancelled = cancelled;
  work.id.events = events;
  *ending = estimate_points(&work.id, &end);
  if (*ending == STATUS_OK) {
    *ending = outcome_fill(&work.id, &work.outcome, &end);
  }
  if (*ending == STATUS_NO_MEMORY || *ending == STATUS_INTERNAL) {
    *error = end;
    status = *ending;
    goto done;
  }
  bool good = *ending == STATUS_OK;
  parts.metrics = good ? document_metrics(&work.id, &work.outcome) : json_object();
  parts.samples = json_array();
  parts.warnings = json_array();
  for (size_t g = 0; g < work.id.group_count; g++) {
    parts.iterations += work.id.group[g].iterations;
  }
  if (good) {
    remarks_warn(&work.id, &work.outcome, parts.warnings);
  }
  *document = document_make(spec, "identify", *ending, &end, &parts);
  if (!*document || (good && !add_results(&work, *document))) {
    json_decref(*document);
    *document = NULL;
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
  }
done:
  release(&work);
  gsl_set_error_handler(handler);
  return status;
}
