/* Runs pneulab-solve on jobs that a benchmark makes up, each in a process of its own. */
#ifndef PNEULAB_TESTS_SOLVER_CALL_H
#define PNEULAB_TESTS_SOLVER_CALL_H

#include <jansson.h>
#include <stdbool.h>
#include "tests/bench/robust_pool.h"

enum { CALL_OPTIONS = 4, CALL_PATH = 4096 };

/* Where and how calls run. */
struct solver_place {
  char program[CALL_PATH];   /* absolute path of pneulab-solve */
  char directory[CALL_PATH]; /* of temporary files */
  double limit_s;            /* CPU time of a call */
};

struct solver_call {
  const json_t *job;                /* the caller's */
  const char *option[CALL_OPTIONS]; /* before the job; those after the last one are NULL */
  json_t *result;                   /* the caller's afterwards; NULL when none was written */
  struct pool_end end;
};

/* Finds the program and makes a temporary directory; dense linear algebra and OpenMP of all
 * children get one thread. False with a message on standard error. */
bool solver_place_create(struct solver_place *place, const char *program, double limit_s);

/* Removes the temporary directory with its files. */
void solver_place_remove(const struct solver_place *place);

/* Runs all calls, `width` at a time. False, with a message on standard error, when a call leaves
 * no result document (--deck as first option leaves none) or is
 * ended by its time limit; `count` is at most 8. */
bool solver_call_run(const struct solver_place *place, struct solver_call *calls, int count,
                     int width);

/* Number at `key` of the result's block ("metrics", "statistics"), or NAN. */
double solver_call_number(const struct solver_call *call, const char *block, const char *key);

/* CPU time of the load path, without the estimate of the errors after it, s. */
double solver_call_path_s(const struct solver_call *call);

/* Releases the result. */
void solver_call_release(struct solver_call *call);

#endif
