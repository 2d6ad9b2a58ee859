/* Any bytes as a table: finite numbers in rows of rising lines, or a sentence, never worse. The
 * first byte says who reads it: x the reader of tables, others a job with data. */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "solver/job/spec.h"
#include "tests/fuzz/fuzz.h"

static const struct {
  char who;
  const char *job;     /* with TABLE in place of the table */
  const char *pointer; /* to the object that holds the table */
} jobs[] = {
    {'i',
     "{\"kind\": \"identify\", \"mass\": \"2 kg\", \"gamma\": \"0.4 N/kPa\", \"data\": {},"
     " \"columns\": {\"time\": {\"name\": \"t\", \"unit\": \"s\"}, \"set_point\": {\"name\": \"u\","
     " \"unit\": \"kPa\"}, \"h\": {\"name\": \"h\", \"unit\": \"mm\"}, \"pressure\": {\"name\":"
     " \"p\", \"unit\": \"kPa\"}}, \"modes\": [{\"name\": \"free\", \"rest\": \"0 mm\"}]}",
     "data"},
    {'t',
     "{\"kind\": \"identify\", \"mass\": \"2 kg\", \"gamma\": \"0.4 N/kPa\", \"data\": {},"
     " \"held_out\": 0.3, \"columns\": {\"trial\": {\"name\": \"n\"}, \"time\": {\"name\": \"t\","
     " \"unit\": \"s\"}, \"set_point\": {\"name\": \"u\", \"unit\": \"kPa\"}, \"h\": {\"name\":"
     " \"h\", \"unit\": \"mm\"}, \"pressure\": {\"name\": \"p\", \"unit\": \"kPa\"}}, \"modes\":"
     " [{\"name\": \"short\", \"rest\": \"0 mm\"}, {\"name\": \"long\"}]}",
     "data"},
    {'s',
     "{\"kind\": \"fit-material\", \"model\": \"yeoh\", \"data\": {}, \"columns\": {\"strain\":"
     " {\"name\": \"e\", \"unit\": \"%\"}, \"stress\": {\"name\": \"s\", \"unit\": \"kPa\"}}}",
     "data"},
    {'g',
     "{\"kind\": \"fit-material\", \"model\": \"ogden\", \"strain\": \"true\", \"stress\":"
     " \"true\", \"range\": [0, 1], \"data\": {}, \"columns\": {\"extension\": {\"name\": \"e\","
     " \"unit\": \"mm\"}, \"gauge\": \"33 mm\", \"stress\": {\"name\": \"s\", \"unit\": \"MPa\"}}}",
     "data"},
    {'m',
     "{\"kind\": \"response\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"60 mm\","
     " \"width\": \"20 mm\", \"height\": \"15 mm\", \"chambers\": [{\"config\": \"B\", \"count\":"
     " 4}], \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"4 mm\"},"
     " \"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"30 kPa\", \"steps\":"
     " 6}}, \"measured\": {\"data\": {}, \"columns\": {\"pressure\": {\"name\": \"p\", \"unit\":"
     " \"kPa\"}, \"angle\": {\"name\": \"a\", \"unit\": \"deg\"}}}}",
     "measured"},
};

static void read_table(const char *text, size_t size) {
  static const struct table_column wanted[] = {{"x", "/columns/x"}, {"y", "/columns/y"}};
  struct table table;
  struct error error = {.status = STATUS_OK};
  enum status status = table_read(text, size, "/data/csv", wanted, 2, &table, &error);
  if (status != STATUS_OK) {
    if (error.status != status || error.message[0] == '\0' || error.pointer[0] != '/' ||
        table.rows > 0 || (status != STATUS_INVALID && status != STATUS_TOO_LARGE)) {
      abort();
    }
    return;
  }
  if (table.rows == 0 || table.rows > TABLE_ROWS_MAX) {
    abort();
  }
  for (size_t i = 0; i < table.rows; i++) {
    if (!isfinite(table.value[0][i]) || !isfinite(table.value[1][i]) || table.line[i] < 2 ||
        (i > 0 && table.line[i] <= table.line[i - 1])) {
      abort();
    }
  }
  table_release(&table);
}

/* A table is text: what is no UTF-8, or has a NUL, reaches no job. */
static void read_job(const char *job, const char *key, const char *text, size_t size) {
  static struct job_reader *reader;
  if (!reader && job_reader_create(&reader, NULL) != STATUS_OK) {
    abort();
  }
  json_t *csv = memchr(text, '\0', size) ? NULL : json_stringn(text, size);
  if (!csv) {
    return;
  }
  json_t *document = json_loads(job, 0, NULL);
  json_t *holder = json_object_get(document, key);
  json_t *inner = json_object_get(holder, "data");
  if (!holder || json_object_set_new(inner ? inner : holder, "csv", csv) != 0) {
    abort();
  }
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status = job_reader_check(reader, document, &spec, &error);
  if (status == STATUS_OK) {
    job_spec_release(&spec);
  } else if (error.status != status || error.message[0] == '\0' ||
             (status != STATUS_INVALID && status != STATUS_TOO_LARGE)) {
    abort();
  }
  json_decref(document);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *text = (const char *)data + 1;
  if (size == 0) {
    return 0;
  }
  for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
    if (data[0] == jobs[i].who) {
      read_job(jobs[i].job, jobs[i].pointer, text, size - 1);
      return 0;
    }
  }
  read_table(text, size - 1);
  return 0;
}
