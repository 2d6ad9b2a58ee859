#include "solver/study/study_run.h"

#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include "solver/base/clock.h"
#include "solver/study/child.h"
#include "solver/study/study_internal.h"

enum { POLL_MS = 250, EXIT_EARLY = 3 };

/* A process gets this long to end when asked to, in s. */
static const double grace_s = 5;

static int core_count(void) {
  cpu_set_t set;
  int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  return count < 1 ? 1 : count > STUDY_JOBS_MAX ? STUDY_JOBS_MAX : count;
}

/* Whether the member is solved itself, not taken from another. */
static bool is_own(const struct study_member *member) {
  return member->same_as < 0 && member->mirror_of < 0;
}

void study_fail(struct member_state *state, const char *reason, const char *message) {
  snprintf(state->reason, sizeof state->reason, "%s", reason);
  snprintf(state->message, sizeof state->message, "%s", message);
}

void study_settle(struct study_run *run, size_t index) {
  struct member_state *state = &run->state[index];
  const struct study_member *member = &run->study.member[index];
  state->settled = true;
  run->settled++;
  run->figures.resumed += state->resumed;
  run->figures.computed += !state->resumed;
  if (run->options->events) {
    size_t members = run->search ? study_search_budget(run->search) : run->study.distinct;
    fprintf(run->options->events,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"step\":%zu,\"steps\":%zu,"
            "\"member\":%zu,\"spec_hash\":\"%s\",\"reason\":\"%s\"}\n",
            (double)run->settled / (double)members, run->settled, members, index, member->hash,
            state->reason);
    fflush(run->options->events);
  }
  if (run->options->verbose) {
    fprintf(stderr, "%zu of %zu: %s%s%s%s\n", run->settled, run->study.distinct, member->name,
            state->resumed ? " (was there)" : "", state->reason[0] ? ": " : "", state->reason);
  }
}

/* ---- one process -------------------------------------------------------------------------- */

static enum status start(struct study_run *run, struct slot *slot, size_t index,
                         struct error *error) {
  const struct study_member *member = &run->study.member[index];
  char threads[16];
  snprintf(threads, sizeof threads, "%d", run->options->threads);
  char *job = member_store_path(&run->store, member, MEMBER_JOB);
  char *part = member_store_path(&run->store, member, MEMBER_PART);
  char *log = member_store_path(&run->store, member, MEMBER_LOG);
  const char *argv[] = {"pneulab-solve", "--threads", threads, job, NULL};
  enum status status = STATUS_OK;
  if (!job || !part || !log) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a path");
  }
  if (status == STATUS_OK) {
    status = member_store_job(&run->store, member, error);
  }
  if (status == STATUS_OK) {
    status = child_start(argv, part, log, &slot->child, error);
  }
  slot->member = index;
  slot->overdue = false;
  slot->deadline_s =
      member->timeout_s > 0 ? clock_wall_s() + member->timeout_s + STUDY_MARGIN_S : INFINITY;
  free(job);
  free(part);
  free(log);
  return status;
}

/* Why a process has left no result. */
static void explain(const struct study_run *run, const struct slot *slot,
                    const struct child_end *end, struct member_state *state) {
  char sentence[200];
  json_t *error = member_store_error(&run->store, &run->study.member[slot->member]);
  const char *code = json_string_value(json_object_get(error, "code"));
  const char *message = json_string_value(json_object_get(error, "message"));
  if (slot->overdue) {
    study_fail(state, status_word(STATUS_TIMEOUT), "the solver overran the member's time limit");
  } else if (code && message) {
    study_fail(state, code, message);
  } else if (end->signal != 0) {
    const char *name = sigdescr_np(end->signal);
    snprintf(sentence, sizeof sentence, "signal %d (%s) ended the solver", end->signal,
             name ? name : "unknown");
    study_fail(state, "crashed", sentence);
  } else {
    snprintf(sentence, sizeof sentence, "the solver ended with exit code %d and no result",
             end->exit_code);
    study_fail(state, "crashed", sentence);
  }
  json_decref(error);
}

/* Takes in the answer of a process that has ended by itself or for its time limit. */
static enum status finish(struct study_run *run, const struct slot *slot,
                          const struct child_end *end, struct error *error) {
  const struct study_member *member = &run->study.member[slot->member];
  struct member_state *state = &run->state[slot->member];
  bool answered = end->exit_code == 0 || end->exit_code == EXIT_EARLY;
  enum status status = answered ? member_store_keep(&run->store, member, error) : STATUS_OK;
  if (status != STATUS_OK) {
    return status;
  }
  json_t *result = answered ? member_store_result(&run->store, member) : NULL;
  if (result) {
    member_store_remove(&run->store, member, MEMBER_LOG);
  } else {
    explain(run, slot, end, state);
    member_store_remove(&run->store, member, MEMBER_PART);
  }
  json_decref(result);
  study_settle(run, slot->member);
  return STATUS_OK;
}

/* ---- all of them -------------------------------------------------------------------------- */

/* The result of an earlier run, if it has what this one keeps. A new reference, or NULL. */
static json_t *earlier_result(const struct study_run *run, size_t index) {
  json_t *result = member_store_result(&run->store, &run->study.member[index]);
  if (run->study.light && run->study.keep_samples && !json_object_get(result, "samples")) {
    json_decref(result);
    return NULL;
  }
  return result;
}

size_t study_next_member(struct study_run *run) {
  for (; run->next < run->study.count; run->next++) {
    size_t index = run->next;
    if (!is_own(&run->study.member[index])) {
      continue;
    }
    json_t *result = earlier_result(run, index);
    if (!result) {
      run->next++;
      return index;
    }
    json_decref(result);
    run->state[index].resumed = true;
    study_settle(run, index);
  }
  return run->study.count;
}

/* Reaps, and ends what is overdue. */
static enum status look_after(struct study_run *run, struct slot *slot, struct error *error) {
  struct child_end end;
  double now = clock_wall_s();
  if (child_ended(&slot->child, &end)) {
    return finish(run, slot, &end, error);
  }
  if (now > slot->deadline_s) {
    child_signal(&slot->child, slot->overdue ? SIGKILL : SIGTERM);
    slot->overdue = true;
    slot->deadline_s = now + grace_s;
  }
  return STATUS_OK;
}

enum status study_ending(const struct study_run *run) {
  bool cancelled = run->options->cancelled && run->options->cancelled(NULL);
  return cancelled                          ? STATUS_CANCELLED
         : clock_wall_s() > run->deadline_s ? STATUS_TIMEOUT
                                            : STATUS_OK;
}

static int running(const struct study_run *run, const struct child *children[STUDY_JOBS_MAX]) {
  int count = 0;
  for (int s = 0; s < run->slots; s++) {
    if (run->slot[s].child.pid) {
      children[count++] = &run->slot[s].child;
    }
  }
  return count;
}

/* Keeps the slots busy until every member is settled, or the study has to end. */
static enum status work(struct study_run *run, enum status *ending, struct error *error) {
  enum status status = STATUS_OK;
  const struct child *children[STUDY_JOBS_MAX];
  for (;;) {
    for (int s = 0; s < run->slots && status == STATUS_OK; s++) {
      struct slot *slot = &run->slot[s];
      if (slot->child.pid) {
        status = look_after(run, slot, error);
      }
      size_t index =
          status == STATUS_OK && !slot->child.pid ? study_next_member(run) : run->study.count;
      if (index < run->study.count) {
        status = start(run, slot, index, error);
      }
    }
    *ending = study_ending(run);
    int count = running(run, children);
    if (status != STATUS_OK || *ending != STATUS_OK || count == 0) {
      return status;
    }
    child_wait_any(children, count, POLL_MS);
  }
}

void study_stop(struct study_run *run) {
  const struct child *children[STUDY_JOBS_MAX];
  double kill_at_s = clock_wall_s() + grace_s;
  for (int count = running(run, children), sent = 0; count > 0; count = running(run, children)) {
    bool insist = clock_wall_s() > kill_at_s;
    for (int c = 0; c < count && (insist || !sent); c++) {
      child_signal(children[c], insist ? SIGKILL : SIGTERM);
    }
    sent = 1;
    child_wait_any(children, count, POLL_MS);
    for (int s = 0; s < run->slots; s++) {
      struct child_end end;
      if (run->slot[s].child.pid && child_ended(&run->slot[s].child, &end)) {
        if (!run->study.light) {
          member_store_remove(&run->store, &run->study.member[run->slot[s].member], MEMBER_PART);
        }
      }
    }
  }
}

static enum status prepare(struct study_run *run, const struct job_spec *spec,
                           struct error *error) {
  bool light = study_has_light_members(spec->document);
  enum status status = job_reader_create(&run->reader, error);
  if (status == STATUS_OK) {
    status = study_expand(run->reader, spec->document, !light, &run->study, error);
  }
  if (status == STATUS_OK && study_is_search(spec->document)) {
    status = study_search_create(run->reader, spec->document, &run->search, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  run->slots = run->options->jobs > 0 ? run->options->jobs : core_count();
  run->state = calloc(run->study.count, sizeof *run->state);
  if (!run->state) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the study");
  }
  return member_store_open(run->options->out_dir, &run->store, error);
}

/* One round, or of a search as many as it takes. */
static enum status work_rounds(struct study_run *run, enum status *ending, struct error *error) {
  bool more = true;
  enum status status = STATUS_OK;
  while (status == STATUS_OK && *ending == STATUS_OK && more) {
    status = run->study.light ? study_work_light(run, ending, error) : work(run, ending, error);
    study_stop(run);
    if (status == STATUS_OK && *ending == STATUS_OK) {
      status = study_next_round(run, &more, error);
    }
  }
  return status;
}

static double children_cpu_s(void) {
  struct rusage usage;
  getrusage(RUSAGE_CHILDREN, &usage);
  return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* What a member has come to, for the document. */
static json_t *result_of(void *context, size_t index, const char **reason, const char **message) {
  const struct study_run *run = context;
  const struct member_state *state = &run->state[index];
  json_t *result = state->settled && !state->reason[0]
                       ? member_store_result(&run->store, &run->study.member[index])
                       : NULL;
  *reason = state->settled ? state->reason : "not_run";
  *message = state->settled ? state->message : "the study ended before this member";
  return result;
}

static bool any_solved(const struct study_run *run) {
  for (size_t i = 0; i < run->study.count; i++) {
    if (run->state[i].settled && !run->state[i].reason[0]) {
      return true;
    }
  }
  return false;
}

enum status study_run(const struct job_spec *spec, const struct study_options *options,
                      json_t **document, enum status *ending, struct error *error) {
  struct study_run run = {.options = options, .document = spec->document};
  double start_s = clock_wall_s();
  run.deadline_s = spec->timeout_s > 0 ? start_s + spec->timeout_s : INFINITY;
  *document = NULL;
  *ending = STATUS_OK;
  enum status status = prepare(&run, spec, error);
  if (status != STATUS_OK) {
    goto done;
  }
  status = work_rounds(&run, ending, error);
  if (status != STATUS_OK) {
    goto done;
  }
  if (*ending == STATUS_OK && !any_solved(&run)) {
    *ending = STATUS_DIVERGED;
  }
  run.figures.wall_s = clock_wall_s() - start_s;
  run.figures.cpu_s = children_cpu_s();
  struct study_results results = {.context = &run, .result = result_of};
  *document = study_document(spec, &run.study, &results, &run.figures, *ending);
  if (*document && run.search && study_search_report(run.search, *document) != STATUS_OK) {
    json_decref(*document);
    *document = NULL;
  }
  if (!*document) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
  }
done:
  member_store_close(&run.store, &run.study);
  study_release(&run.study);
  study_search_destroy(run.search);
  job_reader_destroy(run.reader);
  free(run.state);
  return status;
}
