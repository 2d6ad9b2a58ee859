/* The poll: one question for all tasks. What ends a task well is seen in its files; the poll tells
 * why tasks wait, on which node they are, and which are gone without a word. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/slurm/slurm_internal.h"

/* Between polls: as long as keeps their processor time below POLL_SHARE, within limits; a cluster
 * that does not answer is asked again after RETRY_MS, and a task that was not seen once is looked
 * for again after ABSENT_MS. */
enum { POLL_LEAST_MS = 5000, POLL_MOST_MS = 30000, RETRY_MS = 4000, ABSENT_MS = 3000 };
enum { NEWS_MAX = 256 };
static const double POLL_SHARE = 0.05 / 60;

void slurm_poll_soon(struct slurm *slurm, int64_t ms) {
  int64_t at = clock_monotonic_ms() + ms;
  slurm->poll_at_ms = at < slurm->poll_at_ms ? at : slurm->poll_at_ms;
}

/* ---- what was said ------------------------------------------------------------------------ */

/* News on their way to the database; their texts live in the tasks. */
struct news {
  struct slurm *slurm;
  struct cluster_task_news item[NEWS_MAX];
  size_t count;
};

static void news_flush(struct news *news) {
  struct error error;
  if (news->count > 0 && store_tasks_note(news->slurm->settings.engine.store, news->item,
                                          news->count, &error) != STATUS_OK) {
    log_event(LOG_LEVEL_ERROR, "cannot note what the cluster says",
              LOG_TEXT("error", error.message));
  }
  news->count = 0;
}

static void news_add(struct news *news, const struct slurm_task *task) {
  if (news->count == NEWS_MAX) {
    news_flush(news);
  }
  news->item[news->count++] = (struct cluster_task_news){.batch_id = task->batch->id,
                                                         .task = task->index,
                                                         .state = slurm_state_word(task->state),
                                                         .reason = task->reason,
                                                         .node = task->node[0] ? task->node : NULL};
}

static struct slurm_batch *batch_of(const struct slurm *slurm, const struct slurm_line *line) {
  for (struct slurm_batch *batch = slurm->first; batch; batch = batch->next) {
    if (batch->cluster_job == line->job && strcmp(batch->name, line->name) == 0) {
      return batch;
    }
  }
  return NULL;
}

static void take_task(struct news *news, struct slurm_task *task, const struct slurm_line *line) {
  struct slurm *slurm = news->slurm;
  const char *reason = line->state == SLURM_PENDING ? line->reason : "";
  task->seen = true;
  task->absent_ms = 0;
  task->requeued = task->phase == TASK_RUNS && line->state == SLURM_PENDING;
  if (task->phase == TASK_OVER ||
      (task->state == line->state && strncmp(task->reason, reason, sizeof task->reason - 1) == 0 &&
       (task->node[0] || !line->node[0]))) {
    return;
  }
  pthread_mutex_lock(&slurm->mutex);
  task->state = line->state;
  snprintf(task->reason, sizeof task->reason, "%s", reason);
  snprintf(task->node, sizeof task->node, "%s", line->node);
  pthread_mutex_unlock(&slurm->mutex);
  news_add(news, task);
}

static void take_line(struct news *news, const struct slurm_line *line) {
  struct slurm_batch *batch = batch_of(news->slurm, line);
  struct slurm_range range;
  const char *cursor = line->tasks;
  while (batch && slurm_range_next(&cursor, &range)) {
    for (int64_t i = range.low; i <= range.high && i < (int64_t)batch->count; i += range.step) {
      take_task(news, &batch->task[i], line);
    }
  }
}

static void take_lines(struct slurm *slurm, char *lines) {
  struct news *news = malloc(sizeof *news);
  char *rest = lines, *text;
  if (!news) {
    return;
  }
  *news = (struct news){.slurm = slurm};
  while ((text = strsep(&rest, "\n"))) {
    struct slurm_line line;
    if (slurm_line_read(text, &line)) {
      take_line(news, &line);
    }
  }
  news_flush(news);
  free(news);
}

/* ---- what was not said -------------------------------------------------------------------- */

/* How a task of an array ended and where, as far as the cluster still knows. */
static enum slurm_state last_state(const struct slurm_task *task, const char *lines, char *node,
                                   size_t size) {
  enum slurm_state state = SLURM_UNKNOWN;
  char *copy = lines ? strdup(lines) : NULL, *rest = copy, *text;
  while (rest && (text = strsep(&rest, "\n"))) {
    struct slurm_line line;
    struct slurm_range range;
    const char *cursor;
    if (!slurm_line_read(text, &line)) {
      continue;
    }
    cursor = line.tasks;
    while (slurm_range_next(&cursor, &range)) {
      if (task->index >= range.low && task->index <= range.high &&
          (task->index - range.low) % range.step == 0) {
        state = line.state;
        snprintf(node, size, "%s", line.node);
      }
    }
  }
  free(copy);
  return state;
}

/* Whether the task is gone: two polls have not seen it, and neither is there a mark of its end. */
static bool gone(struct slurm_task *task, int64_t now) {
  struct slurm *slurm = task->batch->slurm;
  if (task->phase == TASK_OVER || task->seen) {
    return false;
  }
  if (task->absent_ms == 0) {
    task->absent_ms = now;
    slurm_poll_soon(slurm, ABSENT_MS);
    return false;
  }
  if (now - task->absent_ms < ABSENT_MS) {
    return false;
  }
  batch_look_end(task);
  return task->phase != TASK_OVER;
}

static void lose(struct slurm_task *task, const char *lines) {
  char node[CLUSTER_WORD_SIZE] = "";
  enum slurm_state state = last_state(task, lines, node, sizeof node);
  if (state == SLURM_PENDING || state == SLURM_RUNNING) {
    task->absent_ms = 0; /* it is there after all */
    return;
  }
  log_event(LOG_LEVEL_WARNING, "task lost", LOG_TEXT("batch", task->batch->name),
            LOG_NUMBER("task", task->index), LOG_TEXT("state", slurm_state_word(state)),
            LOG_TEXT("node", node[0] ? node : task->node));
  task_lost(task, state, node[0] ? node : task->node);
}

/* A task that has begun and is pending again: its node was lost, and the cluster wants to start it
 * once more although it was told not to. It would find its mark and end. */
static void take_away(struct slurm_task *task) {
  char name[48];
  const char *const names[] = {name};
  struct error error;
  snprintf(name, sizeof name, "%lld_%u", (long long)task->batch->cluster_job, task->index);
  if (slurm_cancel(&task->batch->slurm->client, names, 1, false, &error) != STATUS_OK) {
    slurm_note_answer(task->batch->slurm, &error);
    return; /* the next poll sees it again */
  }
  batch_look_end(task);
  if (task->phase != TASK_OVER) {
    log_event(LOG_LEVEL_WARNING, "task started anew", LOG_TEXT("batch", task->batch->name),
              LOG_NUMBER("task", task->index));
    task_lost(task, SLURM_NODE_LOST, task->node);
  }
}

/* Looks for tasks of a batch that are gone; asks the cluster once what became of them. */
static void look_for_lost(struct slurm_batch *batch, int64_t now) {
  struct slurm *slurm = batch->slurm;
  char *lines = NULL, job[24];
  struct error error;
  bool asked = false;
  for (size_t i = 0; i < batch->count; i++) {
    if (batch->task[i].requeued && batch->task[i].phase == TASK_RUNS) {
      take_away(&batch->task[i]);
    }
    if (!gone(&batch->task[i], now)) {
      continue;
    }
    if (!asked) {
      snprintf(job, sizeof job, "%lld", (long long)batch->cluster_job);
      enum status status = slurm_list(&slurm->client, job, &lines, &error);
      asked = true;
      if (status != STATUS_OK && status != STATUS_CONFLICT) {
        slurm_note_answer(slurm, &error);
        break;
      }
    }
    lose(&batch->task[i], lines);
  }
  free(lines);
}

/* ---- the poll ----------------------------------------------------------------------------- */

static void unsee(struct slurm *slurm) {
  for (struct slurm_batch *batch = slurm->first; batch; batch = batch->next) {
    for (size_t i = 0; i < batch->count; i++) {
      batch->task[i].seen = false;
    }
  }
}

/* Whether there is anything to ask: tasks with the cluster, or whether it answers. */
static bool wanted(struct slurm *slurm) {
  pthread_mutex_lock(&slurm->mutex);
  bool doubt = !slurm->asked || !slurm->reachable;
  pthread_mutex_unlock(&slurm->mutex);
  for (const struct slurm_batch *batch = slurm->first; batch && !doubt; batch = batch->next) {
    doubt = batch->cluster_job != 0;
  }
  return doubt;
}

static void count_poll(struct slurm *slurm, bool good, int64_t start_us, double cpu_s) {
  slurm->poll_cpu_s = slurm->poll_cpu_s > 0 ? 0.7 * slurm->poll_cpu_s + 0.3 * cpu_s : cpu_s;
  pthread_mutex_lock(&slurm->mutex);
  slurm->figures.polls++;
  slurm->figures.poll_failures += !good;
  slurm->figures.poll_s += 1e-6 * (double)(clock_monotonic_us() - start_us);
  pthread_mutex_unlock(&slurm->mutex);
}

void slurm_poll(struct slurm *slurm) {
  int64_t now = clock_monotonic_ms(), start_us = clock_monotonic_us();
  double before_s = slurm->client.cpu_s;
  struct error error;
  char *lines = NULL;
  if (now < slurm->poll_at_ms || !wanted(slurm)) {
    return;
  }
  enum status status = slurm_list(&slurm->client, NULL, &lines, &error);
  count_poll(slurm, status == STATUS_OK, start_us, slurm->client.cpu_s - before_s);
  if (status != STATUS_OK) {
    slurm->poll_at_ms = clock_monotonic_ms() + RETRY_MS;
    slurm_note_answer(slurm, &error);
    return;
  }
  slurm_note_answer(slurm, NULL);
  double pace_ms = 1000 * slurm->poll_cpu_s / POLL_SHARE;
  pace_ms = pace_ms < POLL_LEAST_MS ? POLL_LEAST_MS : pace_ms;
  slurm->poll_at_ms = now + (int64_t)(pace_ms < POLL_MOST_MS ? pace_ms : POLL_MOST_MS);
  unsee(slurm);
  take_lines(slurm, lines);
  free(lines);
  for (struct slurm_batch *batch = slurm->first; batch; batch = batch->next) {
    if (batch->cluster_job != 0) {
      look_for_lost(batch, now);
    }
  }
}
