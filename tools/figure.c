#include "tools/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

bool figure_save(unsigned char *png, size_t size, const char *path) {
  FILE *file = fopen(path, "wb");
  bool good = file && fwrite(png, 1, size, file) == size;
  good = file && fclose(file) == 0 && good;
  if (!good) {
    perror(path);
  }
  free(png);
  return good;
}

bool figure_write(const char *program, const char *plot, const struct plot_input *inputs,
                  size_t count, int width, int height, const char *path) {
  unsigned char *png = NULL;
  size_t size = 0;
  struct error error = {.status = STATUS_OK};
  const struct plot_sheet sheet = {.width = width, .height = height};
  if (plot_render(plot, inputs, count, &sheet, &png, &size, &error) != STATUS_OK) {
    fprintf(stderr, "%s: %s: %s\n", program, path, error.message);
    return false;
  }
  return figure_save(png, size, path);
}

double figure_number(const json_t *object, const char *key) {
  const json_t *value = json_object_get(object, key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

const char *figure_text(const json_t *object, const char *key) {
  const char *text = json_string_value(json_object_get(object, key));
  return text ? text : "";
}
