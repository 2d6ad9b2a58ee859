#include <math.h>

#include "tools/performance.h"

void print_hybrid(FILE *out, const struct figures *figures) {
  const json_t *document = figures->part[FIGURES_HYBRID];
  const json_t *own = json_object_get(document, "simulation");
  const json_t *octave = json_object_get(document, "octave");
  fprintf(out,
          "| | |\n|---|---|\n| with %.0f samples | %.2f ms |\n| without samples | %.2f ms |\n"
          "| steps, evaluations | %.0f, %.0f |\n| error of the last state, of the switches | %.1e "
          "of its size, %.1e s |\n",
          figure_number(own, "samples"), 1e3 * figure_number(own, "with_samples_s"),
          1e3 * figure_number(own, "without_samples_s"), figure_number(own, "steps"),
          figure_number(own, "evaluations"), figure_number(own, "state_error"),
          figure_number(own, "event_error_s"));
  if (isfinite(figure_number(octave, "ratio"))) {
    fprintf(out,
            "| `ode45` of Octave %s at 1e-8 | %.3f s |\n| its errors | %.1e of its size, %.1e s |\n"
            "| its time over ours with samples | **%.0f** |\n",
            figure_text(octave, "version"), figure_number(octave, "time_s"),
            figure_number(octave, "state_error"), figure_number(octave, "event_error_s"),
            figure_number(octave, "ratio"));
  } else {
    fprintf(out, "\nNo comparison: %s.\n", figure_text(octave, "skipped"));
  }
}

void print_queue(FILE *out, const struct figures *figures) {
  const json_t *queue = figures->part[FIGURES_QUEUE];
  fprintf(
      out,
      "| | |\n|---|---|\n| simulations that came to their end | %.0f of %.0f |\n"
      "| the POST, in which every member is checked | %.2f s |\n"
      "| from then until the result is in the database | %.1f s |\n"
      "| CPU time of the solvers, of the daemon | %.1f, %.1f s |\n"
      "| simulations a minute, of wall-clock time and of a core | %.0f, **%.0f** |\n"
      "| peak memory of solver and daemon | %.0f, %.0f MB |\n"
      "| the result; page of the job, result, plot of a metric | %.1f MB; %.2f, %.2f, %.2f s |\n",
      figure_number(queue, "solved"), figure_number(queue, "members"),
      figure_number(queue, "post_s"), figure_number(queue, "wall_s"), figure_number(queue, "cpu_s"),
      figure_number(queue, "daemon_cpu_s"), figure_number(queue, "simulations_per_minute_wall"),
      figure_number(queue, "simulations_per_minute_core"),
      figure_number(queue, "solver_peak_memory_MB"), figure_number(queue, "daemon_peak_memory_MB"),
      1e-6 * figure_number(queue, "result_bytes"), figure_number(queue, "page_s"),
      figure_number(queue, "result_s"), figure_number(queue, "plot_s"));
}
