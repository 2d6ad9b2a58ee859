#include "tools/performance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- CalculiX ---- */

static void print_ccx_mesh(FILE *out, const json_t *body, const json_t *mesh) {
  const json_t *ours = json_object_get(mesh, "ours"), *other = json_object_get(mesh, "calculix");
  struct comparison c = compare_calculix(body, figure_text(mesh, "name"));
  fprintf(out, "| %.0f | %s | %.0f | %.2f s | %.4f | %.2f %% |", figure_number(body, "chambers"),
          figure_text(mesh, "name"), figure_number(mesh, "unknowns"), figure_number(ours, "cpu_s"),
          figure_number(ours, "angle_deg"), 100 * c.ours);
  if (isnan(c.same_mesh)) {
    fprintf(out, " %.0f s, not finished | - | - | more than %.0f |", figure_number(other, "cpu_s"),
            figure_number(other, "cpu_s") / figure_number(ours, "cpu_s"));
  } else {
    fprintf(out, " %.1f s, %.0f | %.4f | %.2f %% | %.0f |", figure_number(other, "cpu_s"),
            figure_number(other, "increments"), figure_number(other, "angle_deg"),
            100 * figure_number(other, "error"), c.same_mesh);
  }
  if (isnan(c.same_error)) {
    fputs(" - |\n", out);
  } else {
    fprintf(out, " %s%.0f (%s, %.2f %%) |\n", c.beyond ? "more than " : "", c.same_error,
            c.ccx_mesh, 100 * c.calculix);
  }
}

void print_calculix(FILE *out, const struct figures *figures) {
  const json_t *bodies = json_object_get(figures->part[FIGURES_CALCULIX], "bodies"), *body, *mesh;
  size_t b, m;
  fputs("| chambers | mesh | unknowns | our time | our angle, deg | our error | CalculiX's time, "
        "increments | its angle, deg | its error | ratio, same mesh | ratio, same error |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n",
        out);
  json_array_foreach(bodies, b, body) {
    json_array_foreach(json_object_get(body, "meshes"), m, mesh) {
      print_ccx_mesh(out, body, mesh);
    }
  }
  fputs("\nThe last column divides by our time on this mesh that of the cheapest CalculiX run "
        "whose error "
        "is not larger (its mesh\nand error in brackets); \"more than\": none was as accurate, and "
        "the most "
        "accurate one is taken. References: ",
        out);
  json_array_foreach(bodies, b, body) {
    fprintf(out, "%s%.0f chambers %.4f degrees with %.0f unknowns", b ? ", " : "",
            figure_number(body, "chambers"), figure_number(body, "reference_deg"),
            figure_number(body, "reference_unknowns"));
  }
  fputs(".\n", out);
}

/* ---- designs ---- */

static double sum(const json_t *designs, const char *key) {
  const json_t *design;
  double total = 0;
  size_t index;
  json_array_foreach(designs, index, design) {
    double value = figure_number(design, key);
    total += isfinite(value) ? value : 0;
  }
  return total;
}

static void print_reasons(FILE *out, const json_t *summary) {
  const char *reason;
  json_t *number;
  fputs("| ending | designs |\n|---|---|\n", out);
  json_object_foreach(json_object_get(summary, "reasons"), reason, number) {
    fprintf(out, "| `%s` | %lld |\n", reason, (long long)json_integer_value(number));
  }
}

static void print_chambers(FILE *out, const json_t *design) {
  const json_t *actuator = json_object_get(json_object_get(design, "job"), "actuator"), *run;
  size_t index;
  json_array_foreach(json_object_get(actuator, "chambers"), index, run) {
    fprintf(out, "%s%.0f %s", index ? " + " : "", figure_number(run, "count"),
            figure_text(run, "config"));
  }
}

/* Those that neither reach the end nor a limit of the body. */
static void print_rest(FILE *out, const json_t *designs) {
  const json_t *design;
  size_t index;
  bool any = false;
  json_array_foreach(designs, index, design) {
    if (strcmp(figure_text(design, "status"), "succeeded") == 0 || ending_is_physical(design)) {
      continue;
    }
    fputs(any ? ""
              : "\nThe rest:\n\n| design | chambers | material | ending | cause | reached, kPa | "
                "angle, deg | factorisations | CPU, s |\n|---|---|---|---|---|---|---|---|---|\n",
          out);
    any = true;
    fprintf(out, "| %.0f | ", figure_number(design, "index"));
    print_chambers(out, design);
    fprintf(out, " | %s | %s | `%s` | %.1f | %.1f | %.0f | %.1f |\n",
            figure_text(json_object_get(design, "job"), "material"), figure_text(design, "status"),
            figure_text(design, "reason"), figure_number(design, "pressure_kPa"),
            figure_number(design, "bending_angle_deg"), figure_number(design, "factorizations"),
            figure_number(design, "cpu_s"));
  }
  fputs(any ? "" : "\nNo other ending.\n", out);
}

static void print_designs(FILE *out, const json_t *document) {
  const json_t *summary = json_object_get(document, "summary");
  const json_t *options = json_object_get(document, "options");
  const json_t *designs = json_object_get(document, "designs");
  const json_t *cpu = json_object_get(summary, "cpu_s");
  const json_t *factors = json_object_get(summary, "factorizations");
  struct endings e = count_endings(document);
  double estimates = sum(designs, "estimate_s"), all = sum(designs, "cpu_s");
  fprintf(out,
          "| | |\n|---|---|\n| designs, accuracy | %d, `%s` |\n"
          "| reach the last pressure | %d (%.1f %%) |\n"
          "| stop at a named limit of the body | %d (%.1f %%) |\n| others | %d |\n"
          "| ended by the limit of %.0f s CPU time, crashed | %d, %d |\n| with contact | %.0f |\n",
          e.designs, figure_text(options, "accuracy"), e.succeeded, 100.0 * e.succeeded / e.designs,
          e.physical, 100.0 * e.physical / e.designs, e.designs - e.succeeded - e.physical,
          figure_number(options, "limit_s"), e.hung, e.crashed, figure_number(summary, "touched"));
  fprintf(out,
          "| CPU time, median and 90th percentile | %.2f s, %.2f s |\n"
          "| share of it spent on estimates of the error | %.0f %% |\n"
          "| factorisations, median and 90th percentile | %.0f, %.0f |\n"
          "| largest peak memory | %.0f MB |\n| designs an hour, %.0f at a time | %.0f |\n",
          figure_number(cpu, "median"), figure_number(cpu, "percentile_90"), 100 * estimates / all,
          figure_number(factors, "median"), figure_number(factors, "percentile_90"),
          e.peak_memory_MB, figure_number(options, "jobs"),
          figure_number(summary, "designs_per_hour"));
}

void print_robustness(FILE *out, const struct figures *figures) {
  const json_t *document = figures->part[FIGURES_ROBUSTNESS];
  print_designs(out, document);
  fputs("\n", out);
  print_reasons(out, json_object_get(document, "summary"));
  print_rest(out, json_object_get(document, "designs"));
  fputs("\n![CPU time of the designs](figures/performance-designs.png)\n", out);
}

void print_batch(FILE *out, const struct figures *figures) {
  print_designs(out, figures->part[FIGURES_BATCH]);
}

/* ---- error estimates ---- */

void print_error(FILE *out, const struct figures *figures) {
  const json_t *document = figures->part[FIGURES_ERROR], *one;
  json_t *metric;
  const char *name;
  size_t index;
  double path = 0, estimate = 0;
  fprintf(out,
          "%.0f designs at `%s`, %.0f without a solution to compare.\n\n"
          "| metric | estimate covers | within a factor 3 | true error, rms | worst |\n"
          "|---|---|---|---|---|\n",
          figure_number(document, "designs"), figure_text(document, "accuracy"),
          figure_number(document, "without_solution"));
  json_object_foreach(json_object_get(document, "summary"), name, metric) {
    fprintf(out, "| `%s` | %.0f %% | %.0f %% | %.2f %% | %.2f %% |\n", name,
            100 * figure_number(metric, "covered"), 100 * figure_number(metric, "within_factor_3"),
            100 * figure_number(metric, "rms_error"), 100 * figure_number(metric, "worst_error"));
  }
  json_array_foreach(json_object_get(document, "cases"), index, one) {
    path += figure_number(one, "solve_s");
    estimate += figure_number(one, "estimate_s");
  }
  fprintf(out, "\nThe estimates take %.0f %% of the time of the load paths.\n",
          100 * estimate / path);
}

/* ---- repetition ---- */

void print_repeat(FILE *out, const struct figures *figures) {
  const json_t *document = figures->part[FIGURES_REPEAT];
  const json_t *repeat = json_object_get(document, "repeat");
  const json_t *beside = json_object_get(repeat, "beside_load");
  const json_t *threads = json_object_get(repeat, "two_threads");
  double apart = figure_number(threads, "largest_difference");
  bool same = json_is_true(json_object_get(beside, "same_document"));
  bool states = json_is_true(json_object_get(beside, "same_states"));
  fprintf(
      out,
      "Job \"%s\", alone and as %.0f processes at a time on a machine of %.0f cores: result "
      "documents "
      "without their statistics are\n%s, the files of all unknowns at all recorded pressures %s. ",
      figure_text(document, "job"), figure_number(repeat, "processes"),
      figure_number(json_object_get(document, "machine"), "cores"),
      same ? "the same byte for byte" : "**different**", states ? "too" : "**are different**");
  fprintf(out,
          "With `--threads 2`, which adds in another order,\nthe samples (angles, tip, volume, "
          "stretch) "
          "differ by %s%.0e of their largest value.\n",
          apart < 1e-9 ? "less than " : "at most ", fmax(apart, 1e-9));
}
