/* make_trials PRESET.json SEED NOISE: a table of step trials of a preset of jobs/beast on standard
 * output, for an identify job. The published protocol, 10 s at 1 to 4 psi compressed and at 1 to 8
 * psi stretched and 10 s back at 0, three of each, after 0.25 s at 0; then three runs that snap and
 * come back by vacuum. NOISE is the standard deviation of the normal noise of h and pressure, a
 * part of the range of each in its trial. 120 Hz before the first step and for half a second after
 * each, 5 Hz then. */
#include <gsl/gsl_randist.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/spec.h"
#include "tests/physics/synthetic.h"

#define PSI 6894.757293168361

static char text[1 << 20];

static const struct synthetic_plan plan = {
    .before = 0.25, .hold = 10.0, .fast = 120.0, .fast_time = 0.5, .slow = 5.0};

static void print_trial(int number, const struct synthetic_trial *trial, double noise,
                        gsl_rng *generator) {
  double sigma_h = noise * synthetic_range(trial->h, trial->count);
  double sigma_p = noise * synthetic_range(trial->pressure, trial->count);
  for (size_t i = 0; i < trial->count; i++) {
    double h = trial->h[i] + gsl_ran_gaussian(generator, sigma_h);
    double p = trial->pressure[i] + gsl_ran_gaussian(generator, sigma_p);
    printf("%d,%.7g,%.6g,%.3f,%.3f\n", number, trial->time[i], 1e-3 * trial->set_point[i], 1e3 * h,
           1e-3 * p);
  }
}

int main(int argc, char **argv) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  struct synthetic_run run[SYNTHETIC_RUNS_MAX];
  FILE *file = argc == 4 ? fopen(argv[1], "rb") : NULL;
  if (!file) {
    fprintf(stderr, "usage: make_trials PRESET.json SEED NOISE\n");
    return EXIT_FAILURE;
  }
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  if (job_spec_read(text, size, &spec, &error) != STATUS_OK || !spec.hlpv) {
    fprintf(stderr, "%s: %s\n", argv[1], error.message);
    return EXIT_FAILURE;
  }
  size_t count = synthetic_protocol(3, run);
  static const double snaps[] = {5.2, 5.5, 6.0};
  for (int i = 0; i < 3; i++) {
    run[count++] = (struct synthetic_run){0, snaps[i] * PSI, -2.0 * PSI};
  }
  gsl_rng *generator = gsl_rng_alloc(gsl_rng_mt19937);
  gsl_rng_set(generator, strtoul(argv[2], NULL, 10));
  printf("trial,t (s),set-point (kPa),h (mm),pressure (kPa)\n");
  for (size_t i = 0; i < count; i++) {
    struct synthetic_trial trial;
    synthetic_make(spec.hlpv, &run[i], &plan, &trial);
    print_trial((int)i + 1, &trial, strtod(argv[3], NULL), generator);
    synthetic_release(&trial);
  }
  gsl_rng_free(generator);
  job_spec_release(&spec);
  return EXIT_SUCCESS;
}
