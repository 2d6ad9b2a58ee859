#include "tests/unit/plot_grasp_samples.h"

#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/mesh/grid.h"
#include "solver/post/grasp_frames.h"

static const double LENGTH = 0.118, WIDTH = 0.03, HEIGHT = 0.016, RADIUS = 0.03; /* m */

enum { CHAMBERS = 10, AROUND = 48 };

/* ---- results ----------------------------------------------------------------------------- */

/* Force against displacement of a grasp with a peak of 1. */
static double profile(double mm) {
  double rise = 1 - exp(-mm / 9), fade = mm < 131 ? 1 - pow(mm / 131, 3) : 0;
  double jump = mm > 70 && mm < 82 ? 0.25 * (82 - mm) / 12 : 0;
  return fmax(1.07 * rise * fade * (1 - jump), 0);
}

static json_t *sample(const char *stage, double time, double kPa, double mm, double force) {
  double touching = fmin(kPa / 80, 1) * (mm < 131 ? 1 - mm / 160 : 0);
  return json_pack("{s:s,s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:f,s:b}", "stage", stage, "time_s",
                   time, "pressure_kPa", kPa, "displacement_mm", mm, "force_x_N", 0.2 * force,
                   "force_y_N", 0.0, "force_z_N", -force, "grasp_force_N", force,
                   "contact_area_mm2", 900 * touching, "contact_pressure_max_kPa", 60 * touching,
                   "slip_share", mm > 24 ? 1.0 : mm / 24, "dynamic", mm > 70 && mm < 76);
}

json_t *plot_sample_grasp(double peak) {
  json_t *samples = json_array();
  for (int i = 0; i <= 10; i++) {
    json_array_append_new(samples,
                          sample("inflation", 0.5 * i, 8 * i, 0, 0.02 * peak * i * i / 100));
  }
  for (int i = 1; i <= 75; i++) {
    json_array_append_new(samples, sample("pull", 5 + 0.4 * i, 80, 2 * i, peak * profile(2 * i)));
  }
  for (int i = 1; i <= 5; i++) {
    json_array_append_new(samples, sample("release", 35 + 0.5 * i, 80 - 16 * i, 150, 0));
  }
  return json_pack("{s:s,s:s,s:s,s:{s:f,s:f,s:f,s:f,s:f},s:o,s:[sss],s:{s:s}}", "status",
                   "succeeded", "reason", "", "kind", "grasp", "metrics", "grasp_force_peak_N",
                   peak, "grasp_force_mean_N", 0.62 * peak, "slip_onset_mm", 24.0, "released_at_mm",
                   131.0, "contact_area_mm2", 900.0, "samples", samples, "artifacts", "samples.csv",
                   "grasp.bin", "moments.bin", "provenance", "version", "0.1.0");
}

json_t *plot_sample_blocked(double most) {
  json_t *samples = json_array();
  for (int i = 0; i <= 10; i++) {
    double force = i > 3 ? most * (i - 3) / 7 : 0;
    json_array_append_new(samples, sample("inflation", 0.5 * i, 5 * i, 0, force));
  }
  return json_pack("{s:s,s:s,s:s,s:{s:f},s:o}", "status", "succeeded", "reason", "", "kind",
                   "grasp", "metrics", "blocked_force_N", most, "samples", samples);
}

/* ---- bodies ------------------------------------------------------------------------------ */

/* Every second cell along the body above the bottom layer is a gap. */
static int chambered(const void *context, const int tag[3]) {
  (void)context;
  return tag[0] % 2 && tag[2] > 0 ? CELL_GAP : CELL_SOLID;
}

static void to_body(const void *context, const double s[3], double x[3]) {
  (void)context;
  x[0] = LENGTH * s[0];
  x[1] = WIDTH * (s[1] - 0.5);
  x[2] = HEIGHT * s[2];
}

static void build(struct mesh *mesh) {
  struct grid grid = {0};
  struct error error = {0};
  for (int d = 0; d < 3; d++) {
    ck_assert_int_eq(grid_axis_extend(&grid.axis[d], 0, 0, 0), STATUS_OK);
  }
  for (int c = 0; c < 2 * CHAMBERS - 1; c++) {
    double end = (c / 2 + (c % 2 ? 1 : 0.8)) / (CHAMBERS - 0.2);
    ck_assert_int_eq(grid_axis_extend(&grid.axis[0], end, c % 2 ? 1 : 2, c), STATUS_OK);
  }
  ck_assert_int_eq(grid_axis_extend(&grid.axis[1], 1, 4, 0), STATUS_OK);
  ck_assert_int_eq(grid_axis_extend(&grid.axis[2], 0.35, 1, 0), STATUS_OK);
  ck_assert_int_eq(grid_axis_extend(&grid.axis[2], 1, 2, 1), STATUS_OK);
  ck_assert_int_eq(grid_mesh(&grid, false, chambered, to_body, NULL, mesh, &error), STATUS_OK);
  grid_release(&grid);
}

/* Winds the bottom of the body around a cylinder across it, up to an angle. */
static void wind(const struct mesh *mesh, double angle, double *u) {
  double radius = angle > 1e-6 ? LENGTH / angle : 1e6;
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * n;
    double turn = x[0] / radius;
    u[3 * n] = (radius + x[2]) * sin(turn) - x[0];
    u[3 * n + 1] = 0;
    u[3 * n + 2] = (radius + x[2]) * cos(turn) - radius - x[2];
  }
}

/* A patch of contact on the bottom, strongest in its middle. */
static void press(const struct mesh *mesh, double most, double *contact) {
  for (int n = 0; n < mesh->node_count; n++) {
    const double *x = mesh->x + 3 * n;
    double along = (x[0] - 0.07) / 0.035, across = x[1] / (0.6 * WIDTH);
    double place = 1 - along * along - across * across;
    contact[n] = x[2] < 1e-9 && place > 0 ? most * sqrt(place) : 0;
  }
}

/* A cylinder along y, closed at both ends. */
struct drum {
  double point[3 * (2 * AROUND + 2)];
  int triangle[3 * 4 * AROUND];
};

static void make_drum(struct drum *drum) {
  int t = 0;
  for (int i = 0; i < AROUND; i++) {
    for (int end = 0; end < 2; end++) {
      double *p = drum->point + 3 * (2 * i + end), angle = 2 * M_PI * i / AROUND;
      p[0] = RADIUS * cos(angle);
      p[1] = end ? 0.03 : -0.03;
      p[2] = RADIUS * sin(angle);
    }
    int a = 2 * i, b = 2 * ((i + 1) % AROUND);
    const int corners[12] = {a, a + 1, b,          b,     a + 1, b + 1,
                             a, b,     2 * AROUND, b + 1, a + 1, 2 * AROUND + 1};
    memcpy(drum->triangle + t, corners, sizeof corners);
    t += 12;
  }
  const double ends[6] = {0, -0.03, 0, 0, 0.03, 0};
  memcpy(drum->point + 6 * AROUND, ends, sizeof ends);
}

/* The pose of finger k of n around the x axis, which is that of the gripper. */
static struct grasp_frames_pose around(int k, int n) {
  double angle = 2 * M_PI * k / n, c = cos(angle), s = sin(angle), away = n > 1 ? RADIUS : 0;
  return (struct grasp_frames_pose){.place = {0, -away * s, away * c},
                                    .rotation = {1, 0, 0, 0, c, -s, 0, s, c}};
}

void plot_sample_frames(const char *directory, int fingers) {
  enum { FINGERS_MOST = 6 };
  struct grasp_frames_pose finger[FINGERS_MOST];
  struct drum drum;
  struct mesh mesh;
  struct error error = {0};
  struct grasp_frames *frames;
  json_t *result = plot_sample_grasp(12), *artifacts = json_array(), *row;
  size_t index;
  build(&mesh);
  make_drum(&drum);
  for (int k = 0; k < fingers; k++) {
    finger[k] = around(k, fingers);
  }
  const struct grasp_frames_object object = {2 * AROUND + 2, drum.point, 4 * AROUND, drum.triangle};
  ck_assert_int_eq(grasp_frames_create(&object, &frames, &error), STATUS_OK);
  ck_assert_int_eq(grasp_frames_begin(frames, &mesh, finger, fingers, &error), STATUS_OK);
  double *u = calloc(3 * (size_t)mesh.node_count, sizeof *u);
  double *contact = calloc((size_t)mesh.node_count, sizeof *contact);
  double *stretch = calloc((size_t)mesh.node_count, sizeof *stretch);
  json_array_foreach(json_object_get(result, "samples"), index, row) {
    double share = json_number_value(json_object_get(row, "pressure_kPa")) / 80;
    double moved = 1e-3 * json_number_value(json_object_get(row, "displacement_mm"));
    double touch = json_number_value(json_object_get(row, "contact_pressure_max_kPa"));
    const struct grasp_frames_pose pose = {
        .place = {0.012 + moved, 0, -RADIUS - (fingers > 1 ? 0 : 0.4 * moved)},
        .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    wind(&mesh, 2.4 * share, u);
    press(&mesh, 1e3 * touch, contact);
    for (int n = 0; n < mesh.node_count; n++) {
      stretch[n] = 1 + 0.4 * share * mesh.x[3 * n + 2] / HEIGHT;
    }
    const struct grasp_frames_state state = {.u = u, .contact = contact, .stretch = stretch};
    ck_assert_int_eq(grasp_frames_add(frames, row, &pose, &state), STATUS_OK);
  }
  ck_assert_int_eq(
      grasp_frames_save(frames, json_object_get(result, "samples"), directory, artifacts, &error),
      STATUS_OK);
  ck_assert_uint_eq(json_array_size(artifacts), 2);
  free(u);
  free(contact);
  free(stretch);
  json_decref(artifacts);
  json_decref(result);
  grasp_frames_destroy(frames);
  mesh_release(&mesh);
}
