#include "server/study/space.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

const char *space_coding_word(enum space_coding coding) {
  static const char *const words[] = {[SPACE_NUMBER] = "number",
                                      [SPACE_LOGARITHM] = "logarithm",
                                      [SPACE_FLAGS] = "flags",
                                      [SPACE_ORDER] = "order"};
  return words[coding];
}

/* ---- ranges ------------------------------------------------------------------------------- */

/* The most frequent of the words among values[count]. */
static double frequent_word(const double *values, size_t count, size_t words) {
  size_t most = 0, best = 0;
  for (size_t w = 0; w < words; w++) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
      found += values[i] == (double)w;
    }
    if (found > most) {
      most = found;
      best = w;
    }
  }
  return (double)best;
}

/* Fills the axis of a parameter from its values[count], all finite, which are sorted. */
static void axis_make(const struct study_column *column, double *values, size_t count,
                      struct space_axis *axis) {
  gsl_sort(values, 1, count);
  *axis = (struct space_axis){.low = values[0], .high = values[count - 1]};
  if (column->categorical) {
    axis->words = column->word_count;
    axis->coding = SPACE_FLAGS;
    axis->width = axis->words > 2 ? (int)axis->words : 1;
    axis->middle = frequent_word(values, count, axis->words);
    return;
  }
  axis->low = fmin(axis->low, isfinite(column->low) ? column->low : axis->low);
  axis->high = fmax(axis->high, isfinite(column->high) ? column->high : axis->high);
  axis->whole = column->unit[0] == '\0';
  for (size_t i = 0; i < count && axis->whole; i++) {
    axis->whole = values[i] == round(values[i]);
  }
  axis->middle = gsl_stats_median_from_sorted_data(values, 1, count);
  axis->middle = axis->whole ? round(axis->middle) : axis->middle;
  axis->coding = column->logarithmic && axis->low > 0.0 ? SPACE_LOGARITHM : SPACE_NUMBER;
  axis->width = 1;
}

/* While there are too many coordinates, the parameter with the most words gets one alone. */
static void limit_width(struct space *space) {
  for (;;) {
    size_t widest = 0;
    space->width = 0;
    for (size_t k = 0; k < space->parameters; k++) {
      space->axis[k].first = space->width;
      space->width += space->axis[k].width;
      widest = space->axis[k].width > space->axis[widest].width ? k : widest;
    }
    if (space->width <= SURROGATE_PARAMETERS_MAX) {
      return;
    }
    space->axis[widest].coding = SPACE_ORDER;
    space->axis[widest].width = 1;
  }
}

enum status space_make(const struct study_table *table, struct space *space, struct error *error) {
  *space = (struct space){.parameters = table->parameters};
  if (table->parameters == 0) {
    return error_set(error, STATUS_INVALID, NULL, "The study has no parameters.");
  }
  if (table->parameters > SURROGATE_PARAMETERS_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL,
                     "the study has %zu parameters\nat most %d for a surrogate", table->parameters,
                     SURROGATE_PARAMETERS_MAX);
  }
  double *values = malloc((table->members + 1) * sizeof *values);
  enum status status =
      values ? STATUS_OK
             : error_set(error, STATUS_NO_MEMORY, NULL, "No memory for the parameters of a study.");
  for (size_t k = 0; k < table->parameters && status == STATUS_OK; k++) {
    size_t count = 0;
    for (size_t i = 0; i < table->members; i++) {
      double value = table->value[i * table->parameters + k];
      if (isfinite(value)) {
        values[count++] = value;
      }
    }
    if (count == 0) {
      status = error_set(error, STATUS_INVALID, NULL, "No member has a value of %s.",
                         table->parameter[k].key);
    } else {
      axis_make(&table->parameter[k], values, count, &space->axis[k]);
    }
  }
  free(values);
  if (status == STATUS_OK) {
    limit_width(space);
  }
  return status;
}

/* ---- designs ------------------------------------------------------------------------------ */

bool space_encode(const struct space *space, const double *design, double *x) {
  for (size_t k = 0; k < space->parameters; k++) {
    const struct space_axis *axis = &space->axis[k];
    double value = design[k];
    if (!isfinite(value) || (axis->coding == SPACE_LOGARITHM && value <= 0.0)) {
      return false;
    }
    if (axis->coding == SPACE_FLAGS && axis->width > 1) {
      for (int w = 0; w < axis->width; w++) {
        x[axis->first + w] = value == w ? 1.0 : 0.0;
      }
    } else {
      x[axis->first] = axis->coding == SPACE_LOGARITHM ? log10(value) : value;
    }
  }
  return true;
}

void space_design(const struct space *space, const double *u, double *design) {
  for (size_t k = 0; k < space->parameters; k++) {
    const struct space_axis *axis = &space->axis[k];
    if (axis->words) {
      design[k] = fmin(floor(u[k] * (double)axis->words), (double)axis->words - 1.0);
    } else if (axis->whole) {
      design[k] = fmin(axis->low + floor(u[k] * (axis->high - axis->low + 1.0)), axis->high);
    } else if (axis->coding == SPACE_LOGARITHM) {
      design[k] = axis->low * pow(axis->high / axis->low, u[k]);
    } else {
      design[k] = axis->low + u[k] * (axis->high - axis->low);
    }
  }
}

void space_place(const struct space *space, const double *design, double *u) {
  for (size_t k = 0; k < space->parameters; k++) {
    const struct space_axis *axis = &space->axis[k];
    if (axis->words) {
      u[k] = (design[k] + 0.5) / (double)axis->words;
    } else if (axis->whole) {
      u[k] = (design[k] - axis->low + 0.5) / (axis->high - axis->low + 1.0);
    } else if (axis->high <= axis->low) {
      u[k] = 0.5;
    } else if (axis->coding == SPACE_LOGARITHM) {
      u[k] = log(design[k] / axis->low) / log(axis->high / axis->low);
    } else {
      u[k] = (design[k] - axis->low) / (axis->high - axis->low);
    }
  }
}

void space_round(const struct space *space, double *design) {
  for (size_t k = 0; k < space->parameters; k++) {
    const struct space_axis *axis = &space->axis[k];
    double width = axis->coding == SPACE_LOGARITHM ? design[k] : axis->high - axis->low;
    if (axis->words || width <= 0.0) {
      continue;
    }
    /* A power of ten, so that the decimal text is short. */
    double step = axis->whole ? 1.0 : pow(10.0, floor(log10(width / 500.0)));
    double rounded = step >= 1.0 ? round(design[k] / step) * step
                                 : round(design[k] * round(1.0 / step)) / round(1.0 / step);
    design[k] = fmin(fmax(rounded, axis->low), axis->high);
  }
}

void space_middle(const struct space *space, double *design) {
  for (size_t k = 0; k < space->parameters; k++) {
    design[k] = space->axis[k].middle;
  }
}

json_t *space_values(const struct study_table *table, const double *design) {
  json_t *values = json_object();
  for (size_t k = 0; k < table->parameters; k++) {
    const struct study_column *column = &table->parameter[k];
    size_t word = design[k] >= 0.0 ? (size_t)design[k] : 0;
    json_t *value = !isfinite(design[k]) ? json_null()
                    : column->categorical
                        ? json_string(word < column->word_count ? column->words[word] : "")
                        : json_real(design[k]);
    if (json_object_set_new(values, column->key, value) != 0) {
      json_decref(values);
      return NULL;
    }
  }
  return values;
}
