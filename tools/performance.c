/* Writes docs/PERFORMANCE.md and its figures from what the programs of tests/bench have measured.
 *
 * usage: performance TEMPLATE OUTPUT FIGURES RESULTS
 * TEMPLATE is Markdown in which a line such as "@SUMMARY@" becomes the section of that name.
 * FIGURES is the directory of the pictures, which OUTPUT names relative to its own place as
 * "figures/"; RESULTS that of the JSON files. */
#include "tools/performance.h"
#include "tools/template.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const files[FIGURES_COUNT] = {[FIGURES_SOLVE] = "solve",
                                                 [FIGURES_WARM] = "warm",
                                                 [FIGURES_SENSITIVITY] = "sensitivity",
                                                 [FIGURES_SCALING] = "scaling",
                                                 [FIGURES_LINEAR] = "linear",
                                                 [FIGURES_CALCULIX] = "calculix",
                                                 [FIGURES_ROBUSTNESS] = "robustness",
                                                 [FIGURES_BATCH] = "batch",
                                                 [FIGURES_ERROR] = "error",
                                                 [FIGURES_REPEAT] = "repeat",
                                                 [FIGURES_HYBRID] = "hybrid",
                                                 [FIGURES_QUEUE] = "queue"};

static const struct section {
  const char *line;
  int part; /* FIGURES_COUNT: of all */
  void (*print)(FILE *out, const struct figures *figures);
} sections[] = {{"@MACHINE@\n", FIGURES_COUNT, print_machine},
                {"@SUMMARY@\n", FIGURES_COUNT, print_summary},
                {"@SOLVE@\n", FIGURES_SOLVE, print_solve},
                {"@WARM@\n", FIGURES_WARM, print_warm},
                {"@SENSITIVITY@\n", FIGURES_SENSITIVITY, print_sensitivity},
                {"@SCALING@\n", FIGURES_SCALING, print_scaling},
                {"@LINEAR@\n", FIGURES_LINEAR, print_linear},
                {"@CALCULIX@\n", FIGURES_CALCULIX, print_calculix},
                {"@ROBUSTNESS@\n", FIGURES_ROBUSTNESS, print_robustness},
                {"@BATCH@\n", FIGURES_BATCH, print_batch},
                {"@ERROR@\n", FIGURES_ERROR, print_error},
                {"@REPEAT@\n", FIGURES_REPEAT, print_repeat},
                {"@HYBRID@\n", FIGURES_HYBRID, print_hybrid},
                {"@QUEUE@\n", FIGURES_QUEUE, print_queue}};

/* A missing file is no failure, a damaged one is. */
static bool read_figures(const char *directory, struct figures *figures) {
  for (int k = 0; k < FIGURES_COUNT; k++) {
    char path[4096];
    json_error_t error;
    snprintf(path, sizeof path, "%s/%s.json", directory, files[k]);
    if (access(path, R_OK) != 0) {
      continue;
    }
    figures->part[k] = json_load_file(path, 0, &error);
    if (!figures->part[k]) {
      fprintf(stderr, "performance: %s: %s\n", path, error.text);
      return false;
    }
  }
  return true;
}

void print_machine(FILE *out, const struct figures *figures) {
  const json_t *machine = NULL;
  double low = INFINITY, high = 0;
  bool several = false;
  for (int k = 0; k < FIGURES_COUNT; k++) {
    const json_t *found = json_object_get(figures->part[k], "machine");
    double rate = figure_number(found, "dgemm_flop_s");
    if (!found) {
      continue;
    }
    several = several || (machine && strcmp(figure_text(machine, "processor"),
                                            figure_text(found, "processor")) != 0);
    machine = machine ? machine : found;
    low = fmin(low, rate);
    high = fmax(high, rate);
  }
  if (!machine) {
    fputs("(nothing measured yet)\n", out);
    return;
  }
  fprintf(out, "| | |\n|---|---|\n| processor | %s%s |\n| cores | %.0f |\n",
          figure_text(machine, "processor"), several ? " and others: figures are mixed" : "",
          figure_number(machine, "cores"));
  fprintf(out, "| BLAS | %s, kernels for %s |\n", figure_text(machine, "blas"),
          figure_text(machine, "blas_kernels"));
  fprintf(out, "| dgemm on one core, in the single runs | %.1f to %.1f Gflop/s |\n", 1e-9 * low,
          1e-9 * high);
}

/* Prints the section of a template's line; false when the line is plain text. */
static bool print_section(FILE *out, const char *line, const void *context) {
  const struct figures *figures = context;
  for (size_t k = 0; k < sizeof sections / sizeof *sections; k++) {
    const struct section *s = &sections[k];
    if (strcmp(line, s->line) != 0) {
      continue;
    }
    if (s->part == FIGURES_COUNT || figures->part[s->part]) {
      s->print(out, figures);
    } else {
      fprintf(out, "Not measured: run `make bench%s`.\n",
              s->part == FIGURES_ROBUSTNESS ? "-robustness" : "");
    }
    return true;
  }
  return false;
}

int main(int argc, char **argv) {
  struct figures figures = {.part = {NULL}};
  if (argc != 5) {
    fprintf(stderr, "usage: performance TEMPLATE OUTPUT FIGURES RESULTS\n");
    return EXIT_FAILURE;
  }
  bool good = read_figures(argv[4], &figures) && write_plots(&figures, argv[3]) &&
              template_fill(argv[1], argv[2], print_section, &figures);
  for (int k = 0; k < FIGURES_COUNT; k++) {
    json_decref(figures.part[k]);
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
