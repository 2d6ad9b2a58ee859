/* What derivatives cost at a state with contact.
 *   bench_sensitivity [--json FILE] JOB.json
 * Solves the job to its last pressure, then differentiates all metrics there, once by one
 * parameter and once by all of them: the difference is the price of one more parameter, the rest
 * that of the state (settling, factorisation, one adjoint solution a metric). */
#include <cblas.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "solver/base/clock.h"
#include "solver/fe/path.h"
#include "solver/job/parameter.h"
#include "solver/mesh/pneunet.h"
#include "solver/post/result_sensitivity.h"
#include "tests/bench/bench.h"

enum { REPETITIONS = 3 };

struct body {
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
};

static enum status solve(const struct job_spec *spec, struct body *b, struct error *error) {
  enum status status = pneunet_mesh(spec, &b->mesh, error);
  if (status == STATUS_OK) {
    status = model_create(&b->mesh, &spec->material, spec->contact, &b->model, error);
  }
  if (status == STATUS_OK) {
    model_add_gravity(b->model, spec->load.gravity);
    status = equilibrium_create(b->model, &b->solver, error);
  }
  if (status == STATUS_OK) {
    status = state_create(b->model, &b->state);
  }
  if (status != STATUS_OK) {
    return status;
  }
  const double *g = spec->load.gravity;
  b->solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
  struct path_options path = {.pressure_to = spec->load.pressure_to,
                              .steps = spec->load.steps,
                              .dead_load = g[0] != 0 || g[1] != 0 || g[2] != 0};
  return path_follow(b->solver, &path, &b->state, error);
}

static void release(struct body *b) {
  state_release(&b->state);
  equilibrium_destroy(b->solver);
  model_destroy(b->model);
  mesh_release(&b->mesh);
}

/* Times of the derivatives by the parameters of the spec, CPU s. */
struct cost {
  double create; /* model, analysis, variants of the mesh: once a job */
  double state;  /* best of some repetitions */
};

static enum status differentiate(const struct job_spec *spec, const struct body *b,
                                 struct cost *cost, struct error *error) {
  struct result_sensitivity *r;
  double start = clock_cpu_s();
  enum status status = result_sensitivity_create(spec, b->model, &r, error);
  cost->create = clock_cpu_s() - start;
  cost->state = INFINITY;
  struct path_point point = {
      .pressure = spec->load.pressure_to, .dead = 1, .recorded = true, .state = &b->state};
  for (int k = 0; status == STATUS_OK && k < REPETITIONS && k <= spec->load.steps; k++) {
    start = clock_cpu_s();
    status = result_sensitivity_add(r, &point);
    cost->state = fmin(cost->state, clock_cpu_s() - start);
  }
  result_sensitivity_destroy(r);
  return status;
}

static json_t *report(const struct body *b, int count, const struct cost *one,
                      const struct cost *all) {
  double parameter = (all->state - one->state) / (count - 1), fixed = one->state - parameter;
  double create = (all->create - one->create) / (count - 1);
  int touching = contact_summarise(&b->model->contact).active;
  printf("%d unknowns, %d points in contact, %d parameters\n", b->model->dof_count, touching,
         count);
  printf("  per state              %7.1f ms  (settling, factorisation, adjoint solutions)\n",
         1e3 * fixed);
  printf("  per parameter          %7.1f ms  (all metrics)\n", 1e3 * parameter);
  printf("  mean of a derivative   %7.1f ms  (state and parameters together)\n",
         1e3 * all->state / count);
  printf("  once per job           %7.1f ms  and %.1f ms a parameter\n",
         1e3 * (one->create - create), 1e3 * create);
  return json_pack("{s:i, s:i, s:i, s:f, s:f, s:f, s:f, s:f}", "unknowns", b->model->dof_count,
                   "contact_points", touching, "parameters", count, "state_s", fixed, "parameter_s",
                   parameter, "mean_s", all->state / count, "once_s", one->create - create,
                   "once_parameter_s", create);
}

static const char *read_arguments(int argc, char **argv, const char **json) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'}, {0}};
  int option;
  *json = NULL;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    if (option != 'j') {
      return NULL;
    }
    *json = optarg;
  }
  return optind + 1 == argc ? argv[optind] : NULL;
}

int main(int argc, char **argv) {
  const char *json, *job = read_arguments(argc, argv, &json);
  struct job_spec spec;
  struct body body = {0};
  struct error error = {0};
  struct cost one, all;
  if (!job) {
    fprintf(stderr, "usage: bench_sensitivity [--json FILE] JOB.json\n");
    return EXIT_FAILURE;
  }
  openblas_set_num_threads(1);
  if (!bench_read_job(job, &spec)) {
    return EXIT_FAILURE;
  }
  spec.sensitivity.count = parameter_list(&spec, spec.sensitivity.parameter);
  struct job_spec single = spec;
  single.sensitivity.count = 1;
  enum status status = solve(&spec, &body, &error);
  if (status == STATUS_OK) {
    status = differentiate(&single, &body, &one, &error);
  }
  if (status == STATUS_OK) {
    status = differentiate(&spec, &body, &all, &error);
  }
  bool good = status == STATUS_OK;
  if (good) {
    json_t *figures = report(&body, spec.sensitivity.count, &one, &all);
    json_t *document = json_pack("{s:o, s:o}", "machine", bench_machine(bench_dgemm_rate()),
                                 "sensitivity", figures);
    good = !json || bench_write_json(json, document);
    json_decref(document);
  } else {
    fprintf(stderr, "%s: %s %s\n", job, status_word(status), error.message);
  }
  release(&body);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
