#include "solver/job/bistable.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS_MIN = 8, COLUMNS = 4, WHERE_MAX = 200 };

void law_table_release(struct law_table *table) {
  for (int i = 0; i < table->count; i++) {
    free(table->level[i].h);
  }
  *table = (struct law_table){0};
}

void bistable_spec_destroy(struct bistable_spec *spec) {
  if (!spec) {
    return;
  }
  for (int i = 0; i < spec->law_count; i++) {
    law_table_release(&spec->law[i].table);
    free(spec->law[i].snap);
  }
  for (int i = 0; i < spec->actuator_count; i++) {
    hlpv_input_release(&spec->actuator[i].input);
  }
  free(spec);
}

/* ---- tables ------------------------------------------------------------------------------- */

/* The number under `key` of the object, which is at `where`. */
static enum status read_number(const json_t *object, const char *key, double unit,
                               const char *where, double *value, struct error *error) {
  const json_t *member = json_object_get(object, key);
  *value = unit * json_number_value(member);
  if (json_is_number(member) && isfinite(*value) && fabs(*value) < 1e9) {
    return STATUS_OK;
  }
  return error_set(error, STATUS_INVALID, where,
                   "the number \"%s\" is missing\na number\n{ \"h_mm\": 1.5, \"force_N\": 12.1, "
                   "\"volume_mm3\": 8400, \"energy_mJ\": 9.2 }",
                   key);
}

static enum status read_point(const json_t *point, const char *where, struct law_level *level,
                              size_t i, struct error *error) {
  enum status status = read_number(point, "h_mm", 1e-3, where, &level->h[i], error);
  if (status == STATUS_OK) {
    status = read_number(point, "force_N", 1.0, where, &level->force[i], error);
  }
  if (status == STATUS_OK) {
    status = read_number(point, "volume_mm3", 1e-9, where, &level->volume[i], error);
  }
  if (status == STATUS_OK && json_object_get(point, "energy_mJ")) {
    status = read_number(point, "energy_mJ", 1e-3, where, &level->energy[i], error);
  }
  if (status == STATUS_OK && i > 0 && level->h[i] == level->h[i - 1] &&
      level->force[i] == level->force[i - 1]) {
    status = error_set(error, STATUS_INVALID, where,
                       "the point is the one before it again\nthe points of a path follow one "
                       "another along its length");
  }
  return status;
}

static enum status read_level(const json_t *value, const char *pointer, struct law_level *level,
                              struct error *error) {
  const json_t *points = json_object_get(value, "points");
  size_t count = json_array_size(points), energies = 0;
  if (count < POINTS_MIN || count > BISTABLE_LEVEL_POINTS_MAX) {
    return error_set(
        error, STATUS_INVALID, pointer,
        "the path has %zu points\n%d to %d points, from the compressed to the stretched side",
        count, POINTS_MIN, BISTABLE_LEVEL_POINTS_MAX);
  }
  level->h = calloc(COLUMNS * count, sizeof *level->h);
  if (!level->h) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a table");
  }
  level->count = count;
  level->force = level->h + count;
  level->volume = level->force + count;
  level->energy = level->volume + count;
  for (size_t i = 0; i < count; i++) {
    char where[WHERE_MAX];
    const json_t *point = json_array_get(points, i);
    snprintf(where, sizeof where, "%.150s/points/%zu", pointer, i);
    enum status status = read_point(point, where, level, i, error);
    if (status != STATUS_OK) {
      return status;
    }
    energies += json_object_get(point, "energy_mJ") != NULL;
  }
  if (energies != count) {
    level->energy = NULL;
  }
  return STATUS_OK;
}

enum status law_table_read(const json_t *law, const char *pointer, struct law_table *table,
                           struct error *error) {
  size_t count = json_array_size(law);
  *table = (struct law_table){0};
  if (count < 2 || count > BISTABLE_LEVELS_MAX) {
    return error_set(error, STATUS_INVALID, pointer,
                     "there are paths at %zu pressures\n2 to %d, for the forces between two of "
                     "them are interpolated",
                     count, BISTABLE_LEVELS_MAX);
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *value = json_array_get(law, i);
    struct law_level *level = &table->level[table->count++];
    char where[WHERE_MAX];
    snprintf(where, sizeof where, "%.150s/%zu", pointer, i);
    enum status status = read_number(value, "pressure_kPa", 1e3, where, &level->pressure, error);
    if (status == STATUS_OK && i > 0 && !(level->pressure > level[-1].pressure)) {
      status = error_set(
          error, STATUS_INVALID, where,
          "the pressure %.6g kPa is not above the one before it, %.6g kPa\nthey must rise",
          1e-3 * level->pressure, 1e-3 * level[-1].pressure);
    }
    if (status == STATUS_OK) {
      status = read_level(value, where, level, error);
    }
    if (status != STATUS_OK) {
      return status;
    }
  }
  return STATUS_OK;
}
