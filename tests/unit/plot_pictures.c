#include "tests/unit/plot_pictures.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fontconfig keeps its tables until the process ends and hides them from the leak checker. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
  return "leak:libfontconfig\nleak:libpango\n";
}

/* The thread checker does not see the locks inside libraries that were built without it. */
const char *__tsan_default_suppressions(void);
const char *__tsan_default_suppressions(void) {
  return "called_from_lib:libfontconfig.so\ncalled_from_lib:libglib-2.0.so\n"
         "called_from_lib:libgobject-2.0.so\ncalled_from_lib:libcairo.so\n"
         "called_from_lib:libpango-1.0.so\ncalled_from_lib:libpangocairo-1.0.so\n"
         "called_from_lib:libpangoft2-1.0.so\ncalled_from_lib:libharfbuzz.so\n"
         "called_from_lib:libfreetype.so\ncalled_from_lib:libpixman-1.so\n"
         "called_from_lib:libfribidi.so\ncalled_from_lib:libexpat.so\n";
}

static void keep(const char *name, const unsigned char *png, size_t size) {
  const char *directory = getenv("PLOT_TEST_DIR");
  char path[512];
  if (directory && name) {
    snprintf(path, sizeof path, "%s/%s.png", directory, name);
    FILE *file = fopen(path, "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(png, 1, size, file), size);
    fclose(file);
  }
}

static struct picture decode(const unsigned char *png, size_t size) {
  struct picture picture = {.image = {.version = PNG_IMAGE_VERSION}};
  ck_assert_int_ne(png_image_begin_read_from_memory(&picture.image, png, size), 0);
  picture.image.format = PNG_FORMAT_RGB;
  picture.rgb = malloc(PNG_IMAGE_SIZE(picture.image));
  ck_assert_int_ne(png_image_finish_read(&picture.image, NULL, picture.rgb, 0, NULL), 0);
  return picture;
}

struct picture picture_decode(const unsigned char *png, size_t size, const char *name) {
  keep(name, png, size);
  return decode(png, size);
}

/* Draws, decodes and keeps a picture; fails the test when it cannot be drawn. */
struct picture picture_draw(const char *plot, const struct plot_input *inputs, size_t count,
                            int width, int height, const char *name) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct error error = {0};
  struct plot_sheet sheet = {.width = width, .height = height};
  enum status status = plot_render(plot, inputs, count, &sheet, &png, &size, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", plot, error.message);
  keep(name, png, size);
  struct picture picture = decode(png, size);
  ck_assert_int_eq((int)picture.image.width, width);
  ck_assert_int_eq((int)picture.image.height, height);
  free(png);
  return picture;
}

enum status picture_refuse(const char *plot, const struct plot_input *inputs, size_t count,
                           int width, int height) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct error error = {0};
  struct plot_sheet sheet = {.width = width, .height = height};
  enum status status = plot_render(plot, inputs, count, &sheet, &png, &size, &error);
  ck_assert_ptr_null(png);
  ck_assert_int_eq(error.status, status);
  ck_assert_uint_gt(strlen(error.message), 10);
  return status;
}

/* Pixels within a small distance of a colour. */
size_t picture_count(const struct picture *picture, int r, int g, int b) {
  size_t count = 0;
  for (size_t i = 0; i < (size_t)picture->image.width * picture->image.height; i++) {
    const unsigned char *p = picture->rgb + 3 * i;
    count += abs(p[0] - r) < 12 && abs(p[1] - g) < 12 && abs(p[2] - b) < 12;
  }
  return count;
}

/* Mean y of the pixels of a colour in columns from <= x < to; NaN when there are none. */
double picture_mean_y(const struct picture *picture, int from, int to, int r, int g, int b) {
  double sum = 0, count = 0;
  for (int y = 0; y < (int)picture->image.height; y++) {
    for (int x = from; x < to; x++) {
      const unsigned char *p = picture->rgb + 3 * ((size_t)y * picture->image.width + (size_t)x);
      if (abs(p[0] - r) < 12 && abs(p[1] - g) < 12 && abs(p[2] - b) < 12) {
        sum += y;
        count++;
      }
    }
  }
  return sum / count;
}

static struct plot_input input_of(const json_t *result, const char *title) {
  return (struct plot_input){.result = result, .title = title, .job_id = 7};
}

/* Draws on a dark sheet: its words are light, and the paper is dark from edge to edge. */
static void draw_dark(const char *plot, const struct plot_input *input, const char *name) {
  unsigned char *png = NULL;
  size_t size = 0;
  char file[80];
  struct plot_sheet sheet = {.width = 800, .height = 600, .theme = THEME_DARK};
  ck_assert_int_eq(plot_render(plot, input, 1, &sheet, &png, &size, NULL), STATUS_OK);
  snprintf(file, sizeof file, "%s-%s-dark", plot, name);
  keep(file, png, size);
  struct picture picture = decode(png, size);
  ck_assert_uint_gt(picture_count(&picture, 231, 235, 240), 30);
  ck_assert_uint_gt(picture_count(&picture, 26, 33, 42), 800 * 600 / 5);
  ck_assert_uint_lt(picture_count(&picture, 255, 255, 255), 800 * 600 / 100);
  free(picture.rgb);
  free(png);
}

void picture_at_all_sizes(const char *plot, const json_t *result, const char *name) {
  static const int sizes[][2] = {{900, 650}, {1600, 1200}, {400, 300}, {200, 200}, {4000, 200}};
  struct plot_input input = input_of(result, name);
  draw_dark(plot, &input, name);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    char file[80];
    snprintf(file, sizeof file, "%s-%s-%d", plot, name, sizes[i][0]);
    struct picture picture = picture_draw(plot, &input, 1, sizes[i][0], sizes[i][1], file);
    ck_assert_uint_gt(picture_count(&picture, 28, 37, 48), 30);
    free(picture.rgb);
  }
}

struct picture picture_of(const char *plot, const json_t *result, const char *metric) {
  struct plot_input input = input_of(result, "");
  input.metric = metric;
  return picture_draw(plot, &input, 1, 800, 600, NULL);
}

enum status picture_refuse_one(const char *plot, const json_t *result, const char *metric) {
  struct plot_input input = input_of(result, "");
  input.metric = metric;
  return picture_refuse(plot, &input, 1, 800, 600);
}

size_t picture_pixels(const char *plot, const json_t *result, int r, int g, int b) {
  struct picture picture = picture_of(plot, result, NULL);
  size_t count = picture_count(&picture, r, g, b);
  free(picture.rgb);
  return count;
}

const char *picture_offered(const char *kind, const json_t *result, char text[300]) {
  const char *names[PLOT_NAMES];
  plot_names_for(kind, result, names);
  text[0] = '\0';
  for (size_t i = 0; names[i]; i++) {
    size_t used = strlen(text);
    snprintf(text + used, 300 - used, "%s%s", i ? " " : "", names[i]);
  }
  return text;
}
