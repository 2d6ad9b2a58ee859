#include "solver/post/csv.h"

#include <math.h>
#include <string.h>

static void write_text(FILE *file, const char *text) {
  if (!strpbrk(text, ",\"\r\n")) {
    fputs(text, file);
    return;
  }
  fputc('"', file);
  for (; *text; text++) {
    if (*text == '"') {
      fputc('"', file);
    }
    fputc(*text, file);
  }
  fputc('"', file);
}

static void write_value(FILE *file, const json_t *value) {
  if (json_is_number(value)) {
    fprintf(file, "%.15g", json_number_value(value));
  } else if (json_is_string(value)) {
    write_text(file, json_string_value(value));
  } else if (json_is_boolean(value)) {
    fputs(json_is_true(value) ? "true" : "false", file);
  }
}

void csv_write_objects(FILE *file, const json_t *rows) {
  json_t *columns = json_object(), *ignored;
  const char *name, *between = "";
  for (size_t i = 0; i < json_array_size(rows); i++) {
    json_object_update_missing(columns, json_array_get(rows, i));
  }
  json_object_foreach(columns, name, ignored) {
    fputs(between, file);
    write_text(file, name);
    between = ",";
  }
  fputs("\r\n", file);
  for (size_t i = 0; i < json_array_size(rows); i++) {
    between = "";
    json_object_foreach(columns, name, ignored) {
      fputs(between, file);
      write_value(file, json_object_get(json_array_get(rows, i), name));
      between = ",";
    }
    fputs("\r\n", file);
  }
  json_decref(columns);
}

void csv_write_midlines(FILE *file, const json_t *midlines) {
  fputs("pressure_kPa,point,arc_length_mm,x_mm,y_mm,z_mm\r\n", file);
  for (size_t m = 0; m < json_array_size(midlines); m++) {
    const json_t *midline = json_array_get(midlines, m);
    const json_t *points = json_object_get(midline, "points_mm");
    double pressure = json_number_value(json_object_get(midline, "pressure_kPa"));
    double before[3] = {0}, length = 0;
    for (size_t p = 0; p < json_array_size(points); p++) {
      double x[3], square = 0;
      for (size_t i = 0; i < 3; i++) {
        x[i] = json_number_value(json_array_get(json_array_get(points, p), i));
        square += (x[i] - before[i]) * (x[i] - before[i]);
        before[i] = x[i];
      }
      length += p > 0 ? sqrt(square) : 0;
      fprintf(file, "%.15g,%zu,%.15g,%.15g,%.15g,%.15g\r\n", pressure, p, length, x[0], x[1], x[2]);
    }
  }
}
