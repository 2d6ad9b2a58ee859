/* How time and memory grow with the number of unknowns.
 *   bench_scaling [--json FILE] [--limit UNKNOWNS] [--solve-limit UNKNOWNS] JOB.json
 * The job's body with more elements, with more chambers, and with both. Each point runs in a
 * process of its own, so that its peak memory is its own. One step (assembly, factorisation,
 * solution) is taken in the undeformed state, the best of three; the whole solve follows the
 * job's load path. Exponents are least-squares slopes of log(figure) over log(unknowns). */
#include <cblas.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include "solver/base/clock.h"
#include "solver/fe/path.h"
#include "solver/mesh/pneunet.h"
#include "tests/bench/bench.h"

enum { SERIES_LENGTH = 16, ATTEMPTS = 3, UNKNOWNS_MAX = 1000000, SOLVE_UNKNOWNS_MAX = 60000 };

enum figure {
  FIGURE_SETUP,
  FIGURE_ASSEMBLY,
  FIGURE_FACTOR,
  FIGURE_SOLVE,
  FIGURE_STEP, /* assembly + factor + solve */
  FIGURE_STEP_MEMORY,
  FIGURE_FLOPS,
  FIGURE_ENTRIES,
  FIGURE_PATH,
  FIGURE_COUNT
};

static const char *const figure_names[FIGURE_COUNT] = {
    "setup_s",           "assembly_s", "factor_s",       "solve_s",      "step_s",
    "peak_memory_bytes", "flops",      "factor_entries", "whole_solve_s"};

/* What one process measures and sends back. */
struct point {
  int unknowns, factorizations;
  double figure[FIGURE_COUNT]; /* 0: not measured */
  double pressure;             /* reached by the whole solve, Pa */
  enum status status;          /* of the whole solve */
};

struct series {
  const char *name;
  int count;
  struct {
    int unknowns; /* about */
    struct bench_size size;
  } point[SERIES_LENGTH];
};

/* chambers, then gap_wall, cavity, gap, half_width, side_wall, bottom, height, top */
static const struct series all_series[] = {
    {"refinement",
     7,
     {{11000, {12, {1, 1, 1, 1, 1, 1, 2, 1}}},
      {20000, {12, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {35000, {12, {2, 1, 1, 2, 1, 2, 3, 1}}},
      {58000, {12, {2, 1, 1, 2, 2, 2, 4, 1}}},
      {99000, {12, {2, 2, 1, 3, 2, 2, 6, 2}}},
      {150000, {12, {2, 2, 1, 4, 2, 3, 8, 2}}},
      {300000, {12, {4, 2, 2, 4, 2, 4, 9, 2}}}}},
    {"chambers",
     6,
     {{5000, {3, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {10000, {6, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {20000, {12, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {40000, {24, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {80000, {48, {2, 1, 1, 1, 1, 1, 3, 1}}},
      {107000, {64, {2, 1, 1, 1, 1, 1, 3, 1}}}}},
    {"both",
     4,
     {{6000, {6, {1, 1, 1, 1, 1, 1, 3, 1}}},
      {29000, {18, {1, 1, 1, 2, 1, 1, 3, 1}}},
      {87000, {24, {2, 1, 1, 2, 2, 2, 3, 1}}},
      {230000, {48, {2, 1, 1, 2, 2, 2, 4, 1}}}}},
};

/* Assembly, factorisation and solution in the undeformed state, the best of each. */
static enum status measure_step(struct fe_model *m, const struct job_spec *spec,
                                struct point *point) {
  struct fe_state state = {0};
  double *figure = point->figure, *x = calloc((size_t)m->dof_count, sizeof *x);
  enum status status = x ? state_create(m, &state) : STATUS_NO_MEMORY;
  const struct fe_load load = {spec->load.pressure_to, spec->load.pressure_to, 0};
  for (int k = 0; status == STATUS_OK && k < ATTEMPTS; k++) {
    double start = clock_cpu_s();
    status = model_evaluate(m, &state, &load, true);
    double assembled = clock_cpu_s();
    model_factor(m);
    double factored = clock_cpu_s();
    model_solve(m, m->residual, x);
    double solved = clock_cpu_s();
    figure[FIGURE_ASSEMBLY] = fmin(k ? figure[FIGURE_ASSEMBLY] : INFINITY, assembled - start);
    figure[FIGURE_FACTOR] = fmin(k ? figure[FIGURE_FACTOR] : INFINITY, factored - assembled);
    figure[FIGURE_SOLVE] = fmin(k ? figure[FIGURE_SOLVE] : INFINITY, solved - factored);
  }
  figure[FIGURE_STEP] = figure[FIGURE_ASSEMBLY] + figure[FIGURE_FACTOR] + figure[FIGURE_SOLVE];
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  figure[FIGURE_STEP_MEMORY] = 1024 * (double)usage.ru_maxrss;
  figure[FIGURE_FLOPS] = ldlt_statistics(m->ldlt).flops;
  figure[FIGURE_ENTRIES] = (double)ldlt_statistics(m->ldlt).factor_entries;
  state_release(&state);
  free(x);
  return status;
}

static enum status keep_pressure(void *context, const struct path_point *point) {
  ((struct point *)context)->pressure = point->pressure;
  return STATUS_OK;
}

static enum status measure_path(struct fe_model *m, const struct job_spec *spec,
                                struct point *point, struct error *error) {
  struct equilibrium *solver = NULL;
  struct fe_state state = {0};
  int before = m->statistics.factorizations;
  double start = clock_cpu_s();
  enum status status = equilibrium_create(m, &solver, error);
  if (status == STATUS_OK) {
    status = state_create(m, &state);
  }
  if (status == STATUS_OK) {
    solver->options.traction_tolerance = 0.01 * spec->load.pressure_to;
    struct path_options path = {.pressure_to = spec->load.pressure_to,
                                .steps = spec->load.steps,
                                .visit = keep_pressure,
                                .context = point};
    point->status = path_follow(solver, &path, &state, error);
    point->figure[FIGURE_PATH] = point->figure[FIGURE_SETUP] + clock_cpu_s() - start;
    point->factorizations = m->statistics.factorizations - before;
  }
  state_release(&state);
  equilibrium_destroy(solver);
  return status;
}

static enum status measure(const struct job_spec *spec, long solve_limit, struct point *point) {
  struct mesh mesh = {0};
  struct fe_model *model = NULL;
  struct error error = {0};
  double start = clock_cpu_s();
  enum status status = pneunet_mesh(spec, &mesh, &error);
  if (status == STATUS_OK) {
    status = model_create(&mesh, &spec->material, spec->contact, &model, &error);
  }
  if (status != STATUS_OK) {
    goto done;
  }
  point->figure[FIGURE_SETUP] = clock_cpu_s() - start;
  point->unknowns = model->dof_count;
  status = measure_step(model, spec, point);
  if (status == STATUS_OK && model->dof_count <= solve_limit) {
    status = measure_path(model, spec, point, &error);
  }
done:
  if (status != STATUS_OK) {
    fprintf(stderr, "%s: %s\n", status_word(status), error.message);
  }
  model_destroy(model);
  mesh_release(&mesh);
  return status;
}

/* Measures in a child process. */
static bool measure_apart(const struct job_spec *spec, long solve_limit, struct point *point) {
  int ends[2], outcome = 0;
  fflush(stdout);
  if (pipe(ends) != 0) {
    perror("pipe");
    return false;
  }
  pid_t child = fork();
  if (child == 0) {
    struct point found = {0};
    bool sent = measure(spec, solve_limit, &found) == STATUS_OK &&
                write(ends[1], &found, sizeof found) == (ssize_t)sizeof found;
    _exit(sent ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  close(ends[1]);
  bool received = child > 0 && read(ends[0], point, sizeof *point) == (ssize_t)sizeof *point;
  close(ends[0]);
  return child > 0 && waitpid(child, &outcome, 0) == child && received;
}

/* Slope of log(figure) over log(unknowns); NAN below three points. */
static double exponent(const struct point *points, int count, enum figure figure) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int k = 0; k < count; k++) {
    const struct point *p = &points[k];
    if (p->figure[figure] > 0 && p->status == STATUS_OK) {
      double u = log(p->unknowns), v = log(p->figure[figure]);
      n++;
      x += u;
      y += v;
      xx += u * u;
      xy += u * v;
    }
  }
  return n >= 3 ? (n * xy - x * y) / (n * xx - x * x) : NAN;
}

static json_t *point_json(const struct bench_size *size, const struct point *p) {
  const struct mesh_spec *m = &size->mesh;
  json_t *mesh =
      json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:i}", "gap_wall", m->gap_wall, "cavity",
                m->cavity, "gap", m->gap, "half_width", m->half_width, "side_wall", m->side_wall,
                "bottom", m->bottom, "height", m->height, "top", m->top);
  json_t *json = json_pack("{s:i, s:i, s:o}", "unknowns", p->unknowns, "chambers", size->chambers,
                           "mesh", mesh);
  for (int f = 0; json && f < FIGURE_COUNT; f++) {
    if (p->figure[f] > 0) {
      json_object_set_new(json, figure_names[f], json_real(p->figure[f]));
    }
  }
  if (json && p->figure[FIGURE_PATH] > 0) {
    json_object_set_new(json, "factorizations", json_integer(p->factorizations));
    json_object_set_new(json, "reached_kPa", json_real(1e-3 * p->pressure));
    json_object_set_new(json, "status", json_string(status_word(p->status)));
  }
  return json;
}

static void print_point(const struct bench_size *size, const struct point *p) {
  const double *f = p->figure;
  printf("  %8d %8d %8.3f %9.4f %9.4f %9.4f %9.4f %8.2f %7.1f %6.0f", p->unknowns, size->chambers,
         f[FIGURE_SETUP], f[FIGURE_ASSEMBLY], f[FIGURE_FACTOR], f[FIGURE_SOLVE], f[FIGURE_STEP],
         1e-9 * f[FIGURE_FLOPS], 1e-6 * f[FIGURE_STEP_MEMORY], f[FIGURE_STEP_MEMORY] / p->unknowns);
  if (f[FIGURE_PATH] > 0) {
    printf(" %8.2f %5d %s", f[FIGURE_PATH], p->factorizations, status_word(p->status));
    printf(" %.4g kPa", 1e-3 * p->pressure);
  }
  printf("\n");
}

static json_t *run_series(const struct job_spec *job, const struct series *s, long limit,
                          long solve_limit) {
  struct point points[SERIES_LENGTH];
  json_t *list = json_array(), *exponents = json_object();
  int count = 0;
  printf("\n%s\n  %8s %8s %8s %9s %9s %9s %9s %8s %7s %6s %8s %5s\n", s->name, "unknowns",
         "chambers", "setup s", "assembly", "factor", "solve", "step s", "Gflop", "MB", "B/unk.",
         "path s", "fac.");
  for (int k = 0; k < s->count && s->point[k].unknowns <= limit; k++) {
    const struct bench_size *size = &s->point[k].size;
    struct job_spec spec = bench_resize(job, size);
    if (!measure_apart(&spec, solve_limit, &points[count])) {
      fprintf(stderr, "%s: point %d was not measured\n", s->name, k);
      continue;
    }
    print_point(size, &points[count]);
    json_array_append_new(list, point_json(size, &points[count++]));
  }
  printf("  exponents:");
  for (int f = 0; f < FIGURE_COUNT; f++) {
    double slope = exponent(points, count, (enum figure)f);
    if (!isnan(slope)) {
      printf(" %s %.2f", figure_names[f], slope);
      json_object_set_new(exponents, figure_names[f], json_real(slope));
    }
  }
  printf("\n");
  return json_pack("{s:s, s:o, s:o}", "name", s->name, "points", list, "exponents", exponents);
}

int main(int count, char **argument) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'},
                                          {"limit", required_argument, NULL, 'l'},
                                          {"solve-limit", required_argument, NULL, 's'},
                                          {0}};
  const char *path = NULL;
  long limit = UNKNOWNS_MAX, solve_limit = SOLVE_UNKNOWNS_MAX;
  struct job_spec job;
  openblas_set_num_threads(1);
  for (int c; (c = getopt_long(count, argument, "", options, NULL)) != -1;) {
    if (c == '?') {
      return EXIT_FAILURE;
    }
    path = c == 'j' ? optarg : path;
    limit = c == 'l' ? strtol(optarg, NULL, 10) : limit;
    solve_limit = c == 's' ? strtol(optarg, NULL, 10) : solve_limit;
  }
  if (optind + 1 != count) {
    fprintf(stderr, "usage: %s [--json FILE] [--limit N] [--solve-limit N] JOB.json\n",
            argument[0]);
    return EXIT_FAILURE;
  }
  if (!bench_read_job(argument[optind], &job)) {
    return EXIT_FAILURE;
  }
  json_t *list = json_array();
  json_t *document = json_pack("{s:s, s:s, s:o, s:O}", "program", "bench_scaling", "job", job.name,
                               "machine", bench_machine(bench_dgemm_rate()), "series", list);
  bool done = document != NULL;
  for (size_t k = 0; done && k < sizeof all_series / sizeof *all_series; k++) {
    json_array_append_new(list, run_series(&job, &all_series[k], limit, solve_limit));
    done = !path || bench_write_json(path, document);
  }
  json_decref(list);
  json_decref(document);
  return done ? EXIT_SUCCESS : EXIT_FAILURE;
}
