#include "server/plot/study_columns.h"

#include <stdio.h>
#include <string.h>

enum { KEY = 400, METRICS = 3 };

static enum status read_keys(const struct study_table *table, const char *keys, size_t most,
                             struct study_axis *axes, size_t *count, struct error *error) {
  enum status status = STATUS_OK;
  while (*keys && *count < most && status == STATUS_OK) {
    char key[KEY];
    size_t length = strcspn(keys, ",");
    snprintf(key, sizeof key, "%.*s", (int)(length < KEY ? length : KEY - 1), keys);
    status = study_axis_find(table, key, &axes[*count], error);
    ++*count;
    keys += length + (keys[length] == ',');
  }
  return status;
}

enum status study_columns(const struct study_table *table, const char *keys,
                          const struct study_axis *metric, size_t most, struct study_axis *axes,
                          size_t *count, struct error *error) {
  *count = 0;
  if (keys) {
    return read_keys(table, keys, most, axes, count, error);
  }
  bool have = metric && metric->table && metric->metric;
  for (size_t k = 0; k < table->parameters && *count + have < most; k++) {
    struct study_axis axis = study_axis_parameter(table, k);
    if (axis.varies) {
      axes[(*count)++] = axis;
    }
  }
  size_t metrics = 0;
  if (have && *count < most) {
    axes[(*count)++] = *metric;
    metrics++;
  }
  for (size_t k = 0; k < table->metrics && metrics < METRICS && *count < most; k++) {
    struct study_axis axis = study_axis_metric(table, k);
    if (axis.varies && !(have && k == metric->index)) {
      axes[(*count)++] = axis;
      metrics++;
    }
  }
  return STATUS_OK;
}
