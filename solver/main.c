/* pneulab-solve: one job document in, one result document out. */
#include <cblas.h>
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "solver/job/embed.h"
#include "solver/job/json.h"
#include "solver/answer.h"
#include "solver/bundle.h"
#include "solver/cancel.h"
#include "solver/run.h"
#include "solver/study/study_run.h"

static const char usage[] =
    "usage: pneulab-solve [--out DIR] [--events FILE] [--threads N] [--jobs N] [--deck FILE]\n"
    "                     [--path-in FILE] [--path-out FILE] [--verbose] JOB.json\n"
    "       pneulab-solve --embed JOB.json\n"
    "       pneulab-solve --bundle FILE\n"
    "  JOB.json        job document; - reads standard input. Files that it names, as in\n"
    "                  { \"file\": \"curve.csv\" }, are looked for from its folder\n"
    "  --embed         print the job with the content of these files in their place, to be sent\n"
    "                  to the daemon\n"
    "  --out DIR       write fields, tables and a CalculiX deck there; made when missing\n"
    "  --events FILE   append progress as JSON lines\n"
    "  --threads N     threads of the dense linear algebra (default 1)\n"
    "  --jobs N        members of a study that are solved at a time (default: number of cores)\n"
    "  --deck FILE     write the problem as a CalculiX deck instead of solving it\n"
    "  --path-out FILE keep the path of converged states there\n"
    "  --path-in FILE  start from such a path of a design with the same mesh topology; where that\n"
    "                  does not work the solve starts from the undeformed body by itself\n"
    "  --bundle FILE   solve several jobs, each in a folder of its own and starting from the one\n"
    "                  before: the file lists them as docs/JOBS.md says\n"
    "  --verbose       print iterations on standard error\n"
    "The result document goes to standard output. Exit status: 0 succeeded, 2 invalid job,\n"
    "3 stopped early (the result says why), 4 internal error, 5 cancelled.\n";

struct arguments {
  const char *job, *events, *bundle;
  int threads, jobs;
  bool embed; /* print the self-contained job instead of running it */
  struct run_options run;
};

static bool parse_arguments(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {{"out", required_argument, NULL, 'o'},
                                          {"events", required_argument, NULL, 'e'},
                                          {"threads", required_argument, NULL, 't'},
                                          {"deck", required_argument, NULL, 'd'},
                                          {"path-in", required_argument, NULL, 'i'},
                                          {"path-out", required_argument, NULL, 'p'},
                                          {"jobs", required_argument, NULL, 'j'},
                                          {"verbose", no_argument, NULL, 'v'},
                                          {"embed", no_argument, NULL, 'm'},
                                          {"bundle", required_argument, NULL, 'b'},
                                          {"version", no_argument, NULL, 'V'},
                                          {"help", no_argument, NULL, 'h'},
                                          {0}};
  int option;
  while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
    switch (option) {
    case 'o':
      a->run.out_dir = optarg;
      break;
    case 'e':
      a->events = optarg;
      break;
    case 't':
      a->threads = atoi(optarg);
      break;
    case 'j':
      a->jobs = atoi(optarg);
      break;
    case 'd':
      a->run.deck_path = optarg;
      break;
    case 'i':
      a->run.path_in = optarg;
      break;
    case 'p':
      a->run.path_out = optarg;
      break;
    case 'b':
      a->bundle = optarg;
      break;
    case 'm':
      a->embed = true;
      break;
    case 'v':
      a->run.verbose = true;
      break;
    case 'V':
      puts("pneulab-solve " PNEULAB_VERSION);
      exit(EXIT_SUCCEEDED);
    case 'h':
      fputs(usage, stdout);
      exit(EXIT_SUCCEEDED);
    default:
      return false;
    }
  }
  a->job = optind + 1 == argc ? argv[optind] : NULL;
  return (a->bundle ? optind == argc : a->job != NULL) && a->threads >= 1 && a->threads <= 256 &&
         a->jobs >= 0 && a->jobs <= STUDY_JOBS_MAX;
}

/* Makes the directory of the artifacts unless it is there. */
static enum status make_directory(const char *path, struct error *error) {
  if (!path || mkdir(path, 0777) == 0 || errno == EEXIST) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_IO, NULL, "cannot make the directory %s: %s", path,
                   strerror(errno));
}

static enum status open_events(const char *path, FILE **events, struct error *error) {
  *events = path ? fopen(path, "a") : NULL;
  if (path && !*events) {
    return error_set(error, STATUS_IO, NULL, "cannot write %s: %s", path, strerror(errno));
  }
  return STATUS_OK;
}

/* Prints the error as a document and returns the exit code that fits it. */
static int report(const struct error *error) {
  char text[ERROR_TEXT_MAX];
  fprintf(stderr, "pneulab-solve: %s\n", error_describe(error, text, sizeof text));
  json_t *document = answer_of_error(error);
  answer_write(document, stdout);
  json_decref(document);
  if (error->status == STATUS_NO_MEMORY) { /* at exit OpenBLAS would wait for ever for memory */
    fflush(NULL);
    _exit(EXIT_INTERNAL);
  }
  return answer_exit_of_error(error);
}

/* Reads the job with the files that it names, or only prints it so. Places of errors are those in
 * the job's own file. */
static enum status read_spec(const struct arguments *a, struct job_spec *spec,
                             struct error *error) {
  size_t size = 0, length = 0;
  char *embedded = NULL;
  char *text = answer_read_job(a->job, &size, error);
  if (!text) {
    return STATUS_IO;
  }
  const char *path = strcmp(a->job, "-") == 0 ? NULL : a->job;
  enum status status = embed_files(text, size, path, &embedded, &length, error);
  if (status == STATUS_OK) {
    status = job_spec_read(embedded, length, spec, error);
    if (status != STATUS_OK && error->line > 0) {
      json_text_locate(text, size, error->pointer, &error->line, &error->column);
    }
  }
  if (status == STATUS_OK && a->embed) {
    puts(embedded);
  }
  free(embedded);
  free(text);
  return status;
}

static enum status run(const struct job_spec *spec, const struct arguments *a, json_t **document,
                       enum status *ending, struct error *error) {
  if (spec->kind != JOB_STUDY) {
    return run_job(spec, &a->run, document, ending, error);
  }
  if (a->run.deck_path || a->run.path_in || a->run.path_out) {
    return error_set(error, STATUS_INVALID, "/kind",
                     "a study has no deck and no path of its own: its members have");
  }
  struct study_options study = {
      .out_dir = a->run.out_dir,
      .events = a->run.events,
      .jobs = a->jobs,
      .threads = a->threads,
      .verbose = a->run.verbose,
      .cancelled = a->run.cancelled,
  };
  return study_run(spec, &study, document, ending, error);
}

int main(int argc, char **argv) {
  struct arguments a = {.threads = 1, .run.cancelled = cancel_wanted};
  struct error error = {0};
  struct job_spec spec;
  if (!parse_arguments(argc, argv, &a)) {
    fputs(usage, stderr);
    return EXIT_INTERNAL;
  }
  cancel_watch();
  openblas_set_num_threads(a.threads);
  if (a.bundle) {
    struct bundle_options bundle = {a.bundle, a.run.verbose};
    return bundle_run(&bundle);
  }
  if (read_spec(&a, &spec, &error) != STATUS_OK) {
    return report(&error);
  }
  if (a.embed) {
    job_spec_release(&spec);
    return EXIT_SUCCEEDED;
  }
  if (make_directory(a.run.out_dir, &error) != STATUS_OK ||
      open_events(a.events, &a.run.events, &error) != STATUS_OK) {
    return report(&error);
  }
  json_t *document = NULL;
  enum status ending = STATUS_OK;
  enum status status = run(&spec, &a, &document, &ending, &error);
  if (a.run.events) {
    fclose(a.run.events);
  }
  job_spec_release(&spec);
  if (status != STATUS_OK) {
    return report(&error);
  }
  if (document) {
    answer_write(document, stdout);
    json_decref(document);
  }
  if (fflush(stdout) != 0 || ferror(stdout)) {
    fprintf(stderr, "pneulab-solve: writing the result failed: %s\n", strerror(errno));
    return EXIT_INTERNAL;
  }
  return answer_exit_of_ending(ending);
}
