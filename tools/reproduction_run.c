/* Jobs of the reproduction: which there are, and running them. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <signal.h>
#include <unistd.h>

#include "solver/base/clock.h"
#include "solver/job/embed.h"
#include "solver/job/spec.h"
#include "tools/reproduction.h"

static const char *const folders[] = {"beast", "multicurvature", "ptba",
                                      "grasp", "tapered",        "material"};

enum { FOLDERS = sizeof folders / sizeof *folders, JOB_BYTES_MAX = 1 << 24, PROCESSES_MAX = 64 };

/* ---- finding ------------------------------------------------------------------------------ */

static char *read_file(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  char *text = file ? malloc(JOB_BYTES_MAX) : NULL;
  *size = text ? fread(text, 1, JOB_BYTES_MAX, file) : 0;
  if (file) {
    fclose(file);
  }
  return text;
}

/* Hash and kind of a job; a job that is refused keeps an empty hash, and the reason is told. */
static void identify(const struct job_reader *reader, struct work *work) {
  size_t size = 0, length = 0;
  char *text = read_file(work->job, &size), *embedded = NULL;
  struct error error = {.status = STATUS_OK};
  struct job_spec spec;
  if (text && embed_files(text, size, work->job, &embedded, &length, &error) == STATUS_OK &&
      job_reader_read(reader, embedded, length, &spec, &error) == STATUS_OK) {
    snprintf(work->hash, sizeof work->hash, "%s", spec.hash);
    work->study = spec.kind == JOB_STUDY;
    job_spec_release(&spec);
  } else {
    fprintf(stderr, "reproduction: %s: %s: %s\n", work->job, error.pointer, error.message);
  }
  free(embedded);
  free(text);
}

static bool same_text(const json_t *object, const char *key, const char *wanted) {
  const char *text = json_string_value(json_object_get(object, key));
  return text && strcmp(text, wanted) == 0;
}

/* Reads the result unless it is that of another job or version. */
static void take_result(struct work *work) {
  char path[WORK_PATH + 16];
  snprintf(path, sizeof path, "%s/result.json", work->directory);
  json_t *result = json_load_file(path, 0, NULL);
  const json_t *provenance = json_object_get(result, "provenance");
  if (work->hash[0] && same_text(provenance, "spec_hash", work->hash) &&
      same_text(provenance, "version", PNEULAB_VERSION)) {
    work->result = json_incref(result);
    work->wall_s =
        json_number_value(json_object_get(json_object_get(result, "statistics"), "wall_s"));
  }
  json_decref(result);
}

static int is_job(const struct dirent *entry) {
  const char *ending = strrchr(entry->d_name, '.');
  return ending && strcmp(ending, ".json") == 0;
}

static void add_work(struct works *works, const struct job_reader *reader, const char *folder,
                     const char *file, const char *source, const char *build) {
  if (works->count == WORKS_MAX) {
    return;
  }
  struct work *work = &works->item[works->count++];
  int stem = (int)(strlen(file) - strlen(".json"));
  snprintf(work->name, sizeof work->name, "%s/%.*s", folder, stem, file);
  snprintf(work->job, sizeof work->job, "%s/jobs/%s/%s", source, folder, file);
  snprintf(work->directory, sizeof work->directory, "%s/%s", build, work->name);
  identify(reader, work);
  take_result(work);
}

bool works_find(struct works *works, const char *source, const char *build) {
  struct job_reader *reader = NULL;
  *works = (struct works){.item = calloc(WORKS_MAX, sizeof *works->item)};
  if (!works->item || job_reader_create(&reader, NULL) != STATUS_OK) {
    fprintf(stderr, "reproduction: no memory\n");
    return false;
  }
  for (int f = 0; f < FOLDERS; f++) {
    char path[WORK_PATH];
    struct dirent **entries = NULL;
    snprintf(path, sizeof path, "%s/jobs/%s", source, folders[f]);
    int count = scandir(path, &entries, is_job, alphasort);
    for (int i = 0; i < count; i++) {
      add_work(works, reader, folders[f], entries[i]->d_name, source, build);
      free(entries[i]);
    }
    free(entries);
  }
  job_reader_destroy(reader);
  return true;
}

void works_release(struct works *works) {
  for (int w = 0; w < works->count; w++) {
    json_decref(works->item[w].result);
  }
  free(works->item);
  *works = (struct works){.item = NULL};
}

bool work_is_wanted(const struct work *work, const char *only) {
  const char *slash = strchr(work->name, '/');
  size_t folder = (size_t)(slash - work->name);
  return !only || strcmp(only, work->name) == 0 || strcmp(only, slash + 1) == 0 ||
         (strlen(only) == folder && strncmp(only, work->name, folder) == 0);
}

bool paper_is_wanted(const struct works *works, const char *paper, const char *only) {
  size_t folder = strlen(paper);
  for (int w = 0; w < works->count; w++) {
    const struct work *work = &works->item[w];
    if (strncmp(work->name, paper, folder) == 0 && work->name[folder] == '/' &&
        work_is_wanted(work, only)) {
      return true;
    }
  }
  return !only;
}

/* ---- running ------------------------------------------------------------------------------ */

/* Makes all folders on the way. */
static bool make_folders(const char *path) {
  char part[WORK_PATH];
  snprintf(part, sizeof part, "%s", path);
  for (char *at = part + 1;; at++) {
    if (*at == '/' || *at == '\0') {
      char end = *at;
      *at = '\0';
      if (mkdir(part, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "reproduction: cannot make %s: %s\n", part, strerror(errno));
        return false;
      }
      *at = end;
      if (!end) {
        return true;
      }
    }
  }
}

static pid_t start(const struct work *work, const char *solver, int processes) {
  char part[WORK_PATH + 24], jobs[16];
  snprintf(part, sizeof part, "%s/result.json.part", work->directory);
  snprintf(jobs, sizeof jobs, "%d", processes);
  int output = open(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  pid_t parent = getpid(), pid = output >= 0 ? fork() : -1;
  if (pid == 0) {
    /* A study shows its members on standard error; a response job stays silent. */
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == parent &&
        dup2(output, STDOUT_FILENO) >= 0) {
      execl(solver, solver, "--out", work->directory, "--jobs", jobs, work->job,
            work->study ? "--verbose" : (char *)NULL, (char *)NULL);
    }
    _exit(127);
  }
  if (output >= 0) {
    close(output);
  }
  return pid;
}

/* Takes in the result of a process that has ended. */
static void finish(struct work *work, int state, double elapsed_s) {
  char part[WORK_PATH + 24], path[WORK_PATH + 24];
  snprintf(part, sizeof part, "%s/result.json.part", work->directory);
  snprintf(path, sizeof path, "%s/result.json", work->directory);
  int code = WIFEXITED(state) ? WEXITSTATUS(state) : -1;
  if (code == 0 || code == 3) {
    rename(part, path);
    take_result(work);
  }
  const char *status = json_string_value(json_object_get(work->result, "status"));
  const char *reason = json_string_value(json_object_get(work->result, "reason"));
  fprintf(stderr, "  %7.1f s  %s: %s%s%s\n", elapsed_s, work->name, status ? status : "no result",
          reason && reason[0] ? ", " : "", reason ? reason : "");
}

/* One process at work. */
struct place {
  pid_t pid;
  struct work *work;
  double start_s;
};

/* Waits for one of them to end; false when there was none. */
static bool wait_for_one(struct place *places, int count) {
  int state = 0;
  pid_t pid = wait(&state);
  for (int p = 0; pid > 0 && p < count; p++) {
    if (places[p].pid == pid) {
      finish(places[p].work, state, clock_wall_s() - places[p].start_s);
      places[p].pid = 0;
    }
  }
  return pid > 0;
}

static bool run_some(struct works *works, const char *only, const char *solver, int places_used,
                     int processes, bool studies) {
  struct place places[PROCESSES_MAX] = {{0}};
  bool good = true;
  for (int w = 0; w < works->count && good; w++) {
    struct work *work = &works->item[w];
    if (work->result || !work->hash[0] || work->study != studies || !work_is_wanted(work, only)) {
      continue;
    }
    int free_place = -1;
    while (free_place < 0) {
      for (int p = 0; p < places_used; p++) {
        free_place = places[p].pid ? free_place : p;
      }
      if (free_place < 0 && !wait_for_one(places, places_used)) {
        return false;
      }
    }
    struct place *place = &places[free_place];
    *place = (struct place){.work = work, .start_s = clock_wall_s()};
    fprintf(stderr, "  run        %s\n", work->name);
    place->pid = make_folders(work->directory) ? start(work, solver, processes) : -1;
    good = place->pid > 0;
  }
  while (wait_for_one(places, places_used)) {
  }
  return good;
}

bool works_run(struct works *works, const char *only, const char *solver, int processes) {
  int count = processes > PROCESSES_MAX ? PROCESSES_MAX : processes;
  return run_some(works, only, solver, count, 1, false) &&
         run_some(works, only, solver, 1, count, true);
}
