/* Paths of a bellows that snaps, against what holds for any mesh: work and energy, where stability
 * is lost, dimensional analysis. The bellows here is soft and thin, so that nothing touches. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/snap/calibrate.h"
#include "solver/snap/result_snap.h"
#include "solver/snap/study.h"
#include "tests/physics/snap_case.h"
#include "tests/unit/suite.h"

static const char form[] =
    "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", \"outer_diameter\": "
    "\"%.17g mm\", \"wall\": \"%.17g mm\", \"snapping_angle\": \"40 deg\", \"supporting_angle\": "
    "\"55 deg\", \"snapping_slant\": \"%.17g mm\", \"hinge_length\": \"%.17g mm\", "
    "\"pet_thickness\": \"%.17g mm\"}, \"silicone\": {\"model\": \"neo-hooke\", \"mu\": "
    "\"%.17g MPa\"}, \"pet\": {\"modulus\": \"%.17g MPa\"}, \"load\": {\"pressure_to\": "
    "\"%.17g kPa\", \"vacuum_to\": \"%.17g kPa\", \"law\": [\"0 kPa\", \"%.17g kPa\"]}, "
    "\"accuracy\": \"fast\", \"harmonics\": {\"to\": 0}, \"contact\": false}";

/* Lengths times `length`, moduli and pressures times `modulus`. */
static void read_scaled(double length, double modulus, struct job_spec *job) {
  char text[4000];
  struct error error = {.status = STATUS_OK};
  snprintf(text, sizeof text, form, 40.0 * length, 0.6 * length, 6.0 * length, 3.0 * length,
           0.25 * length, 2.0 * modulus, 100.0 * modulus, 1.0 * modulus, -10.0 * modulus,
           0.2 * modulus);
  ck_assert_msg(job_spec_read(text, strlen(text), job, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
}

static void run_scaled(double length, double modulus, struct job_spec *job,
                       struct snap_study *study) {
  struct error error = {.status = STATUS_OK};
  read_scaled(length, modulus, job);
  ck_assert_int_eq(snap_study_open(job->snap, study, &error), STATUS_OK);
  ck_assert_msg(snap_study_run(study, &error) == STATUS_OK, "%s", error.message);
}

static void close_all(struct job_spec *job, struct snap_study *study) {
  snap_study_close(study);
  job_spec_release(job);
}

/* The body of most tests, computed once. */
static struct job_spec job;
static struct snap_study study;

static void setup(void) {
  run_scaled(1.0, 1.0, &job, &study);
}

static void teardown(void) {
  close_all(&job, &study);
}

static const struct snap_path *path_of(const char *name) {
  for (int i = 0; i < study.path_count; i++) {
    if (strcmp(study.path[i].name, name) == 0) {
      return &study.path[i];
    }
  }
  ck_abort_msg("no path %s", name);
  return NULL;
}

/* Work of the loads between two states of a path, by trapezia, which under a constant pressure and
 * where the length does not turn back know the slope dF/dh at both ends. */
static double work(const struct snap_path *path, int from, int to) {
  double sum = 0.0;
  for (int i = from; i < to; i++) {
    const struct snap_point *p = &path->point[i], *q = p + 1;
    double step = q->elongation - p->elongation;
    bool smooth = p->pressure == q->pressure && p->negative_held == 0 && q->negative_held == 0;
    sum += 0.5 * (p->force + q->force) * step +
           0.5 * (p->pressure + q->pressure) * (q->volume - p->volume);
    sum += smooth ? step * step / 12.0 * (p->stiffness - q->stiffness) : 0.0;
  }
  return sum;
}

/* tolerance: relative to the work done and given back on the whole way. */
static void check_energy(const struct snap_path *path, double tolerance) {
  double size = 0.0;
  for (int i = 0; i + 1 < path->count; i++) {
    size += fabs(work(path, i, i + 1));
  }
  for (int i = 1; i < path->count; i++) {
    double stored = path->point[i].energy - path->point[0].energy;
    ck_assert_msg(fabs(work(path, 0, i) - stored) <= tolerance * size,
                  "%s, state %d of %d: %g of %g", path->name, i, path->count,
                  (work(path, 0, i) - stored) / size, tolerance);
  }
}

START_TEST(the_work_of_the_loads_is_stored) {
  for (int i = 0; i < study.path_count; i++) {
    check_energy(&study.path[i], 2e-3);
  }
  check_energy(&study.held, 2e-3);
  ck_assert_int_eq(study.law_count, 2);
  check_energy(&study.law[0], 2e-3);
}
END_TEST

START_TEST(two_states_are_stable_without_load) {
  const struct snap_metrics *m = &study.metrics;
  ck_assert_int_eq(m->stable_states, 2);
  ck_assert_double_lt(m->compressed, 0.0);
  ck_assert_int_eq(study.body.inverted(study.body.self, study.state[SNAP_COMPRESSED].u), 1);
  ck_assert_double_gt(m->barrier, 0.0);
  ck_assert_double_gt(m->return_barrier, 0.0);
  ck_assert_double_gt(m->released, 0.0);
  ck_assert_double_gt(m->trigger_pressure, 0.0);
  ck_assert_double_lt(m->release_pressure, 0.0);
  ck_assert_double_gt(m->snap_force, 0.0);
  /* As moulded it is free of energy. */
  double stored = study.state[SNAP_COMPRESSED].energy;
  ck_assert_double_eq_tol((m->return_barrier - m->barrier) / stored, 1.0, 1e-6);
}
END_TEST

/* Force and pressure have their limits where dF/dh vanishes and where the tangent under pressure
 * loses its definiteness. */
START_TEST(stability_is_lost_at_the_limit_points) {
  const struct snap_path *axial = path_of("axial");
  double stiffest = 0.0;
  for (int i = 0; i < axial->count; i++) {
    stiffest = fmax(stiffest, fabs(axial->point[i].stiffness));
  }
  int limits = 0;
  for (int i = 1; i + 1 < axial->count; i++) {
    const struct snap_point *p = &axial->point[i];
    bool limit = (p->force - p[-1].force) * (p[1].force - p->force) < 0.0;
    if (limit) {
      limits++;
      ck_assert_double_lt(fabs(p->stiffness), 1e-2 * stiffest);
      ck_assert(p[-1].negative_free != p[1].negative_free);
    }
  }
  ck_assert_int_ge(limits, 2);
  const struct snap_path *pressure = path_of("pressure");
  double trigger = study.metrics.trigger_pressure;
  for (int i = 0; i < pressure->count && pressure->point[i].pressure < trigger * (1.0 - 1e-9);
       i++) {
    ck_assert_int_eq(pressure->point[i].negative_free, 0);
    ck_assert_double_lt(pressure->point[i].pressure, trigger);
  }
  ck_assert_int_eq(pressure->point[pressure->count - 1].negative_free, 0);
  ck_assert_double_eq_tol(pressure->point[pressure->count - 1].pressure, 1e3, 1e-6);
}
END_TEST

/* The path under vacuum and the one from the compressed state meet in the same limit point; so do
 * the stretched branches. */
START_TEST(paths_meet) {
  const struct snap_path *pressure = path_of("pressure");
  double least = INFINITY;
  for (int i = 0; i < pressure->count; i++) {
    least = fmin(least, pressure->point[i].pressure);
  }
  ck_assert_double_eq_tol(least / study.metrics.release_pressure, 1.0, 1e-4);
  const struct snap_path *stretched = path_of("pressure from natural");
  ck_assert_double_eq_tol(pressure->point[pressure->count - 1].elongation,
                          stretched->point[stretched->count - 1].elongation, 1e-8);
  const struct snap_path *axial = path_of("axial");
  const struct snap_path *law = &study.law[0];
  ck_assert_double_lt(law->point[0].elongation, axial->point[0].elongation);
  ck_assert_double_gt(law->point[law->count - 1].elongation, study.metrics.stretched);
}
END_TEST

/* A body n times as large of a material m times as stiff: pressures m, lengths n, forces m n^2,
 * energies m n^3 times as large; nothing else has a dimension. */
START_TEST(results_scale_with_lengths_and_moduli) {
  static const double length = 2.5, modulus = 3.0;
  struct job_spec scaled_job;
  struct snap_study scaled;
  run_scaled(length, modulus, &scaled_job, &scaled);
  const struct snap_metrics *a = &study.metrics, *b = &scaled.metrics;
  double force = modulus * length * length, energy = force * length;
  ck_assert_double_eq_tol(b->trigger_pressure / a->trigger_pressure, modulus, 1e-4);
  ck_assert_double_eq_tol(b->release_pressure / a->release_pressure, modulus, 1e-4);
  ck_assert_double_eq_tol(b->compressed / a->compressed, length, 1e-5);
  ck_assert_double_eq_tol(b->stretched / a->stretched, length, 1e-5);
  ck_assert_double_eq_tol(b->barrier / a->barrier / energy, 1.0, 1e-4);
  ck_assert_double_eq_tol(b->return_barrier / a->return_barrier / energy, 1.0, 1e-4);
  ck_assert_double_eq_tol(b->snap_force / a->snap_force / force, 1.0, 1e-4);
  ck_assert_double_eq_tol(b->held_force / a->held_force / force, 1.0, 1e-5);
  ck_assert_double_eq_tol(b->pet_strain / a->pet_strain, 1.0, 1e-2);
  close_all(&scaled_job, &scaled);
}
END_TEST

/* Held at its natural length a body pushes with the pressure on the section: at small pressures F =
 * -p dV/dh, Maxwell's relation for the potential W - p V - F h. */
START_TEST(force_and_volume_are_reciprocal) {
  const struct snap_path *law = &study.law[0];
  double slope = NAN;
  for (int i = 1; i < law->count; i++) {
    const struct snap_point *p = &law->point[i - 1], *q = &law->point[i];
    if (p->elongation < 0.0 && q->elongation >= 0.0) {
      slope = (q->volume - p->volume) / (q->elongation - p->elongation);
    }
  }
  const struct snap_point *first = &study.held.point[1];
  ck_assert_double_eq_tol(-first->force / first->pressure / slope, 1.0, 0.03);
}
END_TEST

/* Of a bellows with thick hinges, whose folds close under vacuum. Nothing holds the body with its
 * shells as moulded below the release pressure; a limit point above it, behind which the body is
 * stable again, is none. Only then is the vacuum one that returns it. */
START_TEST(the_release_is_the_last_state_before_shells_turn) {
  struct job_spec other;
  struct snap_study tried;
  struct error error = {.status = STATUS_OK};
  snap_case_must_read("", ", \"accuracy\": \"fast\"", &other);
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  ck_assert_msg(snap_follow_vacuum(&tried, &error) == STATUS_OK, "%s", error.message);
  const struct snap_path *path = &tried.path[0];
  double least = 0.0, release = tried.metrics.release_pressure;
  for (int i = 0; i < path->count; i++) {
    const struct snap_point *p = &path->point[i];
    if (p->negative_free == 0 && p->inverted == 0) {
      least = fmin(least, p->pressure);
    }
  }
  ck_assert(tried.has[SNAP_RELEASE]);
  ck_assert_double_eq_tol(tried.state[SNAP_RELEASE].pressure / release, 1.0, 1e-12);
  ck_assert_double_eq_tol(least / release, 1.0, 1e-3); /* a limit point is flat */
  int limits = 0;
  for (int i = 0; i < tried.event_count; i++) {
    limits += tried.event[i].type == SNAP_LIMIT_POINT && tried.event[i].pressure > 0.95 * release;
  }
  ck_assert_int_ge(limits, 1);
  ck_assert_int_gt(path->point[path->count - 1].inverted, 0);
  close_all(&other, &tried);
}
END_TEST

/* What is asked for between 0 and pressures that are too small. */
START_TEST(missing_limit_points_are_named) {
  struct job_spec other;
  struct snap_study tried;
  struct error error = {.status = STATUS_OK};
  read_scaled(1.0, 1.0, &other);
  other.snap->pressure_to = 0.2e3;
  other.snap->vacuum_to = -10.0;
  other.snap->extension_at = 0.0;
  other.snap->law_count = 0;
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  ck_assert_msg(snap_study_run(&tried, &error) == STATUS_OK, "%s", error.message);
  ck_assert(isnan(tried.metrics.trigger_pressure));
  ck_assert(isnan(tried.metrics.release_pressure));
  ck_assert_double_eq_tol(tried.metrics.stretched, 0.0, 1e-12);
  bool trigger = false, release = false;
  for (int i = 0; i < tried.warning_count; i++) {
    trigger = trigger || strstr(tried.warning[i], "raise /load/pressure_to") != NULL;
    release = release || strstr(tried.warning[i], "lower /load/vacuum_to") != NULL;
  }
  ck_assert(trigger);
  ck_assert(release);
  close_all(&other, &tried);
}
END_TEST

START_TEST(a_calibration_meets_its_target) {
  struct job_spec other;
  struct error error = {.status = STATUS_OK};
  read_scaled(1.0, 1.0, &other);
  struct snap_calibrate *c = &other.snap->calibrate;
  strcpy(c->pointer, "/actuator/pet_thickness");
  strcpy(c->metric, "release_pressure_kPa");
  c->asked = true;
  c->unit = "mm";
  c->unit_si = 1e-3;
  c->offset = offsetof(struct snap_given, pet_thickness);
  c->from = 0.2e-3;
  c->to = 0.3e-3;
  struct snap_study tried;
  struct calibrate_options options = {.deadline_s = 0.0};
  struct calibrate_result result;
  double before;
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  ck_assert_int_eq(snap_study_metric(&tried, c->metric, &before, &error), STATUS_OK);
  snap_study_close(&tried);
  c->target = before;
  ck_assert_int_eq(calibrate(other.snap, &options, &result, &error), STATUS_OK);
  ck_assert_double_eq_tol(other.snap->given.pet_thickness, 0.25e-3, 1e-7);
  c->target = 10.0 * before;
  ck_assert_int_eq(calibrate(other.snap, &options, &result, &error), STATUS_DIVERGED);
  ck_assert_ptr_nonnull(strstr(error.message, "widen the range"));
  job_spec_release(&other);
}
END_TEST

static bool at_once(void *context) {
  (void)context;
  return true;
}

START_TEST(it_stops_when_told) {
  struct job_spec other;
  struct snap_study tried;
  struct error error = {.status = STATUS_OK};
  read_scaled(1.0, 1.0, &other);
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  tried.cancelled = at_once;
  ck_assert_int_eq(snap_study_run(&tried, &error), STATUS_CANCELLED);
  snap_study_close(&tried);
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  tried.deadline_s = 1e-3;
  ck_assert_int_eq(snap_study_run(&tried, &error), STATUS_TIMEOUT);
  close_all(&other, &tried);
}
END_TEST

/* A body with one stable state is no failure of the program: it says so. */
START_TEST(a_body_with_one_state_says_so) {
  struct job_spec other;
  struct snap_study tried;
  struct error error = {.status = STATUS_OK};
  read_scaled(1.0, 1.0, &other);
  other.snap->given.snapping_angle = 12.0 * M_PI / 180.0;
  ck_assert_int_eq(snap_derive(other.snap, &error), STATUS_OK);
  ck_assert_int_eq(snap_study_open(other.snap, &tried, &error), STATUS_OK);
  ck_assert_int_eq(snap_study_run(&tried, &error), STATUS_UNSTABLE_PATH);
  ck_assert_ptr_nonnull(strstr(error.message, "the compressed state"));
  ck_assert(isnan(tried.metrics.trigger_pressure));
  ck_assert_double_gt(tried.metrics.held_force, 0.0);
  close_all(&other, &tried);
}
END_TEST

static double number(const json_t *object, const char *key) {
  const json_t *value = json_object_get(object, key);
  ck_assert_msg(json_is_number(value), "no %s", key);
  return json_number_value(value);
}

/* Work of the loads along a path of a result, by trapezia, mJ. */
static double work_of(const json_t *points) {
  double sum = 0.0;
  for (size_t i = 1; i < json_array_size(points); i++) {
    const json_t *p = json_array_get(points, i - 1), *q = json_array_get(points, i);
    sum += 0.5 * (number(p, "force_N") + number(q, "force_N")) *
               (number(q, "h_mm") - number(p, "h_mm")) +
           0.5e-3 * (number(p, "pressure_kPa") + number(q, "pressure_kPa")) *
               (number(q, "volume_mm3") - number(p, "volume_mm3"));
  }
  return sum;
}

/* The walls of this one touch, and on the mesh of its accuracy a path ends at a kink between two
 * facets: whatever mesh comes to the end, loads and energy agree along its paths. */
START_TEST(a_path_that_is_lost_is_found_on_another_mesh) {
  static const char hard[] =
      "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", \"outer_diameter\": "
      "\"52.183 mm\", \"wall\": \"2.45 mm\", \"snapping_angle\": \"47.225 deg\", "
      "\"supporting_angle\": \"52.359 deg\", \"snapping_slant\": \"6.695 mm\", \"hinge_length\": "
      "\"3.764 mm\", \"pet_thickness\": \"0.2509 mm\"}, \"silicone\": {\"model\": \"neo-hooke\", "
      "\"mu\": \"0.176 MPa\"}, \"pet\": {\"modulus\": \"3 GPa\"}, \"load\": {\"pressure_to\": "
      "\"60 kPa\", \"vacuum_to\": \"0 kPa\"}, \"accuracy\": \"fast\", \"harmonics\": {\"to\": "
      "0}}";
  struct job_spec other;
  struct error error = {.status = STATUS_OK};
  struct result_snap_options options = {.events = NULL};
  json_t *document = NULL, *path = NULL;
  enum status ending;
  size_t i;
  ck_assert_int_eq(job_spec_read(hard, strlen(hard), &other, &error), STATUS_OK);
  ck_assert_int_eq(result_snap(&other, &options, &document, &ending, &error), STATUS_OK);
  ck_assert_msg(ending == STATUS_OK, "%s", json_string_value(json_object_get(document, "message")));
  const json_t *metrics = json_object_get(document, "metrics");
  ck_assert_double_gt(number(metrics, "trigger_pressure_kPa"), 0.0);
  ck_assert_int_eq((int)number(metrics, "stable_states"), 2);
  json_array_foreach(json_object_get(document, "paths"), i, path) {
    const json_t *points = json_object_get(path, "points");
    double from = number(json_array_get(points, 0), "energy_mJ");
    double to = number(json_array_get(points, json_array_size(points) - 1), "energy_mJ");
    ck_assert_double_eq_tol(work_of(points), to - from,
                            0.03 * number(metrics, "energy_barrier_mJ"));
  }
  json_decref(document);
  job_spec_release(&other);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("snap: paths");
  TCase *paths = tcase_create("paths"), *jobs = tcase_create("jobs");
  TCase *meshes = tcase_create("meshes");
  tcase_set_timeout(paths, 120);
  tcase_add_unchecked_fixture(paths, setup, teardown);
  tcase_add_test(paths, the_work_of_the_loads_is_stored);
  tcase_add_test(paths, two_states_are_stable_without_load);
  tcase_add_test(paths, stability_is_lost_at_the_limit_points);
  tcase_add_test(paths, paths_meet);
  tcase_add_test(paths, results_scale_with_lengths_and_moduli);
  tcase_add_test(paths, force_and_volume_are_reciprocal);
  tcase_add_test(jobs, the_release_is_the_last_state_before_shells_turn);
  tcase_add_test(jobs, missing_limit_points_are_named);
  tcase_add_test(jobs, a_calibration_meets_its_target);
  tcase_add_test(jobs, it_stops_when_told);
  tcase_add_test(jobs, a_body_with_one_state_says_so);
  tcase_add_test(meshes, a_path_that_is_lost_is_found_on_another_mesh);
  tcase_set_timeout(meshes, 300);
  tcase_set_timeout(jobs, 120);
  suite_add_tcase(suite, paths);
  suite_add_tcase(suite, jobs);
  suite_add_tcase(suite, meshes);
  return suite_run(suite);
}
