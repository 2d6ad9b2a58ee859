#include "server/plot/raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLE_LIMIT = 8000000 };

struct raster *raster_create(int width, int height, int finest) {
  struct raster *raster = calloc(1, sizeof *raster);
  if (!raster) {
    return NULL;
  }
  raster->factor = finest;
  while (raster->factor > 1 &&
         (double)width * height * raster->factor * raster->factor > SAMPLE_LIMIT) {
    raster->factor--;
  }
  raster->width = width * raster->factor;
  raster->height = height * raster->factor;
  size_t count = (size_t)raster->width * (size_t)raster->height;
  raster->samples = calloc(count, sizeof *raster->samples);
  raster->depth = malloc(count * sizeof *raster->depth);
  if (!raster->samples || !raster->depth) {
    raster_destroy(raster);
    return NULL;
  }
  raster_bring_forward(raster);
  return raster;
}

void raster_destroy(struct raster *raster) {
  if (!raster) {
    return;
  }
  free(raster->samples);
  free(raster->depth);
  free(raster);
}

void raster_bring_forward(struct raster *raster) {
  size_t count = (size_t)raster->width * (size_t)raster->height;
  for (size_t i = 0; i < count; i++) {
    raster->depth[i] = INFINITY;
  }
}

static uint32_t pack(struct rgb colour, double light) {
  uint32_t r = (uint32_t)(255 * fmin(colour.r * light, 1.0) + 0.5);
  uint32_t g = (uint32_t)(255 * fmin(colour.g * light, 1.0) + 0.5);
  uint32_t b = (uint32_t)(255 * fmin(colour.b * light, 1.0) + 0.5);
  return 0xff000000u | r << 16 | g << 8 | b;
}

static int clamp(double value, int limit) {
  return value < 0 ? 0 : value > limit ? limit : (int)value;
}

void raster_triangle(struct raster *raster, const struct raster_vertex corners[3],
                     const struct rgb shades[RASTER_SHADES], double light) {
  const struct raster_vertex *a = &corners[0], *b = &corners[1], *c = &corners[2];
  double area = (b->x - a->x) * (c->y - a->y) - (c->x - a->x) * (b->y - a->y);
  if (fabs(area) < 1e-9) {
    return;
  }
  int left = clamp(floor(fmin(a->x, fmin(b->x, c->x))), raster->width);
  int right = clamp(ceil(fmax(a->x, fmax(b->x, c->x))), raster->width);
  int top = clamp(floor(fmin(a->y, fmin(b->y, c->y))), raster->height);
  int bottom = clamp(ceil(fmax(a->y, fmax(b->y, c->y))), raster->height);
  /* wb, wc: barycentric weights of b and c, linear in x; a hair of slack closes the seams between
   * neighbours */
  const double slack = -1e-6;
  double wb_x = (c->y - a->y) / area, wb_y = -(c->x - a->x) / area;
  double wc_x = -(b->y - a->y) / area, wc_y = (b->x - a->x) / area;
  for (int y = top; y < bottom; y++) {
    double px = left + 0.5 - a->x, py = y + 0.5 - a->y;
    double wb = px * wb_x + py * wb_y, wc = px * wc_x + py * wc_y;
    size_t i = (size_t)y * (size_t)raster->width + (size_t)left;
    for (int x = left; x < right; x++, i++, wb += wb_x, wc += wc_x) {
      if (wb < slack || wc < slack || wb + wc > 1 - slack) {
        continue;
      }
      float depth = (float)(a->depth + wb * (b->depth - a->depth) + wc * (c->depth - a->depth));
      if (depth < raster->depth[i]) {
        double value = a->value + wb * (b->value - a->value) + wc * (c->value - a->value);
        int shade = clamp(value * RASTER_SHADES, RASTER_SHADES - 1);
        raster->depth[i] = depth;
        raster->samples[i] = shade < raster->lowest ? 0 : pack(shades[shade], light);
      }
    }
  }
}

void raster_line(struct raster *raster, const struct raster_vertex ends[2], struct rgb colour,
                 double width, double bias) {
  double dx = ends[1].x - ends[0].x, dy = ends[1].y - ends[0].y;
  double dd = ends[1].depth - ends[0].depth, half = width / 2 + 0.05;
  int steps = (int)fmin(ceil(fmax(fabs(dx), fabs(dy))), 20000) + 1;
  uint32_t packed = pack(colour, 1.0);
  for (int s = 0; s <= steps; s++) {
    double t = (double)s / steps;
    double x = ends[0].x + t * dx, y = ends[0].y + t * dy, depth = ends[0].depth + t * dd - bias;
    int right = clamp(ceil(x + half), raster->width),
        bottom = clamp(ceil(y + half), raster->height);
    for (int j = clamp(floor(y - half), raster->height); j < bottom; j++) {
      for (int i = clamp(floor(x - half), raster->width); i < right; i++) {
        size_t at = (size_t)j * (size_t)raster->width + (size_t)i;
        double from_x = i + 0.5 - x, from_y = j + 0.5 - y;
        if (from_x * from_x + from_y * from_y <= half * half && depth <= raster->depth[at]) {
          raster->samples[at] = packed;
        }
      }
    }
  }
}

/* Average of one pixel's samples as cairo's premultiplied ARGB. */
static uint32_t average(const struct raster *raster, int px, int py) {
  uint32_t a = 0, r = 0, g = 0, b = 0;
  int f = raster->factor;
  for (int j = 0; j < f; j++) {
    const uint32_t *row =
        raster->samples + (size_t)(py * f + j) * (size_t)raster->width + (size_t)(px * f);
    for (int i = 0; i < f; i++) {
      a += row[i] >> 24;
      r += row[i] >> 16 & 255;
      g += row[i] >> 8 & 255;
      b += row[i] & 255;
    }
  }
  uint32_t n = (uint32_t)(f * f);
  return (a / n) << 24 | (r / n) << 16 | (g / n) << 8 | b / n;
}

int raster_paint(const struct raster *raster, cairo_t *cr, double x, double y, double alpha) {
  int width = raster->width / raster->factor, height = raster->height / raster->factor;
  cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  unsigned char *pixels = cairo_image_surface_get_data(surface);
  if (!pixels) {
    cairo_surface_destroy(surface);
    return 0;
  }
  cairo_surface_flush(surface);
  int stride = cairo_image_surface_get_stride(surface);
  for (int py = 0; py < height; py++) {
    for (int px = 0; px < width; px++) {
      uint32_t pixel = average(raster, px, py);
      memcpy(pixels + (ptrdiff_t)py * stride + 4 * (ptrdiff_t)px, &pixel, sizeof pixel);
    }
  }
  cairo_surface_mark_dirty(surface);
  cairo_set_source_surface(cr, surface, x, y);
  cairo_paint_with_alpha(cr, alpha);
  cairo_surface_destroy(surface);
  return 1;
}
