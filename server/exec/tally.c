#include "server/exec/tally.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/meter.h"

enum { WORD_SIZE = 40, KINDS_MAX = 24, ENDS_MAX = 256 };

static const struct meter_bounds solve_bounds = {
    .count = 13, .upper = {0.1, 0.5, 1, 2.5, 5, 10, 30, 60, 300, 900, 3600, 14400, 86400}};
static const struct meter_bounds wait_bounds = {
    .count = 12, .upper = {0.01, 0.05, 0.25, 1, 5, 15, 60, 300, 1800, 7200, 28800, 86400}};
static const struct meter_bounds memory_bounds = {
    .count = 9, .upper = {16e6, 32e6, 64e6, 128e6, 256e6, 512e6, 1024e6, 2048e6, 4096e6}};

/* The last place of each table is for all that the others have no room for. */
struct end {
  char kind[WORD_SIZE], state[WORD_SIZE], reason[WORD_SIZE];
  uint64_t count;
};

struct kind {
  char name[WORD_SIZE];
  struct histogram solve;
};

struct tally {
  pthread_mutex_t mutex; /* guards all but the histograms */
  struct end ends[ENDS_MAX];
  struct kind kinds[KINDS_MAX];
  size_t end_count, kind_count;
  struct histogram wait, memory;
  uint64_t started, ended[ATTEMPT_REQUEUED + 1]; /* attempts, the latter by their end */
  double cpu_s;                                  /* of ended workers */
};

enum status tally_create(struct tally **tally, struct error *error) {
  *tally = calloc(1, sizeof **tally);
  if (!*tally) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the counts of workers.");
  }
  pthread_mutex_init(&(*tally)->mutex, NULL);
  return STATUS_OK;
}

void tally_destroy(struct tally *tally) {
  if (tally) {
    pthread_mutex_destroy(&tally->mutex);
    free(tally);
  }
}

/* A label's value: reasons come from solvers, so anything but a word's letters becomes '_'. */
static void word_copy(char word[WORD_SIZE], const char *text) {
  size_t i = 0;
  for (; text[i] && i + 1 < WORD_SIZE; i++) {
    bool plain = strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.",
                        text[i]) != NULL;
    word[i] = '_';
    if (plain) {
      word[i] = text[i];
    }
  }
  word[i] = '\0';
}

static struct end *end_find(struct tally *tally, const struct tally_attempt *attempt) {
  struct end wanted = {.count = 0};
  word_copy(wanted.kind, attempt->kind);
  word_copy(wanted.state, attempt->state);
  word_copy(wanted.reason, attempt->reason);
  for (size_t i = 0; i < tally->end_count; i++) {
    const struct end *at = &tally->ends[i];
    if (strcmp(at->kind, wanted.kind) == 0 && strcmp(at->state, wanted.state) == 0 &&
        strcmp(at->reason, wanted.reason) == 0) {
      return &tally->ends[i];
    }
  }
  if (tally->end_count < ENDS_MAX - 1) {
    tally->ends[tally->end_count] = wanted;
    return &tally->ends[tally->end_count++];
  }
  struct end *last = &tally->ends[ENDS_MAX - 1];
  if (tally->end_count < ENDS_MAX) {
    *last = (struct end){.kind = "other", .state = "other", .reason = "other"};
    tally->end_count = ENDS_MAX;
  }
  return last;
}

static struct kind *kind_find(struct tally *tally, const char *name) {
  char wanted[WORD_SIZE];
  word_copy(wanted, name);
  for (size_t i = 0; i < tally->kind_count; i++) {
    if (strcmp(tally->kinds[i].name, wanted) == 0) {
      return &tally->kinds[i];
    }
  }
  if (tally->kind_count < KINDS_MAX - 1) {
    memcpy(tally->kinds[tally->kind_count].name, wanted, sizeof wanted);
    return &tally->kinds[tally->kind_count++];
  }
  strcpy(tally->kinds[KINDS_MAX - 1].name, "other");
  tally->kind_count = KINDS_MAX;
  return &tally->kinds[KINDS_MAX - 1];
}

void tally_ended(struct tally *tally, const struct tally_attempt *attempt) {
  pthread_mutex_lock(&tally->mutex);
  struct kind *kind = kind_find(tally, attempt->kind);
  if (attempt->final) {
    end_find(tally, attempt)->count++;
  }
  pthread_mutex_unlock(&tally->mutex);
  histogram_add(&kind->solve, &solve_bounds, attempt->wall_s);
  histogram_add(&tally->memory, &memory_bounds, 1048576 * attempt->peak_memory_MB);
}

void tally_waited(struct tally *tally, double seconds) {
  histogram_add(&tally->wait, &wait_bounds, seconds);
}

void tally_attempts_started(struct tally *tally, unsigned count) {
  pthread_mutex_lock(&tally->mutex);
  tally->started += count;
  pthread_mutex_unlock(&tally->mutex);
}

void tally_attempt_ended(struct tally *tally, enum attempt_end end, double cpu_s) {
  pthread_mutex_lock(&tally->mutex);
  tally->ended[end]++;
  tally->cpu_s += cpu_s;
  pthread_mutex_unlock(&tally->mutex);
}

static void attempts_write(const struct tally *tally, FILE *out) {
  static const char *const ends[] = {
      [ATTEMPT_SUCCEEDED] = "succeeded",     [ATTEMPT_FAILED] = "failed",
      [ATTEMPT_TIMED_OUT] = "timed_out",     [ATTEMPT_CANCELLED] = "cancelled",
      [ATTEMPT_WORKER_LOST] = "worker_lost", [ATTEMPT_REQUEUED] = "requeued"};
  meter_head(out, "pneulab_attempts_started_total", "counter", "Attempts started.");
  fprintf(out, "pneulab_attempts_started_total %llu\n", (unsigned long long)tally->started);
  meter_head(out, "pneulab_worker_cpu_seconds_total", "counter",
             "Processor time of workers that have ended.");
  fprintf(out, "pneulab_worker_cpu_seconds_total %.3f\n", tally->cpu_s);
  meter_head(out, "pneulab_attempts_ended_total", "counter", "Attempts ended, by outcome.");
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    fprintf(out, "pneulab_attempts_ended_total{outcome=\"%s\"} %llu\n", ends[i],
            (unsigned long long)tally->ended[i]);
  }
}

static void tables_write(struct tally *tally, FILE *out) {
  meter_head(out, "pneulab_jobs_finished_total", "counter",
             "Jobs that a worker of this daemon brought to an end, by how.");
  for (size_t i = 0; i < tally->end_count; i++) {
    const struct end *at = &tally->ends[i];
    fprintf(out, "pneulab_jobs_finished_total{kind=\"%s\",state=\"%s\",reason=\"%s\"} %llu\n",
            at->kind, at->state, at->reason, (unsigned long long)at->count);
  }
  meter_head(out, "pneulab_solve_seconds", "histogram",
             "Time from the start of a worker to its end, by the kind of its job.");
  for (size_t i = 0; i < tally->kind_count; i++) {
    char label[WORD_SIZE + 8];
    snprintf(label, sizeof label, "kind=\"%s\"", tally->kinds[i].name);
    meter_histogram(out, "pneulab_solve_seconds", label, &tally->kinds[i].solve, &solve_bounds);
  }
}

void tally_write(struct tally *tally, FILE *out) {
  pthread_mutex_lock(&tally->mutex);
  attempts_write(tally, out);
  tables_write(tally, out);
  pthread_mutex_unlock(&tally->mutex);
  meter_head(out, "pneulab_queue_wait_seconds", "histogram",
             "Time from the submission of a job to the start of its first attempt.");
  meter_histogram(out, "pneulab_queue_wait_seconds", "", &tally->wait, &wait_bounds);
  meter_head(out, "pneulab_worker_peak_memory_bytes", "histogram",
             "Largest resident set of each worker.");
  meter_histogram(out, "pneulab_worker_peak_memory_bytes", "", &tally->memory, &memory_bounds);
}
