/* Checks the error estimates of the metrics: a Latin hypercube of designs, cut to a few chambers,
 * every second one with contact, each against a much finer mesh. Prints a line a design and, per
 * metric, how often the estimate covers the true error, and how often it is within a factor 3.
 *
 * bench_error [--count N] [--skip N] [--seed N] [--chambers N] [--accuracy TIER] [--pressure KPA]
 *             [--json FILE] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"
#include "tests/bench/error_case.h"
#include "tests/bench/robust_design.h"

struct options {
  struct robust_options sample;
  int skip, chambers;
  double pressure_kPa;
  const char *json;
};

struct tally {
  int cases, failed;
  int covered[ERROR_METRICS], near[ERROR_METRICS];
  double squares[ERROR_METRICS], worst[ERROR_METRICS]; /* of relative true errors */
  double solve_s, estimate_s;
};

static bool read_options(int argc, char **argv, struct options *o) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const char *key = argv[i], *value = argv[i + 1];
    if (strcmp(key, "--count") == 0) {
      o->sample.count = atoi(value);
    } else if (strcmp(key, "--skip") == 0) {
      o->skip = atoi(value);
    } else if (strcmp(key, "--seed") == 0) {
      o->sample.seed = strtoull(value, NULL, 10);
    } else if (strcmp(key, "--chambers") == 0) {
      o->chambers = atoi(value);
    } else if (strcmp(key, "--accuracy") == 0) {
      o->sample.accuracy = value;
    } else if (strcmp(key, "--pressure") == 0) {
      o->pressure_kPa = atof(value);
    } else if (strcmp(key, "--json") == 0) {
      o->json = value;
    } else {
      return false;
    }
  }
  return argc % 2 == 1 && o->sample.count > 0 && o->chambers > 0 && o->pressure_kPa > 0;
}

/* Leaves `chambers` of the job's chambers, of both configurations if it has two. */
static void cut_chambers(json_t *actuator, int chambers) {
  json_t *runs = json_object_get(actuator, "chambers");
  int left = chambers;
  for (size_t r = json_array_size(runs); r-- > 0;) {
    int share = r > 0 ? chambers / 2 : left;
    if (r > 0 && share == 0) {
      json_array_remove(runs, r);
      continue;
    }
    json_object_set_new(json_array_get(runs, r), "count", json_integer(share));
    left -= share;
  }
}

/* The job of a design, every fourth with an air channel, every second with contact. */
static bool make_job(const struct options *o, int index, const double place[ROBUST_FACTORS],
                     struct job_spec *spec, struct error *error) {
  json_t *job = robust_job(&o->sample, index, place);
  json_t *actuator = json_object_get(job, "actuator");
  cut_chambers(actuator, o->chambers);
  if (index % 4 == 1) {
    json_object_set_new(
        actuator, "channel",
        json_pack("{s:s, s:s, s:s}", "width", "4 mm", "height", "1.5 mm", "cover", "1 mm"));
  }
  json_object_set_new(job, "contact", json_boolean(index % 2 == 1));
  json_object_set_new(json_object_get(json_object_get(job, "load"), "pressure"), "to",
                      json_sprintf("%.3f kPa", o->pressure_kPa));
  char *text = json_dumps(job, 0);
  json_decref(job);
  bool good = text && job_spec_read(text, strlen(text), spec, error) == STATUS_OK;
  free(text);
  return good;
}

static void add_case(const struct error_case *c, struct tally *t) {
  t->cases++;
  t->solve_s += c->solve_s;
  t->estimate_s += c->estimate_s;
  for (int k = 0; k < ERROR_METRICS; k++) {
    const struct error_metric *m = &c->metric[k];
    double part = fabs(m->value / m->reference - 1);
    t->covered[k] += error_case_covers(m);
    t->near[k] += error_case_is_near(m);
    t->squares[k] += part * part;
    t->worst[k] = fmax(t->worst[k], part);
  }
}

static json_t *case_object(int index, const struct error_case *c) {
  json_t *metrics = json_object();
  for (int k = 0; k < ERROR_METRICS; k++) {
    const struct error_metric *m = &c->metric[k];
    json_object_set_new(metrics, m->name,
                        json_pack("{s:f, s:f, s:f, s:f}", "value", m->value, "reference",
                                  m->reference, "estimate", m->estimate, "ratio",
                                  m->estimate / error_case_truth(m)));
  }
  return json_pack("{s:i, s:i, s:i, s:f, s:f, s:o}", "design", index, "unknowns", c->unknowns,
                   "reference_unknowns", c->reference_unknowns, "solve_s", c->solve_s, "estimate_s",
                   c->estimate_s, "metrics", metrics);
}

static void print_case(int index, const struct job_spec *spec, const struct error_case *c) {
  char runs[CHAMBERS_MAX + 1] = "";
  for (int r = 0, n = 0; r < spec->pneunet.run_count; r++) {
    for (int k = 0; k < spec->pneunet.runs[r].count; k++) {
      runs[n++] = "ABC"[spec->pneunet.runs[r].config];
      runs[n] = 0;
    }
  }
  printf("%4d %s%c%c %7.2f deg %6d %7d", index, runs, spec->pneunet.has_channel ? 'c' : ' ',
         spec->contact ? '*' : ' ', c->metric[0].value, c->unknowns, c->reference_unknowns);
  for (int k = 0; k < ERROR_METRICS; k++) {
    const struct error_metric *m = &c->metric[k];
    printf("  %7.2f +- %-5.2f", 100 * (m->value / m->reference - 1),
           100 * m->estimate / fabs(m->reference));
  }
  printf("  %.2f + %.2f s\n", c->solve_s, c->estimate_s);
  fflush(stdout);
}

static json_t *summarise(const struct tally *t, const struct error_case *names) {
  json_t *summary = json_object();
  int cases = t->cases > 0 ? t->cases : 1;
  printf("\n%-20s %8s %8s %9s %9s\n", "metric", "covered", "factor 3", "rms error", "worst");
  for (int k = 0; k < ERROR_METRICS; k++) {
    double covered = (double)t->covered[k] / cases, near = (double)t->near[k] / cases;
    double rms = sqrt(t->squares[k] / cases);
    printf("%-20s %6.0f %% %6.0f %% %7.2f %% %7.2f %%\n", names->metric[k].name, 100 * covered,
           100 * near, 100 * rms, 100 * t->worst[k]);
    json_object_set_new(summary, names->metric[k].name,
                        json_pack("{s:f, s:f, s:f, s:f}", "covered", covered, "within_factor_3",
                                  near, "rms_error", rms, "worst_error", t->worst[k]));
  }
  printf("%d designs, %d without a solution; the estimate takes %.0f %% of the load path's time\n",
         t->cases, t->failed, t->solve_s > 0 ? 100 * t->estimate_s / t->solve_s : 0);
  return summary;
}

static void run_designs(const struct options *o, double (*place)[ROBUST_FACTORS], json_t *list,
                        struct tally *tally, struct error_case *last) {
  printf("true error and its estimate in %% of the reference: bending, chord, end face, tip, "
         "volume, stretch\n");
  for (int i = o->skip; i < o->sample.count; i++) {
    struct job_spec spec;
    struct error error = {0};
    struct error_case c;
    if (!make_job(o, i, place[i], &spec, &error) ||
        error_case_run(&spec, &c, &error) != STATUS_OK) {
      printf("%4d %s\n", i, error.message);
      tally->failed++;
      continue;
    }
    if (isnan(c.metric[0].estimate)) {
      printf("%4d no estimate\n", i);
      tally->failed++;
      continue;
    }
    print_case(i, &spec, &c);
    add_case(&c, tally);
    json_array_append_new(list, case_object(i, &c));
    *last = c;
  }
}

int main(int argc, char **argv) {
  struct options o = {{24, 1, "standard", 4, true}, 0, 3, 30, NULL};
  if (!read_options(argc, argv, &o)) {
    fprintf(stderr, "usage: bench_error [--count N] [--skip N] [--seed N] [--chambers N] "
                    "[--accuracy TIER] [--pressure KPA] [--json FILE]\n");
    return EXIT_FAILURE;
  }
  double(*place)[ROBUST_FACTORS] = calloc((size_t)o.sample.count, sizeof *place);
  struct tally tally = {0};
  struct error_case last = {0};
  json_t *list = json_array();
  bool good = place && list && robust_sample(&o.sample, place);
  if (good) {
    run_designs(&o, place, list, &tally, &last);
  }
  good = good && tally.cases > 0;
  if (good) {
    json_t *document = json_pack("{s:s, s:i, s:i, s:o, s:O}", "accuracy", o.sample.accuracy,
                                 "designs", tally.cases, "without_solution", tally.failed,
                                 "summary", summarise(&tally, &last), "cases", list);
    good = !o.json || bench_write_json(o.json, document);
    json_decref(document);
  }
  json_decref(list);
  free(place);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
