/* What the benchmarks share: the job, the machine's speed, the machine's description. */
#ifndef PNEULAB_TESTS_BENCH_H
#define PNEULAB_TESTS_BENCH_H

#include <jansson.h>
#include <stdbool.h>
#include "solver/job/spec.h"

/* Elements through each feature of the body, and how many chambers it has (0: as in the job). */
struct bench_size {
  int chambers;
  struct mesh_spec mesh;
};

/* Reads a job file; a message on standard error and false when it cannot be used. */
bool bench_read_job(const char *path, struct job_spec *spec);

/* The job with another mesh and, for size->chambers > 0, another number of chambers in the first
 * of its runs, the others dropped; the body's length follows, and a longer body
 * tapers at a smaller angle, so that its tip is as wide. */
struct job_spec bench_resize(const struct job_spec *spec, const struct bench_size *size);

/* Best rate of several products of 640 x 640 matrices on one thread, flop/s. */
double bench_dgemm_rate(void);

/* Description of machine and libraries for the head of a JSON file; a new reference, or NULL. */
json_t *bench_machine(double dgemm_rate);

/* Absolute form of a path whose file need not exist, for programs that change their directory.
 * The caller frees it; NULL when memory runs out. */
char *bench_absolute(const char *path);

/* Writes `document` to `path`; false with a message on standard error when that fails. */
bool bench_write_json(const char *path, const json_t *document);

#endif
