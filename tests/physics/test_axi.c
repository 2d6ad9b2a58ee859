/* Bodies of revolution: derivatives, closed solutions, energy balance, limit points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
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

static Suite *axi_suite(void) {
  Suite *suite = suite_create("axi");
  TCase *derivatives = tcase_create("derivatives");
  tcase_add_loop_test(derivatives, residual_is_the_gradient_and_tangent_its_derivative, 0,
                      2 * LAWS);
  suite_add_tcase(suite, derivatives);
  return suite;
}

int main(void) {
  return suite_run(axi_suite());
}
