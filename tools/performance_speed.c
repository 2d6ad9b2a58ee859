#include "tools/performance.h"

#include <math.h>
#include <string.h>

void print_solve(FILE *out, const struct figures *figures) {
  static const char *const names[][2] = {{"setup_s", "mesh and first analysis"},
                                         {"assembly_s", "assembly"},
                                         {"residual_s", "residuals"},
                                         {"factor_s", "factorisation"},
                                         {"solve_s", "solution"},
                                         {"contact_s", "contact"},
                                         {"other_s", "other"}};
  const json_t *s = json_object_get(figures->part[FIGURES_SOLVE], "solve");
  const json_t *parts = json_object_get(s, "parts");
  const json_t *cold = json_object_get(figures->part[FIGURES_WARM], "cold");
  double time = figure_number(s, "cpu_s"), factors = figure_number(s, "factorizations");
  fprintf(out,
          "| | |\n|---|---|\n| elements, unknowns | %.0f, %.0f |\n| load path | %.2f s |\n"
          "| factorisations | %.0f of %.2f Gflop |\n",
          figure_number(s, "elements"), figure_number(s, "unknowns"), time, factors,
          1e-9 * figure_number(s, "flops"));
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    double part = figure_number(parts, names[k][0]);
    fprintf(out, "| %s | %.2f s, %.0f %% |\n", names[k][1], part, 100 * part / time);
  }
  fprintf(out,
          "| rate of the factorisation over dgemm's | %.2f |\n"
          "| share of the limit | **%.2f** |\n| peak memory of the load path | %.0f MB |\n",
          figure_number(s, "factor_dgemm_share"), figure_number(s, "limit_share"),
          1e-6 * figure_number(s, "peak_memory_bytes"));
  if (cold) {
    fprintf(
        out,
        "\nAs a process, `pneulab-solve` takes %.2f s: %.2f s for the load path with its results, "
        "%.2f s for the estimate of the errors on a finer mesh, which also sets its peak memory, "
        "%.0f MB. `\"error_estimate\": false` leaves the estimate out.\n",
        figure_number(cold, "process_s"), figure_number(cold, "path_s"),
        figure_number(cold, "estimate_s"), 1e-6 * figure_number(cold, "peak_memory_bytes"));
  }
}

void print_warm(FILE *out, const struct figures *figures) {
  const json_t *n;
  size_t index;
  bool anew = false;
  fputs("| dimension | change | warm | factorisations | cold | factorisations | cold / warm | "
        "difference of the angle |\n|---|---|---|---|---|---|---|---|\n",
        out);
  json_array_foreach(json_object_get(figures->part[FIGURES_WARM], "neighbours"), index, n) {
    double warm = figure_number(n, "warm_s"), cold = figure_number(n, "cold_s");
    bool started = json_is_true(json_object_get(n, "warm_start"));
    anew = anew || !started;
    fprintf(out, "| `%s` | +%.0f %% | %.2f s%s | %.0f | %.2f s | %.0f | %.1f | %.0e |\n",
            figure_text(n, "dimension"), 100 * figure_number(n, "change"), warm,
            started ? "" : " (*)", figure_number(n, "warm_factorizations"), cold,
            figure_number(n, "cold_factorizations"), cold / warm,
            figure_number(n, "angle_difference"));
  }
  if (anew) {
    fputs("\n(*) the old path did not carry over; the solve began anew by itself.\n", out);
  }
}

void print_sensitivity(FILE *out, const struct figures *figures) {
  const json_t *s = json_object_get(figures->part[FIGURES_SENSITIVITY], "sensitivity");
  fprintf(
      out,
      "| | |\n|---|---|\n| unknowns, points in contact, parameters | %.0f, %.0f, %.0f |\n"
      "| the state: settling, factorisation, adjoint solutions | %.0f ms |\n"
      "| one parameter more | %.1f ms |\n| mean of a derivative, the state included | %.0f ms |\n"
      "| once a job, and for each of its parameters | %.0f ms, %.1f ms |\n",
      figure_number(s, "unknowns"), figure_number(s, "contact_points"),
      figure_number(s, "parameters"), 1e3 * figure_number(s, "state_s"),
      1e3 * figure_number(s, "parameter_s"), 1e3 * figure_number(s, "mean_s"),
      1e3 * figure_number(s, "once_s"), 1e3 * figure_number(s, "once_parameter_s"));
}

struct growth fit_growth(const json_t *scaling, const char *figure) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  struct growth g = {.exponent = NAN, .factor = NAN, .smallest = INFINITY};
  const json_t *series, *point;
  size_t i, k;
  json_array_foreach(json_object_get(scaling, "series"), i, series) {
    json_array_foreach(json_object_get(series, "points"), k, point) {
      double unknowns = figure_number(point, "unknowns"), value = figure_number(point, figure);
      const char *status = figure_text(point, "status");
      bool whole = strcmp(figure, "whole_solve_s") != 0 || strcmp(status, "ok") == 0;
      if (unknowns > 0 && value > 0 && whole) {
        double u = log(unknowns), v = log(value);
        n++;
        x += u;
        y += v;
        xx += u * u;
        xy += u * v;
        g.smallest = fmin(g.smallest, unknowns);
        g.largest = fmax(g.largest, unknowns);
      }
    }
  }
  g.count = (int)n;
  if (g.count >= 3) {
    g.exponent = (n * xy - x * y) / (n * xx - x * x);
    g.factor = exp((y - g.exponent * x) / n);
  }
  return g;
}

static void print_series(FILE *out, const json_t *series) {
  const json_t *p;
  size_t index;
  json_array_foreach(json_object_get(series, "points"), index, p) {
    fprintf(out, "| %s | %.0f | %.0f | %.0f | %.0f | %.0f | %.0f | %.2f | %.0f |",
            figure_text(series, "name"), figure_number(p, "unknowns"), figure_number(p, "chambers"),
            1e3 * figure_number(p, "assembly_s"), 1e3 * figure_number(p, "factor_s"),
            1e3 * figure_number(p, "solve_s"), 1e3 * figure_number(p, "step_s"),
            1e-9 * figure_number(p, "flops"), 1e-6 * figure_number(p, "peak_memory_bytes"));
    double whole = figure_number(p, "whole_solve_s");
    const char *status = figure_text(p, "status");
    if (isnan(whole)) {
      fputs(" - | - |\n", out);
    } else {
      fprintf(out, " %.1f%s | %.0f |\n", whole, strcmp(status, "ok") == 0 ? "" : " (*)",
              figure_number(p, "factorizations"));
    }
  }
}

void print_scaling(FILE *out, const struct figures *figures) {
  static const char *const fits[][2] = {
      {"step_s", "one step"},          {"assembly_s", "assembly"},
      {"factor_s", "factorisation"},   {"solve_s", "solution"},
      {"peak_memory_bytes", "memory"}, {"whole_solve_s", "whole load path"}};
  const json_t *scaling = figures->part[FIGURES_SCALING], *series;
  size_t index;
  fputs(
      "The body of the reference job with finer meshes, with more chambers (and as slender a "
      "taper), "
      "and with both. One step\nis assembly, factorisation and solution in the undeformed state, "
      "best "
      "of three; memory that of a process that\ntakes this step. (*) the body reached a limit "
      "before "
      "the last pressure.\n\n"
      "| body | unknowns | chambers | assembly, ms | factor, ms | solution, ms | step, ms | Gflop "
      "| MB | load path, s | factorisations |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
      out);
  json_array_foreach(json_object_get(scaling, "series"), index, series) {
    print_series(out, series);
  }
  fputs("\n| figure | grows with the power | unknowns | points |\n|---|---|---|---|\n", out);
  for (size_t k = 0; k < sizeof fits / sizeof *fits; k++) {
    struct growth g = fit_growth(scaling, fits[k][0]);
    if (isfinite(g.exponent)) {
      fprintf(out, "| %s | %.2f | %.0f to %.0f | %d |\n", fits[k][1], g.exponent, g.smallest,
              g.largest, g.count);
    }
  }
  fputs("\n![time against unknowns](figures/performance-unknowns.png)\n", out);
}

/* ---- linear solvers ---- */

static double whole_time(const json_t *run) {
  return figure_number(run, "gather_s") + figure_number(run, "factor_s") +
         figure_number(run, "solve_s");
}

/* The fastest run of a solver. */
static const json_t *best_run(const json_t *runs, const char *solver) {
  const json_t *run, *best = NULL;
  size_t index;
  json_array_foreach(runs, index, run) {
    bool fits = strcmp(figure_text(run, "solver"), solver) == 0 &&
                json_is_true(json_object_get(run, "solved"));
    if (fits && (!best || whole_time(run) < whole_time(best))) {
      best = run;
    }
  }
  return best;
}

static bool is_first(const json_t *runs, size_t index) {
  const char *solver = figure_text(json_array_get(runs, index), "solver");
  for (size_t k = 0; k < index; k++) {
    if (strcmp(figure_text(json_array_get(runs, k), "solver"), solver) == 0) {
      return false;
    }
  }
  return true;
}

static void print_linear_case(FILE *out, const json_t *linear_case) {
  const json_t *runs = json_object_get(linear_case, "runs"), *run;
  double ours = whole_time(json_array_get(runs, 0));
  size_t index;
  json_array_foreach(runs, index, run) {
    if (!is_first(runs, index)) {
      continue;
    }
    const char *solver = figure_text(run, "solver");
    const json_t *best = best_run(runs, solver);
    fprintf(out, "| %s | %.0f | %s |", figure_text(linear_case, "name"),
            figure_number(linear_case, "unknowns"), solver);
    if (!best) {
      fprintf(out, " none solves it: %s | - | - | - | - | - | - |\n", figure_text(run, "note"));
      continue;
    }
    fprintf(out, " %s | %.1f | %.1f | %.2f | %.0f | %.0e | %.2f |\n", figure_text(best, "variant"),
            1e3 * figure_number(best, "factor_s"), 1e3 * whole_time(best),
            figure_number(best, "dgemm_share"), 1e-6 * figure_number(best, "memory_bytes"),
            figure_number(best, "residual"), whole_time(best) / ours);
  }
}

void print_linear(FILE *out, const struct figures *figures) {
  const json_t *linear_case;
  size_t index;
  fputs("| matrix | unknowns | solver | its fastest variant | factor, ms | whole, ms | share of "
        "dgemm "
        "| memory, MB | residual | whole over ours |\n|---|---|---|---|---|---|---|---|---|---|\n",
        out);
  json_array_foreach(json_object_get(figures->part[FIGURES_LINEAR], "cases"), index, linear_case) {
    print_linear_case(out, linear_case);
  }
}
