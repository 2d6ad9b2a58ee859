/* Parts of the body that meet although no gap of the mesh lies between them. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include "solver/job/material.h"
#include "tests/physics/forces.h"
#include "tests/physics/inside.h"
#include "tests/physics/legs.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* ---- parameters of the contact, which are no property of the body ---- */

struct variation {
  const char *name;
  double stiffness, smoothing, reach, traction;
};
static const struct variation variations[] = {
    {"stiffness x 0.3", 0.3, 1, 1, 1},
    {"stiffness x 3", 3, 1, 1, 1},
    {"smoothing x 0.5", 1, 0.5, 1, 1},
    {"reach x 0.5", 1, 1, 0.5, 1},
    {"smoothing x 2", 1, 2, 1, 1},
    {"reach x 2", 1, 1, 2, 1},
    {"traction tolerance x 0.3", 1, 1, 1, 0.3},
};
enum { VARIATIONS = SANITIZED ? 4 : sizeof variations / sizeof *variations };

static void vary(struct pneunet_case *c, const struct variation *v) {
  c->model->contact.stiffness *= v->stiffness;
  c->model->contact.smoothing *= v->smoothing;
  c->model->contact.reach *= v->reach;
  c->solver->options.traction_tolerance *= v->traction;
}

/* ---- a body that curls up until its tip meets its base ---- */

enum { CURL_STEPS = 10 };
static const double curl_pressure = 45e3;

static void curl_spec(struct job_spec *spec) {
  case_prototype(spec, 9);
  struct pneunet_spec *p = &spec->pneunet;
  p->length = 9 * 0.007 + 8 * 0.0015;
  p->width = 0.024;
  p->height_base = p->height_tip = 0.016;
  p->chamber_gap = p->side_wall = p->gap_wall = p->top_wall = 0.0015;
  p->bottom_layer = 0.0025;
  p->taper_left = p->taper_right = 0;
  spec->material = *material_find("dragon-skin-30");
  spec->mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  spec->load = (struct load_spec){.pressure_to = curl_pressure, .steps = CURL_STEPS};
  spec->contact = true;
}

/* The body with its states before the tip arrives, one step before the end, and at the end. */
struct curl {
  struct pneunet_case c;
  struct fe_state open, before;
  double angle;
};

static enum status keep_state(void *context, const struct path_point *point) {
  struct curl *curl = context;
  double step = curl_pressure / CURL_STEPS;
  if (point->recorded && fabs(point->pressure - 8 * step) < 1) {
    state_copy(curl->c.model, &curl->open, point->state);
  }
  if (point->recorded && fabs(point->pressure - 9 * step) < 1) {
    state_copy(curl->c.model, &curl->before, point->state);
  }
  return STATUS_OK;
}

static void curl_open(struct curl *curl) {
  struct job_spec spec;
  struct error error = {0};
  curl_spec(&spec);
  case_open(&curl->c, &spec);
  ck_assert_int_eq(state_create(curl->c.model, &curl->open), STATUS_OK);
  ck_assert_int_eq(state_create(curl->c.model, &curl->before), STATUS_OK);
  struct path_options path = {
      .pressure_to = curl_pressure, .steps = CURL_STEPS, .visit = keep_state, .context = curl};
  enum status status = path_follow(curl->c.solver, &path, &curl->c.state, &error);
  ck_assert_msg(status == STATUS_OK, "%s", error.message);
  curl->angle = case_angle(&curl->c.mesh, curl->c.state.u);
}

static void curl_close(struct curl *curl) {
  state_release(&curl->open);
  state_release(&curl->before);
  case_close(&curl->c);
}

/* Goes on from a state in equilibrium with step `from` of the path to its end, by half steps or
 * shorter ones. */
static double curl_go_on(struct curl *curl, const struct fe_state *state, int from) {
  struct pneunet_case *c = &curl->c;
  double full = curl_pressure / CURL_STEPS, at = from * full, step = 0.5 * full;
  struct fe_state good;
  ck_assert_int_eq(state_create(c->model, &good), STATUS_OK);
  state_copy(c->model, &good, state);
  c->solver->factor_fits = false;
  while (at < curl_pressure) {
    struct fe_load load = {.pressure = fmin(at + step, curl_pressure)};
    int iterations;
    state_copy(c->model, &c->state, &good);
    enum status status = equilibrium_solve(c->solver, &load, at, &c->state, &iterations);
    if (status == STATUS_OK) {
      state_copy(c->model, &good, &c->state);
      at = load.pressure;
    } else {
      step *= 0.5;
      ck_assert_msg(step > 0.01 * full, "%s after %g Pa", status_word(status), at);
    }
  }
  state_release(&good);
  return case_angle(&c->mesh, c->state.u);
}

/* Depth of the last chamber, but for the side that its neighbour faces, inside the body. */
static double tip_inside(const struct pneunet_case *c) {
  int from = c->mesh.station[c->mesh.station_count - 2] + 1, to = c->mesh.section_count - 1;
  return fmax(inside_nodes(&c->mesh, c->state.u, from, to),
              inside_points(c->model, c->state.u, from, to));
}

static void check_forces(struct curl *curl) {
  struct pneunet_case *c = &curl->c;
  struct forces pairs = forces_of_pairs(c->model, &c->state);
  struct forces base = forces_at_base(c->model, &c->state, curl_pressure);
  double arm = c->spec.pneunet.length;
  ck_assert_double_gt(pairs.size, 0);
  for (int i = 0; i < 3; i++) {
    ck_assert_double_lt(fabs(pairs.force[i]), 1e-12 * pairs.size);
    ck_assert_double_lt(fabs(pairs.moment[i]), 1e-10 * pairs.size * arm);
  }
  /* Pressure in closed chambers and contact with oneself need no support; of the half that is
   * modelled, that holds for forces and moments within the plane of symmetry. */
  ck_assert_double_gt(base.size, 0);
  ck_assert_double_lt(fabs(base.force[0]), 1e-5 * base.size);
  ck_assert_double_lt(fabs(base.force[2]), 1e-5 * base.size);
  ck_assert_double_lt(fabs(base.moment[1]), 1e-5 * base.size * arm);
}

static void check_parameters(struct curl *curl) {
  struct pneunet_case *c = &curl->c;
  const struct contact before = c->model->contact;
  double tolerance = c->solver->options.traction_tolerance;
  for (int k = 0; k < VARIATIONS; k++) {
    vary(c, &variations[k]);
    double angle = curl_go_on(curl, &curl->before, 9);
    report_check("9 chambers curl up, degrees", variations[k].name, curl->angle, angle, 1e-3);
    ck_assert(contact_folded(&c->model->contact));
    c->model->contact.stiffness = before.stiffness;
    c->model->contact.smoothing = before.smoothing;
    c->model->contact.reach = before.reach;
    c->solver->options.traction_tolerance = tolerance;
  }
}

/* The tip comes to rest on the body. When nobody watches out for it, it passes through. */
START_TEST(tip_meets_its_own_body) {
  struct curl curl;
  curl_open(&curl);
  struct pneunet_case *c = &curl.c;
  double wall = c->mesh.wall_thickness, deep = tip_inside(c);
  struct contact_summary summary = contact_summarise(&c->model->contact);
  report_value("9 chambers curl up, tip inside the body, walls", "coarse", 0, deep / wall);
  report_value("9 chambers curl up, penetration of contact, walls", "coarse", 0,
               summary.penetration / wall);
  ck_assert(contact_folded(&c->model->contact));
  ck_assert_double_lt(deep, 5e-3 * wall);
  ck_assert_double_lt(summary.penetration, 5e-3 * wall);
  ck_assert_double_gt(summary.min_gap, -5e-3 * wall);
  /* One element makes a whole side of a chamber here: between the points of contact the two sides
   * bulge differently. */
  ck_assert_double_lt(inside_points(c->model, c->state.u, 0, c->mesh.section_count), 0.12 * wall);
  check_forces(&curl);
  check_parameters(&curl);

  c->model->contact.reach = 0;
  double free_angle = curl_go_on(&curl, &curl.open, 8), free_deep = tip_inside(c);
  report_value("without search: tip inside the body, walls", "coarse", 0, free_deep / wall);
  ck_assert(!contact_folded(&c->model->contact));
  ck_assert_double_gt(free_deep, 0.5 * wall);
  ck_assert_double_gt(free_angle, curl.angle + 1);
  curl_close(&curl);
}
END_TEST

/* ---- chambers against each other ---- */

/* The whole path anew. */
START_TEST(path_does_not_depend_on_parameters) {
  static const struct variation none = {"as chosen", 1, 1, 1, 1};
  double first = 0;
  for (int k = -1; k < VARIATIONS; k++) {
    const struct variation *v = k < 0 ? &none : &variations[k];
    struct job_spec spec;
    struct pneunet_case c;
    case_prototype(&spec, 3);
    spec.mesh = (struct mesh_spec){2, 1, 1, 1, 1, 1, 1, 1};
    spec.contact = true;
    spec.load = (struct load_spec){.pressure_to = 40e3, .steps = 4};
    case_open(&c, &spec);
    vary(&c, v);
    case_follow(&c);
    ck_assert_int_gt(contact_summarise(&c.model->contact).active, 0);
    first = k < 0 ? c.angle[4] : first;
    report_check("3 chambers, degrees", v->name, first, c.angle[4], 1e-3);
    case_close(&c);
  }
}
END_TEST

/* ---- two legs ---- */

/* Forces of contact on the leg at y > 0. */
static double push_apart(struct legs *legs) {
  struct contact_summary summary = contact_summarise(&legs->model->contact);
  return legs->shape.half ? summary.plane_force[0][1] : summary.force;
}

/* How far the end of a leg has come towards the plane between them, mean of both legs. */
static double closing(const struct legs *legs) {
  double upper = -legs_tip(legs, 1);
  return legs->shape.half ? upper : 0.5 * (upper + legs_lower_tip(legs, 1));
}

/* A leg against the plane of symmetry, two legs across a gap that the mesh lists, and two legs that
 * find each other, are the same body. */
START_TEST(plane_of_symmetry_is_the_other_half) {
  static const char *const name[] = {"half", "full, listed gap", "full, search"};
  double close[3], force[3];
  for (int k = 0; k < 3; k++) {
    struct legs legs;
    const struct legs_shape shape = {.half = k == 0,
                                     .facing = k == 1,
                                     .gap = 1,
                                     .along = 8,
                                     .upper = 4e-3,
                                     .lower = k == 0 ? 0 : 4e-3};
    legs_load(&legs, &shape);
    close[k] = closing(&legs);
    force[k] = push_apart(&legs);
    ck_assert_double_lt(contact_summarise(&legs.model->contact).penetration, 5e-3);
    report_check("two legs, way of the tips, m", name[k], close[0], close[k], 1e-3);
    report_check("two legs, force between them, N", name[k], force[0], force[k], 0.02);
    legs_close(&legs);
  }
  ck_assert_double_eq_tol(close[0], 0.5, 0.01);
  ck_assert_double_gt(force[0], 0);
}
END_TEST

/* Points that have left the face which the mesh put across from them. */
static int changed_partner(const struct legs *legs) {
  const struct contact *contact = &legs->model->contact;
  int changed = 0;
  for (int i = 0; i < QUAD9_POINTS * legs->mesh.facing_count; i++) {
    changed += contact->point[i].pair != i / QUAD9_POINTS && contact->point[i].traction > 0;
  }
  return changed;
}

/* One leg pushes the other far down: their faces slide past each other's edges. */
START_TEST(sliding_faces_change_partner) {
  double tip[3];
  for (int k = 0; k < (SANITIZED ? 2 : 3); k++) {
    struct legs legs;
    const struct legs_shape shape = {
        .facing = k != 1, .gap = 0.1, .along = k == 2 ? 16 : 8, .upper = 1e-2};
    legs_load(&legs, &shape);
    tip[k] = legs_tip(&legs, 1);
    ck_assert_double_lt(contact_summarise(&legs.model->contact).penetration, 5e-3);
    ck_assert_double_lt(inside_points(legs.model, legs.state.u, 0, 0), 5e-3);
    ck_assert(k == 1 || changed_partner(&legs) > 0);
    struct forces pairs = forces_of_pairs(legs.model, &legs.state);
    for (int i = 0; i < 3; i++) {
      ck_assert_double_lt(fabs(pairs.force[i]), 1e-12 * pairs.size);
    }
    legs_close(&legs);
  }
  report_check("sliding legs, found by search, m", "8 along a leg", tip[0], tip[1], 1e-3);
  if (!SANITIZED) {
    report_check("sliding legs, against a finer mesh, m", "8 along a leg", tip[2], tip[0], 5e-3);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("contact_search");
  TCase *search = tcase_create("contact_search");
  tcase_set_timeout(search, 200);
  tcase_add_test(search, tip_meets_its_own_body);
  tcase_add_test(search, path_does_not_depend_on_parameters);
  tcase_add_test(search, plane_of_symmetry_is_the_other_half);
  tcase_add_test(search, sliding_faces_change_partner);
  suite_add_tcase(suite, search);
  return suite_run(suite);
}
