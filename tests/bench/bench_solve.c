/* Where the time of one solve goes, and how close the factorisation comes to the machine.
 *   bench_solve [--json FILE] [--repetitions N] JOB.json
 * Speeds are given as shares of the dgemm rate that the same run measures on one core, so that
 * numbers of different machines compare. */
#include <cblas.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include "solver/base/clock.h"
#include "solver/fe/path.h"
#include "solver/mesh/pneunet.h"
#include "tests/bench/bench.h"

/* Times and counts of one solve. */
struct timing {
  double wall, cpu, setup;
  struct fe_statistics parts;
  struct ldlt_statistics factor;
  int unknowns, elements;
};

static enum status solve(const struct job_spec *spec, struct timing *t, struct error *error) {
  struct mesh mesh = {0};
  struct fe_model *model = NULL;
  struct equilibrium *solver = NULL;
  struct fe_state state = {0};
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  enum status status = pneunet_mesh(spec, &mesh, error);
  if (status != STATUS_OK) {
    goto done;
  }
  status = model_create(&mesh, &spec->material, spec->contact, &model, error);
  if (status != STATUS_OK) {
    goto done;
  }
  status = equilibrium_create(model, &solver, error);
  if (status == STATUS_OK) {
    status = state_create(model, &state);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  t->setup = clock_cpu_s() - cpu;
  solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
  struct path_options path = {.pressure_to = spec->load.pressure_to, .steps = spec->load.steps};
  status = path_follow(solver, &path, &state, error);
  t->wall = clock_wall_s() - wall;
  t->cpu = clock_cpu_s() - cpu;
  t->parts = model->statistics;
  t->factor = ldlt_statistics(model->ldlt);
  t->unknowns = model->dof_count;
  t->elements = mesh.element_count;
done:
  state_release(&state);
  equilibrium_destroy(solver);
  model_destroy(model);
  mesh_release(&mesh);
  return status;
}

static void print_part(const char *name, double seconds, int calls, double total) {
  printf("  %-22s %7.3f s  %5.1f %%", name, seconds, 100 * seconds / total);
  if (calls > 0) {
    printf("  %5d x %.2f ms", calls, 1e3 * seconds / calls);
  }
  printf("\n");
}

static void print_timing(const struct timing *t, double rate) {
  const struct fe_statistics *p = &t->parts;
  double known = p->assembly_s + p->residual_s + p->factor_s + p->solve_s + p->contact_s;
  double factor_rate = t->factor.flops * p->factorizations / p->factor_s;
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  printf("%d elements, %d unknowns\n", t->elements, t->unknowns);
  printf("wall %.3f s, cpu %.3f s, %d factorisations, %d analyses\n", t->wall, t->cpu,
         p->factorizations, p->analyses);
  print_part("mesh and analysis", t->setup, 0, t->cpu);
  print_part("assembly", p->assembly_s, p->assemblies, t->cpu);
  print_part("residual", p->residual_s, p->residuals, t->cpu);
  print_part("factorisation", p->factor_s, p->factorizations, t->cpu);
  print_part("solution", p->solve_s, p->solves, t->cpu);
  print_part("contact", p->contact_s, 0, t->cpu);
  print_part("other", t->cpu - known - t->setup, 0, t->cpu);
  printf("factor: %.3g Gflop, %.3g million entries, largest front %d\n", 1e-9 * t->factor.flops,
         1e-6 * (double)t->factor.factor_entries, t->factor.largest_front);
  printf("factorisation %.2f Gflop/s = %.2f of dgemm (%.1f Gflop/s)\n", 1e-9 * factor_rate,
         factor_rate / rate, 1e-9 * rate);
  printf("factorisations at the dgemm rate over cpu time: %.3f\n",
         p->factorizations * t->factor.flops / rate / t->cpu);
  printf("peak memory %.1f MB\n", (double)usage.ru_maxrss / 1024);
}

static json_t *timing_json(const struct timing *t, double rate) {
  const struct fe_statistics *p = &t->parts;
  double known = t->setup + p->assembly_s + p->residual_s + p->factor_s + p->solve_s + p->contact_s;
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  json_t *parts =
      json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "setup_s", t->setup, "assembly_s",
                p->assembly_s, "residual_s", p->residual_s, "factor_s", p->factor_s, "solve_s",
                p->solve_s, "contact_s", p->contact_s, "other_s", t->cpu - known);
  return json_pack("{s:i, s:i, s:f, s:f, s:i, s:i, s:f, s:f, s:i, s:f, s:f, s:f, s:o}", "elements",
                   t->elements, "unknowns", t->unknowns, "wall_s", t->wall, "cpu_s", t->cpu,
                   "factorizations", p->factorizations, "analyses", p->analyses, "flops",
                   t->factor.flops, "factor_entries", (double)t->factor.factor_entries,
                   "largest_front", t->factor.largest_front, "factor_dgemm_share",
                   t->factor.flops * p->factorizations / p->factor_s / rate, "limit_share",
                   p->factorizations * t->factor.flops / rate / t->cpu, "peak_memory_bytes",
                   1024 * (double)usage.ru_maxrss, "parts", parts);
}

struct arguments {
  const char *json, *job;
  long repetitions;
};

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {
      {"json", required_argument, NULL, 'j'}, {"repetitions", required_argument, NULL, 'r'}, {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    if (option == '?') {
      return false;
    }
    a->json = option == 'j' ? optarg : a->json;
    a->repetitions = option == 'r' ? strtol(optarg, NULL, 10) : a->repetitions;
  }
  a->job = optind + 1 == argc ? argv[optind] : NULL;
  return a->job && a->repetitions > 0;
}

int main(int argc, char **argv) {
  struct arguments a = {.repetitions = 3};
  struct job_spec spec;
  if (!parse(argc, argv, &a)) {
    fprintf(stderr, "usage: %s [--json FILE] [--repetitions N] JOB.json\n", argv[0]);
    return EXIT_FAILURE;
  }
  if (!bench_read_job(a.job, &spec)) {
    return EXIT_FAILURE;
  }
  openblas_set_num_threads(1);
  double rate = bench_dgemm_rate();
  struct timing best = {.cpu = INFINITY};
  for (long k = 0; k < a.repetitions; k++) {
    struct timing t = {0};
    struct error error = {0};
    enum status status = solve(&spec, &t, &error);
    if (status != STATUS_OK) {
      fprintf(stderr, "%s: %s\n", status_word(status), error.message);
      return EXIT_FAILURE;
    }
    best = t.cpu < best.cpu ? t : best;
  }
  rate = fmax(rate, bench_dgemm_rate());
  printf("%s, best of %ld\n", spec.name, a.repetitions);
  print_timing(&best, rate);
  bool good = true;
  if (a.json) {
    json_t *document = json_pack("{s:s, s:s, s:o, s:o}", "program", "bench_solve", "job", spec.name,
                                 "machine", bench_machine(rate), "solve", timing_json(&best, rate));
    good = bench_write_json(a.json, document);
    json_decref(document);
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
