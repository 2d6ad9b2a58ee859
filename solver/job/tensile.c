#include "solver/job/tensile.h"

#include <math.h>
#include <stdlib.h>

#include "solver/base/table.h"
#include "solver/base/text.h"

/* No elastomer is stretched further, softer or stiffer: beyond these bounds the unit or the column
 * is another one. */
static const double stretch_limit = 50.0, modulus_min = 100.0, modulus_max = 1e9;

static const char exchanged[] = "are the columns of strain and stress exchanged, or is the unit "
                                "another one?";

/* ---- names ------------------------------------------------------------------------------ */

/* Refuses columns whose names say the opposite of their use. */
static enum status check_names(const struct fit_spec *fit, struct error *error) {
  static const char *const strains[] = {"strain",       "stretch",    "extension",
                                        "displacement", "elongation", NULL};
  static const char *const stresses[] = {"stress", "mpa", "kpa", "n/mm2", NULL};
  char name[80];
  if (text_mentions(fit->strain.name, stresses) && !text_mentions(fit->strain.name, strains)) {
    return error_set(
        error, STATUS_INVALID, fit->strain.pointer,
        "by its name the column %s holds a stress, not a strain\na column of strains; %s",
        text_quote(name, sizeof name, fit->strain.name), exchanged);
  }
  if (text_mentions(fit->stress.name, strains) && !text_mentions(fit->stress.name, stresses)) {
    return error_set(
        error, STATUS_INVALID, fit->stress.pointer,
        "by its name the column %s holds a strain, not a stress\na column of stresses; %s",
        text_quote(name, sizeof name, fit->stress.name), exchanged);
  }
  return STATUS_OK;
}

/* ---- values ----------------------------------------------------------------------------- */

static double stretch_of(const struct fit_spec *fit, double value) {
  switch (fit->abscissa) {
  case ABSCISSA_STRETCH:
    return value;
  case ABSCISSA_EXTENSION:
    return 1.0 + value / fit->gauge;
  case ABSCISSA_STRAIN:
    break;
  }
  return fit->true_strain ? exp(value) : 1.0 + value;
}

/* Turns the table's numbers into engineering strain and stress in place. */
static enum status convert(const struct fit_spec *fit, struct table *table, struct error *error) {
  for (size_t i = 0; i < table->rows; i++) {
    double given = table->value[0][i];
    double stretch = stretch_of(fit, given * fit->strain.si);
    if (!(stretch > 0.0) || stretch > stretch_limit) {
      return error_set(error, STATUS_INVALID, "/data/csv",
                       "line %d of the table: %.6g in the column of the strain is a stretch of "
                       "%.4g\nit must be more than 0 and at most %g; %s",
                       table->line[i], given, stretch, stretch_limit, exchanged);
    }
    table->value[0][i] = stretch - 1.0;
    table->value[1][i] *= fit->stress.si / (fit->true_stress ? stretch : 1.0);
  }
  return STATUS_OK;
}

/* What the whole curve looks like. */
struct look {
  size_t nearest, farthest;            /* rows with the smallest and the largest strain, by size */
  double stress_max;                   /* by size */
  double covariance;                   /* of strain and stress */
  size_t strain_back, stress_back;     /* rows in which one is less than in the row before */
  int strain_back_line;                /* the first of them */
  double strain_uneven, stress_uneven; /* spread of the steps over their mean */
};

/* Standard deviation of the steps between rows over their mean; infinite without a mean. */
static double unevenness(const double *value, size_t count) {
  double mean = count > 1 ? (value[count - 1] - value[0]) / (double)(count - 1) : 0.0;
  double square = 0.0;
  for (size_t i = 1; i < count; i++) {
    double off = value[i] - value[i - 1] - mean;
    square += off * off;
  }
  return mean != 0.0 ? sqrt(square / (double)(count - 1)) / fabs(mean) : INFINITY;
}

static struct look look_at(const struct table *table) {
  const double *e = table->value[0], *s = table->value[1];
  struct look look = {0};
  double mean_e = 0.0, mean_s = 0.0, n = (double)table->rows;
  for (size_t i = 0; i < table->rows; i++) {
    mean_e += e[i] / n;
    mean_s += s[i] / n;
    look.nearest = fabs(e[i]) < fabs(e[look.nearest]) ? i : look.nearest;
    look.farthest = fabs(e[i]) > fabs(e[look.farthest]) ? i : look.farthest;
    look.stress_max = fmax(look.stress_max, fabs(s[i]));
    if (i > 0 && e[i] < e[i - 1] && look.strain_back++ == 0) {
      look.strain_back_line = table->line[i];
    }
    look.stress_back += i > 0 && s[i] < s[i - 1];
  }
  for (size_t i = 0; i < table->rows; i++) {
    look.covariance += (e[i] - mean_e) * (s[i] - mean_s);
  }
  look.strain_uneven = unevenness(e, table->rows);
  look.stress_uneven = unevenness(s, table->rows);
  return look;
}

static enum status check_look(const struct table *table, const struct look *look,
                              struct error *error) {
  const double *e = table->value[0], *s = table->value[1];
  size_t near = look->nearest, far = look->farthest;
  double modulus = e[far] != 0.0 ? s[far] / e[far] : 0.0;
  if (!(look->covariance > 0.0)) {
    return error_set(error, STATUS_INVALID, "/data/csv",
                     "the stress does not rise with the strain (%zu rows, lines %d to %d of the "
                     "table)\npulling is positive and pushing negative in both; %s",
                     table->rows, table->line[0], table->line[table->rows - 1], exchanged);
  }
  if (look->strain_back >= 3 && look->stress_back == 0) {
    return error_set(error, STATUS_INVALID, "/data/csv",
                     "the strain goes back %zu times, first in line %d of the table, while the "
                     "stress never does\na strain that rises as the stress does; %s",
                     look->strain_back, look->strain_back_line, exchanged);
  }
  if (fabs(e[near]) < 0.2 * fabs(e[far]) && fabs(s[near]) > 0.5 * look->stress_max) {
    return error_set(error, STATUS_INVALID, "/data/csv",
                     "line %d of the table: at a strain of %.4g the stress is %.4g MPa of at most "
                     "%.4g MPa, so the curve does not start near zero\nat most half of the largest "
                     "stress there; %s",
                     table->line[near], e[near], 1e-6 * s[near], 1e-6 * look->stress_max,
                     exchanged);
  }
  if (!(modulus >= modulus_min && modulus <= modulus_max)) {
    return error_set(error, STATUS_INVALID, "/data/csv",
                     "line %d of the table: %.4g MPa at a strain of %.4g is a modulus of %.4g MPa, "
                     "no elastomer's\n0.0001 to 1000 MPa; %s",
                     table->line[far], 1e-6 * s[far], e[far], 1e-6 * modulus, exchanged);
  }
  return STATUS_OK;
}

/* ---- the range -------------------------------------------------------------------------- */

static enum status select_range(const struct fit_spec *fit, const struct table *table,
                                struct tensile_curve *curve, struct error *error) {
  double low = INFINITY, high = -INFINITY;
  curve->strain = calloc(table->rows, sizeof *curve->strain);
  curve->stress = calloc(table->rows, sizeof *curve->stress);
  if (!curve->strain || !curve->stress) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a curve");
  }
  double margin = 1e-9;
  for (size_t i = 0; i < table->rows; i++) {
    double e = table->value[0][i];
    low = fmin(low, e);
    high = fmax(high, e);
    if (e >= fit->from - margin && e <= fit->to + margin) {
      curve->strain[curve->count] = e;
      curve->stress[curve->count++] = table->value[1][i];
    }
  }
  if (curve->count < (size_t)fit->count + 2) {
    bool whole = isinf(fit->from) && isinf(fit->to);
    return error_set(error, STATUS_INVALID, whole ? "/data/csv" : "/range",
                     "%zu of %zu points are used\nfor %d coefficients at least %d; the strains of "
                     "the table go from %.4g to %.4g",
                     curve->count, table->rows, fit->count, fit->count + 2, low, high);
  }
  return STATUS_OK;
}

enum status tensile_read(const json_t *document, const struct fit_spec *fit,
                         struct tensile_curve *curve, struct error *error) {
  const json_t *text = json_object_get(json_object_get(document, "data"), "csv");
  const struct table_column wanted[] = {{fit->strain.name, fit->strain.pointer},
                                        {fit->stress.name, fit->stress.pointer}};
  struct table table;
  *curve = (struct tensile_curve){.count = 0};
  enum status status = table_read(json_string_value(text), json_string_length(text), "/data/csv",
                                  wanted, 2, &table, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = check_names(fit, error);
  if (status == STATUS_OK) {
    status = convert(fit, &table, error);
  }
  if (status == STATUS_OK) {
    struct look look = look_at(&table);
    curve->stress_driven = table.rows > 10 && look.stress_uneven < 0.05 && look.strain_uneven > 0.1;
    status = check_look(&table, &look, error);
  }
  if (status == STATUS_OK) {
    status = select_range(fit, &table, curve, error);
  }
  if (status != STATUS_OK) {
    tensile_release(curve);
  }
  table_release(&table);
  return status;
}

void tensile_release(struct tensile_curve *curve) {
  free(curve->strain);
  free(curve->stress);
  *curve = (struct tensile_curve){.count = 0};
}
