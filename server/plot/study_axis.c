#include "server/plot/study_axis.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Values that differ by less than this part of their range are one. */
static const double same = 1e-6;

bool study_row_counts(const struct study_table *table, size_t row) {
  return table->state[row] == JOB_STATE_SUCCEEDED;
}

bool study_row_failed(const struct study_table *table, size_t row) {
  return !study_row_counts(table, row) && job_state_terminal((enum job_state)table->state[row]);
}

double study_axis_at(const struct study_axis *axis, size_t row) {
  const struct study_table *table = axis->table;
  if (axis->metric && !study_row_counts(table, row)) {
    return NAN;
  }
  double value = axis->metric ? table->result[row * table->metrics + axis->index]
                              : table->value[row * table->parameters + axis->index];
  value = axis->logarithmic ? log10(value) : value;
  return isfinite(value) && fabs(value) < 1e12 ? value : NAN;
}

/* Logarithms are taken only of what is above zero throughout. */
static bool all_positive(const struct study_axis *axis) {
  for (size_t row = 0; row < axis->table->members; row++) {
    if (study_axis_at(axis, row) <= 0) {
      return false;
    }
  }
  return true;
}

static struct study_axis make(const struct study_table *table, bool metric, size_t index) {
  struct study_axis axis = {.table = table,
                            .column = metric ? &table->metric[index] : &table->parameter[index],
                            .metric = metric,
                            .index = index,
                            .low = INFINITY,
                            .high = -INFINITY};
  axis.logarithmic = axis.column->logarithmic && !axis.column->categorical && all_positive(&axis);
  for (size_t row = 0; row < table->members; row++) {
    double at = study_axis_at(&axis, row);
    axis.low = fmin(axis.low, at);
    axis.high = fmax(axis.high, at);
  }
  axis.varies = axis.high - axis.low > same * fmax(fabs(axis.low), fabs(axis.high));
  return axis;
}

struct study_axis study_axis_metric(const struct study_table *table, size_t index) {
  return make(table, true, index);
}

struct study_axis study_axis_parameter(const struct study_table *table, size_t index) {
  return make(table, false, index);
}

static enum status no_column(const struct study_column *columns, size_t count, const char *what,
                             const char *key, struct error *error) {
  char known[400] = "";
  size_t used = 0;
  for (size_t i = 0; i < count && used < sizeof known - 80; i++) {
    used += (size_t)snprintf(known + used, sizeof known - used, "%s%.60s", i ? ", " : "",
                             columns[i].key);
  }
  return error_set(error, STATUS_NOT_FOUND, NULL, "this study has no %s \"%.60s\"; there %s: %s%s",
                   what, key, count == 1 ? "is" : "are", count ? known : "none yet",
                   used >= sizeof known - 80 ? ", ..." : "");
}

static size_t find(const struct study_column *columns, size_t count, const char *key) {
  size_t i = 0;
  while (i < count && strcmp(columns[i].key, key) != 0) {
    i++;
  }
  return i;
}

enum status study_axis_find(const struct study_table *table, const char *key,
                            struct study_axis *axis, struct error *error) {
  size_t metric = find(table->metric, table->metrics, key);
  size_t parameter = find(table->parameter, table->parameters, key);
  if (metric < table->metrics) {
    *axis = study_axis_metric(table, metric);
    return STATUS_OK;
  }
  if (parameter < table->parameters) {
    *axis = study_axis_parameter(table, parameter);
    return STATUS_OK;
  }
  return key[0] == '/' ? no_column(table->parameter, table->parameters, "parameter", key, error)
                       : no_column(table->metric, table->metrics, "metric", key, error);
}

/* The first metric of those that readers ask for, else the first that varies. */
static struct study_axis usual_metric(const struct study_table *table) {
  static const char *const usual[] = {
      "grasp_force_peak_N", "blocked_force_N", "bending_angle_deg", "sensitivity_deg_per_kPa",
      "twist_angle_deg",    "contraction_pct", "extension_ratio",   "trigger_pressure_kPa"};
  for (size_t i = 0; i < sizeof usual / sizeof *usual; i++) {
    size_t at = find(table->metric, table->metrics, usual[i]);
    struct study_axis axis = {0};
    if (at < table->metrics) {
      axis = study_axis_metric(table, at);
    }
    if (axis.varies) {
      return axis;
    }
  }
  for (size_t i = 0; i < table->metrics; i++) {
    struct study_axis axis = study_axis_metric(table, i);
    if (axis.varies) {
      return axis;
    }
  }
  return study_axis_metric(table, 0);
}

enum status study_axis_choose_metric(const struct study_table *table, const char *key,
                                     struct study_axis *axis, struct error *error) {
  if (key) {
    size_t at = find(table->metric, table->metrics, key);
    if (at == table->metrics) {
      return no_column(table->metric, table->metrics, "metric", key, error);
    }
    *axis = study_axis_metric(table, at);
    return STATUS_OK;
  }
  *axis = table->metrics > 0 ? usual_metric(table) : (struct study_axis){0};
  return STATUS_OK;
}

enum status study_axis_choose_parameter(const struct study_table *table, const char *key,
                                        const struct study_axis *other, bool number,
                                        struct study_axis *axis, struct error *error) {
  *axis = (struct study_axis){0};
  if (key) {
    size_t at = find(table->parameter, table->parameters, key);
    if (at == table->parameters) {
      return no_column(table->parameter, table->parameters, "parameter", key, error);
    }
    *axis = study_axis_parameter(table, at);
    return STATUS_OK;
  }
  for (size_t i = 0; i < table->parameters; i++) {
    bool taken = other && other->table && !other->metric && other->index == i;
    if (!taken && !(number && table->parameter[i].categorical)) {
      struct study_axis next = study_axis_parameter(table, i);
      if (next.varies) {
        *axis = next;
        return STATUS_OK;
      }
    }
  }
  return STATUS_OK;
}

double study_axis_value(const struct study_axis *axis, double position) {
  return axis->logarithmic ? pow(10, position) : position;
}

double study_axis_part(const struct study_axis *axis, double position) {
  return axis->high > axis->low ? (position - axis->low) / (axis->high - axis->low)
         : isnan(position)      ? NAN
                                : 0.5;
}

void study_axis_label(const struct study_axis *axis, char label[STUDY_LABEL]) {
  const struct study_column *column = axis->column;
  snprintf(label, STUDY_LABEL, *column->unit ? "%.150s (%.30s)" : "%.150s", column->title,
           column->unit);
  if (label[0] >= 'a' && label[0] <= 'z') {
    label[0] = (char)(label[0] - 'a' + 'A');
  }
}

void study_axis_text(const struct study_axis *axis, double position, bool unit,
                     char text[STUDY_LABEL]) {
  const struct study_column *column = axis->column;
  char number[TICKS_TEXT];
  double value = study_axis_value(axis, position);
  if (column->categorical) {
    bool known = value >= 0 && value < (double)column->word_count;
    snprintf(text, STUDY_LABEL, "%.100s", known ? column->words[(size_t)value] : "none");
    return;
  }
  ticks_plain(value, 4, number);
  const char *space = strcmp(column->unit, "°") == 0 ? "" : " ";
  snprintf(text, STUDY_LABEL, "%s%s%.30s", number, unit && *column->unit ? space : "",
           unit ? column->unit : "");
}

size_t study_axis_place(const double *values, size_t count, double position) {
  double range = count > 0 ? fabs(values[0]) + fabs(values[count - 1]) : 0;
  for (size_t i = 0; i < count; i++) {
    if (fabs(values[i] - position) <= same * range) {
      return i;
    }
  }
  return count;
}

size_t study_axis_values(const struct study_axis *axis, double values[STUDY_VALUES]) {
  size_t count = 0;
  double slack = same * (fabs(axis->low) + fabs(axis->high));
  for (size_t row = 0; row < axis->table->members; row++) {
    double at = study_axis_at(axis, row);
    size_t place = 0;
    while (place < count && values[place] < at - slack) {
      place++;
    }
    if (isnan(at) || (place < count && values[place] <= at + slack)) {
      continue;
    }
    if (count == STUDY_VALUES) {
      return 0;
    }
    memmove(values + place + 1, values + place, (count - place) * sizeof *values);
    values[place] = at;
    count++;
  }
  return count;
}
