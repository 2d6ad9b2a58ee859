#include "server/slurm/client.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/command.h"
#include "server/slurm/words.h"

enum { OUTPUT_MAX = 64 << 20, OPTION_SIZE = 320, OPTIONS_MAX = 20, MINUTE_S = 60, SCRIPT_MAX = 8 };

/* Runs a program; a failure that it tells itself is STATUS_CONFLICT, or STATUS_NOT_FOUND when it
 * could not reach the cluster. */
static enum status call(struct slurm_client *client, const char *const *argv, char **output,
                        struct error *error) {
  struct command command = {.argv = argv,
                            .environment = client->environment,
                            .timeout_ms = client->timeout_ms,
                            .output_max = OUTPUT_MAX,
                            .stop = client->stop,
                            .context = client->context};
  struct command_end end;
  *output = NULL;
  enum status status = command_run(&command, &end, error);
  client->cpu_s += end.cpu_s;
  if (status != STATUS_OK) {
    return status;
  }
  if (end.exit_code != 0) {
    free(end.output);
    bool refused = end.problem[0] && !slurm_unreachable(end.problem);
    return error_set(error, refused ? STATUS_CONFLICT : STATUS_NOT_FOUND, NULL, "%s: %s", argv[0],
                     end.problem[0] ? end.problem : "it failed without a word");
  }
  *output = end.output;
  return STATUS_OK;
}

/* ---- sbatch ------------------------------------------------------------------------------- */

/* A command line with options of its own memory. */
struct line {
  const char *argv[OPTIONS_MAX + SCRIPT_MAX + 1];
  char text[OPTIONS_MAX][OPTION_SIZE];
  size_t count;
};

static void line_add(struct line *line, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void line_add(struct line *line, const char *format, ...) {
  char *text = line->text[line->count];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, OPTION_SIZE, format, arguments);
  va_end(arguments);
  line->argv[line->count++] = text;
}

enum status slurm_submit(struct slurm_client *client, const struct slurm_request *request,
                         int64_t *job, struct error *error) {
  struct line line = {.count = 0};
  char *output;
  line_add(&line, "sbatch");
  line_add(&line, "--parsable");
  line_add(&line, "--no-requeue");
  line_add(&line, "--job-name=%s", request->name);
  line_add(&line, "--array=0-%u", request->tasks - 1);
  line_add(&line, "--ntasks=1");
  line_add(&line, "--cpus-per-task=1");
  line_add(&line, "--chdir=/");
  line_add(&line, "--input=/dev/null");
  line_add(&line, "--output=/dev/null");
  if (request->partition[0]) {
    line_add(&line, "--partition=%s", request->partition);
  }
  if (request->account[0]) {
    line_add(&line, "--account=%s", request->account);
  }
  if (request->memory_bytes > 0) {
    line_add(&line, "--mem=%lluK", (unsigned long long)((request->memory_bytes + 1023) / 1024));
  }
  if (request->time_s > 0) {
    line_add(&line, "--time=%.0f", ceil(request->time_s / MINUTE_S));
  }
  if (request->nice != 0) {
    line_add(&line, "--nice=%d", request->nice);
  }
  for (size_t i = 0; request->script[i] && i < SCRIPT_MAX; i++) {
    line.argv[line.count + i] = request->script[i];
  }
  enum status status = call(client, line.argv, &output, error);
  *job = status == STATUS_OK ? slurm_submitted_job(output) : 0;
  if (status == STATUS_OK && *job == 0) {
    status =
        error_set(error, STATUS_IO, NULL, "sbatch printed no job number but \"%.60s\".", output);
  }
  free(output);
  return status;
}

/* ---- the others --------------------------------------------------------------------------- */

enum status slurm_list(struct slurm_client *client, const char *job, char **lines,
                       struct error *error) {
  const char *const own[] = {"squeue", "--noheader", "--me", "--format=" SLURM_LINE_FORMAT, NULL};
  const char *const some[] = {
      "squeue", "--noheader", "--states=all", "--jobs", job, "--format=" SLURM_LINE_FORMAT, NULL};
  return call(client, job ? some : own, lines, error);
}

enum status slurm_find(struct slurm_client *client, const char *name, int64_t *job,
                       struct error *error) {
  const char *const argv[] = {"squeue", "--noheader", "--me",        "--states=all",
                              "--name", name,         "--format=%F", NULL};
  char *output;
  enum status status = call(client, argv, &output, error);
  *job = status == STATUS_OK ? slurm_submitted_job(output) : 0;
  free(output);
  return status;
}

enum status slurm_cancel(struct slurm_client *client, const char *const *tasks, size_t count,
                         bool member, struct error *error) {
  const char *argv[SLURM_SCANCEL_MAX + 4] = {"scancel"};
  size_t used = 1;
  char *output;
  if (member) {
    argv[used++] = "--batch";
    argv[used++] = "--signal=USR1";
  }
  for (size_t i = 0; i < count && i < SLURM_SCANCEL_MAX; i++) {
    argv[used++] = tasks[i];
  }
  enum status status = call(client, argv, &output, error);
  free(output);
  return status == STATUS_CONFLICT ? STATUS_OK : status; /* some had ended */
}

enum status slurm_cores(struct slurm_client *client, const char *partition, unsigned *cores,
                        struct error *error) {
  const char *const all[] = {"sinfo", "--noheader", "--format=%C", NULL};
  const char *const one[] = {"sinfo", "--noheader", "--format=%C", "--partition", partition, NULL};
  unsigned allocated = 0, idle = 0;
  char *output;
  enum status status = call(client, partition[0] ? one : all, &output, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (sscanf(output, "%u/%u/", &allocated, &idle) != 2) {
    status = error_set(error, STATUS_IO, NULL, "sinfo printed \"%.60s\".", output);
  }
  *cores = allocated + idle;
  free(output);
  return status;
}
