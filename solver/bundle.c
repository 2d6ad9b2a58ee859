#include "solver/bundle.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "solver/answer.h"
#include "solver/base/clock.h"
#include "solver/cancel.h"
#include "solver/fe/warm.h"
#include "solver/job/json.h"
#include "solver/post/output.h"
#include "solver/run.h"

enum { PATH_SIZE = OUTPUT_PATH, HEAP_BLOCK = 1 << 30 };

struct bundle {
  const struct bundle_options *options;
  struct job_reader *reader;
  json_t *document;
  const json_t *members;
  struct run_carry carry;
  char path[PATH_SIZE]; /* file of the last member's states, "" for none */
  bool ended;           /* no other member is to be begun */
};

/* One member; descriptors and files are open from its begin to its end. */
struct member {
  const char *folder;
  char out[PATH_SIZE], path[PATH_SIZE];
  FILE *events;
};

static enum status place(char path[PATH_SIZE], const char *folder, const char *name,
                         struct error *error) {
  int length = snprintf(path, PATH_SIZE, "%s/%s", folder, name);
  return length > 0 && length < PATH_SIZE
             ? STATUS_OK
             : error_set(error, STATUS_IO, NULL, "the path of %s is too long", name);
}

/* Standard error goes to the member's log. */
static enum status open_log(const char *folder, struct error *error) {
  char path[PATH_SIZE];
  enum status status = place(path, folder, "log.txt", error);
  if (status != STATUS_OK) {
    return status;
  }
  int log = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  if (log < 0 || dup2(log, STDERR_FILENO) < 0) {
    status = error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  if (log >= 0) {
    close(log);
  }
  return status;
}

static enum status member_open(struct member *member, struct error *error) {
  char path[PATH_SIZE];
  enum status status = open_log(member->folder, error);
  if (status == STATUS_OK) {
    status = place(member->out, member->folder, "out", error);
  }
  if (status == STATUS_OK && mkdir(member->out, 0777) != 0 && errno != EEXIST) {
    status = error_set(error, STATUS_IO, NULL, "cannot make the directory %s: %s", member->out,
                       strerror(errno));
  }
  if (status == STATUS_OK) {
    status = place(member->path, member->folder, "path", error);
  }
  if (status == STATUS_OK) {
    status = place(path, member->folder, "events.jsonl", error);
  }
  if (status == STATUS_OK && !(member->events = fopen(path, "w"))) {
    status = error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  return status;
}

static enum status read_member(const struct bundle *bundle, const struct member *member,
                               struct job_spec *spec, struct error *error) {
  char path[PATH_SIZE];
  size_t size = 0;
  enum status status = place(path, member->folder, "job.json", error);
  if (status != STATUS_OK) {
    return status;
  }
  char *text = answer_read_job(path, &size, error);
  if (!text) {
    return STATUS_IO;
  }
  status = job_reader_read(bundle->reader, text, size, spec, error);
  free(text);
  if (status == STATUS_OK && spec->kind == JOB_STUDY) {
    job_spec_release(spec);
    status = error_set(error, STATUS_INVALID, "/kind", "a study is no member of a bundle");
  }
  return status;
}

static enum status write_answer(const struct member *member, const json_t *document,
                                struct error *error) {
  struct output output;
  enum status status = output_open(&output, member->folder, "result.json", error);
  if (status == STATUS_OK) {
    answer_write(document, output.file);
    status = output_close(&output, STATUS_OK, error);
  }
  return status;
}

static void tell_begun(size_t index) {
  printf("{\"event\": \"begun\", \"member\": %zu}\n", index);
  fflush(stdout);
}

static void tell_done(size_t index, enum exit_code code, double cpu_s) {
  struct rusage usage = {0};
  getrusage(RUSAGE_SELF, &usage);
  printf("{\"event\": \"done\", \"member\": %zu, \"exit\": %d, \"cpu_s\": %.6f, "
         "\"peak_memory_MB\": %.3f}\n",
         index, (int)code, cpu_s, (double)usage.ru_maxrss / 1024);
  fflush(stdout);
}

/* Keeps the states that the next member starts from also in a file, if there are any, and gives up
 * those that this one has started from. */
static enum status keep_path(struct bundle *bundle, const struct member *member, bool last,
                             struct error *error) {
  enum status status = STATUS_OK;
  char before[PATH_SIZE];
  memcpy(before, bundle->path, sizeof before);
  bundle->path[0] = '\0';
  if (!last && bundle->carry.path) {
    status = path_record_write(bundle->carry.path, member->path, error);
    memcpy(bundle->path, member->path, sizeof bundle->path);
  }
  if (before[0]) {
    remove(before);
  }
  return status;
}

/* Solves the member and writes its answer. Other failures than those of the job, which are part of
 * the answer, are returned. */
static enum status solve_member(struct bundle *bundle, struct member *member, bool last,
                                enum exit_code *code, struct error *error) {
  const struct bundle_options *o = bundle->options;
  struct error problem = {.status = STATUS_OK};
  struct job_spec spec;
  json_t *document = NULL;
  enum status ending = STATUS_OK;
  enum status status = read_member(bundle, member, &spec, &problem);
  if (status == STATUS_OK) {
    struct run_options run = {.out_dir = member->out,
                              .carry = &bundle->carry,
                              .events = member->events,
                              .verbose = o->verbose,
                              .cancelled = cancel_wanted};
    status = run_job(&spec, &run, &document, &ending, &problem);
    job_spec_release(&spec);
  }
  *code = status == STATUS_OK ? answer_exit_of_ending(ending) : answer_exit_of_error(&problem);
  bundle->ended = status == STATUS_NO_MEMORY || ending == STATUS_NO_MEMORY || cancel_all_wanted();
  if (status != STATUS_OK) {
    char text[ERROR_TEXT_MAX];
    fprintf(stderr, "pneulab-solve: %s\n", error_describe(&problem, text, sizeof text));
    document = answer_of_error(&problem);
  }
  status = keep_path(bundle, member, last, error);
  if (status == STATUS_OK) {
    status = write_answer(member, document, error);
  }
  json_decref(document);
  return status;
}

/* Whether a chain begins with this member. */
static bool starts_anew(const struct bundle *bundle, size_t index) {
  const json_t *starts = json_object_get(bundle->document, "starts");
  bool found = false;
  for (size_t i = 0; i < json_array_size(starts) && !found; i++) {
    found = json_integer_value(json_array_get(starts, i)) == (json_int_t)index;
  }
  return found;
}

static enum status run_member(struct bundle *bundle, size_t index, struct error *error) {
  struct member member = {.folder = json_string_value(json_array_get(bundle->members, index))};
  enum exit_code code = EXIT_INTERNAL;
  double start = clock_cpu_s();
  cancel_watch_member(member.folder);
  if (starts_anew(bundle, index)) {
    run_carry_release(&bundle->carry);
  }
  tell_begun(index);
  enum status status = member_open(&member, error);
  if (status == STATUS_OK) {
    bool last = index + 1 == json_array_size(bundle->members) || starts_anew(bundle, index + 1);
    status = solve_member(bundle, &member, last, &code, error);
  }
  if (member.events) {
    fclose(member.events);
  }
  if (status == STATUS_OK) {
    tell_done(index, code, clock_cpu_s() - start);
  }
  return status;
}

/* Reads the file of the bundle, and the states that its first member starts from. */
static enum status bundle_open(struct bundle *bundle, struct error *error) {
  json_error_t reason;
  json_t *folder;
  size_t index;
  bundle->document = json_load_file(bundle->options->file, JSON_REJECT_DUPLICATES, &reason);
  bundle->members = json_object_get(bundle->document, "members");
  if (!bundle->document) {
    return error_set(error, STATUS_IO, NULL, "cannot read the bundle %s: %s", bundle->options->file,
                     reason.text);
  }
  json_array_foreach(bundle->members, index, folder) {
    if (!json_is_string(folder)) {
      return error_set(error, STATUS_INVALID, "/members", "every member is the path of a folder");
    }
  }
  if (json_array_size(bundle->members) == 0) {
    return error_set(error, STATUS_INVALID, "/members",
                     "a bundle has a list of folders; for example { \"members\": [\"a\", \"b\"] }");
  }
  const char *from = json_string_value(json_object_get(bundle->document, "from"));
  struct error lost;
  if (from && path_record_read(from, &bundle->carry.path, &lost) != STATUS_OK) {
    fprintf(stderr, "pneulab-solve: the first member starts anew: %s\n", lost.message);
  }
  return job_reader_create(&bundle->reader, error);
}

static void bundle_close(struct bundle *bundle) {
  run_carry_release(&bundle->carry);
  job_reader_destroy(bundle->reader);
  json_decref(bundle->document);
}

int bundle_run(const struct bundle_options *options) {
  struct bundle bundle = {.options = options};
  /* The members are of one size: what one has freed serves the next, without the kernel clearing it
   * anew. */
  mallopt(M_MMAP_THRESHOLD, HEAP_BLOCK);
  mallopt(M_TRIM_THRESHOLD, HEAP_BLOCK);
  struct error error = {.status = STATUS_OK};
  enum status status = bundle_open(&bundle, &error);
  size_t count = json_array_size(bundle.members), next = 0;
  bool cancelled = cancel_all_wanted();
  while (status == STATUS_OK && next < count && !bundle.ended && !cancelled) {
    status = run_member(&bundle, next++, &error);
    cancelled = cancel_all_wanted();
  }
  cancel_watch_member(NULL);
  if (status != STATUS_OK) {
    char text[ERROR_TEXT_MAX];
    fprintf(stderr, "pneulab-solve: %s\n", error_describe(&error, text, sizeof text));
  }
  if (status == STATUS_NO_MEMORY || (bundle.ended && !cancelled)) {
    fflush(NULL); /* at exit OpenBLAS would wait for ever for memory */
    _exit(EXIT_INTERNAL);
  }
  bundle_close(&bundle);
  return status != STATUS_OK ? EXIT_INTERNAL : cancelled ? EXIT_CANCELLED : EXIT_SUCCEEDED;
}
