#include "solver/snap/result_snap.h"

#include <math.h>

#include "solver/base/clock.h"
#include "solver/snap/snap_document.h"

static json_t *statistics_object(const struct snap_study *study, double wall_s, double cpu_s) {
  return json_pack("{s:i, s:I, s:f, s:f, s:f, s:f}", "unknowns", study->body.size, "states",
                   (json_int_t)study->states, "skin_mm", 1e3 * study->body.skin, "wall_s", wall_s,
                   "cpu_s", cpu_s, "peak_memory_MB", clock_peak_memory_MB());
}

static json_t *document_of(const struct job_spec *job, const struct snap_study *study,
                           enum status ending, const struct error *end, double wall_s,
                           double cpu_s) {
  bool good = ending == STATUS_OK;
  return json_pack(
      "{s:s, s:s, s:s, s:s, s:s, s:o, s:[], s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:[], s:o, "
      "s:{s:s, s:s}}",
      "status", good ? "succeeded" : "diverged", "reason", good ? "" : status_word(ending),
      "message", good ? "" : end->message, "kind", "snap", "name", job->name, "metrics",
      snap_document_metrics(study), "samples", "paths", snap_document_paths(study), "events",
      snap_document_events(study), "held", snap_document_held(study), "stairs",
      snap_document_stairs(study), "shapes", snap_document_shapes(study), "law",
      snap_document_law(study), "harmonics", snap_document_harmonics(study), "warnings",
      snap_document_warnings(study), "artifacts", "statistics",
      statistics_object(study, wall_s, cpu_s), "provenance", "version", PNEULAB_VERSION,
      "spec_hash", job->hash);
}

static bool is_fatal(enum status status) {
  return status == STATUS_NO_MEMORY || status == STATUS_INTERNAL;
}

/* Calibration first, where one is asked for, then everything with the number that it found. */
static enum status compute(struct snap_spec *spec, const struct calibrate_options *options,
                           struct snap_study *study, struct calibrate_result *found,
                           enum status *ending, struct error *end) {
  *ending = spec->calibrate.asked ? calibrate(spec, options, found, end) : STATUS_OK;
  enum status status = snap_study_open(spec, study, end);
  if (status != STATUS_OK) {
    return status;
  }
  study->deadline_s = options->deadline_s;
  study->cancelled = options->cancelled;
  study->progress = options->progress;
  if (*ending == STATUS_OK) {
    *ending = snap_study_run(study, end);
  }
  return STATUS_OK;
}

enum status result_snap(const struct job_spec *job, const struct result_snap_options *options,
                        json_t **document, enum status *ending, struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  struct calibrate_options limits = {
      .deadline_s = job->timeout_s > 0 ? wall + job->timeout_s : 0,
      .cancelled = options->cancelled,
      .progress = options->events,
  };
  struct snap_spec spec = *job->snap; /* a calibration changes it */
  struct calibrate_result found = {.count = 0};
  struct snap_study study;
  struct error end = {.status = STATUS_OK};
  *document = NULL;
  enum status status = compute(&spec, &limits, &study, &found, ending, &end);
  if (status == STATUS_OK && is_fatal(*ending)) {
    status = *ending;
  }
  if (status != STATUS_OK) {
    *error = end;
    goto done;
  }
  *document = document_of(job, &study, *ending, &end, clock_wall_s() - wall, clock_cpu_s() - cpu);
  if (*document && spec.calibrate.asked) {
    json_object_set_new(*document, "calibration", snap_document_calibration(&spec, &found));
  }
  if (!*document) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
  }
done:
  snap_study_close(&study);
  return status;
}
