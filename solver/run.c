#include "solver/run.h"

#include <math.h>

#include "solver/base/clock.h"
#include "solver/bistable/dynamics.h"
#include "solver/bistable/result.h"
#include "solver/estimate.h"
#include "solver/fe/forecast.h"
#include "solver/grasp/grasp_job.h"
#include "solver/identify/identify_job.h"
#include "solver/material/curve_job.h"
#include "solver/material/fit_job.h"
#include "solver/mesh/actuator.h"
#include "solver/post/deck.h"
#include "solver/post/result.h"
#include "solver/post/result_hlpv.h"
#include "solver/post/result_measured.h"
#include "solver/post/result_sensitivity.h"
#include "solver/snap/result_snap.h"
#include "solver/verify/verify.h"

/* Everything one run owns. */
struct run {
  const struct job_spec *spec;
  const struct run_options *options;
  struct solve solve;
  struct result *result;
  struct path_record *from;               /* path to start from, or NULL */
  struct path_record *path;               /* path to be kept, or NULL */
  struct result_sensitivity *sensitivity; /* NULL unless the job asks for derivatives */
  int step;                               /* recorded states above no load */
  double pressure, fraction;              /* of the last report */
};

/* Part of the work that the path is when its error is estimated on a finer mesh. */
static const double path_share = 0.5;

/* Reports how far the job is; the fraction never falls, also where the pressure does. */
static void tell(struct run *run, double fraction) {
  FILE *events = run->options->events;
  run->fraction = fmax(run->fraction, fmin(fraction, 1.0));
  if (events) {
    fprintf(events,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"pressure_kPa\":%.6g,\"step\":%d,"
            "\"steps\":%d,\"iteration\":%d}\n",
            run->fraction, 1e-3 * run->pressure, run->step, run->spec->load.steps,
            run->solve.model->statistics.newton_iterations);
    fflush(events);
  }
}

static enum status take_point(void *context, const struct path_point *point) {
  struct run *run = context;
  double to = run->spec->load.pressure_to, share = run->spec->error_estimate ? path_share : 1;
  run->step += point->recorded && point->pressure != 0;
  run->pressure = point->pressure;
  tell(run, to != 0 ? share * point->pressure / to : 0);
  enum status status = result_add(run->result, point);
  if (status == STATUS_OK && run->path && point->recorded) {
    status = path_record_add(run->path, point->pressure, point->state);
  }
  return status == STATUS_OK && run->sensitivity ? result_sensitivity_add(run->sensitivity, point)
                                                 : status;
}

static enum status prepare(struct run *run, struct error *error) {
  const struct job_spec *spec = run->spec;
  struct run_carry *carry = run->options->carry;
  enum status status =
      solve_prepare_with(spec, carry ? &carry->analyses : NULL, &run->solve, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct equilibrium *solver = run->solve.solver;
  solver->options.deadline_s = spec->timeout_s > 0 ? clock_wall_s() + spec->timeout_s : 0;
  solver->options.cancelled = run->options->cancelled;
  solver->verbose = run->options->verbose;
  run->result = result_create(spec, run->solve.model);
  if (!run->result) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result");
  }
  const char *directory = run->options->out_dir;
  status = directory ? result_export(run->result, directory, error) : STATUS_OK;
  if (status == STATUS_OK && spec->sensitivity.count > 0) {
    status = result_sensitivity_create(spec, run->solve.model, &run->sensitivity, error);
  }
  return status;
}

/* How much the last state changes on a finer mesh; a failure becomes a warning of the result. */
static void estimate(struct run *run) {
  struct error error = {0};
  struct sample finer;
  double start = clock_cpu_s();
  model_retire(run->solve.model);
  enum status status =
      estimate_finer(run->spec, &run->solve, run->spec->load.pressure_to, &finer, &error);
  tell(run, 1);
  result_compare(run->result, status == STATUS_OK ? &finer : NULL, &error, clock_cpu_s() - start);
}

/* The path to start from, as far as what is carried tells. */
static enum status foresee(struct run *run, struct run_carry *carry) {
  double place[DESIGN_NUMBERS];
  enum status status = STATUS_OK;
  if (!carry->earlier) {
    carry->earlier = forecast_create();
    status = carry->earlier ? STATUS_OK : STATUS_NO_MEMORY;
  }
  if (status == STATUS_OK && carry->path) {
    status = forecast_add(carry->earlier, carry->path);
    carry->path = NULL;
  }
  design_numbers(run->spec, place);
  return status == STATUS_OK ? forecast_make(carry->earlier, run->solve.model, place, &run->from)
                             : status;
}

/* Opens the path to start from and the one to be kept, as asked for. */
static enum status open_paths(struct run *run, struct error *error) {
  enum status status = STATUS_OK;
  if (run->options->path_in) {
    status = path_record_read(run->options->path_in, &run->from, error);
  }
  struct run_carry *carry = run->options->carry;
  if (status == STATUS_OK && carry) {
    status = foresee(run, carry);
  }
  if (status == STATUS_OK && (run->options->path_out || carry)) {
    status = path_record_create(run->solve.model, &run->path);
  }
  if (status == STATUS_OK && run->path) {
    design_numbers(run->spec, run->path->place);
  }
  return status;
}

/* Leaves to the next solve what it may start from. */
static void hand_over(struct run *run, enum status ending) {
  struct run_carry *carry = run->options->carry;
  if (carry && run->solve.model && ending == STATUS_OK) {
    path_record_note_pairs(run->path, run->solve.model);
    carry->path = run->path;
    run->path = NULL;
  }
}

void run_carry_release(struct run_carry *carry) {
  path_record_destroy(carry->path);
  forecast_destroy(carry->earlier);
  analyses_release(&carry->analyses);
  *carry = (struct run_carry){0};
}

static enum status follow(struct run *run, struct error *error) {
  struct path_options path = {run->spec->load.pressure_to, run->spec->load.steps,
                              solve_has_gravity(run->spec), take_point, run};
  bool warm = false;
  enum status status = run->from ? path_follow_warm(run->solve.solver, &path, run->from,
                                                    &run->solve.state, &warm, error)
                                 : path_follow(run->solve.solver, &path, &run->solve.state, error);
  result_note_start(run->result, warm);
  return result_cause(run->result, status, error);
}

static enum status solve(struct run *run, json_t **document, enum status *ending,
                         struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  enum status status = prepare(run, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = open_paths(run, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct error end = {0};
  *ending = follow(run, &end);
  if (*ending == STATUS_OK && run->spec->error_estimate) {
    estimate(run);
  }
  if (run->options->path_out) {
    path_record_note_pairs(run->path, run->solve.model);
    status = path_record_write(run->path, run->options->path_out, error);
  }
  if (status == STATUS_OK && run->options->out_dir) {
    status = result_write_files(run->result, run->options->out_dir, error);
  }
  if (status == STATUS_OK) {
    *document =
        result_document(run->result, *ending, &end, clock_wall_s() - wall, clock_cpu_s() - cpu);
    if (!*document ||
        (run->sensitivity && result_sensitivity_store(run->sensitivity, *document) != STATUS_OK)) {
      json_decref(*document);
      *document = NULL;
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
    }
    status = result_measured_store(run->spec, *document, error);
    if (status != STATUS_OK) {
      json_decref(*document);
      *document = NULL;
    }
  }
  return status;
}

/* Jobs without a body of the job's own. */
static enum status run_other(const struct job_spec *spec, const struct run_options *options,
                             json_t **document, enum status *ending, struct error *error) {
  if (options->deck_path) {
    return error_set(error, STATUS_INVALID, "/kind",
                     "only a response job has a deck: the others have no body of their own");
  }
  if (spec->kind == JOB_FIT_MATERIAL) {
    return fit_job(spec, options->cancelled, document, ending, error);
  }
  if (spec->kind == JOB_MATERIAL_CURVE) {
    return curve_job(spec, document, error);
  }
  if (spec->kind == JOB_IDENTIFY) {
    return identify_job(spec, options->events, options->cancelled, document, ending, error);
  }
  if (spec->kind == JOB_BISTABLE) {
    struct result_bistable_options bistable = {options->events, options->cancelled};
    return result_bistable(spec, &bistable, document, ending, error);
  }
  if (spec->kind == JOB_HLPV) {
    struct result_hlpv_options hlpv = {.events = options->events, .cancelled = options->cancelled};
    return result_hlpv(spec, &hlpv, document, ending, error);
  }
  if (spec->kind == JOB_GRASP) {
    struct grasp_options grasp = {options->out_dir, options->events, options->verbose,
                                  options->cancelled};
    return grasp_job(spec, &grasp, document, ending, error);
  }
  if (spec->kind == JOB_SNAP) {
    struct result_snap_options snap = {options->events, options->cancelled};
    enum status status = result_snap(spec, &snap, document, ending, error);
    if (status == STATUS_OK && spec->bistable) {
      struct result_bistable_options motion = {options->events, options->cancelled};
      status = bistable_dynamics(spec, &motion, *document, error);
    }
    return status;
  }
  struct verify_options verify = {options->events, options->cancelled};
  return verify_job(spec, &verify, document, ending, error);
}

enum status run_job(const struct job_spec *spec, const struct run_options *options,
                    json_t **document, enum status *ending, struct error *error) {
  struct run run = {.spec = spec, .options = options};
  *document = NULL;
  *ending = STATUS_OK;
  if (spec->kind != JOB_RESPONSE) {
    return run_other(spec, options, document, ending, error);
  }
  enum status status = actuator_mesh(spec, &run.solve.mesh, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (options->deck_path) {
    status = deck_write(&run.solve.mesh, spec, "C3D20R", options->deck_path, error);
  } else {
    status = solve(&run, document, ending, error);
  }
  if (status == STATUS_OK && !options->deck_path) {
    hand_over(&run, *ending);
  }
  path_record_destroy(run.from);
  path_record_destroy(run.path);
  result_sensitivity_destroy(run.sensitivity);
  result_destroy(run.result);
  solve_release(&run.solve);
  return status;
}
