#include "solver/grasp/grasp_job.h"

#include <math.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/grasp/files.h"
#include "solver/grasp/gripper.h"

/* Everything one job owns. */
struct run {
  const struct job_spec *spec;
  const struct grasp_options *options;
  struct gripper gripper;
  json_t *fingers, *artifacts;
  struct grasp_files *files; /* NULL: none are written */
  int done;                  /* fingers that have been solved */
  double fraction;
  double deadline_s;
  struct error failure; /* of writing files on the way */
};

/* ---- progress ----------------------------------------------------------------------------- */

/* Share of a finger's work that has passed at the end of each stage, about. */
static double passed(const struct run *run, const struct grasp_sample *sample) {
  bool pull = grasp_pulls(run->spec->grasp);
  double inflated = pull ? 0.4 : 1;
  switch (sample->stage) {
  case STAGE_GRAVITY:
    return 0.02 * sample->along;
  case STAGE_APPROACH:
    return 0.02 + 0.08 * sample->along;
  case STAGE_INFLATION:
    return 0.1 + (inflated - 0.1) * sample->along;
  case STAGE_SUCTION:
  case STAGE_LETTING_GO:
    return inflated;
  case STAGE_PULL:
    return inflated + (0.9 - inflated) * sample->along;
  case STAGE_RELEASE:
  case STAGE_COUNT:
    break;
  }
  return 0.9 + 0.1 * sample->along;
}

static void tell(struct run *run, const struct finger *finger, const struct grasp_sample *sample) {
  double fraction = (run->done + passed(run, sample)) / run->gripper.solved;
  run->fraction = fmax(run->fraction, fmin(fraction, 1));
  if (run->options->events) {
    fprintf(run->options->events,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"pressure_kPa\":%.6g,\"iteration\":%d}\n",
            run->fraction, 1e-3 * sample->value[GRASP_PRESSURE],
            finger->solve.model->statistics.newton_iterations);
    fflush(run->options->events);
  }
}

static enum status visit(void *context, const struct finger *finger,
                         const struct grasp_sample *sample) {
  struct run *run = context;
  tell(run, finger, sample);
  return run->files ? grasp_files_add(run->files, sample, &run->failure) : STATUS_OK;
}

/* ---- one finger --------------------------------------------------------------------------- */

static json_t *vector(const double *v, int count, double unit) {
  json_t *list = json_array();
  for (int i = 0; i < count; i++) {
    json_array_append_new(list, json_real(unit * v[i]));
  }
  return list;
}

/* What the result says of a finger that was solved, and of those like it. */
static enum status describe_finger(struct run *run, int number, enum status ending) {
  const struct gripper *g = &run->gripper;
  const struct course_report *report = &g->finger[number].report;
  json_t *poses = json_array();
  for (int k = 0; k < g->count; k++) {
    const struct gripper_finger *finger = &g->finger[k];
    if (finger->like == number) {
      json_array_append_new(poses, json_pack("{s:i, s:o, s:o}", "finger", k + 1, "place_mm",
                                             vector(finger->place, 3, 1e3), "rotation",
                                             vector(&finger->rotation[0][0], 9, 1)));
    }
  }
  json_t *object =
      json_pack("{s:o, s:s, s:s, s:f, s:f, s:f, s:i, s:i, s:i, s:b}", "poses", poses, "reason",
                ending == STATUS_OK ? "" : status_word(ending), "stage",
                grasp_stage_word(report->stage), "stage_share", report->along, "dynamic_share_pct",
                100 * report->in_motion, "energy_error_pct", 100 * report->energy_error, "jumps",
                report->carried, "unknowns", g->finger[number].unknowns, "elements",
                g->finger[number].elements, "half_model", g->finger[number].half);
  return object && json_array_append_new(run->fingers, object) == 0 ? STATUS_OK : STATUS_NO_MEMORY;
}

static void prepare_limits(struct run *run, struct finger *finger) {
  struct equilibrium *solver = finger->solve.solver;
  solver->options.deadline_s = run->deadline_s;
  solver->options.cancelled = run->options->cancelled;
  solver->verbose = run->options->verbose;
}

static void keep_statistics(struct gripper_finger *kept, const struct finger *finger) {
  kept->unknowns = finger->solve.model->dof_count;
  kept->elements = finger->solve.mesh.element_count;
  kept->statistics = finger->solve.model->statistics;
}

/* Solves one finger. *ending tells how its course went; the returned status only what no result can
 * come of. */
static enum status solve_finger(struct run *run, int number, enum status *ending, struct error *end,
                                struct error *error) {
  struct finger finger;
  struct gripper_finger *kept = &run->gripper.finger[number];
  struct course_visit visitor = {visit, run};
  enum status status = finger_prepare(run->spec, number, kept->half, &finger, error);
  if (status == STATUS_OK && run->files) {
    status = grasp_files_begin(run->files, number, &finger, error);
  }
  if (status == STATUS_OK) {
    prepare_limits(run, &finger);
    *ending = course_follow(&finger, &visitor, &kept->report, end);
    keep_statistics(kept, &finger);
    status = *ending == STATUS_IO ? STATUS_IO : STATUS_OK;
  }
  if (status == STATUS_OK) {
    status = describe_finger(run, number, *ending);
  }
  if (*ending == STATUS_IO) {
    *error = run->failure;
  }
  finger_release(&finger);
  run->done++;
  return status;
}

/* ---- the document ------------------------------------------------------------------------- */

static json_t *samples_of(const struct grasp_series *series) {
  json_t *samples = json_array();
  for (size_t i = 0; samples && i < series->count; i++) {
    json_array_append_new(samples, grasp_sample_object(&series->sample[i]));
  }
  return samples;
}

static json_t *statistics_of(const struct gripper *g, double wall_s, double cpu_s) {
  struct fe_statistics sum = {0};
  int unknowns = 0, elements = 0;
  for (int k = 0; k < g->count; k++) {
    const struct fe_statistics *s = &g->finger[k].statistics;
    sum.factorizations += s->factorizations;
    sum.newton_iterations += s->newton_iterations;
    sum.solves += s->solves;
    sum.analyses += s->analyses;
    unknowns += g->finger[k].unknowns;
    elements += g->finger[k].elements;
  }
  return json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:f, s:f}", "fingers_solved",
                   g->solved, "unknowns", unknowns, "elements", elements, "factorizations",
                   sum.factorizations, "newton_iterations", sum.newton_iterations, "solves",
                   sum.solves, "analyses", sum.analyses, "wall_s", wall_s, "cpu_s", cpu_s,
                   "peak_memory_MB", clock_peak_memory_MB());
}

static json_t *warnings_of(const struct run *run) {
  const struct gripper *g = &run->gripper;
  json_t *list = json_array();
  if (run->spec->accuracy == ACCURACY_DRAFT) {
    json_array_append_new(list, json_string("a draft: the mesh is coarser than that of fast, to "
                                            "compare many designs; confirm this one at standard"));
  }
  for (int k = 0; k < g->count; k++) {
    const struct course_report *report = &g->finger[k].report;
    if (g->finger[k].solved && report->carried > 0) {
      json_array_append_new(
          list, json_sprintf("finger %d jumped %d times: these parts, %.3g %% of its course, were "
                             "followed in motion and are marked as dynamic",
                             k + 1, report->carried, 100 * report->in_motion));
    }
    if (g->finger[k].solved && report->energy_error > 0.01) {
      json_array_append_new(list,
                            json_sprintf("the energies of finger %d do not balance by %.2g %% "
                                         "of the work done: take shorter steps",
                                         k + 1, 100 * report->energy_error));
    }
  }
  if (!strcmp(gripper_outcome(g), "never touched")) {
    json_array_append_new(list, json_string("the actuator never touched the object"));
  }
  return list;
}

static json_t *document_of(struct run *run, enum status ending, const struct error *end,
                           double wall_s, double cpu_s) {
  const struct job_spec *spec = run->spec;
  bool good = ending == STATUS_OK;
  return json_pack(
      "{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:O, s:o, s:O, s:o, s:{s:s, s:s}}", "status",
      good ? "succeeded" : "diverged", "reason", good ? "" : status_word(ending), "message",
      good ? "" : end->message, "kind", "grasp", "name", spec->name, "outcome",
      gripper_outcome(&run->gripper), "metrics", gripper_metrics(&run->gripper), "samples",
      samples_of(&run->gripper.sum), "fingers", run->fingers, "warnings", warnings_of(run),
      "artifacts", run->artifacts, "statistics", statistics_of(&run->gripper, wall_s, cpu_s),
      "provenance", "version", PNEULAB_VERSION, "spec_hash", spec->hash);
}

static enum status solve(struct run *run, enum status *ending, struct error *end,
                         struct error *error) {
  enum status status = STATUS_OK;
  for (int k = 0; k < run->gripper.count && status == STATUS_OK && *ending == STATUS_OK; k++) {
    if (run->gripper.finger[k].solved) {
      status = solve_finger(run, k, ending, end, error);
    }
  }
  if (status == STATUS_OK) {
    status = gripper_sum(&run->gripper);
  }
  return status;
}

enum status grasp_job(const struct job_spec *spec, const struct grasp_options *options,
                      json_t **document, enum status *ending, struct error *error) {
  struct run run = {.spec = spec, .options = options};
  struct error end = {0};
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  *document = NULL;
  *ending = STATUS_OK;
  run.fingers = json_array();
  run.artifacts = json_array();
  run.deadline_s = spec->timeout_s > 0 ? wall + spec->timeout_s : 0;
  gripper_init(&run.gripper, spec);
  enum status status = run.fingers && run.artifacts ? STATUS_OK : STATUS_NO_MEMORY;
  if (status == STATUS_OK && options->out_dir) {
    status = grasp_files_create(&run.gripper, options->out_dir, &run.files, error);
  }
  if (status == STATUS_OK) {
    status = solve(&run, ending, &end, error);
  }
  if (status == STATUS_OK) {
    *document = document_of(&run, *ending, &end, clock_wall_s() - wall, clock_cpu_s() - cpu);
    status = *document ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status == STATUS_OK && run.files) {
    status =
        grasp_files_finish(run.files, json_object_get(*document, "samples"), run.artifacts, error);
  }
  if (status == STATUS_NO_MEMORY) {
    error_set(error, status, NULL, "no memory for the grasp");
  }
  if (status != STATUS_OK) {
    json_decref(*document);
    *document = NULL;
  }
  grasp_files_destroy(run.files);
  json_decref(run.fingers);
  json_decref(run.artifacts);
  gripper_release(&run.gripper);
  return status;
}
