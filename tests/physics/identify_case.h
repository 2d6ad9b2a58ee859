/* Identify jobs of synthetic trials. Whatever fails, fails the test. */
#ifndef PNEULAB_TESTS_PHYSICS_IDENTIFY_CASE_H
#define PNEULAB_TESTS_PHYSICS_IDENTIFY_CASE_H

#include <check.h>
#include <gsl/gsl_rng.h>
#include <jansson.h>
#include "solver/job/spec.h"
#include "tests/physics/synthetic.h"
#include "tests/unit/suite.h"

#define PSI 6894.757293168361

/* Reads a preset of jobs/beast; to be released. */
void case_preset(const char *name, struct job_spec *spec);

/* Trials of a model by the matrix exponential, to be released by case_release. */
void case_trials(const struct hlpv_spec *model, const struct synthetic_run *run, size_t count,
                 const struct synthetic_plan *plan, struct synthetic_trial *trial);
void case_release(struct synthetic_trial *trial, size_t count);

/* Their table as the text of a JSON string, to be freed; noise: standard deviation of normal noise,
 * part of the ranges of each trial. The generator may be NULL without noise. */
char *case_table(const struct synthetic_trial *trial, size_t count, double noise,
                 gsl_rng *generator);

/* The result of the job of a table, a new reference; rest: the members of the document beside the
 * table and its columns. */
json_t *case_run(const char *table, const char *rest);

/* The object of an array with that "name". */
const json_t *case_named(const json_t *array, const char *name);

/* The i-th coefficient of a polynomial of a mode. */
const json_t *case_coefficient(const json_t *document, const char *mode, const char *key, size_t i);

double case_number(const json_t *object, const char *key);

#endif
