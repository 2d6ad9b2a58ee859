/* Bodies of revolution: derivatives, closed solutions, a spring washer. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/axi/skin.h"
#include "solver/verify/revolution.h"
#include "tests/unit/suite.h"

static void ok(enum status status, const struct error *error) {
  ck_assert_msg(status == STATUS_OK, "%s: %s", status_word(status), error->message);
}

/* ---- derivatives ------------------------------------------------------------------------- */

/* A bent tube of 3 x 4 elements; its nodes are out of their regular places. */
static void bent(const void *context, double s, double t, double x[2]) {
  (void)context;
  x[0] = 1 + 0.4 * s + 0.2 * t * t + 0.02 * sin(9 * s + 5 * t);
  x[1] = 1.1 * t + 0.1 * s + 0.015 * cos(4 * s - 7 * t);
}

static const struct material_spec laws[] = {
    {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1.3}, .bulk_ratio = 80},
    {.model = MATERIAL_MOONEY_RIVLIN, .terms = 2, .c = {0.5, 0.2}, .bulk_ratio = 80},
    {.model = MATERIAL_YEOH, .terms = 3, .c = {0.5, -0.05, 0.02}, .bulk_ratio = 80},
    {.model = MATERIAL_OGDEN, .terms = 2, .c = {1.1, -0.2}, .alpha = {1.6, -2}, .bulk_ratio = 80},
};
enum { LAWS = sizeof laws / sizeof *laws };

/* Held below, on a plate above; one node hangs on its neighbour, one is ahead of another. */
static void bent_tube(const struct material_spec *law, double skin, struct axi_mesh *mesh,
                      struct axi_model **model) {
  struct error error = {.status = STATUS_OK};
  struct revolution body = {.cells = {3, 4}, .map = bent, .material = *law};
  ok(revolution_mesh(&body, mesh, &error), &error);
  revolution_hold(&body, mesh, 1, 0, 1, AXI_FIXED);
  revolution_hold(&body, mesh, 1, 1, 1, AXI_PLATE);
  int lower = revolution_node(&body, 0, 0), upper = revolution_node(&body, 0, 8);
  int inside = revolution_node(&body, 0, 2), ahead = revolution_node(&body, 0, 6);
  mesh->hold[2 * upper] = AXI_TIED;
  mesh->master[upper] = lower;
  mesh->hold[2 * ahead + 1] = AXI_AHEAD;
  mesh->master[ahead] = inside;
  int tied = revolution_node(&body, 6, 3), next = revolution_node(&body, 6, 2);
  mesh->hold[2 * tied] = AXI_TIED;
  mesh->master[tied] = next;
  ok(axi_model_create(mesh, &(struct axi_model_options){.skin = skin}, model, &error), &error);
}

static void some_state(int n, double *x, double *direction) {
  for (int i = 0; i < n; i++) {
    x[i] = 0.012 * sin(3.1 * i + 1);
    direction[i] = cos(1.7 * i);
  }
  x[n - 1] = 0.2;
}

/* |(b - a) / 2h - exact| / |exact| */
static double difference_error(int n, const double *a, const double *b, double h,
                               const double *exact) {
  double error = 0, size = 0;
  for (int i = 0; i < n; i++) {
    error += pow((b[i] - a[i]) / (2 * h) - exact[i], 2);
    size += exact[i] * exact[i];
  }
  return sqrt(error / size);
}

START_TEST(residual_is_the_gradient_and_tangent_its_derivative) {
  struct error error = {.status = STATUS_OK};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  bent_tube(&laws[_i % LAWS], _i < LAWS ? 0 : 0.5, &mesh, &model);
  int n = axi_model_size(model);
  double *room = calloc(6 * (size_t)n, sizeof *room);
  double *x = room, *d = room + n, *r = room + 2 * n, *product = room + 3 * n;
  double *side[2] = {room + 4 * n, room + 5 * n}, potential[2], value;
  struct axi_load load = {.pressure = 0.3, .force = 0.7};
  some_state(n, x, d);
  ok(axi_evaluate(model, x, &load, &value, r, d, product, &error), &error);
  double h = 1e-5;
  for (int k = 0; k < 2; k++) {
    double step = k ? 2 * h : -h;
    for (int i = 0; i < n; i++) {
      x[i] += step * d[i];
    }
    ok(axi_evaluate(model, x, &load, &potential[k], side[k], NULL, NULL, &error), &error);
  }
  double slope = 0;
  for (int i = 0; i < n; i++) {
    slope += r[i] * d[i];
  }
  double first = fabs((potential[1] - potential[0]) / (2 * h) / slope - 1);
  double second = difference_error(n, side[0], side[1], h, product);
  ck_assert_msg(first < 1e-6, "law %d: gradient %g", _i, first);
  ck_assert_msg(second < 1e-6, "law %d: tangent %g", _i, second);
  free(room);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

/* ---- closed solutions -------------------------------------------------------------------- */

static const double poisson = 0.3;

static struct material_spec elastic(double young, double nu) {
  return (struct material_spec){.model = MATERIAL_NEO_HOOKE,
                                .terms = 1,
                                .c = {young / 2 / (1 + nu)},
                                .bulk_ratio = 2 * (1 + nu) / 3 / (1 - 2 * nu)};
}

/* Between r = 1 and 2; the lines of the mesh are not parallel. */
static void tube_map(const void *context, double s, double t, double x[2]) {
  const double *skew = context;
  x[0] = 1 + s + *skew * 0.1 * sin(M_PI * s) * cos(M_PI * t);
  x[1] = t;
}

/* A solid bar: the side s = 0 is the axis. */
static void bar_map(const void *context, double s, double t, double x[2]) {
  tube_map(context, s, t, x);
  x[0] -= 1;
}

/* Lame (1852): plane strain, inner radius a, outer b, pressure p inside. */
static double lame_displacement(double young, double a, double b, double p) {
  return (1 + poisson) * a * p / (young * (b * b - a * a)) * ((1 - 2 * poisson) * a * a + b * b);
}

static double tube_error(int cells) {
  struct error error = {.status = STATUS_OK};
  const double skew = 1, pressure = 1e-7;
  struct revolution body = {
      .cells = {cells, cells}, .map = tube_map, .context = &skew, .material = elastic(1, poisson)};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  ok(revolution_mesh(&body, &mesh, &error), &error);
  revolution_hold(&body, &mesh, 1, 0, 1, AXI_FIXED);
  revolution_hold(&body, &mesh, 1, 1, 1, AXI_FIXED);
  ok(axi_model_create(&mesh, NULL, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  struct continuation_options options = axi_defaults(model);
  options.tolerance = 1e-13;
  ok(axi_equilibrium(model, &(struct axi_load){.pressure = pressure}, false, &options, &state, NULL,
                     &error),
     &error);
  double wanted = lame_displacement(1, 1, 2, pressure), found = 0;
  for (int j = 0; j <= 2 * cells; j++) {
    found = fmax(found, fabs(state.u[2 * revolution_node(&body, 0, j)] / wanted - 1));
  }
  ck_assert(fabs(state.volume - M_PI * pow(1 + wanted, 2)) < 0.02 * M_PI * 2 * wanted);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
  return found;
}

START_TEST(tube_under_pressure_as_lame_says) {
  double coarse = tube_error(2), fine = tube_error(4), finest = tube_error(8);
  ck_assert_msg(finest < 1e-4, "error %g", finest);
  double order = log(coarse / finest) / log(4);
  ck_assert_msg(order > 2.7 && fine < coarse, "errors %g, %g, %g: order %g", coarse, fine, finest,
                order);
}
END_TEST

/* Lateral stretch of a neo-Hookean body whose axial stretch is l: the lateral stress is 0. */
static double lateral(const struct material_spec *m, double l) {
  double mu = m->c[0], kappa = axi_bulk_modulus(m), low = 0.1, high = 3;
  for (int k = 0; k < 100; k++) {
    double q = 0.5 * (low + high), j = l * q * q, i1 = l * l + 2 * q * q;
    double stress = mu * pow(j, -2.0 / 3) * (q - i1 / (3 * q)) + kappa * (j - 1) * j / q;
    *(stress > 0 ? &high : &low) = q;
  }
  return low;
}

static const double stretches[] = {0.6, 1.5, 2.5};

/* Homogeneous deformation of a tube and of a solid bar, exact on any mesh. */
START_TEST(stretched_bars_stay_homogeneous) {
  struct error error = {.status = STATUS_OK};
  const double skew = 1;
  bool solid = _i % 2;
  double l = stretches[_i / 2];
  struct revolution body = {
      .cells = {3, 4},
      .map = solid ? bar_map : tube_map,
      .context = &skew,
      .material = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {0.7}, .bulk_ratio = 50}};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  ok(revolution_mesh(&body, &mesh, &error), &error);
  revolution_hold(&body, &mesh, 1, 0, 1, AXI_FIXED);
  revolution_hold(&body, &mesh, 1, 1, 1, AXI_PLATE);
  for (int j = 0; solid && j <= 8; j++) {
    int node = revolution_node(&body, 0, j);
    mesh.position[2 * node] = 0;
    mesh.hold[2 * node] = AXI_FIXED;
  }
  ok(axi_model_create(&mesh, NULL, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  struct continuation_options options = axi_defaults(model);
  options.iterations_max = 60;
  ok(axi_equilibrium(model, &(struct axi_load){.elongation = l - 1}, true, &options, &state, NULL,
                     &error),
     &error);
  const struct material_spec *m = &mesh.region[0];
  double q = lateral(m, l), j = l * q * q, mu = m->c[0], i1 = l * l + 2 * q * q;
  double stress =
      mu * pow(j, -2.0 / 3) * (l - i1 / (3 * l)) + axi_bulk_modulus(m) * (j - 1) * q * q;
  double area = M_PI * (solid ? 1 : 3);
  ck_assert_msg(fabs(state.force / (area * stress) - 1) < 1e-6, "force %g of %g", state.force,
                area * stress);
  for (int i = 0; i < mesh.node_count; i++) {
    const double *x = mesh.position + 2 * i, *u = state.u + 2 * i;
    ck_assert_double_lt(fabs(u[0] - (q - 1) * x[0]), 1e-6);
    ck_assert_double_lt(fabs(u[1] - (l - 1) * x[1]), 1e-6);
  }
  ck_assert_int_eq(state.negative_held, 0);
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

/* ---- a spring washer --------------------------------------------------------------------- */

/* De 40, Di 20, t 0.5, h0 0.7 mm. */
static void washer_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  const double thickness = 0.5e-3, height = 0.7e-3, width = 10e-3;
  double angle = atan2(height, width), across = (t - 0.5) * thickness;
  x[0] = 10e-3 + s * width + across * sin(angle);
  x[1] = (1 - s) * height + across * cos(angle);
}

struct forces {
  int count;
  double force[4];
};

static bool keep_targets(void *context, const struct axi_state *state,
                         const struct continuation_point *point) {
  struct forces *f = context;
  if (point->events & CONTINUATION_TARGET) {
    f->force[f->count++] = -state->force;
  }
  return f->count < 4;
}

/* Forces at s/h0 = 1/4 to 1 of another program. The rigid section of Almen and Laszlo (1936) gives
 * an upper bound; for this wide ring it is up to 11 % higher. */
START_TEST(wide_washer) {
  static const double other[4] = {36.6, 56.1, 64.2, 66.7}, targets[4] = {0.25, 0.5, 0.75, 1};
  struct error error = {.status = STATUS_OK};
  struct revolution body = {
      .cells = {20, 2}, .map = washer_map, .material = elastic(206e9, poisson)};
  struct axi_mesh mesh;
  struct axi_model *model = NULL;
  struct axi_state state;
  struct forces found = {.count = 0};
  ok(revolution_mesh(&body, &mesh, &error), &error);
  mesh.hold[2 * revolution_node(&body, 40, 0) + 1] = AXI_FIXED;
  mesh.hold[2 * revolution_node(&body, 0, 4) + 1] = AXI_PLATE;
  ok(axi_model_create(&mesh, NULL, &model, &error), &error);
  ok(axi_state_create(model, &state, &error), &error);
  struct continuation_options options = axi_defaults(model);
  options.target = targets;
  options.target_count = 4;
  struct axi_ramp ramp = {.to = {.elongation = -0.7e-3}, .held = true};
  ok(axi_follow(model, &ramp, &options, 1, NULL, keep_targets, &found, &state, &error), &error);
  double delta = 2, h = 0.7 / 0.5;
  double k = pow((delta - 1) / delta, 2) / ((delta + 1) / (delta - 1) - 2 / log(delta)) / M_PI;
  for (int i = 0; i < 4; i++) {
    double x = targets[i] * h;
    double rigid = 4 * 206e9 / (1 - poisson * poisson) * pow(0.5e-3, 4) / (k * 1.6e-3) * x *
                   ((h - x) * (h - 0.5 * x) + 1);
    ck_assert_msg(fabs(found.force[i] / other[i] - 1) < 0.01, "%g N, not %g", found.force[i],
                  other[i]);
    ck_assert_msg(found.force[i] < rigid && found.force[i] > 0.87 * rigid, "%g N, rigid %g",
                  found.force[i], rigid);
  }
  axi_state_destroy(&state);
  axi_model_destroy(model);
  axi_mesh_release(&mesh);
}
END_TEST

/* ---- skin -------------------------------------------------------------------------------- */

/* An edge of length 0.1 on a ring of radius 3, bent to an arc that turns by `angle` and turned
 * about as a whole: the bending energy is that of a plate, w B/(2 L) angle^2. */
START_TEST(skin_bends_like_a_plate) {
  struct error error = {.status = STATUS_OK};
  struct axi_mesh mesh;
  struct axi_skin skin;
  const double length = 0.1, angle = 0.05, thickness = 0.02;
  ok(axi_mesh_create(9, 1, 1, 0, &mesh, &error), &error);
  mesh.region[0] = elastic(3, 0.5 - 1e-9); /* mu = 1 */
  for (int a = 0; a < AXI_NODES; a++) {
    mesh.element[0].node[a] = a;
    mesh.position[2 * a] = 3;
  }
  mesh.inner[0] = (struct axi_edge){{3, 0, 7}};
  mesh.position[2 * 3 + 1] = length;
  mesh.position[2 * 7 + 1] = 0.5 * length;
  ok(axi_skin_create(&mesh, thickness, &skin, &error), &error);
  ck_assert_int_eq(skin.count, 1);
  double x[SKIN_NODES][2] = {{0}}, force[SKIN_DOFS], energy = 0, radius = length / angle;
  for (int k = 0; k < 3; k++) { /* start, end, middle, turned by 1.1 */
    double phi = 1.1 + (k == 0 ? 0 : k == 1 ? angle : 0.5 * angle);
    x[k][0] = 3 + radius * sin(phi);
    x[k][1] = -radius * cos(phi);
  }
  ck_assert(axi_skin_evaluate(skin.turning, x, &energy, force, NULL));
  double bending = pow(thickness, 3) / 3;
  double wanted = 2 * M_PI * 3 * bending / (2 * length) * angle * angle;
  ck_assert_msg(fabs(energy / wanted - 1) < 2e-3, "energy %g of %g", energy, wanted);
  for (int i = 0; i < 2; i++) { /* the forces balance */
    ck_assert_double_lt(fabs(force[i] + force[2 + i] + force[4 + i]), 1e-12 * energy / length);
  }
  memcpy(x[2], (double[2]){x[0][0] + 3 * length, x[0][1]}, sizeof x[2]);
  memcpy(x[1], x[0], sizeof x[1]);
  ck_assert(!axi_skin_evaluate(skin.turning, x, &energy, force, NULL)); /* folded back */
  axi_skin_release(&skin);
  axi_mesh_release(&mesh);
}
END_TEST

static Suite *axi_suite(void) {
  Suite *suite = suite_create("axi");
  TCase *derivatives = tcase_create("derivatives");
  tcase_add_loop_test(derivatives, residual_is_the_gradient_and_tangent_its_derivative, 0,
                      2 * LAWS);
  suite_add_tcase(suite, derivatives);
  TCase *solutions = tcase_create("solutions");
  tcase_add_test(solutions, tube_under_pressure_as_lame_says);
  tcase_add_loop_test(solutions, stretched_bars_stay_homogeneous, 0,
                      2 * sizeof stretches / sizeof *stretches);
  tcase_add_test(solutions, wide_washer);
  tcase_add_test(solutions, skin_bends_like_a_plate);
  suite_add_tcase(suite, solutions);
  return suite;
}

int main(void) {
  return suite_run(axi_suite());
}
