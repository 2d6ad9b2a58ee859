#include "solver/job/measured.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "solver/base/text.h"
#include "solver/job/reader.h"

enum status reader_measured(const struct reader *reader, const json_t *document,
                            struct job_spec *spec) {
  const json_t *measured = json_object_get(document, "measured");
  const json_t *columns = json_object_get(measured, "columns");
  struct measured_spec *m = &spec->measured;
  struct measured_curve curve;
  if (!measured) {
    return STATUS_OK;
  }
  enum status status = reader_column(reader, columns, "/measured/columns", "pressure", "kPa",
                                     "\"kPa\", \"psi\" or \"bar\"", &m->pressure);
  if (status == STATUS_OK) {
    status = reader_column(reader, columns, "/measured/columns", "angle", "deg",
                           "\"deg\" or \"rad\"", &m->angle);
  }
  reader_copy(m->metric, sizeof m->metric, json_string_value(json_object_get(measured, "metric")));
  if (status == STATUS_OK) {
    status = measured_read(document, spec, &curve, reader->error);
  }
  if (status == STATUS_OK) {
    measured_release(&curve);
  }
  return status;
}

static enum status check_name(const struct column_spec *column, const char *const *words,
                              const char *holds, struct error *error) {
  char name[80];
  if (!text_mentions(column->name, words)) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, column->pointer,
                   "by its name the column %s holds %s\nthe column that was meant; are pressure "
                   "and angle exchanged?",
                   text_quote(name, sizeof name, column->name), holds);
}

/* Refuses columns whose names say the opposite of their use. */
static enum status check_names(const struct measured_spec *m, struct error *error) {
  static const char *const angles[] = {"angle", "(deg", "degree", "bending", NULL};
  static const char *const pressures[] = {"pressure", "kpa", "psi", NULL};
  enum status status = text_mentions(m->pressure.name, pressures)
                           ? STATUS_OK
                           : check_name(&m->pressure, angles, "an angle", error);
  if (status == STATUS_OK && !text_mentions(m->angle.name, angles)) {
    status = check_name(&m->angle, pressures, "a pressure", error);
  }
  return status;
}

static enum status check_overlap(const struct measured_curve *curve, const struct job_spec *spec,
                                 struct error *error) {
  double low = INFINITY, high = -INFINITY, to = spec->load.pressure_to;
  for (size_t i = 0; i < curve->count; i++) {
    if (curve->pressure[i] >= 0.0 && curve->pressure[i] <= to * (1.0 + 1e-9)) {
      return STATUS_OK;
    }
    low = fmin(low, curve->pressure[i]);
    high = fmax(high, curve->pressure[i]);
  }
  return error_set(
      error, STATUS_INVALID, "/measured/data/csv",
      "the measured pressures, %.4g to %.4g kPa, have nothing in common with the load\n"
      "0 to %.4g kPa; is the unit or the column another one?",
      1e-3 * low, 1e-3 * high, 1e-3 * to);
}

enum status measured_read(const json_t *document, const struct job_spec *spec,
                          struct measured_curve *curve, struct error *error) {
  const struct measured_spec *m = &spec->measured;
  const json_t *data = json_object_get(json_object_get(document, "measured"), "data");
  const json_t *text = json_object_get(data, "csv");
  const struct table_column wanted[] = {{m->pressure.name, m->pressure.pointer},
                                        {m->angle.name, m->angle.pointer}};
  struct table table;
  *curve = (struct measured_curve){.count = 0};
  enum status status = check_names(m, error);
  if (status == STATUS_OK) {
    status = table_read(json_string_value(text), json_string_length(text), "/measured/data/csv",
                        wanted, 2, &table, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  for (size_t i = 0; i < table.rows; i++) {
    table.value[0][i] *= m->pressure.si;
    table.value[1][i] *= m->angle.si;
  }
  *curve = (struct measured_curve){table.rows, table.value[0], table.value[1]};
  table.value[0] = table.value[1] = NULL; /* the curve's from here on */
  table_release(&table);
  status = check_overlap(curve, spec, error);
  if (status != STATUS_OK) {
    measured_release(curve);
  }
  return status;
}

void measured_release(struct measured_curve *curve) {
  free(curve->pressure);
  free(curve->angle);
  *curve = (struct measured_curve){.count = 0};
}
