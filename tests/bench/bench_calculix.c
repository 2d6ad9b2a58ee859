/* pneulab-solve against CalculiX on the exported deck, one core each.
 *   bench_calculix [--json FILE] [--solver PATH] [--limit CPU_SECONDS] [--quick]
 * Pneu-nets of 3 and 12 chambers without contact, ten load steps, several meshes. CalculiX solves
 * each with 20-node reduced elements and ten increments (it cuts them where it must, and takes
 * the follower pressure at the start of each). Compared is the angle of the line from base to tip;
 * its reference is our own solution on a mesh that cuts every cell of another one in every
 * direction. Times are CPU times of whole processes. Needs ccx (Debian: calculix-ccx); says so and
 * succeeds without it. --quick takes the first mesh of the first body. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "tests/bench/bench.h"
#include "tests/bench/error_case.h"
#include "tests/bench/solver_call.h"

enum { MESHES_MAX = 4, LINE_SIZE = 256, REPETITIONS = 3 };

struct mesh_choice {
  const char *name, *accuracy; /* NULL: no further mesh */
  int gap_wall, side_wall;     /* elements; 0: as the accuracy says */
};

struct body {
  int chambers;
  double pressure_kPa;
  const char *reference_accuracy; /* of the mesh that is cut */
  struct mesh_choice mesh[MESHES_MAX];
};

static const struct body bodies[] = {
    {3,
     20,
     "fine",
     {{"fast", "fast", 0, 0},
      {"standard", "standard", 0, 0},
      {"fine", "fine", 0, 0},
      {"fine, walls finer", "fine", 3, 2}}},
    {12, 20, "fast", {{"fast", "fast", 0, 0}}},
};

struct arguments {
  const char *json, *solver;
  double limit_s;
  bool quick;
};

static const double our_limit_s = 300;

static json_t *make_job(const struct body *body, const struct mesh_choice *mesh) {
  json_t *job = json_pack(
      "{s:s, s:o, s:{s:s, s:s, s:s, s:s, s:[{s:s, s:i}], s:s, s:s, s:s, s:s, s:s}, s:{s:s, "
      "s:[s, s, s], s:s, s:i}, s:{s:{s:o, s:i}}, s:b, s:s, s:b}",
      "kind", "response", "name", json_sprintf("%d chambers, %s", body->chambers, mesh->name),
      "actuator", "family", "pneunet", "chamber_length", "8 mm", "width", "30 mm", "height",
      "20 mm", "chambers", "config", "B", "count", body->chambers, "chamber_gap", "2 mm",
      "side_wall", "2 mm", "gap_wall", "2 mm", "top_wall", "1.5 mm", "bottom_layer", "6 mm",
      "material", "model", "yeoh", "C", "0.25 MPa", "-0.05 MPa", "0.005 MPa", "density",
      "1080 kg/m3", "bulk_ratio", 1000, "load", "pressure", "to",
      json_sprintf("%g kPa", body->pressure_kPa), "steps", 10, "contact", 0, "accuracy",
      mesh->accuracy, "error_estimate", 0);
  if (job && mesh->gap_wall > 0) {
    json_object_set_new(
        job, "mesh",
        json_pack("{s:i, s:i}", "gap_wall", mesh->gap_wall, "side_wall", mesh->side_wall));
  }
  return job;
}

/* Angle of the line from base to tip on a much finer mesh, degrees; NAN when it cannot be had. */
static double reference_angle(const struct body *body, int *unknowns) {
  struct mesh_choice mesh = {"reference", body->reference_accuracy, 0, 0};
  struct error error = {0};
  struct job_spec spec;
  struct error_case found;
  json_t *job = make_job(body, &mesh);
  char *text = json_dumps(job, 0);
  json_decref(job);
  enum status status = text ? job_spec_read(text, strlen(text), &spec, &error) : STATUS_NO_MEMORY;
  free(text);
  if (status == STATUS_OK) {
    status = error_case_run(&spec, &found, &error);
  }
  if (status != STATUS_OK) {
    fprintf(stderr, "no reference: %s %s\n", status_word(status), error.message);
    return NAN;
  }
  *unknowns = found.reference_unknowns;
  for (int k = 0; k < ERROR_METRICS; k++) {
    if (strcmp(found.metric[k].name, "chord_angle_deg") == 0) {
      return found.metric[k].reference;
    }
  }
  return NAN;
}

/* Copies the deck with ten increments for the ten recorded pressures, and finds the undeformed
 * length of the body, mm: the largest x of its nodes. */
static bool adapt_deck(const char *from, const char *to, double *length) {
  char line[LINE_SIZE];
  bool adapted = false, nodes = false;
  FILE *in = fopen(from, "r"), *out = fopen(to, "w");
  *length = 0;
  while (in && out && fgets(line, sizeof line, in)) {
    double x;
    if (line[0] == '*') {
      nodes = strncmp(line, "*NODE,", 6) == 0 || strcmp(line, "*NODE\n") == 0;
    } else if (nodes && sscanf(line, "%*d , %lf", &x) == 1) {
      *length = fmax(*length, x);
    }
    fputs(line, out);
    if (strncmp(line, "*STATIC", 7) == 0 && fgets(line, sizeof line, in)) {
      fputs("0.1, 1., 1e-6, 0.1\n", out);
      adapted = true;
    }
  }
  adapted = adapted && *length > 0 && !ferror(in) && !ferror(out);
  if (in) {
    fclose(in);
  }
  return out && fclose(out) == 0 && adapted;
}

/* Angle of the line from base to tip from the last displacement that CalculiX prints, degrees. */
static double read_angle(const char *path, double length) {
  char line[LINE_SIZE];
  double angle = NAN;
  FILE *file = fopen(path, "r");
  while (file && fgets(line, sizeof line, file)) {
    double u[3];
    if (sscanf(line, "%*d %lf %lf %lf", &u[0], &u[1], &u[2]) == 3) {
      angle = 180 / M_PI * atan2(-u[2], length + u[0]);
    }
  }
  if (file) {
    fclose(file);
  }
  return angle;
}

/* Number of increments that CalculiX lists: the lines that begin with a number. */
static int count_increments(const char *path) {
  char line[LINE_SIZE];
  int count = 0, step;
  FILE *file = fopen(path, "r");
  while (file && fgets(line, sizeof line, file)) {
    count += sscanf(line, "%d", &step) == 1;
  }
  if (file) {
    fclose(file);
  }
  return count;
}

static void prepare_ccx(void *context, int k, const char **argv, const char **output,
                        const char **log) {
  static const char *const command[] = {"/usr/bin/env", "ccx", "-i", "deck"};
  (void)context;
  (void)k;
  memcpy(argv, command, sizeof command);
  *output = "ccx.out";
  *log = "ccx.log";
}

static void finish_ccx(void *context, int k, const struct pool_end *end) {
  (void)k;
  *(struct pool_end *)context = *end;
}

/* Runs CalculiX; in the temporary directory, where it leaves its files. */
static json_t *run_ccx(const struct solver_place *place, const json_t *job, double reference,
                       double limit) {
  struct solver_call call = {.job = job, .option = {"--deck", "full.inp"}};
  struct pool_end end = {.exit_code = -1};
  struct pool pool = {1, limit, 1, prepare_ccx, finish_ccx, &end};
  double length;
  if (!solver_call_run(place, &call, 1, 1) || !adapt_deck("full.inp", "deck.inp", &length)) {
    fprintf(stderr, "no deck\n");
    return json_null();
  }
  double angle = pool_run(&pool) && !end.timed_out ? read_angle("deck.dat", length) : NAN;
  int increments = count_increments("deck.sta");
  remove("deck.dat");
  remove("deck.sta");
  if (isnan(angle)) {
    printf("  CalculiX: %s after %.1f s\n", end.timed_out ? "stopped by the limit" : "no solution",
           end.cpu_s);
    return json_pack("{s:f, s:b}", "cpu_s", end.cpu_s, "finished", 0);
  }
  printf("  CalculiX %8.2f s, %d increments, %.4f deg, error %.2f %%\n", end.cpu_s, increments,
         angle, 100 * fabs(angle / reference - 1));
  return json_pack("{s:f, s:b, s:i, s:f, s:f, s:f}", "cpu_s", end.cpu_s, "finished", 1,
                   "increments", increments, "angle_deg", angle, "error",
                   fabs(angle / reference - 1), "peak_memory_bytes", end.peak_memory);
}

static json_t *run_mesh(const struct solver_place *place, const struct body *body,
                        const struct mesh_choice *mesh, double reference, double limit) {
  json_t *job = make_job(body, mesh), *figures = NULL;
  struct solver_call best = {.job = NULL};
  bool good = true;
  for (int k = 0; k < REPETITIONS && good; k++) {
    struct solver_call call = {.job = job};
    good = solver_call_run(place, &call, 1, 1);
    bool better = good && (!best.result || call.end.cpu_s < best.end.cpu_s);
    solver_call_release(better ? &best : &call);
    best = better ? call : best;
  }
  if (good) {
    double angle = solver_call_number(&best, "metrics", "chord_angle_deg");
    double unknowns = solver_call_number(&best, "statistics", "unknowns");
    double factorizations = solver_call_number(&best, "statistics", "factorizations");
    double error = fabs(angle / reference - 1);
    printf("%d chambers, %s, %.0f unknowns\n  ours     %8.2f s, %.0f factorisations, %.4f deg, "
           "error %.2f %%\n",
           body->chambers, mesh->name, unknowns, best.end.cpu_s, factorizations, angle,
           100 * error);
    fflush(stdout);
    figures = json_pack("{s:s, s:f, s:{s:f, s:f, s:f, s:f}, s:o}", "name", mesh->name, "unknowns",
                        unknowns, "ours", "cpu_s", best.end.cpu_s, "factorizations", factorizations,
                        "angle_deg", angle, "error", error, "calculix",
                        run_ccx(place, job, reference, limit));
  }
  solver_call_release(&best);
  json_decref(job);
  return figures;
}

static json_t *run_body(const struct solver_place *place, const struct body *body,
                        const struct arguments *a) {
  int unknowns = 0;
  double reference = reference_angle(body, &unknowns);
  json_t *list = json_array();
  printf("%d chambers, %g kPa: %.4f deg with %d unknowns\n", body->chambers, body->pressure_kPa,
         reference, unknowns);
  for (int k = 0; k < (a->quick ? 1 : MESHES_MAX) && body->mesh[k].name; k++) {
    json_t *figures = run_mesh(place, body, &body->mesh[k], reference, a->limit_s);
    if (figures) {
      json_array_append_new(list, figures);
    }
  }
  return json_pack("{s:i, s:f, s:f, s:i, s:o}", "chambers", body->chambers, "pressure_kPa",
                   body->pressure_kPa, "reference_deg", reference, "reference_unknowns", unknowns,
                   "meshes", list);
}

static bool parse(int argc, char **argv, struct arguments *a) {
  static const struct option options[] = {{"json", required_argument, NULL, 'j'},
                                          {"solver", required_argument, NULL, 'S'},
                                          {"limit", required_argument, NULL, 'l'},
                                          {"quick", no_argument, NULL, 'q'},
                                          {0}};
  int option;
  while ((option = getopt_long(argc, argv, "", options, NULL)) != -1) {
    if (option == '?') {
      return false;
    }
    a->json = option == 'j' ? optarg : a->json;
    a->solver = option == 'S' ? optarg : a->solver;
    a->limit_s = option == 'l' ? atof(optarg) : a->limit_s;
    a->quick = a->quick || option == 'q';
  }
  return optind == argc && a->limit_s > 0;
}

int main(int argc, char **argv) {
  struct arguments a = {.solver = "./pneulab-solve", .limit_s = 300};
  struct solver_place place;
  if (!parse(argc, argv, &a)) {
    fprintf(stderr, "usage: %s [--json FILE] [--solver PATH] [--limit CPU_SECONDS] [--quick]\n",
            argv[0]);
    return EXIT_FAILURE;
  }
  if (system("command -v ccx >/dev/null") != 0) {
    puts("ccx is not installed: no comparison with CalculiX");
    return EXIT_SUCCESS;
  }
  char *json = a.json ? bench_absolute(a.json) : NULL;
  if ((a.json && !json) || !solver_place_create(&place, a.solver, our_limit_s)) {
    free(json);
    return EXIT_FAILURE;
  }
  bool good = chdir(place.directory) == 0;
  json_t *list = json_array();
  json_t *document = json_pack("{s:s, s:o, s:O}", "program", "bench_calculix", "machine",
                               bench_machine(bench_dgemm_rate()), "bodies", list);
  for (size_t k = 0; good && k < (a.quick ? 1 : sizeof bodies / sizeof *bodies); k++) {
    json_array_append_new(list, run_body(&place, &bodies[k], &a));
    good = !json || bench_write_json(json, document);
  }
  json_decref(document);
  json_decref(list);
  free(json);
  solver_place_remove(&place);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
