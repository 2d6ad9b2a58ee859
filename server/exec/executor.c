#include "server/exec/executor.h"

#include <stdlib.h>

#include "server/exec/tally.h"

struct executor {
  struct tally *tally;
  struct engine engine[EXECUTOR_ENGINES_MAX];
  size_t engines;
};

enum status executor_create(struct executor **executor, struct error *error) {
  struct executor *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the executor of jobs.");
  }
  enum status status = tally_create(&made->tally, error);
  if (status != STATUS_OK) {
    free(made);
    return status;
  }
  *executor = made;
  return STATUS_OK;
}

void executor_add(struct executor *executor, struct engine engine) {
  executor->engine[executor->engines++] = engine;
}

void executor_wake(struct executor *executor) {
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->wake(executor->engine[i].self);
  }
}

void executor_cancel(struct executor *executor, int64_t job_id) {
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->cancel(executor->engine[i].self, job_id);
  }
}

void executor_recall(struct executor *executor) {
  for (size_t i = 0; i < executor->engines; i++) {
    if (executor->engine[i].methods->recall) {
      executor->engine[i].methods->recall(executor->engine[i].self);
    }
  }
}

bool executor_progress(struct executor *executor, int64_t job_id, struct progress *progress) {
  bool found = false;
  for (size_t i = 0; i < executor->engines && !found; i++) {
    found = executor->engine[i].methods->progress(executor->engine[i].self, job_id, progress);
  }
  return found;
}

json_t *executor_place(struct executor *executor, int64_t job_id, enum store_engine asked,
                       bool waits) {
  json_t *place = NULL;
  for (size_t i = 0; i < executor->engines && !place; i++) {
    const struct engine *engine = &executor->engine[i];
    place =
        engine->methods->place ? engine->methods->place(engine->self, job_id, asked, waits) : NULL;
  }
  return place;
}

enum status executor_check(struct executor *executor, struct error *error) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < executor->engines && status == STATUS_OK; i++) {
    status = executor->engine[i].methods->check(executor->engine[i].self, error);
  }
  return status;
}

struct tally *executor_tally(struct executor *executor) {
  return executor->tally;
}

void executor_drain(struct executor *executor) {
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->drain(executor->engine[i].self);
  }
}

bool executor_idle(struct executor *executor) {
  bool idle = true;
  for (size_t i = 0; i < executor->engines && idle; i++) {
    idle = executor->engine[i].methods->idle(executor->engine[i].self);
  }
  return idle;
}

void executor_stop(struct executor *executor, bool abort) {
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->stop(executor->engine[i].self, abort);
  }
}

void executor_metrics(struct executor *executor, FILE *out) {
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->metrics(executor->engine[i].self, out);
  }
  tally_write(executor->tally, out);
}

void executor_destroy(struct executor *executor) {
  if (!executor) {
    return;
  }
  for (size_t i = 0; i < executor->engines; i++) {
    executor->engine[i].methods->destroy(executor->engine[i].self);
  }
  tally_destroy(executor->tally);
  free(executor);
}
