/* Whether the same job gives the same result.
 *   bench_repeat [--json FILE] [--solver PATH] JOB.json
 * The job is solved alone, then beside two other solves that compete for the processor: result
 * documents without their statistics, and the files of --path-out, which hold every unknown of
 * every recorded state as the machine keeps it, must be the same byte for byte. Then it is solved
 * with two threads of dense linear algebra, where sums are formed in another order: the samples
 * must agree to the solver's tolerance. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/bench/bench.h"
#include "tests/bench/solver_call.h"

enum { BESIDE = 3 };

static const double limit_s = 300;

/* What two results differ by. */
struct difference {
  bool document, path; /* the same bytes */
  double largest;      /* of a sample's number, relative to the largest of its kind */
};

static char *plain_text(const json_t *result) {
  json_t *copy = json_deep_copy(result);
  json_object_del(copy, "statistics");
  char *text = json_dumps(copy, JSON_SORT_KEYS);
  json_decref(copy);
  return text;
}

static bool same_documents(const json_t *a, const json_t *b) {
  char *first = plain_text(a), *second = plain_text(b);
  bool same = first && second && strcmp(first, second) == 0;
  free(first);
  free(second);
  return same;
}

static bool same_files(const char *a, const char *b) {
  FILE *first = fopen(a, "rb"), *second = fopen(b, "rb");
  bool same = first && second;
  for (int c = 0; same && c != EOF;) {
    c = getc(first);
    same = c == getc(second);
  }
  if (first) {
    fclose(first);
  }
  if (second) {
    fclose(second);
  }
  return same;
}

static double sample_number(const json_t *samples, size_t index, const char *key) {
  const json_t *value = json_object_get(json_array_get(samples, index), key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

/* The largest difference of the samples, each kind relative to its largest number. */
static double largest_difference(const json_t *a, const json_t *b) {
  static const char *const keys[] = {"bending_angle_deg", "chord_angle_deg",   "tip_x_mm",
                                     "tip_z_mm",          "cavity_volume_mm3", "max_stretch"};
  const json_t *first = json_object_get(a, "samples"), *second = json_object_get(b, "samples");
  double largest = json_array_size(first) == json_array_size(second) ? 0 : INFINITY;
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
    double scale = 0, apart = 0;
    for (size_t i = 0; i < json_array_size(first); i++) {
      double x = sample_number(first, i, keys[k]), y = sample_number(second, i, keys[k]);
      scale = fmax(scale, fabs(x));
      apart = isnan(y) ? INFINITY : fmax(apart, fabs(x - y));
    }
    largest = scale > 0 ? fmax(largest, apart / scale) : largest;
  }
  return largest;
}

static struct difference compare(const struct solver_call *a, const struct solver_call *b) {
  return (struct difference){.document = same_documents(a->result, b->result),
                             .path = same_files(a->option[1], b->option[1]),
                             .largest = largest_difference(a->result, b->result)};
}

static json_t *report(const char *name, const struct difference *d) {
  printf("%-12s document %s, states %s, samples within %.1e\n", name,
         d->document ? "the same" : "different", d->path ? "the same" : "different", d->largest);
  return json_pack("{s:b, s:b, s:f}", "same_document", d->document, "same_states", d->path,
                   "largest_difference", d->largest);
}

/* Runs everything; a new reference, or NULL. */
static json_t *run(const struct solver_place *place, const json_t *job) {
  char path[BESIDE + 2][CALL_PATH + 32];
  struct solver_call alone = {.job = job}, beside[BESIDE], threads = {.job = job};
  json_t *figures = NULL;
  for (int k = 0; k < BESIDE + 2; k++) {
    snprintf(path[k], sizeof path[k], "%s/path-%d", place->directory, k);
  }
  alone.option[0] = threads.option[0] = "--path-out";
  alone.option[1] = path[BESIDE];
  threads.option[1] = path[BESIDE + 1];
  threads.option[2] = "--threads";
  threads.option[3] = "2";
  for (int k = 0; k < BESIDE; k++) {
    beside[k] = (struct solver_call){.job = job, .option = {"--path-out", path[k]}};
  }
  if (solver_call_run(place, &alone, 1, 1) && solver_call_run(place, beside, BESIDE, BESIDE) &&
      solver_call_run(place, &threads, 1, 1)) {
    struct difference busy = compare(&alone, &beside[0]), other = compare(&alone, &threads);
    for (int k = 1; k < BESIDE; k++) {
      struct difference d = compare(&alone, &beside[k]);
      busy.document = busy.document && d.document;
      busy.path = busy.path && d.path;
      busy.largest = fmax(busy.largest, d.largest);
    }
    json_t *beside_load = report("beside load", &busy);
    figures = json_pack("{s:i, s:o, s:o}", "processes", BESIDE, "beside_load", beside_load,
                        "two_threads", report("two threads", &other));
  }
  for (int k = 0; k < BESIDE; k++) {
    solver_call_release(&beside[k]);
  }
  solver_call_release(&alone);
  solver_call_release(&threads);
  return figures;
}

int main(int argc, char **argv) {
  static const struct option options[] = {
      {"json", required_argument, NULL, 'j'}, {"solver", required_argument, NULL, 'S'}, {0}};
  const char *json = NULL, *solver = "./pneulab-solve";
  struct solver_place place;
  json_error_t error;
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1 && option != '?') {
    json = option == 'j' ? optarg : json;
    solver = option == 'S' ? optarg : solver;
  }
  if (option == '?' || optind + 1 != argc) {
    fprintf(stderr, "usage: %s [--json FILE] [--solver PATH] JOB.json\n", argv[0]);
    return EXIT_FAILURE;
  }
  json_t *job = json_load_file(argv[optind], 0, &error);
  if (!job || !solver_place_create(&place, solver, limit_s)) {
    fprintf(stderr, "%s: %s\n", argv[optind], job ? "cannot be run" : error.text);
    json_decref(job);
    return EXIT_FAILURE;
  }
  json_t *figures = run(&place, job);
  bool good = figures != NULL;
  if (good && json) {
    json_t *document = json_pack("{s:s, s:O, s:o, s:O}", "program", "bench_repeat", "job",
                                 json_object_get(job, "name"), "machine",
                                 bench_machine(bench_dgemm_rate()), "repeat", figures);
    good = bench_write_json(json, document);
    json_decref(document);
  }
  json_decref(figures);
  json_decref(job);
  solver_place_remove(&place);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
