#include "solver/run.h"

#include "solver/base/clock.h"
#include "solver/fe/path.h"
#include "solver/mesh/pneunet.h"
#include "solver/post/deck.h"
#include "solver/post/result.h"
#include "solver/post/result_sensitivity.h"

/* Everything one run owns. */
struct run {
  const struct job_spec *spec;
  const struct run_options *options;
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
  struct result *result;
  struct result_sensitivity *sensitivity; /* NULL unless the job asks for derivatives */
};

static enum status take_point(void *context, const struct path_point *point) {
  struct run *run = context;
  double to = run->spec->load.pressure_to;
  if (run->options->events) {
    fprintf(run->options->events,
            "{\"event\":\"progress\",\"fraction\":%.4f,\"pressure_kPa\":%.6g}\n",
            to != 0 ? point->pressure / to : 0, 1e-3 * point->pressure);
    fflush(run->options->events);
  }
  enum status status = result_add(run->result, point);
  return status == STATUS_OK && run->sensitivity ? result_sensitivity_add(run->sensitivity, point)
                                                 : status;
}

static bool has_gravity(const struct load_spec *load) {
  return load->gravity[0] != 0 || load->gravity[1] != 0 || load->gravity[2] != 0;
}

static enum status prepare(struct run *run, struct error *error) {
  const struct job_spec *spec = run->spec;
  enum status status = model_create(&run->mesh, &spec->material, spec->contact, &run->model, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (has_gravity(&spec->load)) {
    model_add_gravity(run->model, spec->load.gravity);
  }
  status = equilibrium_create(run->model, &run->solver, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct equilibrium_options *o = &run->solver->options;
  /* 1 % of the pressure between chambers leaves a penetration far below the wall thickness. */
  o->traction_tolerance = 0.01 * spec->load.pressure_to;
  o->deadline_s = spec->timeout_s > 0 ? clock_wall_s() + spec->timeout_s : 0;
  o->cancelled = run->options->cancelled;
  run->solver->verbose = run->options->verbose;
  run->result = result_create(spec, run->model, run->solver->retraction);
  if (!run->result || state_create(run->model, &run->state) != STATUS_OK) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result");
  }
  const char *directory = run->options->out_dir;
  status = directory ? result_export(run->result, directory, error) : STATUS_OK;
  if (status == STATUS_OK && spec->sensitivity.count > 0) {
    status = result_sensitivity_create(spec, &run->mesh, &run->sensitivity, error);
  }
  return status;
}

static enum status solve(struct run *run, json_t **document, enum status *ending,
                         struct error *error) {
  double wall = clock_wall_s(), cpu = clock_cpu_s();
  enum status status = prepare(run, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct path_options path = {run->spec->load.pressure_to, run->spec->load.steps,
                              has_gravity(&run->spec->load), take_point, run};
  struct error end = {0};
  *ending = path_follow(run->solver, &path, &run->state, &end);
  if (run->options->out_dir) {
    status = result_write_files(run->result, run->options->out_dir, error);
  }
  if (status == STATUS_OK) {
    *document =
        result_document(run->result, *ending, &end, clock_wall_s() - wall, clock_cpu_s() - cpu);
    if (!*document) {
      status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the result document");
    } else if (run->sensitivity) {
      json_object_set_new(*document, "sensitivity", result_sensitivity_block(run->sensitivity));
    }
  }
  return status;
}

enum status run_job(const struct job_spec *spec, const struct run_options *options,
                    json_t **document, enum status *ending, struct error *error) {
  struct run run = {.spec = spec, .options = options};
  *document = NULL;
  *ending = STATUS_OK;
  enum status status = pneunet_mesh(spec, &run.mesh, error);
  if (status != STATUS_OK) {
    return status;
  }
  if (options->deck_path) {
    status = deck_write(&run.mesh, spec, "C3D20R", options->deck_path, error);
  } else {
    status = solve(&run, document, ending, error);
  }
  result_sensitivity_destroy(run.sensitivity);
  result_destroy(run.result);
  state_release(&run.state);
  equilibrium_destroy(run.solver);
  model_destroy(run.model);
  mesh_release(&run.mesh);
  return status;
}
