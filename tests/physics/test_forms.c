/* Bodies with shaped gaps and suckers under load. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* Three chambers with two suckers below them, on a coarse mesh. */
static void sucker_spec(struct job_spec *spec) {
  case_prototype(spec, 3);
  spec->accuracy = ACCURACY_FAST;
  spec->load = (struct load_spec){.pressure_to = 15e3, .steps = 1};
  spec->mesh = (struct mesh_spec){.gap_wall = 1, .cavity = 1, .height = 2};
  spec->pneunet.sucker[0] = (struct sucker_spec){0.0085, 0.012, 0.003, 0.0015};
  spec->pneunet.sucker[1] = (struct sucker_spec){0.0220, 0.008, 0.003, 0.0015};
  spec->pneunet.sucker_count = 2;
}

/* ---- patch test ---- */

/* A uniform state of the whole body, isochoric and free of pressure: x -> F x. */
static void deform(const struct mesh *mesh, double *u) {
  static const double f[9] = {1.1, 0.2, 0, 0, 1 / 1.1, 0.1, 0, 0, 1};
  for (int n = 0; n < mesh->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      u[3 * n + i] = -mesh->x[3 * n + i];
      for (int k = 0; k < 3; k++) {
        u[3 * n + i] += f[3 * i + k] * mesh->x[3 * n + k];
      }
    }
  }
}

static unsigned char *boundary_nodes(const struct mesh *mesh) {
  unsigned char *outside = calloc((size_t)mesh->node_count, 1);
  ck_assert(outside);
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    for (int m = 0; m < QUAD9_NODES; m++) {
      outside[nodes[m]] = 1;
    }
  }
  return outside;
}

/* In a uniform state nothing acts on inner nodes, however the elements are bent: those of round
 * suckers and of walls beside gaps. */
START_TEST(uniform_states_are_in_equilibrium) {
  struct job_spec spec;
  struct pneunet_case c;
  sucker_spec(&spec);
  spec.half_model = false;
  spec.pneunet.taper_right = 0;
  spec.pneunet.gap_shape = (enum gap_shape)_i;
  spec.pneunet.gap_root = _i == GAP_RECTANGULAR ? spec.pneunet.chamber_gap : 0.0002;
  spec.pneunet.gap_round = 0.0009;
  case_open(&c, &spec);
  struct fe_load none = {0};
  deform(&c.mesh, c.state.u);
  ck_assert_int_eq(model_evaluate(c.model, &c.state, &none, false), STATUS_OK);
  unsigned char *outside = boundary_nodes(&c.mesh);
  double inner = 0, outer = 0;
  int count = 0;
  for (int d = 0; d < 3 * c.mesh.node_count; d++) {
    int equation = c.model->equation[d];
    if (equation >= 0 && outside[d / 3]) {
      outer = fmax(outer, fabs(c.model->residual[equation]));
    } else if (equation >= 0) {
      inner = fmax(inner, fabs(c.model->residual[equation]));
      count++;
    }
  }
  ck_assert_int_gt(count, 500);
  ck_assert_double_gt(outer, 1e-4);
  ck_assert_double_lt(inner, 1e-11 * outer);
  free(outside);
  case_close(&c);
}
END_TEST

/* ---- suckers ---- */

START_TEST(a_half_with_suckers_is_half_of_the_whole) {
  double angle[2];
  for (int whole = 0; whole < 2; whole++) {
    struct job_spec spec;
    struct pneunet_case c;
    sucker_spec(&spec);
    spec.half_model = !whole;
    case_open(&c, &spec);
    c.solver->options.step_tolerance *= 1e-3;
    case_follow(&c);
    angle[whole] = c.angle[1];
    case_close(&c);
  }
  report_check("3 chambers with suckers, whole against half, degrees", "coarse", angle[0], angle[1],
               1e-9);
}
END_TEST

/* More suckers, thicker and deeper ones: each stiffens the bottom layer a little more. On a mesh
 * fine enough that the lines which they add do not matter. */
START_TEST(suckers_stiffen) {
  double angle[4];
  for (int k = 0; k < 4; k++) {
    struct job_spec spec;
    sucker_spec(&spec);
    spec.mesh = (struct mesh_spec){.gap_wall = 2, .cavity = 3, .bottom = 3, .half_width = 3};
    spec.pneunet.sucker_count = k < 2 ? k : 2;
    spec.pneunet.sucker[0].wall = k == 3 ? 0.002 : 0.0015;
    spec.pneunet.sucker[0].depth = k == 3 ? 0.005 : 0.003;
    angle[k] = case_angle_of(&spec);
    printf("suckers, variant %d: %.4f degrees\n", k, angle[k]);
  }
  for (int k = 1; k < 4; k++) {
    ck_assert_double_lt(angle[k], angle[k - 1]);
  }
  ck_assert_double_gt(angle[3], 0.8 * angle[0]);
}
END_TEST

/* Force by which rings, which are below the bottom face at rest, press on each other. */
static double force_on_rings(const struct pneunet_case *c) {
  const struct contact *contact = &c->model->contact;
  double force = 0;
  for (int i = 0; i < QUAD9_POINTS * contact->face_count; i++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(&c->mesh, &contact->face[i / QUAD9_POINTS].face, nodes);
    if (contact->point[i].valid && c->mesh.x[3 * nodes[4] + 2] < -1e-6) {
      force += contact->point[i].area * contact->point[i].traction;
    }
  }
  return force;
}

/* Deep suckers, a tenth of a millimetre apart, meet when the body curls, and do not pass through
 * each other. */
START_TEST(suckers_meet_when_the_body_curls) {
  struct job_spec spec;
  struct pneunet_case c;
  sucker_spec(&spec);
  for (int k = 0; k < 2; k++) {
    spec.pneunet.sucker[k] = (struct sucker_spec){0.0082 + 0.0111 * k, 0.008, 0.008, 0.0015};
  }
  spec.contact = true;
  spec.load = (struct load_spec){.pressure_to = 25e3, .steps = 5};
  case_open(&c, &spec);
  case_follow(&c);
  struct contact_summary s = contact_summarise(&c.model->contact);
  printf("suckers that meet: %.3f degrees, %.4f N\n", c.angle[5], force_on_rings(&c));
  ck_assert_double_gt(force_on_rings(&c), 1e-3);
  ck_assert_double_lt(s.penetration, 0.01 * c.mesh.wall_thickness);
  case_close(&c);
}
END_TEST

/* ---- gaps ---- */

/* Where chambers do not touch, what the gap loses stiffens the walls: under one load on the tip,
 * without pressure, the body yields less the more the gap narrows. */
START_TEST(narrow_roots_stiffen) {
  static const enum gap_shape order[] = {GAP_RECTANGULAR, GAP_U, GAP_TRAPEZOIDAL, GAP_V};
  static const double root[] = {0.002, 0.0002, 0.001, 0.0002};
  double angle[4];
  for (int k = 0; k < 4; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    int iterations;
    case_prototype(&spec, 3);
    spec.mesh = (struct mesh_spec){0};
    spec.accuracy = ACCURACY_FINE;
    spec.pneunet.gap_shape = order[k];
    spec.pneunet.gap_root = root[k];
    spec.pneunet.gap_round = 0.0009;
    case_open(&c, &spec);
    c.model->dead_load[3 * c.mesh.centreline[c.mesh.section_count - 1] + 2] = -1e-2; /* N */
    struct fe_load load = {0, 0, 1};
    ck_assert_int_eq(equilibrium_solve(c.solver, &load, 0, &c.state, &iterations), STATUS_OK);
    angle[k] = case_angle(&c.mesh, c.state.u);
    printf("gap shape %d: %.5f degrees under 20 mN\n", (int)order[k], angle[k]);
    case_close(&c);
  }
  for (int k = 1; k < 4; k++) {
    ck_assert_double_lt(angle[k], angle[k - 1]);
  }
  ck_assert_double_gt(angle[3], 0.5 * angle[0]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("forms of pneu-nets");
  TCase *forms = tcase_create("forms");
  tcase_set_timeout(forms, SANITIZED ? 900 : 120);
  tcase_add_loop_test(forms, uniform_states_are_in_equilibrium, 0, 4);
  tcase_add_test(forms, a_half_with_suckers_is_half_of_the_whole);
  tcase_add_test(forms, suckers_stiffen);
  tcase_add_test(forms, suckers_meet_when_the_body_curls);
  tcase_add_test(forms, narrow_roots_stiffen);
  suite_add_tcase(suite, forms);
  return suite_run(suite);
}
