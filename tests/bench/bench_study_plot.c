/* How long the plots of a study take: bench_study_plot [--json FILE] [MEMBERS]. Each of them is
 * drawn at 800 x 600 pixels, once to warm up and then 15 times; the medians of elapsed and of
 * processor time count.
 * The study is made up; its analyses are there, as they are in the daemon when a plot is drawn. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/unit/study_plot_samples.h"

enum { REPETITIONS = 15, MEMBERS = 10000 };

static double now_ms(clockid_t clock) {
  struct timespec time;
  clock_gettime(clock, &time);
  return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Draws one plot again and again; a new reference, or NULL when it cannot be drawn. */
static json_t *measure(const char *plot, const struct study_sample *sample,
                       enum colour_theme theme) {
  const struct plot_sheet sheet = {.width = 800, .height = 600, .theme = theme};
  const struct study_plot_options options = {0};
  double times[REPETITIONS], busy[REPETITIONS];
  size_t size = 0;
  for (int i = -1; i < REPETITIONS; i++) {
    unsigned char *png = NULL;
    struct error error = {0};
    double start = now_ms(CLOCK_MONOTONIC), start_busy = now_ms(CLOCK_THREAD_CPUTIME_ID);
    if (study_plot_render(plot, &sample->input, &options, &sheet, &png, &size, &error) !=
        STATUS_OK) {
      fprintf(stderr, "%s: %s\n", plot, error.message);
      return NULL;
    }
    times[i < 0 ? 0 : i] = now_ms(CLOCK_MONOTONIC) - start;
    busy[i < 0 ? 0 : i] = now_ms(CLOCK_THREAD_CPUTIME_ID) - start_busy;
    free(png);
  }
  qsort(busy, REPETITIONS, sizeof *busy, compare);
  qsort(times, REPETITIONS, sizeof *times, compare);
  printf("%-12s %-6s p50 %6.1f ms  processor %6.1f ms  %4zu kB\n", plot,
         theme == THEME_DARK ? "dark" : "light", times[REPETITIONS / 2], busy[REPETITIONS / 2],
         size / 1000);
  return json_pack("{s:s, s:s, s:f, s:f, s:I}", "plot", plot, "theme",
                   theme == THEME_DARK ? "dark" : "light", "p50_ms", times[REPETITIONS / 2],
                   "processor_ms", busy[REPETITIONS / 2], "bytes", (json_int_t)size);
}

int main(int argc, char **argv) {
  const char *path = argc > 2 && strcmp(argv[1], "--json") == 0 ? argv[2] : NULL;
  const char *members = argc > (path ? 3 : 1) ? argv[path ? 3 : 1] : NULL;
  struct study_sample *sample =
      study_sample_spread(members ? (size_t)strtoul(members, NULL, 10) : MEMBERS, 2);
  json_t *list = json_array();
  bool fine = true;
  for (const char *const *plot = study_plot_names(); *plot; plot++) {
    for (int theme = 0; theme < THEME_COUNT; theme++) {
      json_t *one = measure(*plot, sample, (enum colour_theme)theme);
      fine = fine && one;
      json_array_append_new(list, one);
    }
  }
  json_t *document =
      json_pack("{s:I, s:O}", "members", (json_int_t)sample->table.members, "plots", list);
  if (path && json_dump_file(document, path, JSON_INDENT(2)) != 0) {
    fprintf(stderr, "%s cannot be written\n", path);
    fine = false;
  }
  json_decref(document);
  json_decref(list);
  study_sample_destroy(sample);
  return fine ? EXIT_SUCCESS : EXIT_FAILURE;
}
