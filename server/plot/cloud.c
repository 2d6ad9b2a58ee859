#include "server/plot/cloud.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 8, DEPTH = 64 };  /* of the table of opacities: parts of one thing, things */
static const float SPECK = 1.1f; /* radius of the largest dot that needs no shape */
enum { SUMS_MOST = 4000000 };    /* 64 MB */

/* Sums over what covers a pixel: colours and, last, how much of it is covered. */
typedef float sums __attribute__((vector_size(16)));

struct cloud {
  int x, y, width, height; /* pixels of the sheet */
  int cell;                /* pixels across that share one sum: more than 1 on vast sheets */
  int columns, rows;       /* of sums */
  sums *sum;
};

struct cloud *cloud_create(const struct canvas *canvas, struct box area, bool coarse) {
  int left = (int)fmax(floor(area.x), 0), top = (int)fmax(floor(area.y), 0);
  int right = (int)fmin(ceil(area.x + area.width), canvas->width);
  int bottom = (int)fmin(ceil(area.y + area.height), canvas->height);
  struct cloud *cloud = malloc(sizeof *cloud);
  if (!cloud) {
    return NULL;
  }
  *cloud = (struct cloud){.x = left,
                          .y = top,
                          .width = right > left ? right - left : 1,
                          .height = bottom > top ? bottom - top : 1};
  cloud->cell = coarse ? 2 : 1;
  while ((double)cloud->width * cloud->height > (double)SUMS_MOST * cloud->cell * cloud->cell) {
    cloud->cell++;
  }
  cloud->columns = (cloud->width + cloud->cell - 1) / cloud->cell;
  cloud->rows = (cloud->height + cloud->cell - 1) / cloud->cell;
  cloud->sum = calloc((size_t)cloud->columns * (size_t)cloud->rows, sizeof(sums));
  if (!cloud->sum) {
    free(cloud);
    return NULL;
  }
  return cloud;
}

void cloud_destroy(struct cloud *cloud) {
  if (cloud) {
    free(cloud->sum);
    free(cloud);
  }
}

/* A dot about as large as a pixel: shared among four. */
static void add_speck(struct cloud *cloud, float x, float y, float weight, sums full) {
  int left = (int)floorf(x - 0.5f), top = (int)floorf(y - 0.5f);
  float fx = x - 0.5f - (float)left, fy = y - 0.5f - (float)top;
  if (left < 0 || top < 0 || left + 1 >= cloud->columns || top + 1 >= cloud->rows) {
    return;
  }
  sums *at = cloud->sum + (size_t)top * (size_t)cloud->columns + (size_t)left;
  full *= weight;
  at[0] += full * ((1 - fx) * (1 - fy));
  at[1] += full * (fx * (1 - fy));
  at[cloud->columns] += full * ((1 - fx) * fy);
  at[cloud->columns + 1] += full * (fx * fy);
}

void cloud_dot(struct cloud *cloud, double x, double y, double radius, struct rgb colour) {
  if (!isfinite(x) || !isfinite(y)) {
    return;
  }
  float r = (float)(radius / cloud->cell);
  float cx = (float)((x - cloud->x) / cloud->cell), cy = (float)((y - cloud->y) / cloud->cell);
  int left = (int)fmaxf(floorf(cx - r - 0.5f), 0), top = (int)fmaxf(floorf(cy - r - 0.5f), 0);
  int right = (int)fminf(ceilf(cx + r + 0.5f), (float)cloud->columns);
  int bottom = (int)fminf(ceilf(cy + r + 0.5f), (float)cloud->rows);
  const sums full = {(float)colour.r, (float)colour.g, (float)colour.b, 1};
  if (r < SPECK) {
    add_speck(cloud, cx, cy, 3.14159f * r * r, full);
    return;
  }
  for (int j = top; j < bottom; j++) {
    sums *row = cloud->sum + (size_t)j * (size_t)cloud->columns;
    float dy = (float)j + 0.5f - cy;
    for (int i = left; i < right; i++) {
      float dx = (float)i + 0.5f - cx;
      /* the share of the pixel inside the disc, from the distance of its middle to the rim */
      float cover = fminf(r + 0.5f - sqrtf(dx * dx + dy * dy), 1);
      if (cover > 0) {
        row[i] += full * cover;
      }
    }
  }
}

/* The lines at one column of sums. */
struct slice {
  sums *column;
  int rows;
  float part;   /* of the way from the first axis to the second */
  float across; /* that way, in columns */
  float top;    /* y of the first row, pixels */
  float scale;  /* rows a pixel */
  float half;   /* of the width of a line, rows */
};

/* Adds the lines with smooth edges, each over as much of the column as its slope demands. */
static void add_smooth(const struct slice *s, const struct cloud_line *lines, size_t count) {
  for (size_t k = 0; k < count; k++) {
    const struct cloud_line *line = &lines[k];
    float rise = (line->to - line->from) * s->scale;
    float middle = (line->from - s->top) * s->scale + s->part * rise, slope = rise / s->across;
    const sums full = (sums){line->r, line->g, line->b, 1} * line->weight;
    float reach = s->half * sqrtf(1 + slope * slope);
    float from = fmaxf(middle - reach, 0), to = fminf(middle + reach, (float)s->rows);
    for (int j = (int)from; (float)j < to; j++) {
      float cover = fminf(to, (float)j + 1) - fmaxf(from, (float)j);
      s->column[j] += full * cover;
    }
  }
}

/* A line on its way through the columns: rows in 1/65536. */
struct runner {
  sums full;
  int32_t y, step;
};

/* Adds the lines to the next column, whole pixels each: of thousands no edge is seen. */
static void add_run(sums *column, struct runner *runners, size_t count) {
  for (size_t k = 0; k < count; k++) {
    struct runner *runner = &runners[k];
    int from = runner->y >> 16;
    runner->y += runner->step;
    int to = runner->y >> 16;
    int low = from <= to ? from : to + 1, high = from < to ? to - 1 : from;
    const sums full = runner->full;
    for (int j = low; j <= high; j++) {
      column[j] += full;
    }
  }
}

/* The lines at the first column, cut to the rows; NULL when memory ran out. */
static struct runner *make_runners(const struct slice *s, const struct cloud_line *lines,
                                   size_t count) {
  struct runner *runners = aligned_alloc(sizeof(sums), (count + 1) * sizeof *runners);
  const double most = s->rows - 1;
  for (size_t k = 0; runners && k < count; k++) {
    double from = fmin(fmax((double)(lines[k].from - s->top) * s->scale, 0), most);
    double to = fmin(fmax((double)(lines[k].to - s->top) * s->scale, 0), most);
    runners[k] =
        (struct runner){(sums){lines[k].r, lines[k].g, lines[k].b, 1} * lines[k].weight,
                        (int32_t)(from * 65536), (int32_t)((to - from) / s->across * 65536)};
  }
  return runners;
}

void cloud_lines(struct cloud *cloud, double x0, double x1, const struct cloud_line *lines,
                 size_t count, double width) {
  enum { MANY = 1500 };
  double cell = cloud->cell;
  int from = (int)fmax(floor((x0 - cloud->x) / cell), 0);
  int to = (int)fmin(ceil((x1 - cloud->x) / cell), cloud->columns);
  struct slice slice = {.column = calloc((size_t)cloud->rows, sizeof(sums)),
                        .rows = cloud->rows,
                        .across = (float)(to - from),
                        .top = (float)cloud->y,
                        .scale = (float)(1 / cell),
                        .half = (float)(width / 2 / cell)};
  struct runner *runners = count < MANY || to <= from ? NULL : make_runners(&slice, lines, count);
  for (int i = from; slice.column && i < to; i++) {
    slice.part = ((float)(i - from) + 0.5f) / slice.across;
    memset(slice.column, 0, (size_t)cloud->rows * sizeof(sums));
    if (runners) {
      add_run(slice.column, runners, count);
    } else {
      add_smooth(&slice, lines, count);
    }
    for (int j = 0; j < cloud->rows; j++) {
      cloud->sum[(size_t)j * (size_t)cloud->columns + (size_t)i] += slice.column[j];
    }
  }
  free(runners);
  free(slice.column);
}

static uint32_t blend(uint32_t below, sums above, float alpha) {
  const float scale = 255 * alpha / above[3], keep = 1 - alpha;
  uint32_t r = (uint32_t)(above[0] * scale + keep * (float)(below >> 16 & 255) + 0.5f);
  uint32_t g = (uint32_t)(above[1] * scale + keep * (float)(below >> 8 & 255) + 0.5f);
  uint32_t b = (uint32_t)(above[2] * scale + keep * (float)(below & 255) + 0.5f);
  return r << 16 | g << 8 | b;
}

/* The sum at a pixel; of 2 x 2 of them smoothly from the four nearest. */
static inline sums sum_at(const struct cloud *cloud, int i, int j) {
  const int columns = cloud->columns;
  if (cloud->cell != 2) {
    return cloud->sum[(size_t)(j / cloud->cell) * (size_t)columns + (size_t)(i / cloud->cell)];
  }
  int x = i / 2, y = j / 2;
  int beside = i % 2 ? (x + 1 < columns ? x + 1 : x) : (x > 0 ? x - 1 : x);
  int above = j % 2 ? (y + 1 < cloud->rows ? y + 1 : y) : (y > 0 ? y - 1 : y);
  const sums *row = cloud->sum + (size_t)y * (size_t)columns;
  const sums *other = cloud->sum + (size_t)above * (size_t)columns;
  return row[x] * 0.5625f + (row[beside] + other[x]) * 0.1875f + other[beside] * 0.0625f;
}

void cloud_paint(const struct cloud *cloud, struct canvas *canvas, double opacity) {
  float table[STEPS * DEPTH + 1];
  for (int i = 0; i <= STEPS * DEPTH; i++) {
    table[i] = (float)(1 - pow(1 - opacity, (double)i / STEPS));
  }
  cairo_surface_flush(canvas->surface);
  unsigned char *data = cairo_image_surface_get_data(canvas->surface);
  ptrdiff_t stride = cairo_image_surface_get_stride(canvas->surface);
  for (int j = 0; j < cloud->height; j++) {
    unsigned char *to = data + stride * (cloud->y + j) + 4 * (ptrdiff_t)cloud->x;
    for (int i = 0; i < cloud->width; i++) {
      sums sum = sum_at(cloud, i, j);
      float n = sum[3] * STEPS;
      if (n <= 0) {
        continue;
      }
      n = fminf(n, STEPS * DEPTH - 0.001f);
      int k = (int)n;
      float alpha = table[k] + (n - (float)k) * (table[k + 1] - table[k]);
      uint32_t pixel;
      memcpy(&pixel, to + 4 * (ptrdiff_t)i, sizeof pixel);
      pixel = blend(pixel, sum, alpha);
      memcpy(to + 4 * (ptrdiff_t)i, &pixel, sizeof pixel);
    }
  }
  cairo_surface_mark_dirty(canvas->surface);
}

double cloud_opacity(size_t count) {
  return fmin(fmax(0.9 * pow(60.0 / (double)(count > 0 ? count : 1), 0.4), 0.08), 0.9);
}
