#include "tests/bench/error_case.h"

#include <math.h>
#include "solver/base/clock.h"
#include "solver/fe/path.h"
#include "solver/fe/transfer.h"
#include "solver/mesh/pneunet.h"
#include "solver/post/sample.h"
#include "solver/run.h"
#include "solver/solve.h"

static const double resolution = 1e-3;

/* Cuts every cell; those in the plane of bending, next to the singular corners, most. */
static void split_all(struct pneunet_cells *c) {
  struct grid_division *twice[] = {&c->cavity,     &c->gap,    &c->channel, &c->stem,
                                   &c->half_width, &c->bottom, &c->below,   &c->duct,
                                   &c->cover,      &c->slit,   &c->floor,   &c->top};
  for (size_t k = 0; k < sizeof twice / sizeof *twice; k++) {
    twice[k]->split = 2;
  }
  c->gap_wall.split = c->gap_wall.cells > 1 ? 2 : 4;
  c->height.split = 2;
}

static enum status follow(const struct job_spec *spec, const struct pneunet_cells *cells,
                          struct solve *solve, struct error *error) {
  enum status status = pneunet_mesh_cells(spec, cells, &solve->mesh, error);
  if (status == STATUS_OK) {
    status = solve_prepare(spec, solve, error);
  }
  if (status == STATUS_OK) {
    struct path_options path = {.pressure_to = spec->load.pressure_to,
                                .steps = spec->load.steps,
                                .dead_load = solve_has_gravity(spec)};
    status = path_follow(solve->solver, &path, &solve->state, error);
  }
  return status;
}

static enum status solve_reference(const struct job_spec *spec, struct sample *sample,
                                   int *unknowns, struct error *error) {
  struct solve coarse = {0}, fine = {0};
  struct pneunet_cells cells = pneunet_resolution(spec);
  enum status status = follow(spec, &cells, &coarse, error);
  split_all(&cells);
  if (status == STATUS_OK) {
    status = pneunet_mesh_cells(spec, &cells, &fine.mesh, error);
  }
  if (status == STATUS_OK) {
    status = solve_prepare(spec, &fine, error);
  }
  if (status == STATUS_OK) {
    status = transfer_state(coarse.model, &coarse.state, fine.model, &fine.state, error);
  }
  if (status == STATUS_OK) {
    double pressure = spec->load.pressure_to;
    struct fe_load load = {pressure, pressure, solve_has_gravity(spec) ? 1 : 0};
    int iterations;
    status = equilibrium_solve(fine.solver, &load, pressure, &fine.state, &iterations);
    if (status != STATUS_OK) {
      error_set(error, status, NULL, "on the finest mesh, %s", status_sentence(status));
    }
  }
  if (status == STATUS_OK) {
    *unknowns = fine.model->dof_count;
    status = sample_measure(fine.model, &fine.state, sample);
  }
  solve_release(&coarse);
  solve_release(&fine);
  return status;
}

static double number(const json_t *object, const char *key, const char *suffix) {
  char name[64];
  snprintf(name, sizeof name, "%s%s", key, suffix);
  const json_t *value = json_object_get(object, name);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

static const char *const names[ERROR_METRICS] = {"bending_angle_deg",  "chord_angle_deg",
                                                 "end_face_angle_deg", "tip_deflection_mm",
                                                 "cavity_volume_mm3",  "max_stretch"};

enum status error_case_metrics(const struct job_spec *spec, struct error_case *result,
                               struct error *error) {
  json_t *document = NULL;
  enum status ending = STATUS_OK;
  *result = (struct error_case){0};
  enum status status = run_job(spec, &(struct run_options){0}, &document, &ending, error);
  if (status == STATUS_OK && ending != STATUS_OK) {
    status = error_set(error, ending, NULL, "%s",
                       json_string_value(json_object_get(document, "message")));
  }
  if (status == STATUS_OK) {
    const json_t *metrics = json_object_get(document, "metrics");
    const json_t *statistics = json_object_get(document, "statistics");
    for (int k = 0; k < ERROR_METRICS; k++) {
      result->metric[k] = (struct error_metric){.name = names[k],
                                                .value = number(metrics, names[k], ""),
                                                .estimate = number(metrics, names[k], "_error")};
    }
    result->unknowns = (int)number(statistics, "unknowns", "");
    result->estimate_s = number(statistics, "estimate_s", "");
    result->solve_s = number(statistics, "cpu_s", "") - result->estimate_s;
  }
  json_decref(document);
  return status;
}

enum status error_case_run(const struct job_spec *spec, struct error_case *result,
                           struct error *error) {
  struct sample reference = {0};
  enum status status = error_case_metrics(spec, result, error);
  if (status == STATUS_OK) {
    status = solve_reference(spec, &reference, &result->reference_unknowns, error);
  }
  if (status == STATUS_OK) {
    double degree = M_PI / 180;
    const double value[ERROR_METRICS] = {
        reference.shape.bending_angle / degree,  reference.shape.chord_angle / degree,
        reference.shape.end_face_angle / degree, 1e3 * reference.tip_deflection,
        1e9 * reference.cavity_volume,           reference.max_stretch};
    for (int k = 0; k < ERROR_METRICS; k++) {
      result->metric[k].reference = value[k];
    }
  }
  return status;
}

double error_case_truth(const struct error_metric *m) {
  return fmax(fabs(m->value - m->reference), resolution * fabs(m->reference));
}

bool error_case_covers(const struct error_metric *m) {
  double known = fmax(m->estimate, resolution * fabs(m->reference));
  return known >= error_case_truth(m);
}

bool error_case_is_near(const struct error_metric *m) {
  double ratio = fmax(m->estimate, resolution * fabs(m->reference)) / error_case_truth(m);
  return ratio >= 1.0 / 3 && ratio <= 3;
}
