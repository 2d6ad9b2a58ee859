/* Plots of grasps, and the frames that they and the pages are drawn from. */
#include <check.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/plot/frames.h"
#include "tests/unit/plot_grasp_samples.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/suite.h"

static const int BLUE[3] = {0, 114, 178}, ORANGE[3] = {213, 94, 0}, GREEN[3] = {0, 158, 115};

static char directory[] = "/tmp/plot-grasp-XXXXXX";

static void set_up(void) {
  strcpy(directory + sizeof directory - 7, "XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static void path_of(const char *name, char path[100]) {
  snprintf(path, 100, "%s/%s", directory, name);
}

static void tear_down(void) {
  static const char *const names[] = {"grasp.bin", "moments.bin"};
  char path[100];
  for (size_t i = 0; i < 2; i++) {
    path_of(names[i], path);
    unlink(path);
  }
  rmdir(directory);
}

static size_t pixels(const struct picture *picture, const int colour[3]) {
  return picture_count(picture, colour[0], colour[1], colour[2]);
}

/* ---- forces ------------------------------------------------------------------------------ */

START_TEST(what_a_grasp_offers) {
  char text[300];
  json_t *pulled = plot_sample_grasp(12), *blocked = plot_sample_blocked(4);
  ck_assert_str_eq(picture_offered("grasp", pulled, text),
                   "force pressure snapshots contact stages");
  ck_assert_str_eq(picture_offered("grasp", blocked, text), "pressure stages");
  ck_assert_str_eq(plot_names("grasp")[0], "stages");
  ck_assert_int_eq(picture_refuse_one("force", blocked, NULL), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse_one("snapshots", blocked, NULL), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse_one("angle", pulled, NULL), STATUS_NOT_FOUND);
  json_decref(pulled);
  json_decref(blocked);
}
END_TEST

START_TEST(forces_at_all_sizes) {
  json_t *pulled = plot_sample_grasp(12), *blocked = plot_sample_blocked(4);
  picture_at_all_sizes("force", pulled, "grasp-force");
  picture_at_all_sizes("stages", pulled, "grasp-stages");
  picture_at_all_sizes("pressure", blocked, "grasp-pressure");
  json_decref(pulled);
  json_decref(blocked);
}
END_TEST

START_TEST(the_force_rises_and_falls) {
  json_t *result = plot_sample_grasp(12);
  struct picture with = picture_of("force", result, NULL);
  double start = picture_mean_y(&with, 80, 90, BLUE[0], BLUE[1], BLUE[2]);
  double top = picture_mean_y(&with, 190, 230, BLUE[0], BLUE[1], BLUE[2]);
  ck_assert_double_lt(top, 200);
  ck_assert_double_gt(start, top + 30);
  ck_assert_uint_gt(pixels(&with, GREEN), 100); /* the mean */
  size_t dynamic = pixels(&with, ORANGE);
  ck_assert_uint_gt(dynamic, 60);
  json_t *samples = json_object_get(result, "samples"), *sample;
  size_t index;
  json_array_foreach(samples, index, sample) {
    json_object_set_new(sample, "dynamic", json_false());
  }
  json_object_del(json_object_get(result, "metrics"), "grasp_force_mean_N");
  struct picture without = picture_of("force", result, NULL);
  ck_assert_uint_eq(pixels(&without, ORANGE), 0);
  ck_assert_uint_eq(pixels(&without, GREEN), 0);
  free(with.rgb);
  free(without.rgb);
  json_decref(result);
}
END_TEST

START_TEST(several_grasps_in_one) {
  static const int colours[4][3] = {{0, 114, 178}, {213, 94, 0}, {0, 158, 115}, {204, 121, 167}};
  static const char *const names[4] = {"spool, twisted", "bottle, bent", "cup, bent", "box, bent"};
  struct plot_input inputs[4];
  for (int i = 0; i < 4; i++) {
    inputs[i] =
        (struct plot_input){plot_sample_grasp(12 - 2.6 * i), NULL, names[i], i + 1, NULL, NULL};
  }
  for (size_t count = 2; count <= 4; count++) {
    struct picture picture =
        picture_draw("overlay", inputs, count, 800, 600, count == 4 ? "grasp-overlay" : NULL);
    for (size_t i = 0; i < 4; i++) {
      ck_assert_int_eq(pixels(&picture, colours[i]) > 300, i < count);
    }
    free(picture.rgb);
  }
  for (int i = 0; i < 4; i++) {
    json_decref((json_t *)(uintptr_t)inputs[i].result);
  }
}
END_TEST

/* Friction from 0.3 to 1.2. */
static json_t *friction_study(void) {
  json_t *members = json_array();
  for (int i = 0; i < 4; i++) {
    double friction = 0.3 * (i + 1);
    json_t *grasp = plot_sample_grasp(4 * friction + 3);
    json_array_append_new(members, json_pack("{s:s,s:s,s:{s:f},s:O,s:O}", "name", "a friction",
                                             "status", "succeeded", "values", "/object/friction",
                                             friction, "metrics", json_object_get(grasp, "metrics"),
                                             "samples", json_object_get(grasp, "samples")));
    json_decref(grasp);
  }
  return json_pack("{s:s,s:s,s:o,s:[{s:s}]}", "status", "succeeded", "kind", "study", "members",
                   members, "parameters", "pointer", "/object/friction");
}

START_TEST(a_study_of_friction) {
  json_t *study = friction_study();
  struct plot_input input = {study, NULL, "friction", 9, NULL, NULL};
  struct picture curves = picture_draw("curves", &input, 1, 800, 600, "grasp-study-curves");
  ck_assert_uint_gt(pixels(&curves, ORANGE), 300);
  struct picture metric = picture_draw("metric", &input, 1, 800, 600, "grasp-study-metric");
  /* peak against friction: it rises to the right */
  ck_assert_double_gt(picture_mean_y(&metric, 80, 300, BLUE[0], BLUE[1], BLUE[2]),
                      picture_mean_y(&metric, 500, 790, BLUE[0], BLUE[1], BLUE[2]) + 100);
  free(curves.rgb);
  free(metric.rgb);
  json_decref(study);
}
END_TEST

/* ---- pictures ---------------------------------------------------------------------------- */

static struct picture draw_dark(const char *plot, const struct plot_input *input,
                                const char *name) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct plot_sheet sheet = {.width = 800, .height = 600, .theme = THEME_DARK};
  ck_assert_int_eq(plot_render(plot, input, 1, &sheet, &png, &size, NULL), STATUS_OK);
  struct picture picture = picture_decode(png, size, name);
  free(png);
  return picture;
}

/* Pixels left of the bar of colours in the colours of contact, in light or shade: all else there is
 * grey, tan or nearly so. */
static size_t touching(const struct picture *picture) {
  size_t count = 0;
  for (int y = 0; y < (int)picture->image.height; y++) {
    for (int x = 0; x < (int)picture->image.width * 7 / 8; x++) {
      const unsigned char *c = picture->rgb + 3 * ((size_t)y * picture->image.width + (size_t)x);
      count += c[1] > c[0] + 30;
    }
  }
  return count;
}

START_TEST(snapshots_show_the_moments) {
  json_t *result = plot_sample_grasp(12);
  struct plot_input input = {result, directory, "spool, twisted", 3, NULL, NULL};
  for (int fingers = 1; fingers <= 3; fingers += 2) {
    char name[40];
    plot_sample_frames(directory, fingers);
    snprintf(name, sizeof name, "grasp-snapshots-%d", fingers);
    struct picture picture = picture_draw("snapshots", &input, 1, 800, 600, name);
    ck_assert_uint_gt(touching(&picture), 200); /* although the body is over the object */
    free(picture.rgb);
    snprintf(name, sizeof name, "grasp-snapshots-dark-%d", fingers);
    free(draw_dark("snapshots", &input, name).rgb);
  }
  free(picture_draw("snapshots", &input, 1, 400, 300, "grasp-snapshots-400").rgb);
  free(picture_draw("snapshots", &input, 1, 200, 200, NULL).rgb);
  free(picture_draw("snapshots", &input, 1, 4000, 200, NULL).rgb);
  free(picture_draw("snapshots", &input, 1, 1600, 1200, NULL).rgb);
  json_decref(result);
}
END_TEST

START_TEST(the_map_shows_where_it_presses) {
  json_t *result = plot_sample_grasp(12);
  struct plot_input input = {result, directory, "spool, twisted", 3, NULL, NULL};
  plot_sample_frames(directory, 1);
  struct picture picture = picture_draw("contact", &input, 1, 800, 600, "grasp-contact");
  /* the middle of the patch is at 70 of 118 mm: right of the middle of the strip */
  double sum = 0;
  int columns = 0;
  for (int x = 92; x < 704; x++) {
    if (isfinite(picture_mean_y(&picture, x, x + 1, 39, 127, 142))) {
      sum += x;
      columns++;
    }
  }
  ck_assert_int_gt(columns, 10);
  ck_assert_double_eq_tol((sum / columns - 92) / (703 - 92), 70.0 / 118, 0.03);
  free(picture.rgb);
  free(draw_dark("contact", &input, "grasp-contact-dark").rgb);
  free(picture_draw("contact", &input, 1, 400, 300, "grasp-contact-400").rgb);
  free(picture_draw("contact", &input, 1, 1600, 400, NULL).rgb);
  input.artifacts_dir = NULL;
  ck_assert_int_eq(picture_refuse("contact", &input, 1, 800, 600), STATUS_NOT_FOUND);
  ck_assert_int_eq(picture_refuse("snapshots", &input, 1, 800, 600), STATUS_NOT_FOUND);
  json_decref(result);
}
END_TEST

/* ---- the file ---------------------------------------------------------------------------- */

START_TEST(moments_come_back_from_the_file) {
  struct frames frames;
  struct error error = {0};
  plot_sample_frames(directory, 3);
  ck_assert_int_eq(frames_read(directory, &frames, &error), STATUS_OK);
  ck_assert_uint_eq(frames.body_count, 1);
  ck_assert_uint_eq(frames.finger_count, 3);
  ck_assert_uint_eq(frames.object_quad_count, 4 * 48);
  ck_assert_uint_eq(frames.shot_count, 4);
  const struct frames_shot *peak = frames_moment(&frames, "peak");
  const struct frames_shot *held = frames_moment(&frames, "held");
  ck_assert_ptr_eq(frames_moment(&frames, "before"), &frames.shots[0]);
  ck_assert_ptr_nonnull(peak);
  ck_assert_ptr_null(frames_moment(&frames, "never"));
  ck_assert_double_eq(json_number_value(json_object_get(held->head, "displacement_mm")), 130);
  /* the body at rest, to a 65535th of its size, and the largest pressure of the frame */
  double from = INFINITY, to = -INFINITY, most = 0;
  for (size_t p = 0; p < frames.point_count; p++) {
    from = fmin(from, frames.bodies[0].rest[p].x);
    to = fmax(to, frames.bodies[0].rest[p].x);
    most = fmax(most, peak->contact[p]);
  }
  ck_assert_double_eq_tol(from, 0, 1e-3);
  ck_assert_double_eq_tol(to, 118, 1e-3);
  double sample = json_number_value(json_object_get(peak->head, "contact_pressure_max_kPa"));
  ck_assert_double_gt(most, 0.97 * sample);
  ck_assert_double_lt(most, 1.001 * sample);
  ck_assert_double_eq_tol(peak->pose.place[0],
                          12 + json_number_value(json_object_get(peak->head, "displacement_mm")),
                          1e-5);
  frames_release(&frames);
}
END_TEST

static char *load(size_t *size) {
  char path[100];
  path_of("moments.bin", path);
  FILE *file = fopen(path, "rb");
  ck_assert_ptr_nonnull(file);
  char *bytes = malloc(1 << 22);
  *size = fread(bytes, 1, 1 << 22, file);
  fclose(file);
  return bytes;
}

static enum status read_as(const char *bytes, size_t size) {
  char path[100];
  struct frames frames;
  struct error error = {0};
  path_of("moments.bin", path);
  FILE *file = fopen(path, "wb");
  ck_assert_ptr_nonnull(file);
  fwrite(bytes, 1, size, file);
  fclose(file);
  enum status status = frames_read(directory, &frames, &error);
  ck_assert(status == STATUS_OK || strlen(error.message) > 10);
  frames_release(&frames);
  return status;
}

/* Exchanges a word of the header for one of the same length. */
static enum status read_with(const char *bytes, size_t size, const char *word, const char *other) {
  char *copy = malloc(size);
  memcpy(copy, bytes, size);
  char *place = memmem(copy, size, word, strlen(word));
  ck_assert_ptr_nonnull(place);
  memcpy(place, other, strlen(other));
  enum status status = read_as(copy, size);
  free(copy);
  return status;
}

START_TEST(damaged_files) {
  size_t size;
  plot_sample_frames(directory, 1);
  char *bytes = load(&size);
  ck_assert_int_eq(read_as(bytes, size), STATUS_OK);
  ck_assert_int_eq(read_as(bytes, 0), STATUS_SYNTAX);
  for (size_t cut = 1; cut < size; cut += size / 40) {
    ck_assert_int_eq(read_as(bytes, cut), STATUS_SYNTAX);
  }
  ck_assert_int_eq(read_with(bytes, size, "\"points\":", "\"pointz\":"), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "\"quads\":", "\"quads\":-"), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "\"bodies\"", "\"bodyes\""), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "\"body\":0", "\"body\":1"), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "\"pose\"", "\"poze\""), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "\"low_mm\"", "\"law_mm\""), STATUS_SYNTAX);
  ck_assert_int_eq(read_with(bytes, size, "PNLSURF1", "PNLSURF2"), STATUS_SYNTAX);
  for (size_t k = 0; k < 60; k++) { /* never more than a sentence */
    char old = bytes[k * size / 60];
    bytes[k * size / 60] = (char)(old ^ 0x5a);
    read_as(bytes, size);
    bytes[k * size / 60] = old;
  }
  free(bytes);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots of grasps");
  TCase *pictures = tcase_create("pictures");
  tcase_set_timeout(pictures, 120);
  tcase_add_checked_fixture(pictures, set_up, tear_down);
  tcase_add_test(pictures, what_a_grasp_offers);
  tcase_add_test(pictures, forces_at_all_sizes);
  tcase_add_test(pictures, the_force_rises_and_falls);
  tcase_add_test(pictures, several_grasps_in_one);
  tcase_add_test(pictures, a_study_of_friction);
  tcase_add_test(pictures, snapshots_show_the_moments);
  tcase_add_test(pictures, the_map_shows_where_it_presses);
  tcase_add_test(pictures, moments_come_back_from_the_file);
  tcase_add_test(pictures, damaged_files);
  suite_add_tcase(suite, pictures);
  return suite_run(suite);
}
