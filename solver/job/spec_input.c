/* What is wanted over time: the set-point of a pressure, or an elongation. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/table.h"
#include "solver/job/hlpv.h"
#include "solver/job/json.h"
#include "solver/job/reader.h"

enum { POINTER_MAX = 220 };

/* The quantity of a profile. */
struct wanted {
  const char *unit; /* as in the schema */
  double most;      /* in SI */
  const char *beyond, *example;
};

static const struct wanted pressure = {
    "kPa", 1e9, "a set-point beyond 1 GPa is none of a soft actuator; for example \"4 psi\"",
    "{ \"hold\": [[\"0 s\", \"3 psi\"], [\"5 s\", \"4 psi\"]] }"};
static const struct wanted elongation = {
    "mm", 1e3, "an elongation beyond 1 km is none of an actuator; for example \"10 mm\"",
    "{ \"hold\": [[\"0 s\", \"5 mm\"], [\"5 s\", \"10 mm\"]] }"};

static enum status reserve_points(const struct reader *reader, size_t count,
                                  struct hlpv_input *input) {
  input->count = count;
  input->time = calloc(count, sizeof *input->time);
  input->value = calloc(count, sizeof *input->value);
  return input->time && input->value
             ? STATUS_OK
             : error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the set-point");
}

/* line: of each point in its table, NULL for points of the job itself. */
static enum status check_times(const struct reader *reader, const struct hlpv_input *input,
                               const int *line, const char *pointer) {
  for (size_t i = 0; i < input->count; i++) {
    char where[POINTER_MAX], place[40] = "";
    snprintf(where, sizeof where, line ? "%.180s" : "%.180s/%zu/0", pointer, i);
    if (line) {
      snprintf(place, sizeof place, "line %d: ", line[i]);
    }
    if (i == 0 && input->time[i] != 0.0) {
      return error_set(reader->error, STATUS_INVALID, where,
                       "%sthe profile begins at %.9g s\nthe first time must be 0 s", place,
                       input->time[i]);
    }
    if (i > 0 && !(input->time[i] > input->time[i - 1])) {
      return error_set(reader->error, STATUS_INVALID, where,
                       "%sthe time %.9g s is not after the one before it, %.9g s\ntimes must rise",
                       place, input->time[i], input->time[i - 1]);
    }
  }
  return STATUS_OK;
}

static enum status read_points(const struct reader *reader, const json_t *points,
                               const char *pointer, const struct wanted *wanted,
                               struct hlpv_input *input) {
  size_t index;
  json_t *point;
  enum status status = reserve_points(reader, json_array_size(points), input);
  if (status != STATUS_OK) {
    return status;
  }
  json_array_foreach(points, index, point) {
    const json_t *time = json_array_get(point, 0), *value = json_array_get(point, 1);
    struct error *error = reader->error;
    char where[POINTER_MAX];
    status = units_read(reader->units, json_string_value(time), "s", &input->time[index], error);
    snprintf(where, sizeof where, "%.180s/%zu/0", pointer, index);
    if (status == STATUS_OK) {
      status = units_read(reader->units, json_string_value(value), wanted->unit,
                          &input->value[index], error);
      snprintf(where, sizeof where, "%.180s/%zu/1", pointer, index);
    }
    if (status == STATUS_OK && fabs(input->value[index]) > wanted->most) {
      status = error_set(error, STATUS_INVALID, where, "%s", wanted->beyond);
    }
    if (status != STATUS_OK) {
      reader_copy(error->pointer, sizeof error->pointer, where);
      return status;
    }
  }
  return check_times(reader, input, NULL, pointer);
}

static enum status read_data(const struct reader *reader, const json_t *value, const char *pointer,
                             struct hlpv_input *input) {
  char columns_at[POINTER_MAX], csv_at[POINTER_MAX];
  snprintf(columns_at, sizeof columns_at, "%s/columns", pointer);
  snprintf(csv_at, sizeof csv_at, "%s/data/csv", pointer);
  const json_t *columns = json_object_get(value, "columns");
  const char *text = json_string_value(json_object_get(json_object_get(value, "data"), "csv"));
  const char *between = json_string_value(json_object_get(value, "between"));
  struct column_spec time, set_point;
  struct table table = {0};
  enum status status =
      reader_column(reader, columns, columns_at, "time", "s", "\"s\" or \"ms\"", &time);
  if (status == STATUS_OK) {
    status = reader_column(reader, columns, columns_at, "set_point", "kPa", "\"kPa\" or \"psi\"",
                           &set_point);
  }
  if (status != STATUS_OK) {
    return status;
  }
  const struct table_column wanted[] = {{time.name, time.pointer},
                                        {set_point.name, set_point.pointer}};
  status = table_read(text, strlen(text), csv_at, wanted, 2, &table, reader->error);
  if (status == STATUS_OK) {
    status = reserve_points(reader, table.rows, input);
  }
  if (status == STATUS_OK) {
    for (size_t i = 0; i < table.rows; i++) {
      input->time[i] = time.si * table.value[0][i];
      input->value[i] = set_point.si * table.value[1][i];
    }
    input->profile = strcmp(between, "linear") == 0 ? HLPV_LINEAR : HLPV_HELD;
    status = check_times(reader, input, table.line, csv_at);
  }
  table_release(&table);
  return status;
}

static void read_sine(const struct reader *reader, const json_t *sine, const char *unit,
                      struct hlpv_input *input) {
  input->profile = HLPV_SINE;
  input->mean = reader_member(reader, sine, "mean", unit, 0.0);
  input->amplitude = reader_member(reader, sine, "amplitude", unit, 0.0);
  input->frequency = reader_member(reader, sine, "frequency", "Hz", 0.0);
  input->phase = reader_member(reader, sine, "phase", "deg", 0.0);
}

/* A profile that the job gives by itself, not in a table. */
static enum status read_given(const struct reader *reader, const json_t *value, const char *pointer,
                              const struct wanted *wanted, struct hlpv_input *input) {
  const json_t *hold = json_object_get(value, "hold"), *linear = json_object_get(value, "linear");
  const json_t *sine = json_object_get(value, "sine");
  char where[POINTER_MAX];
  if (sine) {
    read_sine(reader, sine, wanted->unit, input);
    return STATUS_OK;
  }
  input->profile = hold ? HLPV_HELD : HLPV_LINEAR;
  snprintf(where, sizeof where, "%s/%s", pointer, hold ? "hold" : "linear");
  return read_points(reader, hold ? hold : linear, where, wanted, input);
}

enum status reader_reference(const struct reader *reader, const json_t *value, const char *pointer,
                             struct hlpv_input *input) {
  int given = !!json_object_get(value, "hold") + !!json_object_get(value, "linear") +
              !!json_object_get(value, "sine");
  return given == 1
             ? read_given(reader, value, pointer, &elongation, input)
             : error_set(reader->error, STATUS_INVALID, pointer,
                         "there are %d profiles\none of \"hold\", \"linear\" and \"sine\"\n%s",
                         given, elongation.example);
}

enum status reader_set_point(const struct reader *reader, const json_t *value, const char *pointer,
                             struct hlpv_input *input) {
  const json_t *hold = json_object_get(value, "hold"), *linear = json_object_get(value, "linear");
  const json_t *sine = json_object_get(value, "sine"), *data = json_object_get(value, "data");
  int given = !!hold + !!linear + !!sine + !!data;
  char where[POINTER_MAX];
  if (given != 1) {
    return error_set(
        reader->error, STATUS_INVALID, pointer,
        "there are %d profiles\none of \"hold\", \"linear\", \"sine\" and \"data\"\n%s", given,
        pressure.example);
  }
  if (!data && json_object_get(value, "columns")) {
    snprintf(where, sizeof where, "%s/columns", pointer);
    return error_set(reader->error, STATUS_INVALID, where,
                     "there are columns but no table\ncolumns of a table in \"data\"");
  }
  if (data && !json_object_get(value, "columns")) {
    return error_set(
        reader->error, STATUS_INVALID, pointer,
        "the key \"columns\" is missing\nan object\n{\"columns\": { \"time\": { \"name\": \"t\", "
        "\"unit\": \"s\" }, \"set_point\": { \"name\": \"u\", \"unit\": \"kPa\" } }}");
  }
  return data ? read_data(reader, value, pointer, input)
              : read_given(reader, value, pointer, &pressure, input);
}

/* The largest number of four digits that is not above a positive one. */
static double round_down(double value) {
  double digit = pow(10.0, floor(log10(value)) - 3.0);
  return floor(value / digit) * digit;
}

enum status reader_check_samples(const struct reader *reader, double end, double rate, int most) {
  double samples = end * rate + 1.0;
  return samples <= most
             ? STATUS_OK
             : error_set(reader->error, STATUS_INVALID, "/sample_rate",
                         "%.6g Hz over %.6g s make %.0f samples\nat most %d\n\"%.4g Hz\"", rate,
                         end, samples, most, round_down((most - 1) / end));
}
