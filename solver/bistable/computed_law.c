#include "solver/bistable/computed_law.h"

#include <string.h>

#include "solver/snap/result_snap.h"

enum status computed_law(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **result, struct error *error) {
  struct bistable_spec *bistable = spec->bistable;
  *result = NULL;
  for (int i = 0; i < bistable->law_count; i++) {
    struct law_spec *law = &bistable->law[i];
    if (!law->is_snap || law->table.count > 0) {
      continue;
    }
    struct job_spec inner = *spec;
    struct result_snap_options options = {events, cancelled};
    enum status ending = STATUS_OK;
    json_t *document = NULL;
    inner.kind = JOB_SNAP;
    inner.bistable = NULL;
    inner.document = NULL;
    enum status status = result_snap(&inner, &options, &document, &ending, error);
    if (status != STATUS_OK) {
      return status;
    }
    const json_t *paths = json_object_get(document, "law");
    if (json_array_size(paths) < 2) {
      const char *message = json_string_value(json_object_get(document, "message"));
      status = error_set(error, ending == STATUS_OK ? STATUS_DIVERGED : ending, "/snap",
                         "the bellows gives no paths at several pressures: %.250s",
                         message && *message ? message : "its result has no \"law\"");
    } else {
      status = law_table_read(paths, "/snap", &law->table, error);
    }
    if (status != STATUS_OK) {
      json_decref(document);
      return status;
    }
    *result = document;
  }
  return STATUS_OK;
}
