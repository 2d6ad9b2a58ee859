#include "tests/physics/identify_case.h"

#include <check.h>
#include <gsl/gsl_randist.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/identify/identify_job.h"

/* Reads a preset of jobs/beast. */
void case_preset(const char *name, struct job_spec *spec) {
  static char text[1 << 16];
  const char *source = getenv("srcdir");
  char path[600];
  snprintf(path, sizeof path, "%s/jobs/beast/%s.json", source ? source : ".", name);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(job_spec_read(text, size, spec, &error) == STATUS_OK, "%s", error.message);
}

/* A table of trials as the "data" of a job; noise: part of the ranges. */
char *case_table(const struct synthetic_trial *trial, size_t count, double noise,
                 gsl_rng *generator) {
  size_t rows = 0;
  for (size_t i = 0; i < count; i++) {
    rows += trial[i].count;
  }
  char *text = malloc(100 * rows + 100), *at = text;
  ck_assert_ptr_nonnull(text);
  at += sprintf(at, "n,t,u,h,p\\n");
  for (size_t i = 0; i < count; i++) {
    double sigma_h = noise * synthetic_range(trial[i].h, trial[i].count);
    double sigma_p = noise * synthetic_range(trial[i].pressure, trial[i].count);
    for (size_t k = 0; k < trial[i].count; k++) {
      double h = trial[i].h[k] + (noise > 0.0 ? gsl_ran_gaussian(generator, sigma_h) : 0.0);
      double p = trial[i].pressure[k] + (noise > 0.0 ? gsl_ran_gaussian(generator, sigma_p) : 0.0);
      at +=
          sprintf(at, noise > 0.0 ? "%zu,%.6g,%.9g,%.6g,%.6g\\n" : "%zu,%.12g,%.12g,%.11g,%.11g\\n",
                  i + 1, trial[i].time[k], trial[i].set_point[k], h, p);
    }
  }
  return text;
}

static const char columns[] =
    "\"columns\":{\"trial\":{\"name\":\"n\",\"unit\":\"1\"},\"time\":{\"name\":\"t\",\"unit\":"
    "\"s\"},\"set_point\":{\"name\":\"u\",\"unit\":\"Pa\"},\"h\":{\"name\":\"h\",\"unit\":\"m\"},"
    "\"pressure\":{\"name\":\"p\",\"unit\":\"Pa\"}}";

/* Runs the job of a table; rest: the other members of the document. */
json_t *case_run(const char *table, const char *rest) {
  size_t size = strlen(table) + strlen(rest) + sizeof columns + 200;
  char *text = malloc(size);
  static struct job_reader *reader; /* kept: creating it takes 10 ms */
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  json_t *document = NULL;
  enum status ending = STATUS_INTERNAL;
  ck_assert_ptr_nonnull(text);
  snprintf(text, size, "{\"kind\":\"identify\",\"data\":{\"csv\":\"%s\"},%s,%s}", table, columns,
           rest);
  ck_assert(reader || job_reader_create(&reader, &error) == STATUS_OK);
  ck_assert_msg(job_reader_read(reader, text, strlen(text), &spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  ck_assert_msg(identify_job(&spec, NULL, NULL, &document, &ending, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(ending == STATUS_OK, "%s", json_string_value(json_object_get(document, "message")));
  job_spec_release(&spec);
  free(text);
  return document;
}

/* Trials of a model by the matrix exponential, released by release_trials. */
void case_trials(const struct hlpv_spec *model, const struct synthetic_run *run, size_t count,
                 const struct synthetic_plan *plan, struct synthetic_trial *trial) {
  for (size_t i = 0; i < count; i++) {
    synthetic_make(model, &run[i], plan, &trial[i]);
  }
}

void case_release(struct synthetic_trial *trial, size_t count) {
  for (size_t i = 0; i < count; i++) {
    synthetic_release(&trial[i]);
  }
}

const json_t *case_named(const json_t *array, const char *name) {
  size_t index;
  const json_t *value;
  json_array_foreach(array, index, value) {
    if (strcmp(json_string_value(json_object_get(value, "name")), name) == 0) {
      return value;
    }
  }
  ck_abort_msg("no %s", name);
  return NULL;
}

/* The i-th coefficient of a polynomial of a mode. */
const json_t *case_coefficient(const json_t *document, const char *mode, const char *key,
                               size_t i) {
  const json_t *m = case_named(json_object_get(document, "modes"), mode);
  const json_t *p = json_object_get(json_object_get(m, "polynomials"), key);
  const json_t *c = json_array_get(json_object_get(p, "coefficients"), i);
  ck_assert_msg(c != NULL, "no coefficient %zu of %s of %s", i, key, mode);
  return c;
}

double case_number(const json_t *object, const char *key) {
  const json_t *value = json_object_get(object, key);
  ck_assert_msg(json_is_number(value), "no number %s", key);
  return json_number_value(value);
}
