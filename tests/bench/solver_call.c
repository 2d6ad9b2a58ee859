#include "tests/bench/solver_call.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CALLS_MAX = 8 };

/* Files of the calls of one run. */
struct batch {
  const struct solver_place *place;
  struct solver_call *calls;
  struct {
    char job[CALL_PATH + 32], output[CALL_PATH + 32], log[CALL_PATH + 32];
  } file[CALLS_MAX];
};

bool solver_place_create(struct solver_place *place, const char *program, double limit_s) {
  char made[] = "/tmp/bench-XXXXXX", *found = realpath(program, NULL);
  place->limit_s = limit_s;
  if (!found || strlen(found) >= sizeof place->program) {
    perror(program);
    free(found);
    return false;
  }
  strcpy(place->program, found);
  free(found);
  if (!mkdtemp(made)) {
    perror(made);
    return false;
  }
  strcpy(place->directory, made);
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  setenv("OMP_NUM_THREADS", "1", 1);
  return true;
}

void solver_place_remove(const struct solver_place *place) {
  DIR *directory = opendir(place->directory);
  const struct dirent *entry;
  while (directory && (entry = readdir(directory))) {
    char path[CALL_PATH + 300];
    snprintf(path, sizeof path, "%s/%s", place->directory, entry->d_name);
    unlink(path); /* "." and ".." cannot be unlinked */
  }
  if (directory) {
    closedir(directory);
  }
  rmdir(place->directory);
}

static void prepare(void *context, int k, const char **argv, const char **output,
                    const char **log) {
  struct batch *b = context;
  int n = 0;
  argv[n++] = b->place->program;
  for (int i = 0; i < CALL_OPTIONS && b->calls[k].option[i]; i++) {
    argv[n++] = b->calls[k].option[i];
  }
  argv[n] = b->file[k].job;
  *output = b->file[k].output;
  *log = b->file[k].log;
}

static void finish(void *context, int k, const struct pool_end *end) {
  struct batch *b = context;
  b->calls[k].end = *end;
  b->calls[k].result = json_load_file(b->file[k].output, 0, NULL);
}

bool solver_call_run(const struct solver_place *place, struct solver_call *calls, int count,
                     int width) {
  struct batch *b = calloc(1, sizeof *b);
  bool good = b && count <= CALLS_MAX;
  for (int k = 0; good && k < count; k++) {
    const char *directory = place->directory;
    snprintf(b->file[k].job, sizeof b->file[k].job, "%s/job-%d.json", directory, k);
    snprintf(b->file[k].output, sizeof b->file[k].output, "%s/result-%d.json", directory, k);
    snprintf(b->file[k].log, sizeof b->file[k].log, "%s/log-%d.txt", directory, k);
    good = json_dump_file(calls[k].job, b->file[k].job, JSON_INDENT(1)) == 0;
  }
  if (!good) {
    fprintf(stderr, "jobs cannot be written to %s\n", place->directory);
    free(b);
    return false;
  }
  b->place = place;
  b->calls = calls;
  struct pool pool = {width, place->limit_s, count, prepare, finish, b};
  good = pool_run(&pool);
  for (int k = 0; good && k < count; k++) {
    /* The option --deck writes no document. */
    bool wanted = !calls[k].option[0] || strcmp(calls[k].option[0], "--deck") != 0;
    good = calls[k].end.started && !calls[k].end.timed_out && (calls[k].result || !wanted);
    if (!good) {
      fprintf(stderr, "%s: %s\n", json_string_value(json_object_get(calls[k].job, "name")),
              calls[k].end.timed_out ? "ended by the time limit" : "no result document");
    }
  }
  free(b);
  return good;
}

double solver_call_number(const struct solver_call *call, const char *block, const char *key) {
  const json_t *found = json_object_get(json_object_get(call->result, block), key);
  return json_is_number(found) ? json_number_value(found) : NAN;
}

double solver_call_path_s(const struct solver_call *call) {
  double estimate = solver_call_number(call, "statistics", "estimate_s");
  return solver_call_number(call, "statistics", "cpu_s") - (isnan(estimate) ? 0 : estimate);
}

void solver_call_release(struct solver_call *call) {
  json_decref(call->result);
  call->result = NULL;
}
