/* How many of many different designs the solver carries to the end, and at what cost.
 *   bench_robustness [--count N] [--seed N] [--accuracy fast|standard|fine] [--steps N]
 * [--estimate]
 *                    [--jobs N] [--limit CPU_SECONDS] [--only I] [--keep DIR] [--solver PATH]
 *                    [--json FILE]
 * Designs and jobs are those of robust_design.h; each is solved by a process of its own. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "solver/base/clock.h"
#include "tests/bench/bench.h"
#include "tests/bench/robust_design.h"
#include "tests/bench/robust_pool.h"

enum { PATH_SIZE = 4096, COUNT_MAX = 100000 };

struct arguments {
  struct robust_options design;
  int parallel, only; /* only: -1 for all */
  double limit_s;
  const char *keep, *solver, *json;
};

/* How one design ended. */
struct outcome {
  char status[16], reason[32];
  double angle_deg, pressure_kPa, cpu_s, wall_s, peak_memory_MB, estimate_s;
  int factorizations, unknowns;
  bool touched;
};

struct bench {
  const struct arguments *arguments;
  const char *directory;
  int first; /* index of the first design that is run */
  struct outcome *outcome;
  char job[PATH_SIZE], output[PATH_SIZE], log[PATH_SIZE];
};

static void set_paths(struct bench *b, int index) {
  snprintf(b->job, sizeof b->job, "%s/design-%04d.json", b->directory, index);
  snprintf(b->output, sizeof b->output, "%s/result-%04d.json", b->directory, index);
  snprintf(b->log, sizeof b->log, "%s/log-%04d.txt", b->directory, index);
}

static void prepare(void *context, int k, const char **argv, const char **output,
                    const char **log) {
  struct bench *b = context;
  set_paths(b, b->first + k);
  argv[0] = b->arguments->solver;
  argv[1] = b->job;
  *output = b->output;
  *log = b->log;
}

static double number(const json_t *object, const char *key) {
  const json_t *found = json_object_get(object, key);
  return json_is_number(found) ? json_number_value(found) : NAN;
}

static void take_result(const json_t *result, struct outcome *o) {
  const json_t *metrics = json_object_get(result, "metrics");
  const json_t *samples = json_object_get(result, "samples");
  const json_t *statistics = json_object_get(result, "statistics");
  const char *status = json_string_value(json_object_get(result, "status"));
  const char *reason = json_string_value(json_object_get(result, "reason"));
  snprintf(o->status, sizeof o->status, "%s", status ? status : "no_status");
  snprintf(o->reason, sizeof o->reason, "%s", reason ? reason : "");
  size_t count = json_array_size(samples);
  o->angle_deg = number(metrics, "bending_angle_deg");
  o->pressure_kPa = count > 0 ? number(json_array_get(samples, count - 1), "pressure_kPa") : NAN;
  o->touched = json_object_get(metrics, "contact_onset_kPa") != NULL;
  double factorizations = number(statistics, "factorizations");
  o->factorizations = isfinite(factorizations) ? (int)factorizations : 0;
  o->estimate_s = fmax(0, number(statistics, "estimate_s"));
  double unknowns = number(statistics, "unknowns");
  o->unknowns = isfinite(unknowns) ? (int)unknowns : 0;
}

static void print_number(const char *format, double x) {
  if (isfinite(x)) {
    printf(format, x);
  } else {
    printf("%*s", atoi(format + 1), "-");
  }
}

static void print_outcome(int index, const struct outcome *o) {
  printf("%5d  %-9s  %-20s", index, o->status, o->reason[0] ? o->reason : "-");
  print_number("%9.2f", o->angle_deg);
  print_number("%8.2f", o->pressure_kPa);
  printf("%7d", o->factorizations);
  print_number("%9.2f", o->cpu_s);
  print_number("%9.2f", o->wall_s);
  printf("  %s\n", o->touched ? "touches" : "");
  fflush(stdout);
}

static void finish(void *context, int k, const struct pool_end *end) {
  struct bench *b = context;
  struct outcome *o = &b->outcome[k];
  set_paths(b, b->first + k);
  *o = (struct outcome){.angle_deg = NAN, .pressure_kPa = NAN};
  json_t *result = json_load_file(b->output, 0, NULL);
  if (result) {
    take_result(result, o);
  } else {
    snprintf(o->status, sizeof o->status, "%s", end->started ? "crashed" : "not_started");
    snprintf(o->reason, sizeof o->reason, end->signal ? "signal_%d" : "exit_%d",
             end->signal ? end->signal : end->exit_code);
  }
  if (end->timed_out) {
    snprintf(o->status, sizeof o->status, "timed_out");
    snprintf(o->reason, sizeof o->reason, "time_limit");
  }
  json_decref(result);
  o->cpu_s = end->cpu_s;
  o->wall_s = end->wall_s;
  o->peak_memory_MB = 1e-6 * end->peak_memory;
  print_outcome(b->first + k, o);
}

/* ---- summary ---- */

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The share-th quantile of sorted values, between the two nearest of them. */
static double quantile(const double *sorted, int count, double share) {
  double at = share * (count - 1);
  int below = (int)at;
  double above = sorted[below + 1 < count ? below + 1 : below];
  return sorted[below] + (at - below) * (above - sorted[below]);
}

/* Adds median and 90th percentile of a value to the summary. */
static void summarise_value(json_t *summary, const char *name, double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, compare);
  double median = quantile(values, count, 0.5), high = quantile(values, count, 0.9);
  printf("%s: median %.2f, 90th percentile %.2f\n", name, median, high);
  json_object_set_new(summary, name,
                      json_pack("{s:f, s:f}", "median", median, "percentile_90", high));
}

static json_t *summarise(const struct outcome *outcome, int count, double wall_s) {
  json_t *summary = json_object(), *reasons = json_object();
  double *cpu = malloc(sizeof *cpu * (size_t)count), *factors = malloc(sizeof *cpu * (size_t)count);
  int good = 0, touched = 0;
  for (int k = 0; cpu && factors && k < count; k++) {
    const struct outcome *o = &outcome[k];
    bool succeeded = strcmp(o->status, "succeeded") == 0;
    const char *reason = o->reason[0] ? o->reason : o->status;
    good += succeeded;
    touched += o->touched;
    json_int_t known = json_integer_value(json_object_get(reasons, reason));
    json_object_set_new(reasons, reason, json_integer(known + 1));
    cpu[k] = o->cpu_s;
    factors[k] = o->factorizations;
  }
  printf("\n%d of %d succeeded (%.1f %%), %d with contact\n", good, count, 100.0 * good / count,
         touched);
  const char *reason;
  json_t *number_of;
  json_object_foreach(reasons, reason, number_of) {
    printf("  %-22s %4d\n", reason, (int)json_integer_value(number_of));
  }
  json_object_set_new(summary, "designs", json_integer(count));
  json_object_set_new(summary, "succeeded", json_integer(good));
  json_object_set_new(summary, "touched", json_integer(touched));
  json_object_set_new(summary, "reasons", reasons);
  if (cpu && factors) {
    summarise_value(summary, "cpu_s", cpu, count);
    summarise_value(summary, "factorizations", factors, count);
  }
  printf("%.0f designs an hour (%.1f s)\n", 3600 * count / wall_s, wall_s);
  json_object_set_new(summary, "wall_s", json_real(wall_s));
  json_object_set_new(summary, "designs_per_hour", json_real(3600 * count / wall_s));
  free(cpu);
  free(factors);
  return summary;
}

static json_t *real_or_null(double x) {
  return isfinite(x) ? json_real(x) : json_null();
}

static json_t *document(const struct bench *b, int count, json_t *summary) {
  const struct arguments *a = b->arguments;
  json_t *designs = json_array();
  for (int k = 0; k < count; k++) {
    const struct outcome *o = &b->outcome[k];
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/design-%04d.json", b->directory, b->first + k);
    json_array_append_new(
        designs,
        json_pack("{s:i, s:s, s:s, s:o, s:o, s:i, s:i, s:b, s:f, s:f, s:f, s:f, s:o*}", "index",
                  b->first + k, "status", o->status, "reason", o->reason, "bending_angle_deg",
                  real_or_null(o->angle_deg), "pressure_kPa", real_or_null(o->pressure_kPa),
                  "factorizations", o->factorizations, "unknowns", o->unknowns, "touched",
                  o->touched, "cpu_s", o->cpu_s, "wall_s", o->wall_s, "estimate_s", o->estimate_s,
                  "peak_memory_MB", o->peak_memory_MB, "job", json_load_file(path, 0, NULL)));
  }
  return json_pack("{s:o*, s:{s:i, s:I, s:s, s:i, s:i, s:f}, s:O, s:o}", "machine",
                   bench_machine(bench_dgemm_rate()), "options", "count", a->design.count, "seed",
                   (json_int_t)a->design.seed, "accuracy", a->design.accuracy, "steps",
                   a->design.steps, "jobs", a->parallel, "limit_s", a->limit_s, "summary", summary,
                   "designs", designs);
}

/* ---- running ---- */

static bool write_jobs(struct bench *b, int count, double (*place)[ROBUST_FACTORS]) {
  bool written = true;
  for (int k = 0; k < count && written; k++) {
    json_t *job = robust_job(&b->arguments->design, b->first + k, place[b->first + k]);
    set_paths(b, b->first + k);
    written = job && json_dump_file(job, b->job, JSON_INDENT(2)) == 0;
    json_decref(job);
  }
  if (!written) {
    fprintf(stderr, "%s cannot be written\n", b->job);
  }
  return written;
}

static void remove_files(struct bench *b, int count) {
  for (int k = 0; k < count; k++) {
    set_paths(b, b->first + k);
    remove(b->job);
    remove(b->output);
    remove(b->log);
  }
  rmdir(b->directory);
}

static bool run(struct bench *b, int count) {
  const struct arguments *a = b->arguments;
  struct pool pool = {a->parallel, a->limit_s, count, prepare, finish, b};
  double start = clock_wall_s();
  printf("index  status     reason                   angle  press.    fact.      cpu     wall\n"
         "                                             deg     kPa                 s        s\n");
  if (!pool_run(&pool)) {
    fprintf(stderr, "out of memory\n");
    return false;
  }
  json_t *summary = summarise(b->outcome, count, clock_wall_s() - start);
  bool good = true;
  if (a->json) {
    json_t *all = document(b, count, summary);
    good = all && bench_write_json(a->json, all);
    json_decref(all);
  }
  json_decref(summary);
  return good;
}

static bool bench_all(const struct arguments *a) {
  char temporary[] = "/tmp/bench-robustness-XXXXXX";
  double(*place)[ROBUST_FACTORS] = calloc((size_t)a->design.count, sizeof *place);
  struct bench b = {.arguments = a, .first = a->only < 0 ? 0 : a->only};
  int count = a->only < 0 ? a->design.count : 1;
  bool good = false;
  b.outcome = calloc((size_t)count, sizeof *b.outcome);
  if (!place || !b.outcome) {
    fprintf(stderr, "out of memory\n");
    goto done;
  }
  if (a->keep) {
    mkdir(a->keep, 0777); /* may be there; what cannot be written there is told below */
  }
  b.directory = a->keep ? a->keep : mkdtemp(temporary);
  if (!b.directory) {
    perror(temporary);
    goto done;
  }
  good = robust_sample(&a->design, place) && write_jobs(&b, count, place) && run(&b, count);
  if (!a->keep) {
    remove_files(&b, count);
  }
done:
  free(place);
  free(b.outcome);
  return good;
}

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {
      {"count", required_argument, NULL, 'c'},    {"seed", required_argument, NULL, 's'},
      {"accuracy", required_argument, NULL, 'a'}, {"steps", required_argument, NULL, 'n'},
      {"jobs", required_argument, NULL, 'p'},     {"limit", required_argument, NULL, 'l'},
      {"only", required_argument, NULL, 'o'},     {"keep", required_argument, NULL, 'k'},
      {"solver", required_argument, NULL, 'S'},   {"json", required_argument, NULL, 'j'},
      {"estimate", no_argument, NULL, 'e'},       {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    switch (option) {
    case 'c':
      a->design.count = atoi(optarg);
      break;
    case 's':
      a->design.seed = strtoull(optarg, NULL, 10);
      break;
    case 'a':
      a->design.accuracy = optarg;
      break;
    case 'n':
      a->design.steps = atoi(optarg);
      break;
    case 'p':
      a->parallel = atoi(optarg);
      break;
    case 'l':
      a->limit_s = atof(optarg);
      break;
    case 'o':
      a->only = atoi(optarg);
      break;
    case 'k':
      a->keep = optarg;
      break;
    case 'S':
      a->solver = optarg;
      break;
    case 'e':
      a->design.estimate = true;
      break;
    case 'j':
      a->json = optarg;
      break;
    default:
      return false;
    }
  }
  return optind == argc && a->design.count > 0 && a->design.count <= COUNT_MAX &&
         a->only < a->design.count && a->design.steps > 0 && a->parallel > 0 &&
         a->parallel <= 256 && a->limit_s > 0;
}

int main(int argc, char **argv) {
  struct arguments a = {.design = {200, 1, "standard", 10},
                        .parallel = 2,
                        .only = -1,
                        .limit_s = 120,
                        .solver = "./pneulab-solve"};
  if (!parse(argc, argv, &a)) {
    fprintf(stderr,
            "usage: %s [--count N] [--seed N] [--accuracy fast|standard|fine] [--steps N]\n"
            "       [--jobs N] [--limit CPU_SECONDS] [--only I] [--keep DIR] [--solver PATH]\n"
            "       [--json FILE]\n",
            argv[0]);
    return EXIT_FAILURE;
  }
  if (access(a.solver, X_OK) != 0) {
    perror(a.solver);
    return EXIT_FAILURE;
  }
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  return bench_all(&a) ? EXIT_SUCCESS : EXIT_FAILURE;
}
