/* What the simulation of a hybrid model costs, alone and beside Octave's ode45.
 *   bench_hybrid [--json FILE] [--script FILE] [--repetitions N] JOB.json
 * The job's model is taken through eight steps of 1 psi, 5 s each, at a tolerance of 1e-9, with
 * samples at 120 Hz and without; the shortest of N runs counts. Errors are those against a
 * tolerance of 1e-13. Then `octave` runs the script (ode45_hybrid.m) on the same problem at a
 * tolerance of 1e-8, three times; without octave (Debian: octave) that is left out and says so.
 * Times are CPU times. */
#include <cblas.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "solver/base/clock.h"
#include "solver/hlpv/check.h"
#include "solver/hlpv/simulate.h"
#include "tests/bench/bench.h"

enum { STEPS = 8, OCTAVE_RUNS = 3, PATH_SIZE = 4096 };

#define PSI 6894.757293168361

static const double tolerance = 1e-9, octave_tolerance = 1e-8, fine_tolerance = 1e-13;
static const double end_s = 40, rate_Hz = 120;

/* ---- our own ------------------------------------------------------------------------------ */

/* The profile in place of the job's. */
static bool set_profile(struct hlpv_spec *spec) {
  free(spec->input.time);
  free(spec->input.value);
  spec->input = (struct hlpv_input){.profile = HLPV_HELD,
                                    .count = STEPS,
                                    .time = calloc(STEPS, sizeof(double)),
                                    .value = calloc(STEPS, sizeof(double))};
  if (!spec->input.time || !spec->input.value) {
    return false;
  }
  for (int i = 0; i < STEPS; i++) {
    spec->input.time[i] = i * end_s / STEPS;
    spec->input.value[i] = (i + 1) * PSI;
  }
  spec->end = end_s;
  spec->sample_rate = rate_Hz;
  return true;
}

/* The shortest of some runs; the trajectory of the last one is the caller's. False when it does not
 * come to its end. */
static bool measure(const struct hlpv_spec *spec, bool samples, long repetitions, double *shortest,
                    struct hlpv_trajectory *trajectory) {
  struct hlpv_options options = {.no_samples = !samples};
  struct error error;
  *shortest = INFINITY;
  *trajectory = (struct hlpv_trajectory){0};
  for (long k = 0; k < repetitions; k++) {
    hlpv_trajectory_release(trajectory);
    double start = clock_cpu_s();
    if (hlpv_simulate(spec, &options, trajectory, &error) != STATUS_OK) {
      fprintf(stderr, "%s\n", error.message);
      return false;
    }
    *shortest = fmin(*shortest, clock_cpu_s() - start);
  }
  return true;
}

/* How far two runs are apart: states at the end relative to their sizes, and switches. */
struct apart {
  double state, event_s;
};

static struct apart compare(const struct hlpv_trajectory *exact, const double x[HLPV_STATES],
                            const double *switches, size_t count) {
  struct apart apart = {0, exact->event_count == count ? 0 : INFINITY};
  for (int i = 0; i < HLPV_STATES; i++) {
    double size = fmax(fabs(exact->lowest[i]), fabs(exact->highest[i]));
    apart.state = fmax(apart.state, fabs(x[i] - exact->x[i]) / size);
  }
  for (size_t i = 0; i < count && i < exact->event_count; i++) {
    apart.event_s = fmax(apart.event_s, fabs(switches[i] - exact->event[i].time));
  }
  return apart;
}

static struct apart compare_own(const struct hlpv_trajectory *exact,
                                const struct hlpv_trajectory *t) {
  double *switches = calloc(t->event_count + 1, sizeof *switches);
  for (size_t i = 0; switches && i < t->event_count; i++) {
    switches[i] = t->event[i].time;
  }
  struct apart apart = switches ? compare(exact, t->x, switches, t->event_count)
                                : (struct apart){INFINITY, INFINITY};
  free(switches);
  return apart;
}

/* ---- Octave ------------------------------------------------------------------------------- */

static json_t *polynomial(const struct hlpv_polynomial *p) {
  json_t *c = json_array();
  for (int i = 0; i < p->count; i++) {
    json_array_append_new(c, json_real(p->c[i]));
  }
  return json_pack("{s:f, s:o}", "per", p->per, "c", c);
}

static json_t *numbers(const double *values, size_t count) {
  json_t *array = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(array, json_real(values[i]));
  }
  return array;
}

static json_t *problem(const struct hlpv_spec *spec) {
  json_t *modes = json_array(), *transitions = json_array();
  double size[HLPV_STATES];
  check_sizes(spec, size);
  for (int i = 0; i < spec->mode_count; i++) {
    const struct hlpv_mode *m = &spec->mode[i];
    json_array_append_new(modes,
                          json_pack("{s:f, s:o, s:o, s:o, s:o}", "rest", m->rest, "stiffness",
                                    polynomial(&m->stiffness), "damping", polynomial(&m->damping),
                                    "alpha", polynomial(&m->alpha), "beta", polynomial(&m->beta)));
  }
  for (int i = 0; i < spec->transition_count; i++) {
    const struct hlpv_transition *t = &spec->transition[i];
    json_t *reset = json_array();
    for (int k = 0; k < HLPV_STATES; k++) {
      json_array_append_new(reset, json_pack("[f, f]", t->reset[k].factor, t->reset[k].value));
    }
    json_array_append_new(transitions,
                          json_pack("{s:i, s:i, s:i, s:f, s:i, s:o}", "from", t->from, "to", t->to,
                                    "quantity", (int)t->quantity, "level", t->level, "direction",
                                    t->direction, "reset", reset));
  }
  return json_pack("{s:f, s:f, s:o, s:o, s:i, s:o, s:o, s:o, s:f, s:f, s:o}", "mass", spec->mass,
                   "gamma", spec->gamma, "modes", modes, "transitions", transitions, "initial_mode",
                   spec->initial_mode, "initial", numbers(spec->initial, HLPV_STATES), "time",
                   numbers(spec->input.time, spec->input.count), "value",
                   numbers(spec->input.value, spec->input.count), "stop", spec->end, "tolerance",
                   octave_tolerance, "size", numbers(size, HLPV_STATES));
}

/* Octave's answer, a new reference, or NULL. */
static json_t *ask_octave(const struct hlpv_spec *spec, const char *script) {
  char directory[] = "/tmp/bench-hybrid-XXXXXX", in[64], out[64], command[PATH_SIZE + 200];
  if (!mkdtemp(directory)) {
    return NULL;
  }
  snprintf(in, sizeof in, "%s/problem.json", directory);
  snprintf(out, sizeof out, "%s/answer.json", directory);
  snprintf(command, sizeof command,
           "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 octave --no-gui --norc --quiet '%s' '%s' '%s' "
           "%d 2> '%s/log'",
           script, in, out, OCTAVE_RUNS, directory);
  json_t *document = problem(spec), *answer = NULL;
  if (json_dump_file(document, in, JSON_REAL_PRECISION(17)) == 0 && system(command) == 0) {
    answer = json_load_file(out, 0, NULL);
  }
  json_decref(document);
  unlink(in);
  unlink(out);
  snprintf(out, sizeof out, "%s/log", directory);
  unlink(out);
  rmdir(directory);
  return answer;
}

static struct apart compare_octave(const struct hlpv_trajectory *exact, const json_t *answer) {
  const json_t *final = json_object_get(answer, "final"),
               *list = json_object_get(answer, "switches");
  double x[HLPV_STATES], switches[STEPS];
  size_t count = json_array_size(list);
  for (size_t i = 0; i < HLPV_STATES; i++) {
    x[i] = json_number_value(json_array_get(final, i));
  }
  for (size_t i = 0; i < count && i < STEPS; i++) {
    switches[i] = json_number_value(json_array_get(list, i));
  }
  return compare(exact, x, switches, count < STEPS ? count : STEPS);
}

/* ---- the program -------------------------------------------------------------------------- */

struct arguments {
  const char *json, *script, *job;
  long repetitions;
};

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'},
                                          {"script", required_argument, NULL, 's'},
                                          {"repetitions", required_argument, NULL, 'r'},
                                          {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    if (option == '?') {
      return false;
    }
    a->json = option == 'j' ? optarg : a->json;
    a->script = option == 's' ? optarg : a->script;
    a->repetitions = option == 'r' ? strtol(optarg, NULL, 10) : a->repetitions;
  }
  a->job = optind + 1 == argc ? argv[optind] : NULL;
  return a->job && a->repetitions > 0;
}

/* The part of the document about Octave, and a line about it. */
static json_t *octave_part(const struct arguments *a, const struct hlpv_spec *spec,
                           const struct hlpv_trajectory *exact, double own_s) {
  if (!a->script || system("command -v octave > /dev/null 2>&1") != 0) {
    printf("octave is not installed: no comparison\n");
    return json_pack("{s:s}", "skipped", "octave was not installed");
  }
  json_t *answer = ask_octave(spec, a->script);
  if (!answer) {
    printf("octave gave no answer\n");
    return json_pack("{s:s}", "skipped", "octave gave no answer");
  }
  double time = json_number_value(json_object_get(answer, "time_s"));
  struct apart apart = compare_octave(exact, answer);
  printf("octave %s: %.3f s, %.0f times; state within %.1e, switches within %.1e s\n",
         json_string_value(json_object_get(answer, "version")), time, time / own_s, apart.state,
         apart.event_s);
  json_object_set_new(answer, "ratio", json_real(time / own_s));
  json_object_set_new(answer, "state_error", json_real(apart.state));
  json_object_set_new(answer, "event_error_s", json_real(apart.event_s));
  return answer;
}

static bool run(const struct arguments *a, struct job_spec *spec) {
  struct hlpv_trajectory with, without, exact;
  double with_s, without_s, exact_s;
  struct hlpv_spec *h = spec->hlpv;
  h->tolerance = fine_tolerance;
  bool good = measure(h, false, 1, &exact_s, &exact);
  h->tolerance = tolerance;
  good = good && measure(h, true, a->repetitions, &with_s, &with);
  good = good && measure(h, false, a->repetitions, &without_s, &without);
  if (!good) {
    return false;
  }
  struct apart apart = compare_own(&exact, &with);
  printf("%.0f s in %d steps at %.0e: %.2f ms with %zu samples, %.2f ms without; %ld steps, state "
         "within %.1e, switches within %.1e s\n",
         end_s, STEPS, tolerance, 1e3 * with_s, with.sample_count, 1e3 * without_s,
         with.counts.steps, apart.state, apart.event_s);
  json_t *octave = octave_part(a, h, &exact, with_s);
  json_t *document = json_pack(
      "{s:s, s:s, s:o, s:{s:f, s:f, s:i, s:I, s:I, s:f, s:f}, s:o}", "program", "bench_hybrid",
      "job", spec->name, "machine", bench_machine(bench_dgemm_rate()), "simulation",
      "with_samples_s", with_s, "without_samples_s", without_s, "samples", (int)with.sample_count,
      "steps", (json_int_t)with.counts.steps, "evaluations", (json_int_t)with.counts.evaluations,
      "state_error", apart.state, "event_error_s", apart.event_s, "octave", octave);
  good = !a->json || bench_write_json(a->json, document);
  json_decref(document);
  hlpv_trajectory_release(&exact);
  hlpv_trajectory_release(&with);
  hlpv_trajectory_release(&without);
  return good;
}

int main(int argc, char **argv) {
  struct arguments a = {.repetitions = 50};
  struct job_spec spec;
  if (!parse(argc, argv, &a)) {
    fprintf(stderr, "usage: %s [--json FILE] [--script FILE] [--repetitions N] JOB.json\n",
            argv[0]);
    return EXIT_FAILURE;
  }
  if (!bench_read_job(a.job, &spec)) {
    return EXIT_FAILURE;
  }
  openblas_set_num_threads(1);
  bool good = spec.hlpv && set_profile(spec.hlpv) && run(&a, &spec);
  job_spec_release(&spec);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
