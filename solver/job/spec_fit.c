#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/text.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"
#include "solver/job/tensile.h"

/* ---- columns of a table ----------------------------------------------------------------- */

enum status reader_column(const struct reader *reader, const json_t *columns, const char *pointer,
                          const char *key, const char *unit, const char *example,
                          struct column_spec *spec) {
  const json_t *column = json_object_get(columns, key);
  const char *given = json_string_value(json_object_get(column, "unit"));
  char quantity[80], where[60], quoted[60];
  reader_copy(spec->name, sizeof spec->name, json_string_value(json_object_get(column, "name")));
  snprintf(spec->pointer, sizeof spec->pointer, "%s/%s/name", pointer, key);
  snprintf(where, sizeof where, "%s/%s/unit", pointer, key);
  spec->si = 1.0;
  if (strcmp(given, "1") == 0 && strcmp(unit, "1") == 0) {
    return STATUS_OK;
  }
  snprintf(quantity, sizeof quantity, "1 %s", given);
  if (units_read(reader->units, quantity, unit, &spec->si, NULL) == STATUS_OK && spec->si > 0.0) {
    return STATUS_OK;
  }
  return error_set(reader->error, STATUS_INVALID, where,
                   "%s is no unit of the %s\nits units are for example %s",
                   text_quote(quoted, sizeof quoted, given), key, example);
}

static enum status read_columns(const struct reader *reader, const json_t *columns,
                                struct fit_spec *fit) {
  static const struct {
    const char *key, *unit, *example;
    enum abscissa abscissa;
  } abscissae[] = {{"strain", "1", "\"1\" or \"%\"", ABSCISSA_STRAIN},
                   {"stretch", "1", "\"1\"", ABSCISSA_STRETCH},
                   {"extension", "mm", "\"mm\"", ABSCISSA_EXTENSION}};
  const size_t kinds = sizeof abscissae / sizeof *abscissae;
  size_t found = kinds, given = 0;
  for (size_t i = 0; i < kinds; i++) {
    if (json_object_get(columns, abscissae[i].key)) {
      given++;
      found = i;
    }
  }
  if (given != 1) {
    return error_set(reader->error, STATUS_INVALID, "/columns",
                     "there are %zu columns of the strain\none of \"strain\", \"stretch\" and "
                     "\"extension\"\n{\"strain\": { \"name\": \"Strain\", \"unit\": \"%%\" }}",
                     given);
  }
  fit->abscissa = abscissae[found].abscissa;
  fit->gauge = reader_member(reader, columns, "gauge", "mm", 0.0);
  if ((fit->gauge > 0.0) != (fit->abscissa == ABSCISSA_EXTENSION)) {
    return error_set(reader->error, STATUS_INVALID, "/columns",
                     "only one of \"extension\" and \"gauge\", the length that it refers to, is "
                     "given\nboth or none\n{\"gauge\": \"33 mm\"}");
  }
  enum status status = reader_column(reader, columns, "/columns", abscissae[found].key,
                                     abscissae[found].unit, abscissae[found].example, &fit->strain);
  return status == STATUS_OK ? reader_column(reader, columns, "/columns", "stress", "MPa",
                                             "\"MPa\", \"kPa\" or \"N/mm2\"", &fit->stress)
                             : status;
}

/* ---- the law ---------------------------------------------------------------------------- */

static enum status read_model(const struct reader *reader, const json_t *document,
                              struct fit_spec *fit) {
  static const struct {
    const char *word;
    enum material_model model;
    int terms; /* 0: as the job says */
  } models[] = {{"neo-hooke", MATERIAL_NEO_HOOKE, 1},
                {"yeoh", MATERIAL_YEOH, 0},
                {"mooney-rivlin", MATERIAL_MOONEY_RIVLIN, 2},
                {"ogden", MATERIAL_OGDEN, 0}};
  const char *word = json_string_value(json_object_get(document, "model"));
  size_t i = 0;
  while (i + 1 < sizeof models / sizeof *models && strcmp(models[i].word, word) != 0) {
    i++;
  }
  fit->model = models[i].model;
  fit->terms = models[i].terms > 0 ? models[i].terms : reader_count(document, "terms", 2);
  fit->count = fit->model == MATERIAL_OGDEN ? 2 * fit->terms : fit->terms;
  if (models[i].terms > 0 && json_object_get(document, "terms")) {
    return error_set(reader->error, STATUS_INVALID, "/terms",
                     "the law \"%s\" has no choice of terms\nterms of \"yeoh\" and \"ogden\" only",
                     word);
  }
  return STATUS_OK;
}

/* The names of the law's coefficients; an Ogden law lists its moduli first. */
static const char *const *coefficient_names(const struct fit_spec *fit) {
  static const char *const neo_hooke[] = {"mu"}, *const yeoh[] = {"C1", "C2", "C3"},
                           *const mooney[] = {"C10", "C01"},
                           *const ogden[3][6] = {
                               {"mu1", "alpha1"},
                               {"mu1", "mu2", "alpha1", "alpha2"},
                               {"mu1", "mu2", "mu3", "alpha1", "alpha2", "alpha3"},
                           };
  return fit->model == MATERIAL_NEO_HOOKE       ? neo_hooke
         : fit->model == MATERIAL_YEOH          ? yeoh
         : fit->model == MATERIAL_MOONEY_RIVLIN ? mooney
                                                : ogden[fit->terms - 1];
}

const char *fit_coefficient_name(const struct fit_spec *fit, int index) {
  return coefficient_names(fit)[index];
}

bool fit_coefficient_is_exponent(const struct fit_spec *fit, int index) {
  return fit->model == MATERIAL_OGDEN && index >= fit->terms;
}

static double read_bound(const struct reader *reader, const json_t *value, bool exponent) {
  return exponent ? json_number_value(value) : reader_quantity(reader, value, "MPa");
}

static enum status read_bounds(const struct reader *reader, const json_t *bounds,
                               struct fit_spec *fit) {
  size_t used = 0;
  for (int i = 0; i < fit->count; i++) {
    bool exponent = fit_coefficient_is_exponent(fit, i);
    const char *name = fit_coefficient_name(fit, i);
    const json_t *pair = json_object_get(bounds, name);
    /* Exponents beyond 50 are no material of a job. */
    fit->lower[i] = exponent ? -50.0 : -INFINITY;
    fit->upper[i] = exponent ? 50.0 : INFINITY;
    if (!pair) {
      continue;
    }
    used++;
    fit->lower[i] = read_bound(reader, json_array_get(pair, 0), exponent);
    fit->upper[i] = read_bound(reader, json_array_get(pair, 1), exponent);
    if (!(fit->lower[i] < fit->upper[i])) {
      char pointer[40];
      snprintf(pointer, sizeof pointer, "/bounds/%s", name);
      return error_set(reader->error, STATUS_INVALID, pointer,
                       "the lower bound is not below the upper one\nthe lower one must be below "
                       "the upper one\n%s",
                       exponent ? "[1, 10]" : "[\"0 MPa\", \"1 MPa\"]");
    }
  }
  if (used < json_object_size(bounds)) {
    char list[80];
    int length = 0;
    for (int i = 0; i < fit->count; i++) {
      length += snprintf(list + length, sizeof list - (size_t)length, "%s\"%s\"", i > 0 ? ", " : "",
                         fit_coefficient_name(fit, i));
    }
    return error_set(reader->error, STATUS_INVALID, "/bounds",
                     "a bound names no coefficient of this law\nit has %s", list);
  }
  return STATUS_OK;
}

/* ---- the jobs --------------------------------------------------------------------------- */

static bool is_true_measure(const json_t *document, const char *key) {
  const char *word = json_string_value(json_object_get(document, key));
  return word && strcmp(word, "true") == 0;
}

/* A pair of rising numbers, left alone where it is absent. */
static enum status read_pair(const struct reader *reader, const json_t *document, const char *key,
                             const char *example, double *from, double *to) {
  const json_t *pair = json_object_get(document, key);
  char pointer[40];
  if (!pair) {
    return STATUS_OK;
  }
  *from = json_number_value(json_array_get(pair, 0));
  *to = json_number_value(json_array_get(pair, 1));
  snprintf(pointer, sizeof pointer, "/%s", key);
  return *from < *to ? STATUS_OK
                     : error_set(reader->error, STATUS_INVALID, pointer,
                                 "%g is not below %g\nthe first value must be below the second\n%s",
                                 *from, *to, example);
}

static void read_head(const struct reader *reader, const json_t *document, struct job_spec *spec) {
  reader_copy(spec->name, sizeof spec->name, json_string_value(json_object_get(document, "name")));
  spec->timeout_s = reader_member(reader, document, "timeout", "s", 0.0);
}

enum status reader_fit(const struct reader *reader, const json_t *document, struct job_spec *spec) {
  struct fit_spec *fit = &spec->fit;
  struct tensile_curve curve;
  spec->kind = JOB_FIT_MATERIAL;
  read_head(reader, document, spec);
  fit->true_strain = is_true_measure(document, "strain");
  fit->true_stress = is_true_measure(document, "stress");
  fit->density_kg_m3 = reader_member(reader, document, "density", "kg/m3", 0.0);
  fit->bulk_ratio = json_number_value(json_object_get(document, "bulk_ratio"));
  fit->from = -INFINITY;
  fit->to = INFINITY;
  enum status status = read_model(reader, document, fit);
  if (status == STATUS_OK) {
    status = read_pair(reader, document, "range", "[0, 1]", &fit->from, &fit->to);
  }
  if (status == STATUS_OK) {
    status = read_bounds(reader, json_object_get(document, "bounds"), fit);
  }
  if (status == STATUS_OK) {
    status = read_columns(reader, json_object_get(document, "columns"), fit);
  }
  if (status == STATUS_OK && fit->true_strain && fit->abscissa != ABSCISSA_STRAIN) {
    status =
        error_set(reader->error, STATUS_INVALID, "/strain",
                  "the column holds no strain, so no true one\n\"engineering\"\n\"engineering\"");
  }
  if (status == STATUS_OK) {
    status = tensile_read(document, fit, &curve, reader->error);
  }
  if (status == STATUS_OK) {
    tensile_release(&curve);
  }
  return status;
}

enum status reader_material_curve(const struct reader *reader, const json_t *document,
                                  struct job_spec *spec) {
  struct material_curve_spec *curve = &spec->curve;
  spec->kind = JOB_MATERIAL_CURVE;
  read_head(reader, document, spec);
  curve->points = reader_count(document, "points", 0);
  enum status status = read_pair(reader, document, "stretch", "[0.5, 3]", &curve->from, &curve->to);
  return status == STATUS_OK
             ? reader_material(reader, json_object_get(document, "material"), &spec->material)
             : status;
}
