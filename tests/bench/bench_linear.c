/* Linear solvers on the tangents of pneu-nets.
 *   bench_linear [--json FILE] [--limit UNKNOWNS] JOB.json
 * The bodies are the job's with other numbers of elements; each is brought into equilibrium
 * under the job's material, half its pressure, with and without contact, by following the load
 * path; the matrix is the tangent of that state, touching pairs included. The case `load
 * stiffness` takes the pressure's part of the tangent many times too large, as steps far from
 * equilibrium do: it is indefinite. Every solver analyses the pattern with all pairs that may
 * touch, once, and runs on one thread; times are CPU times, the best of several. */
#include <cblas.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>
#include <unistd.h>
#include "tests/bench/linear_solvers.h"

enum { RUNS_MAX = 32, UNKNOWNS_MAX = 1000000 };

struct bench_case {
  const char *name;
  int unknowns; /* about; cases above the limit are left out */
  struct bench_size size;
  bool contact;
  double stiffness_factor;
};

/* gap_wall, cavity, gap, half_width, side_wall, bottom, height, top */
#define MESH_10K                                                                                   \
  {                                                                                                \
    0, {                                                                                           \
      1, 1, 1, 1, 1, 1, 2, 1                                                                       \
    }                                                                                              \
  }
#define MESH_20K                                                                                   \
  {                                                                                                \
    0, {                                                                                           \
      2, 1, 1, 1, 1, 1, 3, 1                                                                       \
    }                                                                                              \
  }
#define MESH_50K                                                                                   \
  {                                                                                                \
    0, {                                                                                           \
      2, 1, 1, 2, 2, 2, 4, 1                                                                       \
    }                                                                                              \
  }
#define MESH_150K                                                                                  \
  {                                                                                                \
    0, {                                                                                           \
      2, 2, 1, 4, 2, 3, 8, 2                                                                       \
    }                                                                                              \
  }

static const struct bench_case cases[] = {
    {"10k", 10000, MESH_10K, false, 1},
    {"10k, contact", 10000, MESH_10K, true, 1},
    {"20k", 20000, MESH_20K, false, 1},
    {"20k, contact", 20000, MESH_20K, true, 1},
    {"20k, contact, load stiffness x 30", 20000, MESH_20K, true, 30},
    {"50k", 50000, MESH_50K, false, 1},
    {"50k, contact", 50000, MESH_50K, true, 1},
    {"150k", 150000, MESH_150K, false, 1},
    {"150k, contact", 150000, MESH_150K, true, 1},
};

static const struct cholmod_choice cholmod_choices[] = {
    {"super LL' AMD", CHOLMOD_AMD, true, {0}, {0}},
    {"super LL' METIS", CHOLMOD_METIS, true, {0}, {0}},
    {"super LL' AMD relaxed", CHOLMOD_AMD, true, {12, 48, 144}, {0.9, 0.3, 0.1}},
    {"super LL' METIS relaxed", CHOLMOD_METIS, true, {12, 48, 144}, {0.9, 0.3, 0.1}},
    {"simplicial LDL' AMD", CHOLMOD_AMD, false, {0}, {0}},
};

/* MUMPS 5.5 orders element input by AMD only, unless it is given an order. */
static const struct mumps_choice mumps_choices[] = {
    {"elements AMD", MUMPS_ORDER_AMD, true, 0.01},
    {"elements METIS", MUMPS_ORDER_GIVEN, true, 0.01},
    {"elements AMD, no pivoting", MUMPS_ORDER_AMD, true, 0},
    {"assembled AMD", MUMPS_ORDER_AMD, false, 0.01},
    {"assembled AMF", MUMPS_ORDER_AMF, false, 0.01},
    {"assembled PORD", MUMPS_ORDER_PORD, false, 0.01},
    {"assembled METIS", MUMPS_ORDER_GIVEN, false, 0.01},
};

static double whole(const struct linear_figures *f) {
  return f->gather_s + f->factor_s + f->solve_s;
}

static void print_run(const struct linear_figures *f, const struct linear_figures *best,
                      double rate) {
  printf("  %-8s %-26s ", f->solver, f->variant);
  if (!f->solved) {
    printf("%s\n", f->note[0] ? f->note : "not solved");
    return;
  }
  char negative[16] = "-";
  if (f->negative >= 0) {
    snprintf(negative, sizeof negative, "%d", f->negative);
  }
  printf("%8.1f %7.1f %8.1f %7.2f %6.2f %6.1f %5.2f %7.0f %5s %8.1e %6.2f %6.2f\n",
         1e3 * f->analysis_s, 1e3 * f->gather_s, 1e3 * f->factor_s, 1e3 * f->solve_s,
         1e-9 * f->flops, 1e-9 * f->flops / f->factor_s, f->flops / f->factor_s / rate,
         1e-6 * f->memory, negative, f->residual, f->factor_s / best->factor_s,
         whole(f) / whole(best));
}

static void print_table(const struct linear_figures *runs, int count, double rate) {
  struct linear_figures best = {.factor_s = INFINITY, .solve_s = INFINITY};
  for (int k = 0; k < count; k++) {
    if (runs[k].solved && runs[k].factor_s < best.factor_s) {
      best.factor_s = runs[k].factor_s;
    }
  }
  double least = INFINITY;
  for (int k = 0; k < count; k++) {
    least = runs[k].solved ? fmin(least, whole(&runs[k])) : least;
  }
  best.solve_s = least - best.factor_s;
  printf("  %-8s %-26s %8s %7s %8s %7s %6s %6s %5s %7s %5s %8s %6s %6s\n", "", "", "analysis",
         "gather", "factor", "solve", "Gflop", "Gf/s", "dgemm", "memory", "neg.", "residual",
         "factor", "all");
  printf("  %-8s %-26s %8s %7s %8s %7s %6s %6s %5s %7s %5s %8s %6s %6s\n", "", "", "ms", "ms", "ms",
         "ms", "", "", "share", "MB", "", "", "/best", "/best");
  for (int k = 0; k < count; k++) {
    print_run(&runs[k], &best, rate);
  }
}

static json_t *run_json(const struct linear_figures *f, double rate) {
  json_t *run = json_pack("{s:s, s:s, s:b, s:s}", "solver", f->solver, "variant", f->variant,
                          "solved", f->solved, "note", f->note);
  if (run && f->solved) {
    json_t *figures =
        json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "analysis_s", f->analysis_s,
                  "gather_s", f->gather_s, "factor_s", f->factor_s, "solve_s", f->solve_s,
                  "residual", f->residual, "flops", f->flops, "flop_s", f->flops / f->factor_s,
                  "dgemm_share", f->flops / f->factor_s / rate, "memory_bytes", f->memory);
    json_object_update_new(run, figures);
    json_object_set_new(run, "negative_pivots",
                        f->negative >= 0 ? json_integer(f->negative) : json_null());
  }
  return run;
}

static int run_all(const struct linear_problem *problem, struct linear_matrix *matrix,
                   struct linear_figures *runs) {
  int count = 0;
  linear_run_own(problem, &runs[count++]);
  for (size_t k = 0; k < sizeof cholmod_choices / sizeof *cholmod_choices; k++) {
    linear_run_cholmod(problem, matrix, &cholmod_choices[k], &runs[count++]);
  }
  for (size_t k = 0; k < sizeof mumps_choices / sizeof *mumps_choices; k++) {
    linear_run_mumps(problem, matrix, &mumps_choices[k], &runs[count++]);
  }
  return count;
}

/* Runs one case; its JSON goes to the end of `list`. */
static bool run_case(const struct job_spec *job, const struct bench_case *c, json_t *list) {
  struct job_spec spec = bench_resize(job, &c->size);
  struct linear_problem problem = {0};
  struct linear_matrix matrix = {0};
  struct linear_figures runs[RUNS_MAX] = {0};
  struct error error = {0};
  spec.load.pressure_to *= 0.5;
  spec.load.steps = 2;
  enum status status =
      linear_problem_create(&spec, c->contact, c->stiffness_factor, &problem, &error);
  if (status == STATUS_OK) {
    status = linear_matrix_create(&problem, &matrix);
  }
  if (status != STATUS_OK) {
    fprintf(stderr, "%s: %s %s\n", c->name, status_word(status), error.message);
    linear_problem_release(&problem);
    return false;
  }
  double rate = bench_dgemm_rate();
  int count = run_all(&problem, &matrix, runs);
  rate = fmax(rate, bench_dgemm_rate());
  int unknowns = problem.model->dof_count, entries = matrix.start[matrix.order];
  printf("\n%s: %d unknowns, %.2f million entries (lower), %d cliques, %d of them contact in "
         "touch; %.4g kPa%s after %d factorisations; dgemm %.1f Gf/s\n",
         c->name, unknowns, 1e-6 * entries, problem.clique_count, problem.touching,
         1e-3 * problem.pressure, problem.reached ? "" : " (stopped there)", problem.factorizations,
         1e-9 * rate);
  print_table(runs, count, rate);
  fflush(stdout);
  json_t *results = json_array();
  for (int k = 0; k < count; k++) {
    json_array_append_new(results, run_json(&runs[k], rate));
  }
  json_array_append_new(
      list, json_pack("{s:s, s:i, s:i, s:i, s:i, s:b, s:f, s:f, s:b, s:f, s:o}", "name", c->name,
                      "unknowns", unknowns, "entries", entries, "cliques", problem.clique_count,
                      "touching_pairs", problem.touching, "contact", c->contact, "pressure_kPa",
                      1e-3 * problem.pressure, "load_stiffness_factor", c->stiffness_factor,
                      "reached", problem.reached, "dgemm_flop_s", rate, "runs", results));
  linear_matrix_release(&matrix);
  linear_problem_release(&problem);
  return true;
}

/* CHOLMOD asks OpenMP for four threads of its own accord; the limit that stops it is read when a
 * program starts, so this one starts itself again with the limit set. */
static void limit_threads(char **argument) {
  if (!getenv("OMP_THREAD_LIMIT")) {
    setenv("OMP_THREAD_LIMIT", "1", 1);
    execv("/proc/self/exe", argument);
    perror("OMP_THREAD_LIMIT");
  }
  openblas_set_num_threads(1);
}

int main(int count, char **argument) {
  static const struct option options[] = {
      {"json", required_argument, NULL, 'j'}, {"limit", required_argument, NULL, 'l'}, {0}};
  const char *path = NULL;
  long limit = UNKNOWNS_MAX;
  limit_threads(argument);
  for (int c; (c = getopt_long(count, argument, "", options, NULL)) != -1;) {
    if (c == '?') {
      return EXIT_FAILURE;
    }
    path = c == 'j' ? optarg : path;
    limit = c == 'l' ? strtol(optarg, NULL, 10) : limit;
  }
  struct job_spec job;
  if (optind + 1 != count) {
    fprintf(stderr, "usage: %s [--json FILE] [--limit UNKNOWNS] JOB.json\n", argument[0]);
    return EXIT_FAILURE;
  }
  if (!bench_read_job(argument[optind], &job)) {
    return EXIT_FAILURE;
  }
  json_t *list = json_array();
  json_t *document = json_pack("{s:s, s:s, s:o, s:O}", "program", "bench_linear", "job", job.name,
                               "machine", bench_machine(bench_dgemm_rate()), "cases", list);
  bool done = document != NULL;
  for (size_t k = 0; done && k < sizeof cases / sizeof *cases; k++) {
    /* The file is renewed after every case: the last ones take minutes. */
    done = cases[k].unknowns > limit ||
           (run_case(&job, &cases[k], list) && (!path || bench_write_json(path, document)));
  }
  json_decref(list);
  json_decref(document);
  return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
