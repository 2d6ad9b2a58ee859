#include "server/study/work.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

enum { BATCH = COLUMNS_ROWS };

/* ---- the beginning ------------------------------------------------------------------------ */

void work_destroy(struct work *work) {
  if (!work) {
    return;
  }
  columns_destroy(work->columns);
  study_search_destroy(work->search);
  free(work->place);
  free(work->order);
  study_release(&work->study);
  job_spec_release(&work->spec);
  free(work->submitter);
  free(work);
}

/* Members wait for workers, and so does the study: its limit counts only where somebody has set
 * one, not the one that the solver takes on the command line. */
static void limit_read(struct work *work, const char *text) {
  json_t *root = json_read(text, strlen(text), 0, NULL);
  work->limit_s = json_object_get(root, "timeout") ? work->spec.timeout_s : 0;
  json_decref(root);
}

/* Notes in the database what the study consists of. */
static enum status note(const struct conductor_settings *settings, struct work *work,
                        struct error *error) {
  size_t count = columns_count(work->columns);
  struct study_parameter_row *rows = calloc(count + 1, sizeof *rows);
  if (!rows) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study.");
  }
  for (size_t k = 0; k < count; k++) {
    columns_parameter(work->columns, k, &rows[k]);
  }
  const char *sampling = json_string_value(json_object_get(work->spec.document, "sampling"));
  enum status status = store_study_begin(settings->store, work->id, work->attempt, sampling,
                                         work->study.count, work->study.light, rows, count, error);
  free(rows);
  return status;
}

enum status work_begin(const struct conductor_settings *settings, struct study_claim *claim,
                       struct work **work, struct error *error) {
  struct work *made = calloc(1, sizeof *made);
  *work = made;
  if (!made) {
    study_claim_clear(claim);
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study.");
  }
  *made = (struct work){.id = claim->id,
                        .attempt = claim->attempt,
                        .submitter = claim->submitter,
                        .priority = claim->priority,
                        .memory_bytes = claim->memory_bytes,
                        .elapsed_s = claim->elapsed_s,
                        .start_ms = clock_monotonic_ms(),
                        .progress = progress_none()};
  claim->submitter = NULL;
  pace_start(&made->pace, made->start_ms);
  enum status status = job_reader_read(settings->reader, claim->document, strlen(claim->document),
                                       &made->spec, error);
  if (status == STATUS_OK) {
    limit_read(made, claim->document);
    status = work_search_begin(settings, made, error);
  }
  if (status == STATUS_OK) {
    status = study_expand(settings->reader, made->spec.document, false, &made->study, error);
  }
  if (status == STATUS_OK) {
    status = columns_create(job_reader_units(settings->reader), made->spec.document, &made->study,
                            &made->columns, error);
  }
  if (status == STATUS_OK && !made->search) {
    status = order_members(made->columns, &made->study, &made->place, &made->order, error);
  }
  if (status == STATUS_OK) {
    status = note(settings, made, error);
  }
  study_claim_clear(claim);
  return status;
}

/* ---- members ------------------------------------------------------------------------------ */

/* Members on their way into the store. */
struct batch {
  size_t count;
  struct study_member_row row[BATCH];
  struct study_value_row *values; /* BATCH rows of all columns */
  json_t *root[BATCH];
  char *text[BATCH];
};

static void batch_clear(struct batch *batch) {
  for (size_t i = 0; i < batch->count; i++) {
    json_decref(batch->root[i]);
    free(batch->text[i]);
  }
  free(batch->values);
}

static enum status batch_fill(const struct conductor_settings *settings, struct work *work,
                              struct batch *batch, size_t index, struct error *error) {
  struct job_spec spec;
  size_t at = batch->count, columns = columns_count(work->columns);
  json_t *root = NULL;
  enum status status =
      study_read_member(settings->reader, work->spec.document, index, &root, &spec, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct study_value_row *values = batch->values + at * columns;
  uint64_t memory_bytes = (uint64_t)spec.memory_bytes;
  double timeout_s = spec.timeout_s;
  job_spec_release(&spec);
  batch->root[at] = root;
  batch->text[at] = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
  batch->count++;
  if (!batch->text[at] || !columns_row(work->columns, at, index, values)) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the members of a study.");
  }
  batch->row[at] = (struct study_member_row){
      .value = values,
      .submission = {.document = batch->text[at],
                     .root = root,
                     .spec_hash = work->study.member[index].hash,
                     .timeout_s = timeout_s,
                     .submitter = work->submitter,
                     .priority = work->priority,
                     .memory_bytes = memory_bytes ? memory_bytes : work->memory_bytes,
                     .reuse = true,
                     .study_id = work->id,
                     .member = (int64_t)index,
                     .chain = work->place ? (int64_t)work->place[index].chain : -1,
                     .chain_position = work->place ? (int64_t)work->place[index].position : 0}};
  return STATUS_OK;
}

/* Where the next batch ends: with a chain, so that no worker finds one that is not complete. */
static size_t batch_end(const struct work *work) {
  size_t end = work->study.count;
  if (end - work->added > BATCH) {
    end = work->added + BATCH;
    while (work->place && end > work->added + 1 && work->place[work->order[end]].position != 0) {
      end--;
    }
  }
  return end;
}

enum status work_add(const struct conductor_settings *settings, struct work *work, bool *more,
                     struct error *error) {
  size_t columns = columns_count(work->columns), stored = 0;
  struct batch batch = {.values = calloc(BATCH * columns + 1, sizeof *batch.values)};
  enum status status =
      batch.values ? STATUS_OK
                   : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a study's members.");
  for (size_t k = work->added; status == STATUS_OK && k < batch_end(work); k++) {
    status = batch_fill(settings, work, &batch, work->order ? work->order[k] : k, error);
  }
  if (status == STATUS_OK && batch.count > 0) {
    status = store_study_add(settings->store, work->id, work->attempt, batch.row, batch.count,
                             columns, &stored, error);
  }
  batch_clear(&batch);
  work->added += stored;
  *more = status == STATUS_OK && work->added < work->study.count;
  if (status == STATUS_OK && !*more && !work->search) { /* a search may go on: see work_search */
    status = store_study_stored(settings->store, work->id, work->attempt, work->study.count, error);
    work->stored = status == STATUS_OK;
  }
  return status;
}
