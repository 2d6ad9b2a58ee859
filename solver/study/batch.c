#include "solver/study/batch.h"

#include <sys/mman.h>

#include "solver/base/clock.h"
#include "solver/post/result_hlpv.h"

/* One process and its number. */
struct batch_worker {
  const struct batch *batch;
  struct batch_place *place;
};

enum status batch_board_create(size_t members, struct batch_board **board, struct error *error) {
  size_t bytes = sizeof(struct batch_board) + members;
  void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  *board = NULL;
  if (memory == MAP_FAILED) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the processes of the study");
  }
  *board = memory;
  (*board)->bytes = bytes;
  return STATUS_OK;
}

void batch_board_destroy(struct batch_board *board) {
  if (board) {
    munmap(board, board->bytes);
  }
}

/* ---- inside of a process ------------------------------------------------------------------ */

static enum status solve(const struct batch *batch, const struct job_spec *spec, json_t **result,
                         enum status *ending, struct error *error) {
  struct result_hlpv_options options = {.cancelled = batch->cancelled,
                                        .brief = !batch->study->keep_samples};
  return result_hlpv(spec, &options, result, ending, error);
}

/* Leaves the result or the error in the store. */
static enum batch_fate solve_member(const struct batch *batch, size_t index) {
  const struct study_member *member = &batch->study->member[index];
  struct error error = {.status = STATUS_OK};
  struct job_spec spec;
  json_t *result = NULL;
  enum status ending = STATUS_OK;
  enum status status = study_read_member(batch->reader, batch->document, index, NULL, &spec, &error);
  if (status == STATUS_OK) {
    status = solve(batch, &spec, &result, &ending, &error);
    job_spec_release(&spec);
  }
  if (status == STATUS_OK && ending == STATUS_CANCELLED) {
    json_decref(result);
    return BATCH_OPEN;
  }
  if (status == STATUS_OK) {
    status = member_store_write(batch->store, member, result, &error);
  }
  if (status == STATUS_OK) {
    status = member_store_keep(batch->store, member, &error);
  }
  if (status != STATUS_OK) {
    json_t *report =
        json_pack("{s:{s:s, s:s}}", "error", "code", status_word(status), "message", error.message);
    member_store_write(batch->store, member, report, NULL);
    json_decref(report);
  }
  json_decref(result);
  return status == STATUS_OK ? BATCH_SOLVED : BATCH_FAILED;
}

static void work(void *context) {
  const struct batch_worker *worker = context;
  const struct batch *batch = worker->batch;
  struct batch_board *board = batch->board;
  while (!batch->cancelled || !batch->cancelled(NULL)) {
    size_t next = atomic_fetch_add(&board->next, 1);
    if (next >= batch->todo_count) {
      return;
    }
    size_t member = batch->todo[next];
    atomic_store(&worker->place->since_wall_s, clock_wall_s());
    atomic_store(&worker->place->member, member + 1);
    atomic_store(&board->fate[member], (unsigned char)solve_member(batch, member));
    atomic_store(&worker->place->member, 0);
  }
}

enum status batch_start(const struct batch *batch, int place, struct child *child,
                        struct error *error) {
  struct batch_worker worker = {batch, &batch->board->place[place]};
  atomic_store(&worker.place->member, 0);
  return child_fork(work, &worker, child, error);
}
