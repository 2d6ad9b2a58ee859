/* Plots of studies. Pictures are decoded again and their pixels counted. With PLOT_TEST_DIR set,
 * they are left there to look at, light and dark. */
#include <check.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/plot/cloud.h"
#include "tests/unit/plot_pictures.h"
#include "tests/unit/study_plot_samples.h"
#include "tests/unit/suite.h"

#define LONG_NAME "a name of sixty characters, as people give who want it exact"

static const struct plot_sheet plain = {.width = 800, .height = 600};
static const struct plot_sheet dark = {.width = 800, .height = 600, .theme = THEME_DARK};
static const struct study_plot_options usual = {0};

static struct picture draw(const char *plot, const struct study_sample *sample,
                           const struct study_plot_options *options, const struct plot_sheet *sheet,
                           const char *name) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct error error = {0};
  char file[120];
  enum status status = study_plot_render(plot, &sample->input, options, sheet, &png, &size, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", plot, error.message);
  snprintf(file, sizeof file, "study-%s-%s%s", plot, name ? name : "",
           sheet->theme == THEME_DARK ? "-dark" : "");
  struct picture picture = picture_decode(png, size, name ? file : NULL);
  ck_assert_int_eq((int)picture.image.width, sheet->width);
  ck_assert_int_eq((int)picture.image.height, sheet->height);
  free(png);
  return picture;
}

/* Pixels of a colour of the light table, below the heading of a picture that is drawn for this. */
static size_t pixels(const char *plot, const struct study_sample *sample,
                     const struct study_plot_options *options, int r, int g, int b) {
  enum { HEADING = 110 };
  struct picture picture = draw(plot, sample, options, &plain, NULL), part = picture;
  part.rgb += (size_t)3 * 800 * HEADING;
  part.image.height -= HEADING;
  size_t count = picture_count(&part, r, g, b);
  free(picture.rgb);
  return count;
}

static enum status refuse(const char *plot, const struct study_plot_input *input,
                          const struct study_plot_options *options, const struct plot_sheet *sheet,
                          const char *why) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct error error = {0};
  enum status status = study_plot_render(plot, input, options, sheet, &png, &size, &error);
  ck_assert_ptr_null(png);
  ck_assert_msg(strstr(error.message, why) != NULL, "%s: %s", plot, error.message);
  return status;
}

/* Every plot of a sample in both themes: words, and the sheet's paper. */
static void draw_everything(const struct study_sample *sample, const char *name) {
  for (const char *const *plot = study_plot_names(); *plot; plot++) {
    struct picture light = draw(*plot, sample, &usual, &plain, name);
    struct picture night = draw(*plot, sample, &usual, &dark, name);
    ck_assert_uint_gt(picture_count(&light, 28, 37, 48), 100);
    ck_assert_uint_gt(picture_count(&night, 231, 235, 240), 100);
    ck_assert_uint_gt(picture_count(&night, 26, 33, 42), 800 * 600 / 12);
    free(light.rgb);
    free(night.rgb);
  }
}

START_TEST(all_plots_of_a_spread_study) {
  struct study_sample *sample = study_sample_spread(256, 6);
  draw_everything(sample, "spread");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(all_plots_of_a_grid) {
  struct study_sample *sample = study_sample_grid(7, 6, 5);
  draw_everything(sample, "grid");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(all_plots_of_an_optimisation) {
  struct study_sample *sample = study_sample_course(60);
  draw_everything(sample, "course");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(all_plots_of_thousands) {
  struct study_sample *sample = study_sample_spread(4000, 2);
  draw_everything(sample, "thousands");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(no_members_one_member_and_none_that_is_solved) {
  static const size_t counts[] = {0, 1, 2, 3};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
    char name[20];
    struct study_sample *sample = study_sample_spread(counts[i], 0);
    snprintf(name, sizeof name, "few-%zu", counts[i]);
    draw_everything(sample, name);
    study_sample_destroy(sample);
  }
  struct study_sample *failed = study_sample_spread(20, 100);
  draw_everything(failed, "failed");
  study_sample_destroy(failed);
}
END_TEST

START_TEST(long_names_stay_on_the_sheet) {
  struct study_sample *sample = study_sample_spread(64, 10);
  study_sample_rename(sample, LONG_NAME);
  draw_everything(sample, "long");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(numbers_that_are_none) {
  struct study_sample *sample = study_sample_grid(5, 5, 0);
  struct study_table *t = &sample->table;
  const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300, 1e-300};
  for (size_t k = 0; k < t->members * t->metrics; k += 3) {
    t->result[k] = odd[k / 3 % 6];
  }
  for (size_t k = 0; k < t->members * t->parameters; k += 5) {
    t->value[k] = odd[k / 5 % 6];
  }
  draw_everything(sample, "odd");
  study_sample_destroy(sample);
}
END_TEST

START_TEST(all_sizes) {
  static const int sizes[][2] = {{200, 200}, {4000, 200}, {200, 4000}, {400, 300}, {1600, 1200}};
  struct study_sample *sample = study_sample_spread(100, 5);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    const struct plot_sheet sheet = {.width = sizes[i][0], .height = sizes[i][1]};
    for (const char *const *plot = study_plot_names(); *plot; plot++) {
      char name[40];
      snprintf(name, sizeof name, "%dx%d", sizes[i][0], sizes[i][1]);
      struct picture picture = draw(*plot, sample, &usual, &sheet, name);
      ck_assert_uint_gt(picture_count(&picture, 28, 37, 48), 20);
      free(picture.rgb);
    }
  }
  const struct plot_sheet small = {.width = 199, .height = 600},
                          vast = {.width = 600, .height = 4001};
  ck_assert_int_eq(refuse("curve", &sample->input, &usual, &small, "200 to 4000"), STATUS_INVALID);
  ck_assert_int_eq(refuse("curve", &sample->input, &usual, &vast, "200 to 4000"), STATUS_INVALID);
  study_sample_destroy(sample);
}
END_TEST

START_TEST(what_is_not_there_is_refused_by_name) {
  struct study_sample *sample = study_sample_spread(20, 0);
  const struct study_plot_options no_metric = {.metric = "speed"}, no_x = {.x = "/actuator/size"},
                                  no_colour = {.colour = "speed"},
                                  no_column = {.columns = "mass_g,/nothing"};
  const struct study_plot_input bare = {.table = &sample->table};
  ck_assert_int_eq(refuse("pie", &sample->input, &usual, &plain, "heat-map"), STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("curve", &sample->input, &no_metric, &plain, "tip_force_N"),
                   STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("heat-map", &sample->input, &no_x, &plain, "/actuator/gap"),
                   STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("curve", &sample->input, &no_colour, &plain, "tip_force_N"),
                   STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("scatter", &sample->input, &no_column, &plain, "/actuator/gap"),
                   STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("pareto", &bare, &usual, &plain, "objectives"), STATUS_NOT_FOUND);
  ck_assert_int_eq(refuse("contour", &bare, &usual, &plain, "surrogate"), STATUS_NOT_FOUND);
  study_sample_destroy(sample);
}
END_TEST

/* Failed members are seen: their colour is where none is without them. */
START_TEST(failed_members_are_shown) {
  static const char *const plots[] = {"curve", "parallel", "scatter", "history"};
  struct study_sample *none = study_sample_spread(120, 0), *some = study_sample_spread(120, 12);
  for (size_t i = 0; i < sizeof plots / sizeof *plots; i++) {
    size_t without = pixels(plots[i], none, &usual, 168, 66, 0);
    size_t with = pixels(plots[i], some, &usual, 168, 66, 0);
    ck_assert_msg(with > without + 60, "%s: %zu, %zu", plots[i], without, with);
  }
  study_sample_destroy(none);
  study_sample_destroy(some);
}
END_TEST

/* In a cell whose members all failed there is a cross and no colour of the map. */
START_TEST(cells_that_failed_are_crossed_out) {
  struct study_sample *sample = study_sample_grid(3, 3, 0);
  size_t before = pixels("heat-map", sample, &usual, 168, 66, 0);
  sample->table.state[4] = JOB_STATE_FAILED;
  sample->table.reason[4] = sample->table.name;
  ck_assert_uint_gt(pixels("heat-map", sample, &usual, 168, 66, 0), before + 25);
  study_sample_destroy(sample);
}
END_TEST

/* The first column of cells has the thinnest wall, whose angle is the largest: it is brighter. */
START_TEST(cells_follow_the_metric) {
  struct study_sample *sample = study_sample_grid(2, 2, 0);
  struct picture picture = draw("heat-map", sample, &usual, &plain, NULL);
  double bright[2];
  for (int k = 0; k < 2; k++) {
    const unsigned char *p = picture.rgb + 3 * (400 * 800 + (k ? 500 : 180));
    bright[k] = 0.3 * p[0] + 0.59 * p[1] + 0.11 * p[2];
  }
  ck_assert_double_gt(bright[0], bright[1] + 40);
  free(picture.rgb);
  study_sample_destroy(sample);
}
END_TEST

enum { SHEET = 200, LINES = 3000, BLOCK = 8 };

/* A sheet of SHEET x SHEET with lines from edge to edge, drawn so many at a time. */
static struct canvas *draw_lines(const struct cloud_line *lines, size_t some, double opacity) {
  struct canvas *canvas = canvas_create(SHEET, SHEET, THEME_LIGHT);
  ck_assert_ptr_nonnull(canvas);
  struct cloud *cloud = cloud_create(canvas, (struct box){0, 0, SHEET, SHEET}, false);
  ck_assert_ptr_nonnull(cloud);
  for (size_t done = 0; done < LINES; done += some) {
    cloud_lines(cloud, 0, SHEET, lines + done, some, 1);
  }
  cloud_paint(cloud, canvas, opacity);
  cloud_destroy(cloud);
  return canvas;
}

static const unsigned char *pixel_at(const struct canvas *canvas, int x, int y) {
  return cairo_image_surface_get_data(canvas->surface) +
         cairo_image_surface_get_stride(canvas->surface) * y + 4 * x;
}

static double block_mean(const struct canvas *canvas, int x, int y, int channel) {
  double sum = 0;
  for (int i = 0; i < BLOCK * BLOCK; i++) {
    sum += pixel_at(canvas, x + i % BLOCK, y + i / BLOCK)[channel];
  }
  return sum / (BLOCK * BLOCK);
}

/* Thousands of lines are drawn in another way than a few: the same picture but for their edges. */
START_TEST(many_lines_lie_where_few_do) {
  static struct cloud_line lines[LINES];
  uint32_t state = 7;
  for (int k = 0; k < LINES; k++) {
    float random[4];
    for (int i = 0; i < 4; i++) {
      state = state * 1664525 + 1013904223;
      random[i] = (float)(state >> 8) / 16777216;
    }
    lines[k] = (struct cloud_line){
        20 + 40 * random[0], 190 - 90 * random[1] * random[1], random[2], random[3], 0.5,
        k % 10 == 0 ? 3 : 1};
  }
  struct canvas *many = draw_lines(lines, LINES, 0.02), *few = draw_lines(lines, 500, 0.02);
  double apart = 0;
  for (int y = 0; y < SHEET; y += BLOCK) {
    for (int x = 0; x < SHEET; x += BLOCK) {
      for (int c = 0; c < 3; c++) {
        apart += fabs(block_mean(many, x, y, c) - block_mean(few, x, y, c));
      }
    }
  }
  ck_assert_double_lt(apart * BLOCK * BLOCK / (3.0 * SHEET * SHEET), 4);
  canvas_destroy(many);
  canvas_destroy(few);
}
END_TEST

/* Level lines cover their row and nothing else, with the mean of their colours. */
START_TEST(lines_leave_nothing_beside_them) {
  static struct cloud_line lines[LINES];
  for (int k = 0; k < LINES; k++) {
    float y = k % 3 == 0 ? 0.5f : k % 3 == 1 ? 100.5f : SHEET - 0.5f;
    lines[k] = k % 2 == 0 ? (struct cloud_line){y, y, 1, 0, 0, 1}
                          : (struct cloud_line){y, y, 0, 0, 0.6f, 3};
  }
  struct canvas *canvas = draw_lines(lines, LINES, 0.5);
  const unsigned char *paper = pixel_at(canvas, 0, 50);
  for (int y = 0; y < SHEET; y++) {
    for (int x = 0; x < SHEET; x++) {
      const unsigned char *is = pixel_at(canvas, x, y);
      if (y == 0 || y == 100 || y == SHEET - 1) {
        ck_assert_int_le(abs(is[2] - 64), 1);
        ck_assert_int_le(abs(is[0] - 115), 1);
      } else {
        ck_assert_mem_eq(is, paper, 4);
      }
    }
  }
  canvas_destroy(canvas);
}
END_TEST

/* A member more changes a cloud's colours the same whatever the order. */
START_TEST(clouds_do_not_depend_on_the_order) {
  struct study_sample *sample = study_sample_spread(1000, 0);
  struct study_table *t = &sample->table;
  struct picture one = draw("parallel", sample, &usual, &plain, NULL);
  for (size_t a = 0, b = t->members - 1; a < b; a++, b--) {
    for (size_t k = 0; k < t->parameters; k++) {
      double keep = t->value[a * t->parameters + k];
      /* words are spread by row */
      if (!t->parameter[k].categorical) {
        t->value[a * t->parameters + k] = t->value[b * t->parameters + k];
        t->value[b * t->parameters + k] = keep;
      }
    }
    for (size_t k = 0; k < t->metrics; k++) {
      double keep = t->result[a * t->metrics + k];
      t->result[a * t->metrics + k] = t->result[b * t->metrics + k];
      t->result[b * t->metrics + k] = keep;
    }
  }
  const struct study_plot_options numbers = {
      .columns = "/actuator/top_wall,/actuator/gap,/material/C1,bending_angle_deg"};
  struct picture two = draw("parallel", sample, &numbers, &plain, NULL);
  free(one.rgb);
  for (size_t a = 0, b = t->members - 1; a < b; a++, b--) {
    for (size_t k = 0; k < t->parameters; k++) {
      double keep = t->value[a * t->parameters + k];
      t->value[a * t->parameters + k] = t->value[b * t->parameters + k];
      t->value[b * t->parameters + k] = keep;
    }
    for (size_t k = 0; k < t->metrics; k++) {
      double keep = t->result[a * t->metrics + k];
      t->result[a * t->metrics + k] = t->result[b * t->metrics + k];
      t->result[b * t->metrics + k] = keep;
    }
  }
  one = draw("parallel", sample, &numbers, &plain, NULL);
  size_t different = 0;
  for (size_t i = 0; i < 3 * 800 * 600; i++) {
    different += abs(one.rgb[i] - two.rgb[i]) > 2;
  }
  ck_assert_uint_eq(different, 0);
  free(one.rgb);
  free(two.rgb);
  study_sample_destroy(sample);
}
END_TEST

START_TEST(cells_of_shapes) {
  struct study_sample *sample = study_sample_grid(4, 3, 0);
  struct study_cells cells;
  ck_assert_int_eq(study_plot_cells(&sample->table, &usual, &cells, NULL), STATUS_OK);
  ck_assert_uint_eq(cells.columns, 4);
  ck_assert_uint_eq(cells.rows, 3);
  for (size_t k = 0; k < 12; k++) {
    ck_assert_uint_eq(cells.row[k], k);
  }
  study_sample_destroy(sample);
  sample = study_sample_spread(500, 0);
  ck_assert_int_eq(study_plot_cells(&sample->table, &usual, &cells, NULL), STATUS_OK);
  ck_assert_uint_eq(cells.columns * cells.rows, 25);
  for (size_t a = 0; a < 25; a++) {
    ck_assert_uint_lt(cells.row[a], 500);
    double wall = sample->table.value[cells.row[a] * 5];
    ck_assert_double_eq_tol(wall, 1 + 2 * ((double)(a % 5) + 0.5) / 5, 0.2);
    for (size_t b = 0; b < a; b++) {
      ck_assert_uint_ne(cells.row[a], cells.row[b]);
    }
  }
  study_sample_destroy(sample);
}
END_TEST

struct work {
  const struct study_sample *sample;
  unsigned char *png[12];
  size_t size[12];
};

static void *draw_all(void *data) {
  struct work *work = data;
  const char *const *plots = study_plot_names();
  for (size_t i = 0; plots[i]; i++) {
    if (study_plot_render(plots[i], &work->sample->input, &usual, i % 2 ? &dark : &plain,
                          &work->png[i], &work->size[i], NULL) != STATUS_OK) {
      return work;
    }
  }
  return NULL;
}

START_TEST(threads_draw_the_same) {
  enum { THREADS = 4 };
  struct study_sample *sample = study_sample_spread(300, 4);
  struct work work[THREADS] = {{0}};
  pthread_t threads[THREADS];
  for (size_t i = 0; i < THREADS; i++) {
    work[i].sample = sample;
    ck_assert_int_eq(pthread_create(&threads[i], NULL, draw_all, &work[i]), 0);
  }
  for (size_t i = 0; i < THREADS; i++) {
    void *failed;
    pthread_join(threads[i], &failed);
    ck_assert_ptr_null(failed);
  }
  for (size_t i = 0; i < THREADS; i++) {
    for (size_t k = 0; k < 12; k++) {
      ck_assert_uint_eq(work[i].size[k], work[0].size[k]);
      ck_assert_int_eq(memcmp(work[i].png[k], work[0].png[k], work[0].size[k]), 0);
    }
  }
  for (size_t i = 0; i < THREADS; i++) {
    for (size_t k = 0; k < 12; k++) {
      free(work[i].png[k]);
    }
  }
  study_sample_destroy(sample);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("plots of studies");
  TCase *pictures = tcase_create("pictures");
  tcase_set_timeout(pictures, 120);
  tcase_add_test(pictures, all_plots_of_a_spread_study);
  tcase_add_test(pictures, all_plots_of_a_grid);
  tcase_add_test(pictures, all_plots_of_an_optimisation);
  tcase_add_test(pictures, all_plots_of_thousands);
  tcase_add_test(pictures, no_members_one_member_and_none_that_is_solved);
  tcase_add_test(pictures, long_names_stay_on_the_sheet);
  tcase_add_test(pictures, numbers_that_are_none);
  tcase_add_test(pictures, all_sizes);
  tcase_add_test(pictures, what_is_not_there_is_refused_by_name);
  tcase_add_test(pictures, failed_members_are_shown);
  tcase_add_test(pictures, cells_that_failed_are_crossed_out);
  tcase_add_test(pictures, cells_follow_the_metric);
  tcase_add_test(pictures, many_lines_lie_where_few_do);
  tcase_add_test(pictures, lines_leave_nothing_beside_them);
  tcase_add_test(pictures, clouds_do_not_depend_on_the_order);
  tcase_add_test(pictures, cells_of_shapes);
  tcase_add_test(pictures, threads_draw_the_same);
  suite_add_tcase(suite, pictures);
  return suite_run(suite);
}
