#include "server/http/study_bodies.h"

#include <stdlib.h>
#include <string.h>

#include "solver/job/json.h"

/* Takes x and z of the points; false when memory ran out. */
static bool take_line(const json_t *points, size_t row, struct study_bodies *bodies) {
  size_t count = json_array_size(points);
  double *line = malloc((2 * count + 1) * sizeof *line);
  if (!line) {
    return false;
  }
  for (size_t i = 0; i < count; i++) {
    const json_t *point = json_array_get(points, i);
    line[2 * i] = json_number_value(json_array_get(point, 0));
    line[2 * i + 1] = json_number_value(json_array_get(point, json_array_size(point) - 1));
  }
  bodies->shape[bodies->count++] = (struct study_shape){row, count, line};
  return true;
}

/* Reads one member; one that has no result any more has no body. */
static enum status read_body(struct store *store, const struct study_table *table, size_t row,
                             struct study_bodies *bodies, struct error *error) {
  char *text = NULL;
  struct error unread = {.status = STATUS_OK};
  enum status status = store_result(store, table->job_id[row], &text, NULL, &unread);
  if (status == STATUS_NOT_FOUND) {
    return STATUS_OK;
  }
  if (status != STATUS_OK) {
    *error = unread;
    return status;
  }
  json_t *result = json_read(text, strlen(text), 0, NULL);
  const json_t *lines = json_object_get(result, "midlines");
  const json_t *last = json_array_get(lines, json_array_size(lines) - 1);
  bool fine =
      json_array_size(lines) == 0 || take_line(json_object_get(last, "points_mm"), row, bodies);
  json_decref(result);
  free(text);
  return fine ? STATUS_OK
              : error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
}

enum status study_bodies_read(struct store *store, const struct study_table *table,
                              const struct study_plot_options *options, struct study_bodies *bodies,
                              struct error *error) {
  struct study_cells cells;
  struct error none = {.status = STATUS_OK};
  *bodies = (struct study_bodies){0};
  if (study_plot_cells(table, options, &cells, &none) != STATUS_OK) {
    return STATUS_OK; /* the plot says why */
  }
  size_t count = cells.columns * cells.rows;
  enum status status = STATUS_OK;
  bodies->shape = calloc(count, sizeof *bodies->shape);
  if (!bodies->shape) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t k = 0; k < count && status == STATUS_OK; k++) {
    size_t row = cells.row[k];
    if (row < table->members && table->state[row] == JOB_STATE_SUCCEEDED) {
      status = read_body(store, table, row, bodies, error);
    }
  }
  return status;
}

void study_bodies_clear(struct study_bodies *bodies) {
  for (size_t i = 0; i < bodies->count; i++) {
    free((double *)(uintptr_t)bodies->shape[i].line);
  }
  free(bodies->shape);
  *bodies = (struct study_bodies){0};
}
