/* The reference job from the undeformed body, and its neighbours from its path.
 *   bench_warm [--json FILE] [--solver PATH] [--repetitions N] JOB.json
 * Cold: the job as it is, with the estimate of its errors. Warm: its path at five recorded
 * pressures is kept, then gap_wall, height and bottom_layer are enlarged by 2, 5 and 10 % one at
 * a time and solved at five pressures from that path and from the undeformed body, without the
 * estimate. Every solve is a process of its own; times are CPU times, the best of N. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/bench/bench.h"
#include "tests/bench/solver_call.h"

enum { WARM_STEPS = 5 };

static const double limit_s = 120;
static const char *const dimensions[] = {"gap_wall", "height", "bottom_layer"};
static const double changes[] = {0.02, 0.05, 0.1};

struct arguments {
  const char *json, *solver, *job;
  int repetitions;
};

/* Runs the call several times and keeps the fastest. */
static bool run_best(const struct solver_place *place, int repetitions, struct solver_call *call) {
  struct solver_call best = {.job = NULL};
  bool good = true;
  for (int k = 0; k < repetitions && good; k++) {
    struct solver_call now = *call;
    good = solver_call_run(place, &now, 1, 1);
    if (good && (!best.result || now.end.cpu_s < best.end.cpu_s)) {
      solver_call_release(&best);
      best = now;
    } else {
      solver_call_release(&now);
    }
  }
  *call = best;
  return good;
}

/* A copy of the job with another number of recorded pressures, without the estimate. */
static json_t *short_job(const json_t *job) {
  json_t *copy = json_deep_copy(job);
  json_t *pressure = json_object_get(json_object_get(copy, "load"), "pressure");
  json_object_set_new(pressure, "steps", json_integer(WARM_STEPS));
  json_object_set_new(copy, "error_estimate", json_false());
  return copy;
}

/* Enlarges a length of the actuator, "2 mm" by 0.05 to "2.1 mm". False without such a length. */
static bool enlarge(json_t *job, const char *dimension, double change) {
  json_t *actuator = json_object_get(job, "actuator");
  const char *text = json_string_value(json_object_get(actuator, dimension));
  char *unit = NULL;
  double length = text ? strtod(text, &unit) : 0;
  if (!(length > 0)) {
    fprintf(stderr, "the job gives no %s\n", dimension);
    return false;
  }
  json_t *enlarged = json_sprintf("%.6g%s", (1 + change) * length, unit);
  return json_object_set_new(actuator, dimension, enlarged) == 0;
}

static json_t *run_cold(const struct solver_place *place, const struct arguments *a,
                        const json_t *job) {
  struct solver_call call = {.job = job};
  json_t *figures = NULL;
  if (run_best(place, a->repetitions, &call)) {
    double path = solver_call_path_s(&call);
    double factorizations = solver_call_number(&call, "statistics", "factorizations");
    double estimate = solver_call_number(&call, "statistics", "estimate_s");
    double unknowns = solver_call_number(&call, "statistics", "unknowns");
    printf("cold: %.0f unknowns, %.2f s and %.0f factorisations, estimate %.2f s, process %.2f s, "
           "%.0f MB\n",
           unknowns, path, factorizations, estimate, call.end.cpu_s, 1e-6 * call.end.peak_memory);
    figures = json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "unknowns", unknowns, "path_s", path,
                        "estimate_s", estimate, "process_s", call.end.cpu_s, "factorizations",
                        factorizations, "peak_memory_bytes", call.end.peak_memory);
  }
  solver_call_release(&call);
  return figures;
}

static json_t *neighbour_json(const char *dimension, double change, const struct solver_call *warm,
                              const struct solver_call *cold) {
  double angle = solver_call_number(cold, "metrics", "bending_angle_deg");
  double other = solver_call_number(warm, "metrics", "bending_angle_deg");
  double factors[] = {solver_call_number(warm, "statistics", "factorizations"),
                      solver_call_number(cold, "statistics", "factorizations")};
  const json_t *started =
      json_object_get(json_object_get(warm->result, "statistics"), "warm_start");
  double warm_s = solver_call_path_s(warm), cold_s = solver_call_path_s(cold);
  printf("%-14s +%2.0f %%  warm %6.2f s, %2.0f fact.  cold %6.2f s, %2.0f fact.  %.2f times "
         "faster, angle differs by %.1e%s\n",
         dimension, 100 * change, warm_s, factors[0], cold_s, factors[1], cold_s / warm_s,
         fabs(other / angle - 1), json_is_true(started) ? "" : "  (started anew)");
  return json_pack("{s:s, s:f, s:b, s:f, s:f, s:f, s:f, s:f, s:f}", "dimension", dimension,
                   "change", change, "warm_start", json_is_true(started), "warm_s", warm_s,
                   "cold_s", cold_s, "warm_factorizations", factors[0], "cold_factorizations",
                   factors[1], "bending_angle_deg", angle, "angle_difference",
                   fabs(other / angle - 1));
}

static bool run_neighbour(const struct solver_place *place, const struct arguments *a,
                          const json_t *base, const char *path, int dimension, int change,
                          json_t *list) {
  json_t *job = json_deep_copy(base);
  struct solver_call warm = {.job = job, .option = {"--path-in", path}}, cold = {.job = job};
  bool good = enlarge(job, dimensions[dimension], changes[change]) &&
              run_best(place, a->repetitions, &warm) && run_best(place, a->repetitions, &cold);
  if (good) {
    json_array_append_new(list,
                          neighbour_json(dimensions[dimension], changes[change], &warm, &cold));
  }
  solver_call_release(&warm);
  solver_call_release(&cold);
  json_decref(job);
  return good;
}

static json_t *run_warm(const struct solver_place *place, const struct arguments *a,
                        const json_t *job) {
  char path[CALL_PATH + 16];
  snprintf(path, sizeof path, "%s/path", place->directory);
  json_t *base = short_job(job), *list = json_array();
  struct solver_call first = {.job = base, .option = {"--path-out", path}};
  bool good = solver_call_run(place, &first, 1, 1);
  solver_call_release(&first);
  for (int d = 0; d < (int)(sizeof dimensions / sizeof *dimensions); d++) {
    for (int c = 0; good && c < (int)(sizeof changes / sizeof *changes); c++) {
      good = run_neighbour(place, a, base, path, d, c, list);
    }
  }
  json_decref(base);
  if (!good) {
    json_decref(list);
    list = NULL;
  }
  return list;
}

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'},
                                          {"solver", required_argument, NULL, 'S'},
                                          {"repetitions", required_argument, NULL, 'r'},
                                          {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    if (option == '?') {
      return false;
    }
    a->json = option == 'j' ? optarg : a->json;
    a->solver = option == 'S' ? optarg : a->solver;
    a->repetitions = option == 'r' ? atoi(optarg) : a->repetitions;
  }
  a->job = optind + 1 == argc ? argv[optind] : NULL;
  return a->job && a->repetitions > 0;
}

int main(int argc, char **argv) {
  struct arguments a = {.solver = "./pneulab-solve", .repetitions = 3};
  struct solver_place place;
  json_error_t error;
  if (!parse(argc, argv, &a)) {
    fprintf(stderr, "usage: %s [--json FILE] [--solver PATH] [--repetitions N] JOB.json\n",
            argv[0]);
    return EXIT_FAILURE;
  }
  json_t *job = json_load_file(a.job, 0, &error);
  if (!job) {
    fprintf(stderr, "%s: %s\n", a.job, error.text);
    return EXIT_FAILURE;
  }
  if (!solver_place_create(&place, a.solver, limit_s)) {
    json_decref(job);
    return EXIT_FAILURE;
  }
  json_t *cold = run_cold(&place, &a, job), *warm = cold ? run_warm(&place, &a, job) : NULL;
  bool good = cold && warm;
  if (good && a.json) {
    json_t *document = json_pack("{s:s, s:o, s:O, s:i, s:O}", "program", "bench_warm", "machine",
                                 bench_machine(bench_dgemm_rate()), "cold", cold, "warm_steps",
                                 WARM_STEPS, "neighbours", warm);
    good = bench_write_json(a.json, document);
    json_decref(document);
  }
  json_decref(cold);
  json_decref(warm);
  json_decref(job);
  solver_place_remove(&place);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
