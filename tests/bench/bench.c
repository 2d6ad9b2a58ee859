#include "tests/bench/bench.h"

#include <cblas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "solver/base/clock.h"

enum { JOB_SIZE_MAX = 1 << 20 };

bool bench_read_job(const char *path, struct job_spec *spec) {
  struct error error = {0};
  bool read = false;
  char *text = malloc(JOB_SIZE_MAX);
  FILE *file = fopen(path, "rb");
  if (!text || !file) {
    perror(path);
    goto done;
  }
  size_t size = fread(text, 1, JOB_SIZE_MAX, file);
  read = job_spec_read(text, size, spec, &error) == STATUS_OK;
  if (!read) {
    fprintf(stderr, "%s: %s\n", path, error.message);
  }
done:
  if (file) {
    fclose(file);
  }
  free(text);
  return read;
}

struct job_spec bench_resize(const struct job_spec *spec, const struct bench_size *size) {
  struct job_spec resized = *spec;
  struct pneunet_spec *p = &resized.pneunet;
  resized.mesh = size->mesh;
  if (size->chambers > 0) {
    double pitch = p->cavity_length + 2 * p->gap_wall + p->chamber_gap;
    double length = size->chambers * pitch - p->chamber_gap, flatter = fmin(1, p->length / length);
    p->taper_top *= flatter;
    p->taper_bottom *= flatter;
    p->taper_left *= flatter;
    p->taper_right *= flatter;
    p->length = length;
    p->run_count = 1;
    p->runs[0].count = p->chamber_count = size->chambers;
  }
  return resized;
}

double bench_dgemm_rate(void) {
  const int n = 640;
  const size_t size = (size_t)n * (size_t)n;
  double *a = malloc(3 * size * sizeof *a), best = INFINITY;
  if (!a) {
    return NAN;
  }
  for (size_t i = 0; i < 3 * size; i++) {
    a[i] = 1 / (1.0 + (double)i);
  }
  for (int k = 0; k < 12; k++) {
    double start = clock_cpu_s();
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, n, n, n, 1, a, n, a + size, n, 0,
                a + 2 * size, n);
    best = fmin(best, clock_cpu_s() - start);
  }
  free(a);
  return 2.0 * n * n * n / best;
}

/* Name of the processor as the kernel gives it. */
static void processor_name(char *name, size_t size) {
  char line[256];
  FILE *file = fopen("/proc/cpuinfo", "r");
  snprintf(name, size, "unknown");
  while (file && fgets(line, sizeof line, file)) {
    const char *colon = strchr(line, ':');
    if (strncmp(line, "model name", 10) == 0 && colon) {
      snprintf(name, size, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
      break;
    }
  }
  if (file) {
    fclose(file);
  }
}

json_t *bench_machine(double dgemm_rate) {
  char name[128];
  processor_name(name, sizeof name);
  return json_pack("{s:s, s:i, s:s, s:s, s:f}", "processor", name, "cores",
                   (int)sysconf(_SC_NPROCESSORS_ONLN), "blas", openblas_get_config(),
                   "blas_kernels", openblas_get_corename(), "dgemm_flop_s", dgemm_rate);
}

char *bench_absolute(const char *path) {
  char *here = path[0] == '/' ? strdup("") : getcwd(NULL, 0), *absolute = NULL;
  if (here && asprintf(&absolute, "%s%s%s", here, *here ? "/" : "", path) < 0) {
    absolute = NULL;
  }
  free(here);
  return absolute;
}

bool bench_write_json(const char *path, const json_t *document) {
  if (!document || json_dump_file(document, path, JSON_INDENT(1) | JSON_REAL_PRECISION(6)) != 0) {
    fprintf(stderr, "%s: cannot be written\n", path);
    return false;
  }
  return true;
}
