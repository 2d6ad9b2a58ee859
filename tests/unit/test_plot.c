/* Plots of one job and of several. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/plot/plot.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/plot_samples.h"
#include "tests/unit/suite.h"

#define LONG_NAME                                                                                            \
  "Überlänge 气动 πνεῦμα: a name that goes on and on, as names do when nobody stops them, until " \
  "it has two hundred characters and more, which no subtitle can show without cutting it "                   \
  "somewhere near the end"

static const struct plot_sheet plain = {.width = 800, .height = 600};
static char directory[] = "/tmp/plot-test-XXXXXX";

static void write_surface(const char *text) {
  char path[100];
  snprintf(path, sizeof path, "%s/surface.json", directory);
  FILE *file = fopen(path, "wb");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  fclose(file);
}

static void write_sample_surface(double degrees) {
  json_t *surface = plot_sample_surface(12, degrees, 50);
  char *text = json_dumps(surface, 0);
  write_surface(text);
  free(text);
  json_decref(surface);
}

static void set_up(void) {
  strcpy(directory + sizeof directory - 7, "XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static void tear_down(void) {
  char path[100];
  snprintf(path, sizeof path, "%s/surface.json", directory);
  unlink(path);
  rmdir(directory);
}

START_TEST(names_of_a_kind) {
  const char *const *names = plot_names("response");
  size_t count = 0;
  while (names[count]) {
    count++;
  }
  ck_assert_uint_eq(count, 4);
  ck_assert_str_eq(plot_names("verify")[0], "convergence");
  ck_assert_str_eq(plot_names("verify")[1], "curve");
  ck_assert_ptr_null(plot_names("verify")[2]);
  ck_assert_ptr_null(plot_names("no-such-kind")[0]);
  ck_assert_ptr_null(plot_names(NULL)[0]);
}
END_TEST

START_TEST(every_plot_at_every_size) {
  static const int sizes[][2] = {{800, 600}, {400, 300}, {1600, 1200}, {200, 200}, {4000, 200}};
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, directory, "multi-curvature, chosen design", 42, "abc", NULL};
  write_sample_surface(75);
  for (const char *const *plot = plot_names("response"); *plot; plot++) {
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
      char name[64];
      snprintf(name, sizeof name, "%s-%d", *plot, sizes[i][0]);
      struct picture picture = picture_draw(*plot, &input, 1, sizes[i][0], sizes[i][1], name);
      ck_assert_uint_gt(picture_count(&picture, 28, 37, 48), 50); /* the title's ink */
      free(picture.rgb);
    }
  }
  json_decref(result);
}
END_TEST

START_TEST(angle_shows_curve_fit_and_onset) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  struct picture with = picture_draw("angle", &input, 1, 800, 600, NULL);
  ck_assert_uint_gt(picture_count(&with, 0, 114, 178), 800);
  ck_assert_uint_gt(picture_count(&with, 213, 94, 0), 100);
  /* the curve rises: higher pressure is nearer the top */
  ck_assert_double_gt(picture_mean_y(&with, 200, 220, 0, 114, 178),
                      picture_mean_y(&with, 480, 500, 0, 114, 178) + 50);
  json_object_del(result, "fit");
  json_object_del(json_object_get(result, "metrics"), "contact_onset_kPa");
  struct picture without = picture_draw("angle", &input, 1, 800, 600, NULL);
  ck_assert_uint_eq(picture_count(&without, 213, 94, 0), 0);
  free(with.rgb);
  free(without.rgb);
  json_decref(result);
}
END_TEST

START_TEST(tip_moves_down) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  struct picture picture = picture_draw("tip", &input, 1, 800, 600, NULL);
  int first = -1,
      last = -1; /* columns of the curve: it goes from the upper right to the lower left */
  for (int x = 0; x < 800; x++) {
    if (picture_mean_y(&picture, x, x + 1, 0, 114, 178) > 0) {
      first = first < 0 ? x : first;
      last = x;
    }
  }
  ck_assert_int_ge(first, 0);
  ck_assert_double_gt(picture_mean_y(&picture, first, first + 6, 0, 114, 178),
                      picture_mean_y(&picture, last - 5, last + 1, 0, 114, 178) + 100);
  free(picture.rgb);
  json_decref(result);
}
END_TEST

START_TEST(surface_shows_both_states) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, directory, "", 1, NULL, NULL};
  write_sample_surface(75);
  struct picture picture = picture_draw("surface", &input, 1, 800, 600, NULL);
  ck_assert_uint_gt(picture_count(&picture, 235, 236, 238), 2000); /* the body at rest */
  ck_assert_uint_gt(picture_count(&picture, 68, 1, 84), 500);      /* least stretched places */
  free(picture.rgb);
  json_decref(result);
}
END_TEST

START_TEST(damaged_surfaces) {
  static const char *const texts[] = {
      "",
      "[]",
      "{\"quads\":[[0,1,2,3]],\"states\":[]}",
      "{\"quads\":[[0,1,2,3]],\"states\":[{\"points_mm\":[[0,0,0]]}]}",
      "{\"quads\":[[0,1,2]],\"states\":[{\"points_mm\":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}]}",
      "{\"quads\":[[0,1,2,-1]],\"states\":[{\"points_mm\":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]}]}",
      "{\"quads\":[[0,1,2,3]],\"states\":[{\"points_mm\":[[0,0,0],[1,0],[1,1,0],[0,1,0]]}]}",
      "{\"quads\":[[0,1,2,3]],\"states\":[{\"points_mm\":[[0,0,0],[1,0,1e300],[1,1,0],[0,1,0]]}]}",
      "{\"quads\":[[0,0,0,0]],\"states\":[{\"points_mm\":[[0,0,0]]},{\"points_mm\":[]}]}",
  };
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, directory, "", 1, NULL, NULL};
  ck_assert_int_eq(picture_refuse("surface", &input, 1, 800, 600), STATUS_NOT_FOUND);
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    write_surface(texts[i]);
    ck_assert_int_eq(picture_refuse("surface", &input, 1, 800, 600), STATUS_SYNTAX);
  }
  /* a body without extent and without stretches is odd, but can be drawn */
  write_surface("{\"quads\":[[0,0,0,0]],\"states\":[{\"points_mm\":[[5,5,5]]}]}");
  free(picture_draw("surface", &input, 1, 800, 600, "surface-point").rgb);
  input.artifacts_dir = NULL;
  ck_assert_int_eq(picture_refuse("surface", &input, 1, 800, 600), STATUS_NOT_FOUND);
  json_decref(result);
}
END_TEST

/* Results of every kind of incompleteness give a picture. */
START_TEST(incomplete_results) {
  static const char *const texts[] = {
      "{}",
      "[]",
      "{\"status\":\"diverged\",\"reason\":\"step_below_minimum\",\"samples\":[]}",
      "{\"status\":7,\"samples\":{},\"midlines\":3,\"fit\":[],\"metrics\":null}",
      "{\"samples\":[{}],\"midlines\":[{}],\"fit\":{}}",
      "{\"samples\":[null,{\"pressure_kPa\":null,\"bending_angle_deg\":3}],\"midlines\":[null]}",
      "{\"samples\":[{\"pressure_kPa\":5,\"bending_angle_deg\":3,\"tip_x_mm\":1,\"tip_z_mm\":2}]}",
      "{\"samples\":[{\"pressure_kPa\":1e308,\"bending_angle_deg\":-1e308},"
      "{\"pressure_kPa\":-1e308,\"bending_angle_deg\":1e308}]}",
      "{\"samples\":[{\"pressure_kPa\":1e9,\"bending_angle_deg\":1e-300,\"tip_x_mm\":1e9,"
      "\"tip_z_mm\":-1e9},{\"pressure_kPa\":1e9,\"bending_angle_deg\":1e-300}]}",
      "{\"samples\":[{\"pressure_kPa\":0,\"bending_angle_deg\":0},{\"pressure_kPa\":0,"
      "\"bending_angle_deg\":0}],\"fit\":{\"slope_deg_per_kPa\":1e9,\"intercept_deg\":-1e9}}",
      "{\"midlines\":[{\"pressure_kPa\":5,\"points_mm\":[[0,0,0],[null,0,0],[1],\"x\",[1,0,1]]}]}",
      "{\"midlines\":[{\"pressure_kPa\":5,\"points_mm\":[[3,0,3],[3,0,3]]}]}",
      "{\"metrics\":{\"contact_onset_kPa\":-1e9},\"samples\":[{\"pressure_kPa\":1,"
      "\"bending_angle_deg\":1}]}",
      "{\"case\":7,\"meshes\":{}}",
      "{\"case\":{\"order\":4,\"point\":\"x\"},\"meshes\":[{},null,{\"size\":0,"
      "\"error_percent\":1}],\"samples\":[{\"x\":1}]}",
      "{\"case\":{\"order\":1e9,\"point\":3,\"size\":\"\"},\"meshes\":[{\"size\":1e-300,"
      "\"error_percent\":0},{\"size\":1e9,\"error_percent\":1e9}]}",
      "{\"case\":{\"order\":2,\"point\":\"x\",\"x_label\":\"x\"},\"meshes\":[{\"size\":1,"
      "\"error_percent\":-1},{\"size\":0.5,\"error_percent\":1}],"
      "\"samples\":[{\"x\":1,\"computed\":1e9,\"reference\":-1e9}]}",
  };
  static const char *const plots[] = {"angle", "midline", "tip", "overlay", "convergence", "curve"};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    json_t *result = json_loads(texts[i], 0, NULL);
    ck_assert_ptr_nonnull(result);
    struct plot_input input = {result, NULL, LONG_NAME, 8, NULL, NULL};
    for (size_t k = 0; k < sizeof plots / sizeof *plots; k++) {
      char name[64];
      snprintf(name, sizeof name, "incomplete-%zu-%s", i, plots[k]);
      free(picture_draw(plots[k], &input, 1, 800, 600, name).rgb);
    }
    json_decref(result);
  }
}
END_TEST

/* The error falls from right to left; without a mesh there is no curve. */
START_TEST(convergence_shows_the_error) {
  json_t *result = json_loads("{\"status\":\"succeeded\",\"case\":{\"order\":2},\"meshes\":["
                              "{\"size\":0.5,\"error_percent\":1},"
                              "{\"size\":0.25,\"error_percent\":0.25},"
                              "{\"size\":0.125,\"error_percent\":0.0625}]}",
                              0, NULL);
  struct plot_input input = {result, NULL, "order two", 0, NULL, NULL};
  struct picture picture = picture_draw("convergence", &input, 1, 800, 600, "convergence");
  double left = picture_mean_y(&picture, 80, 300, 0, 114, 178);
  double right = picture_mean_y(&picture, 500, 780, 0, 114, 178);
  ck_assert_double_gt(left, right + 100);
  free(picture.rgb);
  json_object_set_new(result, "meshes", json_array());
  picture = picture_draw("convergence", &input, 1, 800, 600, NULL);
  ck_assert_uint_eq(picture_count(&picture, 0, 114, 178), 0);
  free(picture.rgb);
  json_decref(result);
}
END_TEST

START_TEST(a_result_that_stopped_early_says_so) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, LONG_NAME, 8, NULL, NULL};
  struct picture fine = picture_draw("angle", &input, 1, 800, 600, NULL);
  json_object_set_new(result, "status", json_string("diverged"));
  json_object_set_new(result, "reason", json_string("limit_point"));
  struct picture early = picture_draw("angle", &input, 1, 800, 600, "early");
  ck_assert_uint_eq(picture_count(&fine, 168, 66, 0), 0);
  ck_assert_uint_gt(picture_count(&early, 168, 66, 0), 20);
  free(fine.rgb);
  free(early.rgb);
  json_decref(result);
}
END_TEST

START_TEST(odd_names) {
  static const char *const names[] = {NULL,
                                      "",
                                      LONG_NAME,
                                      "two\nlines\tand \x01 more",
                                      "\xff\xfe\x80",
                                      "<b>&amp;",
                                      "\xe2\x80\xaeright to left"};
  json_t *result = plot_sample_result(1.27, 50, 10);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    struct plot_input input = {result, NULL, names[i], 0, "hash with \x01 bytes \xff", NULL};
    free(picture_draw("angle", &input, 1, 400, 300, NULL).rgb);
    free(picture_draw("overlay", &input, 1, 400, 300, NULL).rgb);
  }
  json_decref(result);
}
END_TEST

START_TEST(overlays) {
  static const int colours[][3] = {{0, 114, 178},   {213, 94, 0},   {0, 158, 115},
                                   {204, 121, 167}, {86, 180, 233}, {230, 159, 0}};
  enum { MOST = 16 };
  struct plot_input inputs[MOST + 1];
  for (int i = 0; i <= MOST; i++) {
    inputs[i] = (struct plot_input){plot_sample_result(0.7 + 0.1 * i, 50 - 2 * (i % 4), 10),
                                    NULL,
                                    i % 3 ? "multi-curvature" : LONG_NAME,
                                    100 + i,
                                    NULL,
                                    NULL};
  }
  for (size_t count = 1; count <= MOST; count++) {
    char name[64];
    snprintf(name, sizeof name, "overlay-%zu", count);
    struct picture picture = picture_draw("overlay", inputs, count, 800, 600, name);
    for (size_t i = 0; i < 6; i++) {
      size_t pixels = picture_count(&picture, colours[i][0], colours[i][1], colours[i][2]);
      ck_assert_int_eq(pixels > 100, i < count);
    }
    free(picture.rgb);
    snprintf(name, sizeof name, "overlay-small-%zu", count);
    free(picture_draw("overlay", inputs, count, 400, 300, name).rgb);
  }
  ck_assert_int_eq(picture_refuse("overlay", inputs, MOST + 1, 800, 600), STATUS_INVALID);
  ck_assert_int_eq(picture_refuse("overlay", inputs, 0, 800, 600), STATUS_INVALID);
  for (int i = 0; i <= MOST; i++) {
    json_decref((json_t *)(uintptr_t)inputs[i].result);
  }
}
END_TEST

START_TEST(refusals) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, "", 1, NULL, NULL};
  ck_assert_int_eq(picture_refuse("no-such-plot", &input, 1, 800, 600), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse("", &input, 1, 800, 600), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse("angle", &input, 1, 199, 600), STATUS_INVALID);
  ck_assert_int_eq(picture_refuse("angle", &input, 1, 800, 4001), STATUS_INVALID);
  ck_assert_int_eq(picture_refuse("angle", &input, 1, -1, 0), STATUS_INVALID);
  json_decref(result);
}
END_TEST

static int has_bytes(const unsigned char *bytes, size_t size, const char *text) {
  size_t length = strlen(text);
  for (size_t i = 0; i + length <= size; i++) {
    if (memcmp(bytes + i, text, length) == 0) {
      return 1;
    }
  }
  return 0;
}

START_TEST(the_file_says_where_it_comes_from) {
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, "", 4711, "0123456789abcdef", NULL};
  unsigned char *png = NULL;
  size_t size = 0;
  ck_assert_int_eq(plot_render("angle", &input, 1, &plain, &png, &size, NULL), STATUS_OK);
  ck_assert(has_bytes(png, size, "tEXtJob"));
  ck_assert(has_bytes(png, size, "4711"));
  ck_assert(has_bytes(png, size, "0123456789abcdef"));
  ck_assert(has_bytes(png, size, "Solver-Version"));
  ck_assert(has_bytes(png, size, "0.1.0"));
  free(png);
  json_decref(result);
}
END_TEST

struct work {
  const struct plot_input *input;
  unsigned char *png;
  size_t size;
};

static void *draw_often(void *argument) {
  struct work *work = argument;
  for (int i = 0; i < 12; i++) {
    free(work->png);
    work->png = NULL;
    if (plot_render(i % 2 ? "angle" : "midline", work->input, 1, &plain, &work->png, &work->size,
                    NULL) != STATUS_OK) {
      return NULL;
    }
  }
  return work;
}

START_TEST(threads_draw_the_same_picture) {
  enum { THREADS = 6 };
  json_t *result = plot_sample_result(1.27, 50, 10);
  struct plot_input input = {result, NULL, LONG_NAME, 1, NULL, NULL};
  struct work works[THREADS] = {{0}};
  pthread_t threads[THREADS];
  for (int i = 0; i < THREADS; i++) {
    works[i].input = &input;
    ck_assert_int_eq(pthread_create(&threads[i], NULL, draw_often, &works[i]), 0);
  }
  for (int i = 0; i < THREADS; i++) {
    void *done;
    pthread_join(threads[i], &done);
    ck_assert_ptr_nonnull(done);
    ck_assert_uint_eq(works[i].size, works[0].size);
    ck_assert_mem_eq(works[i].png, works[0].png, works[0].size);
  }
  for (int i = 0; i < THREADS; i++) {
    free(works[i].png);
  }
  json_decref(result);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plot");
  TCase *pictures = tcase_create("pictures");
  tcase_set_timeout(pictures, 120);
  tcase_add_checked_fixture(pictures, set_up, tear_down);
  tcase_add_test(pictures, names_of_a_kind);
  tcase_add_test(pictures, every_plot_at_every_size);
  tcase_add_test(pictures, angle_shows_curve_fit_and_onset);
  tcase_add_test(pictures, tip_moves_down);
  tcase_add_test(pictures, surface_shows_both_states);
  tcase_add_test(pictures, damaged_surfaces);
  tcase_add_test(pictures, incomplete_results);
  tcase_add_test(pictures, convergence_shows_the_error);
  tcase_add_test(pictures, a_result_that_stopped_early_says_so);
  tcase_add_test(pictures, odd_names);
  tcase_add_test(pictures, overlays);
  tcase_add_test(pictures, refusals);
  tcase_add_test(pictures, the_file_says_where_it_comes_from);
  tcase_add_test(pictures, threads_draw_the_same_picture);
  suite_add_tcase(suite, pictures);
  return suite_run(suite);
}
