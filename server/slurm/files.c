/* What the nodes find on the shared disk: the script, the folders of batches and of attempts. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/file.h"
#include "server/slurm/slurm_internal.h"
#include "solver/job/json.h"

/* A second start of a task finds its mark and ends at once. The solver's end is told by a file that
 * appears whole. SIGUSR1 and SIGTERM are passed on; the wait that they interrupt is taken up again
 * until the solver has ended. */
static const char script[] =
    "#!/bin/sh\n"
    "# A task of a batch of pneulabd; written anew at each start of the daemon.\n"
    "# usage: task.sh BATCH-FOLDER SOLVER MEMORY-KB FILE-BLOCKS\n"
    "batch=$1 solver=$2 task=$SLURM_ARRAY_TASK_ID\n"
    "umask 077\n"
    "mkdir \"$batch/begun/$task\" || exit 75\n"
    "echo \"$SLURM_ARRAY_JOB_ID\" > \"$batch/begun/$task/job\"\n"
    "cd \"$batch/$task\" || exit 74\n"
    "ulimit -c 0\n"
    "[ \"$3\" = 0 ] || ulimit -d \"$3\"\n"
    "ulimit -f \"$4\"\n"
    "export OPENBLAS_NUM_THREADS=1\n"
    "\"$solver\" --threads 1 --bundle bundle.json > members.jsonl 2> log.txt &\n"
    "child=$!\n"
    "trap 'kill -USR1 \"$child\"' USR1\n"
    "trap 'kill -TERM \"$child\"' TERM\n"
    "while :; do\n"
    "  wait \"$child\"\n"
    "  code=$?\n"
    "  kill -0 \"$child\" 2> /dev/null || break\n"
    "done\n"
    "echo \"$code\" > end && mv end \"$batch/ended/$task\"\n"
    "exit \"$code\"\n";

enum status files_write_script(struct slurm *slurm, struct error *error) {
  char folder[PATH_MAX];
  if (!run_path(folder, slurm->data, CLUSTER_FOLDER) ||
      !run_path(slurm->script, folder, "task.sh")) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "The path of the data directory is too long.");
  }
  enum status status = file_make_directory(folder, error);
  return status == STATUS_OK ? file_write(slurm->script, script, sizeof script - 1, error) : status;
}

enum status files_write_batch(const struct slurm_batch *batch, struct error *error) {
  static const char *const names[] = {"begun", "ended"};
  char path[PATH_MAX];
  enum status status = STATUS_OK;
  for (size_t i = 0; i < 2 && status == STATUS_OK; i++) {
    status = run_path(path, batch->folder, names[i])
                 ? file_make_directory(path, error)
                 : error_set(error, STATUS_TOO_LARGE, NULL, "The path of a batch is too long.");
  }
  return status;
}

/* The states that the member before the first one has left, copied to where no orphan of an earlier
 * attempt takes them away. "" when there are none. */
static void take_before(const struct slurm *slurm, const struct draft *draft, const char *folder,
                        char path[PATH_MAX]) {
  struct run_paths *paths = malloc(sizeof *paths);
  char before[PATH_MAX], *data = NULL;
  size_t size;
  path[0] = '\0';
  if (draft->before_id != 0 && paths &&
      run_paths_make(slurm->data, draft->before_id, draft->before_attempt, paths, NULL) ==
          STATUS_OK &&
      run_path(before, paths->directory, "path") &&
      file_read(before, OUTPUT_BYTES_MAX, &data, &size, NULL) == STATUS_OK &&
      (!run_path(path, folder, "path") || file_write(path, data, size, NULL) != STATUS_OK)) {
    path[0] = '\0';
  }
  free(data);
  free(paths);
}

static enum status write_list(const struct slurm_task *task, const struct draft *draft,
                              const json_t *members, const char *folder, struct error *error) {
  char path[PATH_MAX], before[PATH_MAX];
  json_t *starts = json_array();
  for (size_t k = 1; k < draft->count; k++) {
    if (draft->member[k].start) {
      json_array_append_new(starts, json_integer((json_int_t)k));
    }
  }
  take_before(task->batch->slurm, draft, folder, before);
  json_t *document = json_pack("{s:O, s:o, s:s*}", "members", members, "starts", starts, "from",
                               before[0] ? before : NULL);
  char *text = document ? json_dumps(document, JSON_INDENT(1)) : NULL;
  enum status status = !text ? error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a bundle.")
                       : run_path(path, folder, "bundle.json")
                           ? file_write(path, text, strlen(text), error)
                           : error_set(error, STATUS_TOO_LARGE, NULL, "A path is too long.");
  free(text);
  json_decref(document);
  return status;
}

enum status files_write_task(const struct slurm_task *task, const struct draft *draft,
                             struct error *error) {
  char name[32], folder[PATH_MAX];
  struct run_paths *paths = malloc(sizeof *paths);
  json_t *members = json_array();
  enum status status =
      paths ? STATUS_OK : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for a bundle.");
  snprintf(name, sizeof name, "%u", task->index);
  if (status == STATUS_OK && !run_path(folder, task->batch->folder, name)) {
    status = error_set(error, STATUS_TOO_LARGE, NULL, "The path of a batch is too long.");
  }
  if (status == STATUS_OK) {
    status = file_make_directory(folder, error);
  }
  for (size_t k = 0; k < draft->count && status == STATUS_OK; k++) {
    const struct draft_member *member = &draft->member[k];
    status =
        run_paths_make(task->batch->slurm->data, member->job_id, member->attempt, paths, error);
    if (status == STATUS_OK) {
      status = run_folder_make(paths, member->document, error);
    }
    json_array_append_new(members, json_string(paths->directory));
  }
  if (status == STATUS_OK) {
    status = write_list(task, draft, members, folder, error);
  }
  json_decref(members);
  free(paths);
  return status;
}
