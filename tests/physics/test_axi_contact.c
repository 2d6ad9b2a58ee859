/* Self-contact of bodies of revolution: derivatives, two rings pressed together against Hertz, and
 * nothing passes through anything. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/contact.h"
#include "solver/verify/revolution.h"
#include "tests/unit/suite.h"

static void ok(enum status status, const struct error *error) {
  ck_assert_msg(status == STATUS_OK, "%s: %s", status_word(status), error->message);
}

/* ---- derivatives ------------------------------------------------------------------------- */

/* A ring whose section is a U, open towards the axis; the channel between the arms is its inside.
 */
static const double channel = 0.3, wall = 0.5, arm = 1, axis_to_arms = 5;

static void channel_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  double radius = 0.5 * (channel + wall), bend = M_PI * radius, along = t * (2 * arm + bend);
  double place[2] = {along, -radius}, angle = 0;
  if (along > arm + bend) {
    place[0] = 2 * arm + bend - along;
    place[1] = radius;
    angle = M_PI;
  } else if (along > arm) {
    angle = (along - arm) / radius;
    place[0] = arm + radius * sin(angle);
    place[1] = -radius * cos(angle);
  }
  x[0] = axis_to_arms + place[0] + (s - 0.5) * wall * sin(angle);
  x[1] = place[1] - (s - 0.5) * wall * cos(angle);
}

/* The arms approach by `close` each, unevenly. */
static void pinch(const struct axi_mesh *mesh, double close, double *u) {
  for (int i = 0; i < mesh->node_count; i++) {
    double r = mesh->position[2 * i], z = mesh->position[2 * i + 1];
    double share = fmax(0, 1 - fmax(0, r - axis_to_arms) / 1.3) * (1 + 0.3 * sin(9 * r));
    u[2 * i] = 0.004 * sin(7 * r + 3 * z);
    u[2 * i + 1] = -z / (fabs(z) + 0.05) * close * share + 0.003 * cos(5 * r - 4 * z);
  }
}

/* A tube about the axis, whose inside is pressed almost to it. */
static void narrow_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  x[0] = 0.05 + 0.8 * s;
  x[1] = t;
}

static void press_to_axis(const struct axi_mesh *mesh, double close, double *u) {
  for (int i = 0; i < mesh->node_count; i++) {
    double r = mesh->position[2 * i], z = mesh->position[2 * i + 1];
    u[2 * i] = -0.05 * close * (1 + 0.01 * sin(9 * z)) * (1 - r) / 0.95;
    u[2 * i + 1] = 0.01 * cos(3 * r + 5 * z);
  }
}

enum place { CHANNEL, IMAGE, AXIS };

/* In the channel, with the image one period away, at the axis. */
static const struct {
  enum place place;
  double close;
  bool touching;
} squeezes[] = {
    {CHANNEL, 0.15, false}, {CHANNEL, 0.18, true}, {CHANNEL, 0.2, true}, {CHANNEL, 0.25, true},
    {IMAGE, -0.01, true},   {IMAGE, 0.05, false},  {AXIS, 0.2, false},   {AXIS, 0.96, true},
};

/* The last node of the upper arm is one period ahead of the first one of the lower arm: the arms of
 * neighbours lie on each other. */
static void repeat(const struct revolution *body, struct axi_mesh *mesh) {
  int across = 2 * body->cells[0], along = 2 * body->cells[1];
  int first = revolution_node(body, across, 0), last = revolution_node(body, across, along);
  mesh->hold[2 * last + 1] = AXI_AHEAD;
  mesh->master[last] = first;
}

static double difference(int n, const double *before, const double *behind, double h,
                         const double *exact) {
  double wrong = 0, size = 0;
  for (int i = 0; i < n; i++) {
    wrong += pow((behind[i] - before[i]) / (2 * h) - exact[i], 2);
    size += exact[i] * exact[i];
  }
  return sqrt(wrong / size);
}

/* The potential's derivatives in a direction against central differences. */
static void check_derivatives(struct axi_model *model, double *x, int number) {
  struct error error = {.status = STATUS_OK};
  int n = axi_model_size(model);
  double *room = calloc(5 * (size_t)n, sizeof *room), potential[2], value, slope = 0;
  double *d = room, *r = room + n, *product = room + 2 * n;
  double *side[2] = {room + 3 * n, room + 4 * n};
  struct axi_load load = {.pressure = 0};
  const double h = 1e-6;
  for (int i = 0; i < n; i++) {
    d[i] = cos(1.7 * i);
  }
  ok(axi_evaluate(model, x, &load, &value, r, d, product, &error), &error);
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < n; i++) {
      x[i] += (k ? 2 * h : -h) * d[i];
    }
    ok(axi_evaluate(model, x, &load, &potential[k], side[k], NULL, NULL, &error), &error);
  }
  for (int i = 0; i < n; i++) {
    x[i] -= h * d[i];
    slope += r[i] * d[i];
  }
  double first = fabs((potential[1] - potential[0]) / (2 * h) / slope - 1);
  double second = difference(n, side[0], side[1], h, product);
  ck_assert_msg(first < 1e-6, "squeeze %d: gradient %g", number, first);
  ck_assert_msg(second < 1e-7, "squeeze %d: tangent %g", number, second);
  free(room);
}

START_TEST(forces_are_the_gradient_and_tangent_its_derivative) {
  struct error error = {.status = STATUS_OK};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  enum place place = squeezes[_i].place;
  double close = squeezes[_i].close;
  struct revolution body = {
      .cells = {2, 16},
      .map = place == AXIS ? narrow_map : channel_map,
      .material = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 20}};
  ok(revolution_mesh(&body, &mesh, &error), &error);
  if (place == IMAGE) {
    repeat(&body, &mesh);
  }
  ok(axi_model_create(&mesh, &(struct axi_model_options){.contact = true}, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  if (place == AXIS) {
    press_to_axis(&mesh, close, state.u);
  } else {
    pinch(&mesh, place == CHANNEL ? close : 0, state.u);
  }
  axi_model_gather(model, state.u, state.x);
  if (place == IMAGE) {
    ck_assert(axi_model_has_elongation(model));
    state.x[axi_model_size(model) - 1] = close;
  }
  check_derivatives(model, state.x, _i);
  ok(axi_assess(model, false, &state, NULL, &error), &error);
  ck_assert_int_eq(state.touching, squeezes[_i].touching);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

/* ---- two rings --------------------------------------------------------------------------- */

/* Rings of radius 100 with sections 2 wide and 2 high and crowned faces of radius 20 that meet at z
 * = 0: almost a line contact in plane strain. */
static const double ring = 100, half_width = 1, height = 2, crown = 20;

static double graded(double t) {
  double x = 2 * t - 1;
  return half_width * (0.35 * x + 0.65 * x * fabs(x) * fabs(x));
}

static void crowned(double s, double across, double x[2]) {
  double z = s - 1;
  x[0] = across;
  x[1] = z * height * (0.15 + 0.85 * z * z) - s * across * across / (2 * crown);
}

static void lower_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  double p[2];
  crowned(s, graded(t), p);
  x[0] = ring - p[0];
  x[1] = p[1];
}

static void upper_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  double p[2];
  crowned(s, graded(t), p);
  x[0] = ring + p[0];
  x[1] = -p[1];
}

/* Both meshes in one. */
static void join(const struct axi_mesh *a, const struct axi_mesh *b, struct axi_mesh *out) {
  struct error error = {.status = STATUS_OK};
  ok(axi_mesh_create(a->node_count + b->node_count, a->element_count + b->element_count,
                     a->inner_count + b->inner_count, a->outer_count + b->outer_count, out, &error),
     &error);
  out->region_count = a->region_count;
  out->region[0] = a->region[0];
  const struct axi_mesh *part[2] = {a, b};
  for (int k = 0; k < 2; k++) {
    const struct axi_mesh *m = part[k];
    int n = k ? a->node_count : 0, e = k ? a->element_count : 0, f = k ? a->outer_count : 0;
    memcpy(out->position + 2 * n, m->position, sizeof *m->position * 2 * (size_t)m->node_count);
    memcpy(out->hold + 2 * n, m->hold, 2 * (size_t)m->node_count);
    for (int i = 0; i < m->element_count; i++) {
      for (int j = 0; j < AXI_NODES; j++) {
        out->element[e + i].node[j] = m->element[i].node[j] + n;
      }
    }
    for (int i = 0; i < m->outer_count; i++) {
      for (int j = 0; j < AXI_EDGE_NODES; j++) {
        out->outer[f + i].node[j] = m->outer[i].node[j] + n;
        out->inner[f + i].node[j] = m->inner[i].node[j] + n;
      }
    }
  }
}

enum { LOWER_CELLS = 24, UPPER_CELLS = 30 };

static void two_rings(const struct material_spec *material, struct axi_mesh *mesh) {
  struct error error = {.status = STATUS_OK};
  struct axi_mesh part[2];
  struct revolution body[2] = {
      {.cells = {8, LOWER_CELLS}, .map = lower_map, .material = *material},
      {.cells = {8, UPPER_CELLS}, .map = upper_map, .material = *material}};
  for (int k = 0; k < 2; k++) {
    ok(revolution_mesh(&body[k], &part[k], &error), &error);
    revolution_hold(&body[k], &part[k], 0, 0, 1, k ? AXI_PLATE : AXI_FIXED);
    revolution_hold(&body[k], &part[k], 0, 0, 0, AXI_FIXED);
  }
  join(&part[0], &part[1], mesh);
  axi_mesh_release(&part[0]);
  axi_mesh_release(&part[1]);
}

/* z of a surface at r: the place of its edges, found by halving; NaN beside it. */
static double surface_at(const struct axi_mesh *mesh, const struct axi_edge *edge, const double *u,
                         int from, int to, double r) {
  for (int k = from; k < to; k++) {
    double y[AXI_EDGE_NODES][2];
    for (int i = 0; i < AXI_EDGE_DOFS; i++) {
      int at = 2 * edge[k].node[i / 2] + i % 2;
      y[i / 2][i % 2] = mesh->position[at] + u[at];
    }
    double low = y[0][0] < y[1][0] ? -1 : 1;
    double a = low, b = -low;
    if ((r - y[0][0]) * (r - y[1][0]) > 0) {
      continue;
    }
    for (int j = 0; j < 60; j++) {
      double n[AXI_EDGE_NODES], d[AXI_EDGE_NODES], middle = 0.5 * (a + b);
      axi_edge_shape(middle, n, d);
      bool left = n[0] * y[0][0] + n[1] * y[1][0] + n[2] * y[2][0] < r;
      a = left ? middle : a;
      b = left ? b : middle;
    }
    double n[AXI_EDGE_NODES], d[AXI_EDGE_NODES];
    axi_edge_shape(a, n, d);
    return n[0] * y[0][1] + n[1] * y[1][1] + n[2] * y[2][1];
  }
  return NAN;
}

/* Axial force on the held lower face, from the elements alone. */
static double reaction(const struct axi_mesh *mesh, const double *u) {
  double sum = 0;
  for (int e = 0; e < mesh->element_count; e++) {
    double x[AXI_NODES][2], local[AXI_DOFS], force[AXI_DOFS], energy = 0;
    struct axi_geometry geometry;
    for (int i = 0; i < AXI_DOFS; i++) {
      x[i / 2][i % 2] = mesh->position[2 * mesh->element[e].node[i / 2] + i % 2];
    }
    axi_element_displacements(mesh, e, u, local);
    ck_assert(axi_geometry_init(x, &geometry));
    ck_assert(axi_element_evaluate(&geometry, &mesh->region[0], local, &energy, force, NULL));
    for (int a = 0; a < AXI_NODES; a++) {
      bool held = mesh->hold[2 * mesh->element[e].node[a] + 1] == AXI_FIXED;
      sum += held ? force[2 * a + 1] : 0;
    }
  }
  return sum;
}

/* The rings are stiff for their load: touching begins late against the depth of the contact. */
static const struct axi_model_options hertz = {.contact = true, .contact_offset = 1e-4};

/* Nothing passes through anything. */
static void check_overlap(const struct axi_mesh *mesh, const double *u) {
  double least = INFINITY;
  for (int k = 0; k <= 400; k++) {
    double r = ring + (k - 200) * 0.004;
    double below = surface_at(mesh, mesh->outer, u, 0, LOWER_CELLS, r);
    double above = surface_at(mesh, mesh->outer, u, LOWER_CELLS, LOWER_CELLS + UPPER_CELLS, r);
    least = fmin(least, above - below);
  }
  ck_assert_msg(least > -0.001 * height, "overlap %g", -least);
}

START_TEST(rings_pressed_together_as_hertz_says) {
  struct error error = {.status = STATUS_OK};
  const double young = 1, poisson = 0.3, reduced = young / (1 - poisson * poisson) / 2;
  struct material_spec material = {.model = MATERIAL_NEO_HOOKE,
                                   .terms = 1,
                                   .c = {young / 2 / (1 + poisson)},
                                   .bulk_ratio = 2 * (1 + poisson) / 3 / (1 - 2 * poisson)};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  two_rings(&material, &mesh);
  ok(axi_model_create(&mesh, &hertz, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  struct continuation_options options = axi_defaults(model);
  options.increment_max = 0.01;
  options.iterations_max = 60;
  /* First in touch by their motion, then by the force. */
  ok(axi_equilibrium(model, &(struct axi_load){.elongation = -0.003}, true, &options, &state, NULL,
                     &error),
     &error);
  double radius = crown / 2, half = 0.25, line = M_PI * reduced * half * half / (4 * radius);
  double force = -2 * M_PI * ring * line, peak = 2 * line / (M_PI * half);
  ok(axi_equilibrium(model, &(struct axi_load){.force = force}, false, &options, &state, NULL,
                     &error),
     &error);
  ck_assert(state.touching);
  ck_assert_int_eq(state.negative_free, 0);
  ck_assert_double_lt(fabs(reaction(&mesh, state.u) / -force - 1), 1e-6);
  /* Tractions: both surfaces are slaves, each carries its share at its points. */
  struct axi_contact *contact = NULL;
  ok(axi_contact_create(&mesh, 0, hertz.contact_offset, &contact, &error), &error);
  ok(axi_contact_evaluate(contact, state.u, state.elongation, false, &error), &error);
  double most = 0, widest = 0, sum = 0, balance = 0;
  for (int k = 0; k < contact->touch_count; k++) {
    const struct axi_touch *t = &contact->touch[k];
    most = fmax(most, 2 * t->traction);
    sum += t->traction * t->weight;
    for (int a = 0; a < TOUCH_NODES; a++) {
      balance += t->force[2 * a + 1];
    }
    for (int a = 0; a < AXI_EDGE_NODES; a++) {
      double at = mesh.position[2 * contact->edge[t->slave].node[a]] - ring;
      widest = t->traction > 0.02 * peak ? fmax(widest, fabs(at)) : widest;
    }
  }
  ck_assert_msg(fabs(most / peak - 1) < 0.03, "peak %g, Hertz %g", most, peak);
  /* Known to the length of an edge, which is counted whole. */
  ck_assert_msg(fabs(widest / half - 1) < 0.2, "half width %g, Hertz %g", widest, half);
  ck_assert_double_lt(fabs(sum / -force - 1), 1e-3);
  ck_assert_double_lt(fabs(balance), 1e-9 * fabs(force));
  check_overlap(&mesh, state.u);
  axi_contact_destroy(contact);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

/* ---- a channel pressed flat -------------------------------------------------------------- */

enum { ALONG = 40, LOWER_ARM = 10 };

/* The arms of the channel between two plates, closed by more than the channel is wide. They press
 * on each other over their length, and stay apart. */
START_TEST(arms_do_not_pass_through_each_other) {
  static const double closings[] = {-0.2, -0.31, -0.36, -0.4};
  struct error error = {.status = STATUS_OK};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  struct revolution body = {
      .cells = {3, ALONG},
      .map = channel_map,
      .material = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 50}};
  ok(revolution_mesh(&body, &mesh, &error), &error);
  for (int j = 0; j <= 2 * LOWER_ARM; j++) {
    mesh.hold[2 * revolution_node(&body, 6, j) + 1] = AXI_FIXED;
    mesh.hold[2 * revolution_node(&body, 6, 2 * ALONG - j) + 1] = AXI_PLATE;
  }
  ok(axi_model_create(&mesh, &(struct axi_model_options){.contact = true}, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  struct continuation_options options = axi_defaults(model);
  options.iterations_max = 40;
  double force = 0;
  for (int k = 0; k < 4; k++) {
    ok(axi_equilibrium(model, &(struct axi_load){.elongation = closings[k]}, true, &options, &state,
                       NULL, &error),
       &error);
    ck_assert_double_lt(state.force, force);
    ck_assert_int_eq(state.touching, k > 0);
    ck_assert_double_lt(fabs(reaction(&mesh, state.u) / -state.force - 1), 1e-5);
    force = state.force;
    double least = INFINITY;
    for (int i = 0; i <= 200; i++) {
      double r = axis_to_arms + 0.005 * i;
      double below = surface_at(&mesh, mesh.inner, state.u, 0, LOWER_ARM, r);
      double above = surface_at(&mesh, mesh.inner, state.u, ALONG - LOWER_ARM, ALONG, r);
      least = fmin(least, above - below); /* fmin passes over a NaN */
    }
    ck_assert(isfinite(least));
    ck_assert_msg(least > -0.01 * wall, "overlap %g of a wall of %g", -least, wall);
  }
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

static Suite *contact_suite(void) {
  Suite *suite = suite_create("contact of bodies of revolution");
  TCase *derivatives = tcase_create("derivatives"), *rings = tcase_create("rings");
  tcase_add_loop_test(derivatives, forces_are_the_gradient_and_tangent_its_derivative, 0,
                      sizeof squeezes / sizeof *squeezes);
  tcase_add_test(rings, rings_pressed_together_as_hertz_says);
  tcase_add_test(rings, arms_do_not_pass_through_each_other);
  tcase_set_timeout(rings, 120);
  suite_add_tcase(suite, derivatives);
  suite_add_tcase(suite, rings);
  return suite;
}

int main(void) {
  return suite_run(contact_suite());
}
