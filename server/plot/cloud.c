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

/* Colours in 1/255 and the weight, in whole numbers: what a line adds at its first row and takes
 * away below its last one then cancels exactly. */
typedef int32_t wholes __attribute__((vector_size(16)));

/* A line on its way through the columns: rows in 1/65536. */
struct runner {
  wholes full;
  int32_t y, step;
};

enum { RUNNERS = 128 }; /* at a time: they and a column stay in the cache next to the processor */

static void runners_make(const struct slice *s, const struct cloud_line *lines, size_t count,
                         struct runner *runners) {
  /* a margin that rounding on the way does not use up */
  const float least = 1 / 64.f, most = fmaxf((float)(s->rows - 1), least);
  for (size_t k = 0; k < count; k++) {
    const struct cloud_line *line = &lines[k];
    float from = fminf(fmaxf((line->from - s->top) * s->scale, least), most);
    float to = fminf(fmaxf((line->to - s->top) * s->scale, least), most);
    float weight = rintf(line->weight);
    wholes full = {(int32_t)(255 * line->r + 0.5f), (int32_t)(255 * line->g + 0.5f),
                   (int32_t)(255 * line->b + 0.5f), 1};
    runners[k] = (struct runner){.full = full * (int32_t)weight,
                                 .y = (int32_t)(from * 65536),
                                 .step = (int32_t)((to - from) / s->across * 65536)};
  }
}

/* Adds the lines to the changes down the next column, whole pixels each: of thousands no edge is
 * seen. How far a line goes differs from one to the next, so that a loop over its pixels would be
 * mispredicted every time; the two ends need none. */
static void runners_advance(struct runner *runners, size_t count, wholes *changes) {
  for (size_t k = 0; k < count; k++) {
    struct runner *runner = &runners[k];
    int from = runner->y >> 16;
    runner->y += runner->step;
    int to = runner->y >> 16;
    int low = from < to ? from : to, high = from < to ? to : from;
    changes[low] += runner->full;
    changes[high + (low == high)] -= runner->full;
  }
}

/* Adds many lines by their changes down each column. False when memory ran out. */
static bool add_many(struct cloud *cloud, int first, const struct slice *s,
                     const struct cloud_line *lines, size_t count) {
  const size_t columns = (size_t)s->across, rows = (size_t)s->rows;
  wholes *changes = calloc(columns * (rows + 1), sizeof *changes);
  if (!changes) {
    return false;
  }
  for (size_t done = 0; done < count; done += RUNNERS) {
    struct runner runners[RUNNERS];
    size_t some = count - done < RUNNERS ? count - done : RUNNERS;
    runners_make(s, lines + done, some, runners);
    for (size_t i = 0; i < columns; i++) {
      runners_advance(runners, some, changes + i * (rows + 1));
    }
  }
  for (size_t i = 0; i < columns; i++) {
    const wholes *change = changes + i * (rows + 1);
    sums *to = cloud->sum + (size_t)first + i;
    wholes here = {0};
    for (size_t j = 0; j < rows; j++, to += cloud->columns) {
      here += change[j];
      *to += __builtin_convertvector(here, sums) * (sums){1 / 255.f, 1 / 255.f, 1 / 255.f, 1};
    }
  }
  free(changes);
  return true;
}

/* Adds few lines, with smooth edges. */
static void add_few(struct cloud *cloud, int first, struct slice *s, const struct cloud_line *lines,
                    size_t count) {
  s->column = calloc((size_t)s->rows, sizeof(sums));
  for (int i = 0; s->column && i < (int)s->across; i++) {
    s->part = ((float)i + 0.5f) / s->across;
    memset(s->column, 0, (size_t)s->rows * sizeof(sums));
    add_smooth(s, lines, count);
    for (int j = 0; j < s->rows; j++) {
      cloud->sum[(size_t)j * (size_t)cloud->columns + (size_t)(first + i)] += s->column[j];
    }
  }
  free(s->column);
}

void cloud_lines(struct cloud *cloud, double x0, double x1, const struct cloud_line *lines,
                 size_t count, double width) {
  enum { MANY = 1500 };
  double cell = cloud->cell;
  int from = (int)fmax(floor((x0 - cloud->x) / cell), 0);
  int to = (int)fmin(ceil((x1 - cloud->x) / cell), cloud->columns);
  struct slice slice = {.rows = cloud->rows,
                        .across = (float)(to - from),
                        .top = (float)cloud->y,
                        .scale = (float)(1 / cell),
                        .half = (float)(width / 2 / cell)};
  if (to > from && !(count >= MANY && add_many(cloud, from, &slice, lines, count))) {
    add_few(cloud, from, &slice, lines, count);
  }
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
