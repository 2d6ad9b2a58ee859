/* The processes of a study of light members: starts, watches and replaces them. */
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/study/batch.h"
#include "solver/study/study_internal.h"

enum { LOOK_MS = 100 };

struct batches {
  struct study_run *run;
  struct batch batch;
  size_t *todo;
};

/* Lists the members without a result. */
static enum status list_members(struct batches *all, struct error *error) {
  struct study_run *run = all->run;
  all->todo = calloc(run->study.count, sizeof *all->todo);
  if (!all->todo) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the members of the study");
  }
  size_t member;
  while ((member = study_next_member(run)) < run->study.count) {
    all->todo[all->batch.todo_count++] = member;
  }
  all->batch.todo = all->todo;
  return STATUS_OK;
}

/* Gives a member up with the reason that its process has left, or else with that one. */
static void give_up(struct study_run *run, size_t index, const char *reason, const char *message) {
  const struct study_member *member = &run->study.member[index];
  json_t *error = member_store_error(&run->store, member);
  const char *code = json_string_value(json_object_get(error, "code"));
  const char *sentence = json_string_value(json_object_get(error, "message"));
  study_fail(&run->state[index], code && sentence ? code : reason,
             code && sentence ? sentence : message);
  member_store_remove(&run->store, member, MEMBER_PART);
  json_decref(error);
  study_settle(run, index);
}

/* Settles what the processes have done since the last look. */
static void take_in(struct batches *all) {
  struct study_run *run = all->run;
  for (size_t i = 0; i < all->batch.todo_count; i++) {
    size_t member = all->todo[i];
    unsigned char fate = atomic_load(&all->batch.board->fate[member]);
    if (fate == BATCH_OPEN || run->state[member].settled) {
      continue;
    }
    if (fate == BATCH_SOLVED) {
      study_settle(run, member);
    } else {
      give_up(run, member, "internal", "the solver left no result");
    }
  }
}

/* A process has ended: by itself, or with the member that it was at. */
static void bury(struct batches *all, int place, const struct child_end *end) {
  struct slot *slot = &all->run->slot[place];
  size_t member = atomic_load(&all->batch.board->place[place].member);
  char sentence[200];
  if (member == 0 || atomic_load(&all->batch.board->fate[member - 1]) != BATCH_OPEN) {
    return;
  }
  const char *name = end->signal ? sigdescr_np(end->signal) : NULL;
  snprintf(sentence, sizeof sentence, "signal %d (%s) ended the solver", end->signal,
           name ? name : "unknown");
  member_store_remove(&all->run->store, &all->run->study.member[member - 1], MEMBER_PART);
  give_up(all->run, member - 1, slot->overdue ? status_word(STATUS_TIMEOUT) : "crashed",
          slot->overdue ? "the solver overran the member's time limit" : sentence);
}

/* Ends a process whose member takes much longer than it may. */
static void hurry(struct batches *all, int place) {
  const struct batch_place *at = &all->batch.board->place[place];
  struct slot *slot = &all->run->slot[place];
  size_t member = atomic_load(&at->member);
  double limit_s = member ? all->run->study.member[member - 1].timeout_s : 0.0;
  double since_s = atomic_load(&at->since_wall_s);
  if (limit_s > 0.0 && clock_wall_s() > since_s + limit_s + STUDY_MARGIN_S) {
    slot->overdue = true;
    child_signal(&slot->child, SIGKILL);
  }
}

/* Buries, starts or hurries the process of one slot. */
static enum status look_after(struct batches *all, int place, struct error *error) {
  struct slot *slot = &all->run->slot[place];
  struct child_end end;
  if (slot->child.pid && child_ended(&slot->child, &end)) {
    bury(all, place, &end);
  }
  if (slot->child.pid) {
    hurry(all, place);
    return STATUS_OK;
  }
  slot->overdue = false;
  return atomic_load(&all->batch.board->next) < all->batch.todo_count
             ? batch_start(&all->batch, place, &slot->child, error)
             : STATUS_OK;
}

/* Without processes nothing more comes: members that a process took and lost at once. */
static void give_up_rest(struct batches *all) {
  for (size_t i = 0; i < all->batch.todo_count; i++) {
    if (!all->run->state[all->todo[i]].settled) {
      give_up(all->run, all->todo[i], "crashed", "the process that was to solve it was ended");
    }
  }
}

static enum status work(struct batches *all, enum status *ending, struct error *error) {
  struct study_run *run = all->run;
  enum status status = STATUS_OK;
  for (;;) {
    const struct child *children[STUDY_JOBS_MAX];
    int count = 0;
    for (int place = 0; place < run->slots && status == STATUS_OK; place++) {
      status = look_after(all, place, error);
      if (run->slot[place].child.pid) {
        children[count++] = &run->slot[place].child;
      }
    }
    take_in(all);
    *ending = study_ending(run);
    if (status != STATUS_OK || *ending != STATUS_OK || count == 0) {
      return status;
    }
    child_wait_any(children, count, LOOK_MS);
  }
}

enum status study_work_light(struct study_run *run, enum status *ending, struct error *error) {
  struct batches all = {.run = run,
                        .batch = {.reader = run->reader,
                                  .document = run->document,
                                  .study = &run->study,
                                  .store = &run->store,
                                  .cancelled = run->options->cancelled}};
  enum status status = batch_board_create(run->study.count, &all.batch.board, error);
  if (status == STATUS_OK) {
    status = list_members(&all, error);
  }
  if (status == STATUS_OK) {
    status = work(&all, ending, error);
  }
  if (status != STATUS_OK || *ending != STATUS_OK) {
    study_stop(run);
  }
  if (all.batch.board && all.todo) {
    take_in(&all);
  }
  if (status == STATUS_OK && *ending == STATUS_OK) {
    give_up_rest(&all);
  }
  batch_board_destroy(all.batch.board);
  free(all.todo);
  return status;
}
