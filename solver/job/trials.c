#include "solver/job/trials.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "solver/base/text.h"

enum { TIME, SET_POINT, H, PRESSURE, TRIAL, QUOTED_MAX = 80 };

/* No soft actuator of this program is larger, finer or slower: beyond these bounds the unit is
 * another one. */
static const double range_min = 1e-6, range_max = 10.0, interval_max = 60.0, ratio_max = 5.0;

/* ---- names of columns --------------------------------------------------------------------- */

static enum status check_name(const struct column_spec *column, const char *const *right,
                              const char *const *wrong, const char *holds, const char *wanted,
                              struct error *error) {
  char name[QUOTED_MAX];
  if (text_mentions(column->name, right) || !text_mentions(column->name, wrong)) {
    return STATUS_OK;
  }
  return error_set(
      error, STATUS_INVALID, column->pointer,
      "by its name the column %s holds %s\nthe column that holds %s; are two columns exchanged?",
      text_quote(name, sizeof name, column->name), holds, wanted);
}

/* Refuses columns whose names say the opposite of their use. */
static enum status check_names(const struct identify_spec *spec, struct error *error) {
  static const char *const lengths[] = {"elongation", "displacement", "(mm)", "(m)", NULL};
  static const char *const pressures[] = {"pressure", "kpa", "psi", "set-point", "setpoint", NULL};
  enum status status =
      check_name(&spec->h, lengths, pressures, "a pressure", "the elongation", error);
  if (status == STATUS_OK) {
    status =
        check_name(&spec->pressure, pressures, lengths, "an elongation", "the pressure", error);
  }
  return status == STATUS_OK ? check_name(&spec->set_point, pressures, lengths, "an elongation",
                                          "the set-point", error)
                             : status;
}

/* ---- one table ---------------------------------------------------------------------------- */

/* Everything on the way from the document to the trials. */
struct gathering {
  const struct identify_spec *spec;
  struct trials *trials;
  size_t room;
  struct error *error;
};

static enum status no_memory(struct error *error) {
  return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the trials");
}

static enum status refuse(const struct gathering *g, const struct trial *trial, size_t row,
                          const char *text, double a, double b) {
  char sentence[300];
  snprintf(sentence, sizeof sentence, text, a, b);
  return error_set(g->error, STATUS_INVALID, trial->pointer, "line %d of the table: %s",
                   trial->line[row], sentence);
}

static enum status check_times(const struct gathering *g, const struct trial *trial) {
  for (size_t i = 1; i < trial->count; i++) {
    double before = trial->time[i - 1], now = trial->time[i];
    if (!(now > before)) {
      return refuse(g, trial, i,
                    now == before
                        ? "the time %.9g s is there twice\nthe times of a trial must rise"
                        : "the time %.9g s is not after the one before it, %.9g s\nthe times of a "
                          "trial must rise",
                    now, before);
    }
  }
  double mean = (trial->time[trial->count - 1] - trial->time[0]) / (double)(trial->count - 1);
  return mean <= interval_max
             ? STATUS_OK
             : refuse(g, trial, 0,
                      "from here the rows of the trial are %.4g s apart on average\nat most %g s; "
                      "is the unit of the time another one?",
                      mean, interval_max);
}

/* Adds rows [from, to) of a table as a trial. */
static enum status add_trial(struct gathering *g, const char *name, const char *pointer,
                             double *const *column, const int *line, size_t from, size_t to) {
  struct trials *trials = g->trials;
  if (trials->count == TRIALS_MAX) {
    return error_set(
        g->error, STATUS_TOO_LARGE, pointer,
        "line %d of the table: here begins one trial more than are allowed\nat most %d; is "
        "\"trial\" another column? It numbers stretches of rows, as 1, 1, 1, 2, 2, 2",
        line[from], TRIALS_MAX);
  }
  if (trials->count == g->room) {
    size_t room = g->room ? 2 * g->room : 64;
    struct trial *grown = realloc(trials->trial, room * sizeof *grown);
    if (!grown) {
      return no_memory(g->error);
    }
    trials->trial = grown;
    g->room = room;
  }
  struct trial *trial = &trials->trial[trials->count];
  *trial = (struct trial){.count = to - from,
                          .time = column[TIME] + from,
                          .set_point = column[SET_POINT] + from,
                          .h = column[H] + from,
                          .pressure = column[PRESSURE] + from,
                          .line = line + from};
  snprintf(trial->pointer, sizeof trial->pointer, "%s", pointer);
  size_t length = text_prefix(name, sizeof trial->name - 1);
  memcpy(trial->name, name, length);
  trial->name[length] = '\0';
  trials->count++;
  if (trial->count < TRIAL_ROWS_MIN) {
    return error_set(g->error, STATUS_INVALID, pointer,
                     "line %d of the table: the trial that begins here has %zu rows\nat least %d",
                     line[from], trial->count, TRIAL_ROWS_MIN);
  }
  return check_times(g, trial);
}

/* The name of a trial: the number of its column after the name of its table, where there are
 * several. */
static void name_trial(char *out, size_t size, const char *table, bool numbered, double number) {
  if (!numbered) {
    snprintf(out, size, "%s", table ? table : "1");
  } else if (table) {
    snprintf(out, size, "%s/%.15g", table, number);
  } else {
    snprintf(out, size, "%.15g", number);
  }
}

static enum status check_apart(const struct gathering *g, size_t first, const char *name,
                               const char *pointer, int line) {
  for (size_t i = first; i < g->trials->count; i++) {
    if (strcmp(g->trials->trial[i].name, name) == 0) {
      char quoted[QUOTED_MAX];
      return error_set(g->error, STATUS_INVALID, pointer,
                       "line %d of the table: the trial %s begins again here, after it was left "
                       "after line %d\nrows of a trial that stand together",
                       line, text_quote(quoted, sizeof quoted, name),
                       g->trials->trial[i].line[g->trials->trial[i].count - 1]);
    }
  }
  return STATUS_OK;
}

/* Parts the rows of a table into trials. */
static enum status part_rows(struct gathering *g, const char *table, const char *pointer,
                             double *const *column, const int *line, size_t rows) {
  const double *number = g->spec->has_trial ? column[TRIAL] : NULL;
  size_t first = g->trials->count;
  enum status status = STATUS_OK;
  for (size_t from = 0, to; from < rows && status == STATUS_OK; from = to) {
    char name[2 * IDENTIFY_NAME];
    for (to = from + 1; to < rows && (!number || number[to] == number[from]); to++) {
    }
    name_trial(name, sizeof name, table, number != NULL, number ? number[from] : 0.0);
    status = check_apart(g, first, name, pointer, line[from]);
    if (status == STATUS_OK) {
      status = add_trial(g, name, pointer, column, line, from, to);
    }
  }
  return status;
}

/* Keeps what a table owns with the trials. */
static void keep_columns(struct trials *trials, struct table *table, int columns) {
  for (int i = 0; i < columns; i++) {
    trials->block[5 * trials->block_count + (size_t)i] = table->value[i];
    table->value[i] = NULL;
  }
  trials->lines[trials->block_count++] = table->line;
  table->line = NULL;
}

static enum status read_table(struct gathering *g, const json_t *data, const char *name,
                              const char *pointer) {
  const struct identify_spec *spec = g->spec;
  const struct column_spec *const given[] = {&spec->time, &spec->set_point, &spec->h,
                                             &spec->pressure, &spec->trial};
  struct table_column wanted[5];
  const json_t *text = json_object_get(data, "csv");
  struct table table = {0};
  int columns = spec->has_trial ? 5 : 4;
  for (int i = 0; i < columns; i++) {
    wanted[i] = (struct table_column){given[i]->name, given[i]->pointer};
  }
  enum status status = table_read(json_string_value(text), json_string_length(text), pointer,
                                  wanted, (size_t)columns, &table, g->error);
  if (status == STATUS_OK) {
    for (int i = 0; i < columns; i++) {
      for (size_t row = 0; row < table.rows; row++) {
        table.value[i][row] *= given[i]->si;
      }
    }
    size_t rows = table.rows;
    size_t place = g->trials->block_count;
    keep_columns(g->trials, &table, columns);
    status =
        part_rows(g, name, pointer, g->trials->block + 5 * place, g->trials->lines[place], rows);
  }
  table_release(&table);
  return status;
}

static enum status read_tables(struct gathering *g, const json_t *document) {
  const json_t *tables = json_object_get(document, "tables"), *table;
  size_t count = tables ? json_array_size(tables) : 1, index;
  g->trials->block = calloc(5 * count, sizeof *g->trials->block);
  g->trials->lines = calloc(count, sizeof *g->trials->lines);
  if (!g->trials->block || !g->trials->lines) {
    return no_memory(g->error);
  }
  if (!tables) {
    return read_table(g, json_object_get(document, "data"), NULL, "/data/csv");
  }
  enum status status = STATUS_OK;
  json_array_foreach(tables, index, table) {
    char pointer[40];
    const char *name = json_string_value(json_object_get(table, "name"));
    snprintf(pointer, sizeof pointer, "/tables/%zu/name", index);
    for (size_t i = 0; i < index && status == STATUS_OK; i++) {
      if (strcmp(json_string_value(json_object_get(json_array_get(tables, i), "name")), name) ==
          0) {
        status = error_set(g->error, STATUS_INVALID, pointer,
                           "two tables have the same name\nthe names must differ, for example "
                           "\"run 1\" and \"run 2\"");
      }
    }
    snprintf(pointer, sizeof pointer, "/tables/%zu/data/csv", index);
    if (status == STATUS_OK) {
      status = read_table(g, json_object_get(table, "data"), name, pointer);
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return status;
}

/* ---- all of them -------------------------------------------------------------------------- */

static void widen(double range[2], const double *value, size_t count) {
  for (size_t i = 0; i < count; i++) {
    range[0] = fmin(range[0], value[i]);
    range[1] = fmax(range[1], value[i]);
  }
}

/* Refuses units that cannot be meant. */
static enum status check_units(const struct gathering *g) {
  double h[2] = {INFINITY, -INFINITY}, u[2] = {0.0, 0.0}, p[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < g->trials->count; i++) {
    const struct trial *trial = &g->trials->trial[i];
    widen(h, trial->h, trial->count);
    widen(u, trial->set_point, trial->count);
    widen(p, trial->pressure, trial->count);
  }
  double range = h[1] - h[0], set = fmax(u[1], -u[0]), pressure = fmax(p[1], -p[0]);
  if (!(range >= range_min && range <= range_max)) {
    return error_set(g->error, STATUS_INVALID, "/columns/h/unit",
                     "the elongations go from %.4g to %.4g mm\na soft actuator moves by more than "
                     "1 um and less than 10 m; is the unit or the column another one?",
                     1e3 * h[0], 1e3 * h[1]);
  }
  if (!(set > 0.0)) {
    return error_set(
        g->error, STATUS_INVALID, "/columns/set_point/name",
        "all set-points are 0\na set-point with steps, without which nothing can be identified");
  }
  if (!(pressure <= ratio_max * set && set <= ratio_max * pressure)) {
    return error_set(
        g->error, STATUS_INVALID, "/columns/pressure/unit",
        "the pressures reach %.4g kPa and the set-points %.4g kPa\nneither more than %g "
        "times the other; is one of them in another unit (1 psi = 6.895 kPa)?",
        1e-3 * pressure, 1e-3 * set, ratio_max);
  }
  if (!(p[1] > p[0])) {
    return error_set(
        g->error, STATUS_INVALID, "/columns/pressure/name",
        "the pressure is %.6g kPa in all rows\nthe course of the pressure, without which what "
        "moves cannot be told; is it another column?",
        1e-3 * p[0]);
  }
  return STATUS_OK;
}

/* The set-point of a trial is the one farthest from 0. */
static double main_set_point(const struct trial *trial) {
  double u = 0.0;
  for (size_t i = 0; i < trial->count; i++) {
    u = fabs(trial->set_point[i]) > fabs(u) ? trial->set_point[i] : u;
  }
  return u;
}

/* Takes the last trials of each set-point, as many as the share rounds to but not all. */
static enum status hold_share(struct trials *trials, double share, struct error *error) {
  double *set_point = malloc(trials->count * sizeof *set_point);
  if (!set_point) {
    return no_memory(error);
  }
  for (size_t i = 0; i < trials->count; i++) {
    set_point[i] = main_set_point(&trials->trial[i]);
  }
  for (size_t i = 0; i < trials->count; i++) {
    size_t before = 0, same = 0;
    double u = set_point[i];
    for (size_t k = 0; k < trials->count; k++) {
      bool equal = fabs(set_point[k] - u) <= 1e-6 * fabs(u);
      same += equal;
      before += equal && k < i;
    }
    size_t out = (size_t)lround(share * (double)same);
    trials->trial[i].held_out = before >= same - (out < same ? out : same - 1);
  }
  free(set_point);
  return STATUS_OK;
}

static enum status hold_named(const struct gathering *g, const json_t *names) {
  size_t index, k;
  const json_t *name;
  json_array_foreach(names, index, name) {
    for (k = 0; k < g->trials->count; k++) {
      if (strcmp(g->trials->trial[k].name, json_string_value(name)) == 0) {
        g->trials->trial[k].held_out = true;
        break;
      }
    }
    if (k == g->trials->count) {
      char pointer[40], quoted[QUOTED_MAX], first[QUOTED_MAX];
      snprintf(pointer, sizeof pointer, "/held_out/%zu", index);
      return error_set(g->error, STATUS_INVALID, pointer,
                       "there is no trial %s\none of the %zu, the first of which is %s",
                       text_quote(quoted, sizeof quoted, json_string_value(name)), g->trials->count,
                       text_quote(first, sizeof first, g->trials->trial[0].name));
    }
  }
  return STATUS_OK;
}

enum status trials_read(const json_t *document, const struct identify_spec *spec,
                        struct trials *trials, struct error *error) {
  struct gathering g = {.spec = spec, .trials = trials, .error = error};
  const json_t *held_out = json_object_get(document, "held_out");
  *trials = (struct trials){.count = 0};
  enum status status = check_names(spec, error);
  if (status == STATUS_OK) {
    status = read_tables(&g, document);
  }
  if (status == STATUS_OK) {
    status = check_units(&g);
  }
  if (status == STATUS_OK && json_is_array(held_out)) {
    status = hold_named(&g, held_out);
  } else if (status == STATUS_OK) {
    status = hold_share(trials, spec->held_out_share, error);
  }
  size_t left = 0;
  for (size_t i = 0; i < trials->count; i++) {
    left += !trials->trial[i].held_out;
  }
  if (status == STATUS_OK && left == 0) {
    status = error_set(error, STATUS_INVALID, "/held_out",
                       "all %zu trials are held out\nat least one that is left to identify from",
                       trials->count);
  }
  if (status != STATUS_OK) {
    trials_release(trials);
  }
  return status;
}

void trials_release(struct trials *trials) {
  for (size_t i = 0; i < trials->block_count; i++) {
    for (size_t k = 0; k < 5; k++) {
      free(trials->block[5 * i + k]);
    }
    free(trials->lines[i]);
  }
  free(trials->block);
  free(trials->lines);
  free(trials->trial);
  *trials = (struct trials){.count = 0};
}
