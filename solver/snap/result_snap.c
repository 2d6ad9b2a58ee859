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

/* ---- computing ---------------------------------------------------------------------------- */

static bool is_fatal(enum status status) {
  return status == STATUS_NO_MEMORY || status == STATUS_INTERNAL;
}

static enum status open_study(const struct snap_spec *spec, const struct calibrate_options *options,
                              struct snap_study *study, struct error *end) {
  enum status status = snap_study_open(spec, study, end);
  study->deadline_s = options->deadline_s;
  study->cancelled = options->cancelled;
  study->progress = options->progress;
  return status;
}

/* Where walls touch, the facets of their surfaces make kinks that a path may not get around; other
 * elements have them elsewhere. Relative lengths of elements to try, none far from that of the
 * accuracy. */
static const double element_length[] = {0.87, 1.13, 0.77};
enum { LENGTHS = sizeof element_length / sizeof *element_length };

static bool is_lost(enum status status) {
  return status == STATUS_DIVERGED || status == STATUS_INVERTED || status == STATUS_STEP_MINIMUM;
}

/* Takes the study of the first mesh on which every path is found, or that tells that no compressed
 * state is stable where none was found; without one, or without time, the study stays as it is. */
static void try_meshes(struct snap_spec *spec, const struct calibrate_options *options,
                       struct snap_study *study, enum status *ending, struct error *end) {
  enum status one = *ending;
  for (int k = 0; k < LENGTHS && is_lost(*ending) && one != STATUS_TIMEOUT; k++) {
    struct snap_study other;
    struct error local = {.status = STATUS_OK};
    spec->element_length = element_length[k];
    one = open_study(spec, options, &other, &local);
    one = one == STATUS_OK ? snap_study_run(&other, &local) : one;
    bool decided =
        one == STATUS_OK || (one == STATUS_UNSTABLE_PATH && !study->has[SNAP_COMPRESSED]);
    if (decided) {
      snap_study_warn(&other,
                      "computed with elements %.2f times as long as the accuracy asks for, after "
                      "those had ended with: %.160s",
                      element_length[k], end->message);
      struct snap_study first = *study;
      *study = other;
      other = first;
    }
    if (decided || is_fatal(one) || one == STATUS_CANCELLED) {
      *ending = one;
      *end = local;
    }
    snap_study_close(&other);
  }
}

/* Calibration first, where one is asked for, then everything with the number that it found: it is
 * of one mesh, so that no other one is tried. */
static enum status compute(struct snap_spec *spec, const struct calibrate_options *options,
                           struct snap_study *study, struct calibrate_result *found,
                           enum status *ending, struct error *end) {
  *ending = spec->calibrate.asked ? calibrate(spec, options, found, end) : STATUS_OK;
  enum status status = open_study(spec, options, study, end);
  if (status != STATUS_OK) {
    return status;
  }
  if (*ending == STATUS_OK) {
    *ending = snap_study_run(study, end);
  }
  if (!spec->calibrate.asked) {
    try_meshes(spec, options, study, ending, end);
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
