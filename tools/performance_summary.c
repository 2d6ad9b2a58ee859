#include "tools/performance.h"

#include <math.h>
#include <string.h>

/* Reasons that name a limit of the body. */
static const char *const physical_reasons[] = {"limit_point", "loss_of_stability",
                                               "material_instability"};

bool ending_is_physical(const json_t *design) {
  const char *reason = figure_text(design, "reason");
  for (size_t k = 0; k < sizeof physical_reasons / sizeof *physical_reasons; k++) {
    if (strcmp(reason, physical_reasons[k]) == 0) {
      return true;
    }
  }
  return false;
}

struct endings count_endings(const json_t *document) {
  struct endings e = {.designs = 0};
  const json_t *design;
  size_t index;
  json_array_foreach(json_object_get(document, "designs"), index, design) {
    const char *status = figure_text(design, "status");
    e.designs++;
    e.succeeded += strcmp(status, "succeeded") == 0;
    e.physical += strcmp(status, "diverged") == 0 && ending_is_physical(design);
    e.hung += strcmp(status, "timed_out") == 0;
    e.crashed += strcmp(status, "crashed") == 0 || strcmp(status, "not_started") == 0;
    e.peak_memory_MB = fmax(e.peak_memory_MB, figure_number(design, "peak_memory_MB"));
  }
  return e;
}

static const json_t *mesh_named(const json_t *body, const char *name) {
  const json_t *mesh;
  size_t index;
  json_array_foreach(json_object_get(body, "meshes"), index, mesh) {
    if (strcmp(figure_text(mesh, "name"), name) == 0) {
      return mesh;
    }
  }
  return NULL;
}

struct comparison compare_calculix(const json_t *body, const char *name) {
  const json_t *ours = json_object_get(mesh_named(body, name), "ours"), *mesh;
  double time = figure_number(ours, "cpu_s");
  struct comparison c = {.same_mesh = NAN, .same_error = NAN, .beyond = true};
  double cost = INFINITY;
  c.ours = figure_number(ours, "error");
  c.calculix = INFINITY;
  size_t index;
  json_array_foreach(json_object_get(body, "meshes"), index, mesh) {
    const json_t *other = json_object_get(mesh, "calculix");
    double error = figure_number(other, "error"), spent = figure_number(other, "cpu_s");
    if (isnan(error)) {
      continue;
    }
    bool enough = error <= c.ours;
    if (strcmp(figure_text(mesh, "name"), name) == 0) {
      c.same_mesh = spent / time;
    }
    if (enough ? c.beyond || spent < cost : c.beyond && error < c.calculix) {
      c.beyond = !enough;
      c.calculix = error;
      c.ccx_mesh = figure_text(mesh, "name");
      c.same_error = spent / time;
      cost = spent;
    }
  }
  return c;
}

/* One row: what is asked, what is measured, whether it is enough. A NAN was not measured. */
static void row(FILE *out, const char *what, const char *target, const char *measured, bool met,
                bool known) {
  fprintf(out, "| %s | %s | %s | %s |\n", what, target, known ? measured : "-",
          !known ? "not measured"
          : met  ? "met"
                 : "**short**");
}

/* A row of a number that must not exceed, or with `least` not be below, its target. */
static void number_row(FILE *out, const char *what, const char *format, double target,
                       double measured, bool least) {
  char wanted[80], found[80], text[60];
  snprintf(text, sizeof text, format, target);
  snprintf(wanted, sizeof wanted, "%s%s", least ? "at least " : "at most ", text);
  snprintf(found, sizeof found, format, measured);
  row(out, what, wanted, found, least ? measured >= target : measured <= target,
      isfinite(measured));
}

static void robustness_rows(FILE *out, const json_t *document) {
  struct endings e = count_endings(document);
  char text[120];
  int good = e.succeeded + e.physical;
  snprintf(text, sizeof text, "%d of %d (%.1f %%)", good, e.designs, 100.0 * good / e.designs);
  row(out, "designs that reach the end or a named physical limit", "all", text, good == e.designs,
      e.designs > 0);
  snprintf(text, sizeof text, "%d, %d", e.hung, e.crashed);
  row(out, "designs that hang, that crash", "none", text, e.hung + e.crashed == 0, e.designs > 0);
}

static void warm_rows(FILE *out, const json_t *warm) {
  const json_t *cold = json_object_get(warm, "cold"), *neighbour;
  double worst = NAN;
  size_t index;
  json_array_foreach(json_object_get(warm, "neighbours"), index, neighbour) {
    worst = fmax(worst, figure_number(neighbour, "warm_s"));
  }
  number_row(out, "20,000 unknowns with contact, ten pressures, cold", "%.2f s", 2,
             figure_number(cold, "path_s"), false);
  number_row(out, "its factorisations", "%.0f", 30, figure_number(cold, "factorizations"), false);
  number_row(out, "the same, warm, five pressures, slowest of nine neighbours", "%.2f s", 0.8,
             worst, false);
}

static void calculix_rows(FILE *out, const json_t *calculix) {
  const json_t *body = json_array_get(json_object_get(calculix, "bodies"), 0);
  struct comparison c = compare_calculix(body, "standard");
  char text[160];
  snprintf(text, sizeof text, "%s%.0f times (errors %.1f and %.1f %%)",
           c.beyond ? "more than " : "", c.same_error, 100 * c.ours, 100 * c.calculix);
  row(out, "faster than CalculiX at equal accuracy, against `standard`", "at least 50 times", text,
      c.same_error >= 50, isfinite(c.same_error));
}

static void repeat_rows(FILE *out, const json_t *document) {
  const json_t *repeat = json_object_get(document, "repeat");
  const json_t *beside = json_object_get(repeat, "beside_load");
  const json_t *threads = json_object_get(repeat, "two_threads");
  bool same = json_is_true(json_object_get(beside, "same_document")) &&
              json_is_true(json_object_get(beside, "same_states"));
  row(out, "the same job beside a load", "same bytes", same ? "same bytes" : "different", same,
      repeat != NULL);
  number_row(out, "the same job with two threads, largest difference", "%.0e", 1e-6,
             figure_number(threads, "largest_difference"), false);
}

static void hybrid_rows(FILE *out, const json_t *hybrid, const json_t *queue) {
  const json_t *own = json_object_get(hybrid, "simulation");
  number_row(out, "40 s of a hybrid model in eight steps at 1e-9, with samples", "%.2f ms", 5,
             1e3 * figure_number(own, "with_samples_s"), false);
  number_row(out, "faster than Octave's `ode45` with events at 1e-8, same run", "%.0f times", 300,
             figure_number(json_object_get(hybrid, "octave"), "ratio"), true);
  number_row(out, "such simulations a minute of a core, through the queue as one study", "%.0f",
             10000, figure_number(queue, "simulations_per_minute_core"), true);
}

/* The largest peak memory of designs at `standard`, MB; NAN for other designs. */
static double standard_memory(const json_t *document) {
  const char *accuracy = figure_text(json_object_get(document, "options"), "accuracy");
  return strcmp(accuracy, "standard") == 0 ? count_endings(document).peak_memory_MB : NAN;
}

/* As the target asks: at `standard`, two at a time. */
static double designs_per_hour(const json_t *document) {
  const json_t *options = json_object_get(document, "options");
  bool asked = strcmp(figure_text(options, "accuracy"), "standard") == 0 &&
               figure_number(options, "jobs") == 2;
  return asked ? figure_number(json_object_get(document, "summary"), "designs_per_hour") : NAN;
}

void print_summary(FILE *out, const struct figures *figures) {
  json_t *const *part = figures->part;
  double memory =
      fmax(standard_memory(part[FIGURES_BATCH]), standard_memory(part[FIGURES_ROBUSTNESS]));
  fputs("| asked for | target | measured | |\n|---|---|---|---|\n", out);
  robustness_rows(out, part[FIGURES_ROBUSTNESS]);
  warm_rows(out, part[FIGURES_WARM]);
  number_row(out, "a derivative of all metrics, mean over the parameters, the state included",
             "%.3f s", 0.05,
             figure_number(json_object_get(part[FIGURES_SENSITIVITY], "sensitivity"), "mean_s"),
             false);
  number_row(out, "designs an hour on two cores at `standard`", "%.0f", 4000,
             designs_per_hour(part[FIGURES_BATCH]), true);
  calculix_rows(out, part[FIGURES_CALCULIX]);
  number_row(out, "memory of a design at `standard`, the largest", "%.0f MB", 500, memory, false);
  repeat_rows(out, part[FIGURES_REPEAT]);
  hybrid_rows(out, part[FIGURES_HYBRID], part[FIGURES_QUEUE]);
}
