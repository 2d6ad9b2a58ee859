/* Writes docs/VERIFICATION.md and its figures from the results of the verify jobs.
 *
 * usage: verification TEMPLATE OUTPUT FIGURES RESULT.json...
 * TEMPLATE is Markdown; its line "@SUMMARY@" becomes the table of all cases, its line "@CASES@" a
 * section for each. FIGURES is the directory of the pictures, which OUTPUT names relative to its
 * own place as "figures/". */
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/figure.h"
#include "tools/template.h"

enum { FIGURE_WIDTH = 560, FIGURE_HEIGHT = 380, RESULTS_MAX = 100 };

struct results {
  json_t *document[RESULTS_MAX];
  int count;
};

static const json_t *member(const json_t *object, const char *key) {
  return json_object_get(object, key);
}

static const char *case_name(const json_t *result) {
  return figure_text(member(result, "case"), "name");
}

/* Significant digits for values, two for errors; "-" for what is absent. */
static void print_number(FILE *out, const json_t *value, const char *format, const char *unit) {
  if (json_is_number(value)) {
    fprintf(out, format, json_number_value(value));
    fprintf(out, "%s%s", strcmp(unit, "1") == 0 || !*unit ? "" : " ",
            strcmp(unit, "1") == 0 ? "" : unit);
  } else {
    fputs("-", out);
  }
}

static void print_percent(FILE *out, const json_t *value) {
  print_number(out, value, "%.2g", "%");
}

static void print_source(FILE *out, const json_t *known) {
  const json_t *source = member(known, "source");
  fprintf(out, "%s (%lld)", figure_text(source, "author"),
          (long long)json_integer_value(member(source, "year")));
}

static void print_summary(FILE *out, const struct results *results) {
  fputs("| case | compared | computed | reference | error | finest mesh | unknowns | source |\n"
        "|---|---|---|---|---|---|---|---|\n",
        out);
  for (int i = 0; i < results->count; i++) {
    const json_t *r = results->document[i], *known = member(r, "case");
    const json_t *metrics = member(r, "metrics"), *meshes = member(r, "meshes");
    const json_t *last = json_array_get(meshes, json_array_size(meshes) - 1);
    fprintf(out, "| [%s](#%s) | %s | ", case_name(r), case_name(r), figure_text(known, "quantity"));
    print_number(out, member(metrics, "computed"), "%.6g", figure_text(known, "unit"));
    fputs(" | ", out);
    print_number(out, member(metrics, "reference"), "%.6g", figure_text(known, "unit"));
    fputs(" | ", out);
    print_percent(out, member(metrics, "error_percent"));
    fprintf(out, " | %s | ", figure_text(last, "mesh"));
    print_number(out, member(last, "unknowns"), "%.0f", "");
    fputs(" | ", out);
    print_source(out, known);
    fputs(" |\n", out);
  }
}

static void print_meshes(FILE *out, const json_t *r) {
  const json_t *known = member(r, "case"), *meshes = member(r, "meshes"), *mesh;
  size_t index;
  const char *other = figure_text(known, "other_norm");
  fprintf(out, "| mesh | unknowns | computed | error%s%s |%s%s%s\n|---|---|---|---|%s\n",
          *other ? ", " : "", figure_text(known, "norm"), *other ? " error, " : "", other,
          *other ? " |" : "", *other ? "---|" : "");
  json_array_foreach(meshes, index, mesh) {
    fprintf(out, "| %s | ", figure_text(mesh, "mesh"));
    print_number(out, member(mesh, "unknowns"), "%.0f", "");
    fputs(" | ", out);
    print_number(out, member(mesh, "computed"), "%.6g", figure_text(known, "unit"));
    fputs(" | ", out);
    print_percent(out, member(mesh, "error_percent"));
    fputs(" |", out);
    if (*other) {
      fputs(" ", out);
      print_percent(out, member(mesh, "other_error_percent"));
      fputs(" |", out);
    }
    fputs("\n", out);
  }
}

/* Metrics other than those of every case. */
static void print_metrics(FILE *out, const json_t *r) {
  static const char *const common[] = {"computed", "reference", "error_percent", "bound_percent"};
  const char *key;
  json_t *value;
  bool first = true;
  json_object_foreach((json_t *)member(r, "metrics"), key, value) {
    bool known = false;
    for (size_t i = 0; i < sizeof common / sizeof *common; i++) {
      known = known || strcmp(key, common[i]) == 0;
    }
    if (!known) {
      fprintf(out, "%s`%s` %.3g", first ? "\nAlso: " : ", ", key, json_number_value(value));
      first = false;
    }
  }
  fputs(first ? "" : ".\n", out);
}

static void print_case(FILE *out, const json_t *r) {
  const json_t *known = member(r, "case"), *metrics = member(r, "metrics");
  fprintf(out, "### %s\n\n%s. Compared: %s. Reference: ", case_name(r), figure_text(known, "title"),
          figure_text(known, "quantity"));
  print_source(out, known);
  fprintf(out, ", %s. Bound for the coarsest mesh: ", figure_text(member(known, "source"), "work"));
  print_percent(out, member(metrics, "bound_percent"));
  fprintf(out, " (%s).\n\n", figure_text(known, "bound_because"));
  print_meshes(out, r);
  print_metrics(out, r);
  fprintf(out, "\n![error of %s](figures/%s.png)", case_name(r), case_name(r));
  if (member(known, "point")) {
    fprintf(out, " ![curve of %s](figures/%s-curve.png)", case_name(r), case_name(r));
  }
  fputs("\n\n", out);
}

static bool write_figure(const json_t *r, const char *plot, const char *path) {
  struct plot_input input = {.result = r, .title = figure_text(member(r, "case"), "title")};
  return figure_write("verification", plot, &input, 1, FIGURE_WIDTH, FIGURE_HEIGHT, path);
}

static bool write_figures(const struct results *results, const char *directory) {
  char path[4096];
  for (int i = 0; i < results->count; i++) {
    const json_t *r = results->document[i];
    snprintf(path, sizeof path, "%s/%s.png", directory, case_name(r));
    if (!write_figure(r, "convergence", path)) {
      return false;
    }
    snprintf(path, sizeof path, "%s/%s-curve.png", directory, case_name(r));
    if (member(member(r, "case"), "point") && !write_figure(r, "curve", path)) {
      return false;
    }
  }
  return true;
}

/* A result that did not succeed verifies nothing. */
static bool read_results(int count, char **paths, struct results *results) {
  for (int i = 0; i < count; i++) {
    json_error_t error;
    json_t *document = json_load_file(paths[i], 0, &error);
    if (!document) {
      fprintf(stderr, "verification: %s: %s\n", paths[i], error.text);
      return false;
    }
    results->document[results->count++] = document;
    if (strcmp(figure_text(document, "kind"), "verify") != 0 ||
        strcmp(figure_text(document, "status"), "succeeded") != 0) {
      fprintf(stderr, "verification: %s: not a verification that succeeded: %s\n", paths[i],
              figure_text(document, "message"));
      return false;
    }
  }
  return true;
}

static bool print_section(FILE *out, const char *line, const void *context) {
  const struct results *results = context;
  if (strcmp(line, "@SUMMARY@\n") == 0) {
    print_summary(out, results);
    return true;
  }
  if (strcmp(line, "@CASES@\n") != 0) {
    return false;
  }
  for (int i = 0; i < results->count; i++) {
    print_case(out, results->document[i]);
  }
  return true;
}

int main(int argc, char **argv) {
  if (argc < 5 || argc - 4 > RESULTS_MAX) {
    fprintf(stderr, "usage: verification TEMPLATE OUTPUT FIGURES RESULT.json...\n");
    return EXIT_FAILURE;
  }
  struct results results = {.count = 0};
  bool good = read_results(argc - 4, argv + 4, &results) && write_figures(&results, argv[3]) &&
              template_fill(argv[1], argv[2], print_section, &results);
  for (int i = 0; i < results.count; i++) {
    json_decref(results.document[i]);
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
