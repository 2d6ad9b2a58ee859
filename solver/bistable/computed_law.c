#include "solver/bistable/computed_law.h"

#include <stdlib.h>

#include "solver/bistable/law_path.h"
#include "solver/snap/result_snap.h"

/* Leaves out the paths that do not lead from one side to the other. */
static void leave_out(struct law_table *table, json_t *warnings) {
  int kept = 0;
  for (int i = 0; i < table->count; i++) {
    struct law_path path;
    struct error error;
    if (law_path_divide(&table->level[i], &path, &error) == STATUS_OK) {
      table->level[kept++] = table->level[i];
      continue;
    }
    free(table->level[i].h);
    if (json_is_array(warnings)) {
      json_array_append_new(
          warnings, json_sprintf("the law goes without its path at %.6g kPa, which does not lead "
                                 "from one side to the other",
                                 1e-3 * table->level[i].pressure));
    }
  }
  table->count = kept;
}

enum status computed_law_take(json_t *document, const char *pointer, struct law_table *table,
                              struct error *error) {
  const json_t *paths = json_object_get(document, "law");
  const char *message = json_string_value(json_object_get(document, "message"));
  enum status status =
      json_array_size(paths) >= 2 ? law_table_read(paths, pointer, table, error) : STATUS_OK;
  if (status != STATUS_OK) {
    return status;
  }
  leave_out(table, json_object_get(document, "warnings"));
  return table->count >= 2
             ? STATUS_OK
             : error_set(error, STATUS_DIVERGED, pointer,
                         "the bellows gives no paths at several pressures, so that its motion "
                         "cannot be computed: %.200s",
                         message && *message ? message : "it has no law");
}

/* Solves one. *document: of the snap job, a new reference, NULL after a failure. */
static enum status compute(const struct job_spec *spec, struct law_spec *law,
                           const struct result_snap_options *options, json_t **document,
                           struct error *error) {
  struct job_spec inner = *spec;
  enum status ending = STATUS_OK;
  inner.kind = JOB_SNAP;
  inner.snap = law->snap;
  inner.bistable = NULL;
  inner.document = NULL;
  enum status status = result_snap(&inner, options, document, &ending, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = computed_law_take(*document, law->pointer, &law->table, error);
  if (status != STATUS_OK) {
    json_decref(*document);
    *document = NULL;
  }
  return status;
}

enum status computed_law(const struct job_spec *spec, FILE *events,
                         bool (*cancelled)(void *context), json_t **results, struct error *error) {
  struct bistable_spec *bistable = spec->bistable;
  struct result_snap_options options = {events, cancelled};
  enum status status = STATUS_OK;
  json_t *all = json_object();
  for (int i = 0; i < bistable->law_count && status == STATUS_OK; i++) {
    struct law_spec *law = &bistable->law[i];
    json_t *document = NULL;
    if (law->snap && law->table.count == 0) {
      status = compute(spec, law, &options, &document, error);
    }
    if (document && json_object_set_new(all, law->name, document) != 0) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a law");
    }
  }
  if (status != STATUS_OK) {
    json_decref(all);
    all = NULL;
  }
  *results = all;
  return status;
}
