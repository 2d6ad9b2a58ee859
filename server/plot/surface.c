#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/solid.h"

/* One of the two states. */
static struct solid solid_of(const struct skin *skin, const struct skin_point *points) {
  return (struct solid){points, skin->point_count, (const size_t(*)[4])skin->quads,
                        skin->quad_count, false};
}

/* Values between 0 and 1 for the shades; *bar gets the range. NULL: no memory, or no stretches. */
static double *scale_stretch(const struct skin *skin, struct colour_bar *bar) {
  double *values = skin->stretch ? malloc(skin->point_count * sizeof *values) : NULL;
  if (!values) {
    return NULL;
  }
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < skin->point_count; i++) {
    low = fmin(low, skin->stretch[i]);
    high = fmax(high, skin->stretch[i]);
  }
  high = fmax(high, low + 1e-3);
  for (size_t i = 0; i < skin->point_count; i++) {
    values[i] = (skin->stretch[i] - low) / (high - low);
  }
  *bar = (struct colour_bar){
      .label = "Largest principal stretch", .map = colour_map_area, .min = low, .max = high};
  return values;
}

/* Draws both states into the raster; `values` colours the deformed one. */
static void draw_states(const struct canvas *canvas, const struct skin *skin, const double *values,
                        const struct solid_edge *edges, const struct solid_view *view,
                        struct raster *raster) {
  struct solid rest = solid_of(skin, skin->rest), bent = solid_of(skin, skin->bent);
  struct rgb shades[RASTER_SHADES];
  double line = fmax(canvas->unit * raster->factor, 1.0);
  for (int i = 0; i < RASTER_SHADES; i++) {
    shades[i] = colour_rgb(colour_shade, canvas->theme);
  }
  solid_fill(&rest, NULL, shades, 0.94, view, raster);
  solid_outline(&rest, edges, colour_rgb(colour_edge, canvas->theme), line, view, raster);
  raster_bring_forward(raster);
  for (int i = 0; i < RASTER_SHADES; i++) {
    struct colour shade =
        values ? colour_map_area((i + 0.5) / RASTER_SHADES) : (struct colour){.role = COLOUR_BODY};
    shades[i] = colour_rgb(shade, canvas->theme);
  }
  solid_fill(&bent, values, shades, 0.74, view, raster);
  struct rgb edge = colour_rgb((struct colour){.role = COLOUR_OUTLINE}, canvas->theme);
  solid_outline(&bent, edges, edge, line, view, raster);
}

/* The strip below the body: a bar of round length, and what the grey body is. */
static void draw_scale(struct canvas *canvas, double mm, double left, double y,
                       const struct skin *skin) {
  double u = canvas->unit;
  struct ticks ticks = ticks_make(0, 0.3 * canvas->width / mm, 2);
  double right = left + ticks.step * mm;
  struct text_style style = chart_style_tick();
  style.colour = colour_ink;
  char number[TICKS_TEXT], text[TICKS_TEXT + 40];
  ticks_plain(ticks.step, 3, number);
  snprintf(text, sizeof text, "%s mm", number);
  canvas_set_colour(canvas, colour_ink);
  canvas_line(canvas, left, y, right, y, 2);
  canvas_line(canvas, left, y - 4 * u, left, y + 5 * u, 2);
  canvas_line(canvas, right, y - 4 * u, right, y + 5 * u, 2);
  canvas_text(canvas, right + 8 * u, y, 0, 0.5, text, &style);
  double width, height;
  canvas_measure(canvas, text, &style, &width, &height);
  double key = right + 8 * u + width + 28 * u;
  cairo_rectangle(canvas->cr, key, y - 5 * u, 18 * u, 10 * u);
  canvas_set_colour(canvas, colour_shade);
  cairo_fill_preserve(canvas->cr);
  canvas_set_colour(canvas, colour_edge);
  cairo_set_line_width(canvas->cr, u);
  cairo_stroke(canvas->cr);
  ticks_plain(skin->rest_kPa, 3, number);
  snprintf(text, sizeof text, isfinite(skin->rest_kPa) ? "at %s kPa" : "first state", number);
  canvas_text(canvas, key + 26 * u, y, 0, 0.5, text, &style);
}

static enum status draw_body(struct canvas *canvas, const struct skin *skin, struct box area,
                             struct colour_bar *bar, struct error *error) {
  enum status status = STATUS_OK;
  double *values = scale_stretch(skin, bar);
  struct solid rest = solid_of(skin, skin->rest), bent = solid_of(skin, skin->bent);
  struct solid_edge *edges = solid_edges(&rest);
  double bar_room = chart_bar_room(canvas, bar), strip = 34 * canvas->unit;
  struct raster *raster =
      raster_create((int)(area.width - bar_room), (int)(area.height - strip), 3);
  if (!edges || !raster || (skin->stretch && !values)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while drawing a surface");
    goto done;
  }
  struct solid_view view = solid_view_oblique();
  struct solid_box box = solid_box_empty();
  solid_box_widen(&box, &view, &rest);
  solid_box_widen(&box, &view, &bent);
  solid_view_centre(&view, &box, solid_box_scale(&box, raster), raster);
  draw_states(canvas, skin, values, edges, &view, raster);
  if (!raster_paint(raster, canvas->cr, round(area.x), round(area.y), 1)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out while drawing a surface");
    goto done;
  }
  draw_scale(canvas, view.scale / raster->factor, area.x, area.y + area.height - strip / 2, skin);
  if (bar->label) {
    chart_bar(canvas, bar, area);
  }
done:
  raster_destroy(raster);
  free(edges);
  free(values);
  return status;
}

enum status draw_surface(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error) {
  (void)count;
  struct skin skin = {0};
  struct colour_bar bar = {0};
  enum status status = plot_skin_read(inputs[0].artifacts_dir, &skin, error);
  if (status != STATUS_OK) {
    goto done;
  }
  char title[TICKS_TEXT + 40], number[TICKS_TEXT];
  char subtitle[DATA_HEADING], notice[DATA_HEADING];
  ticks_plain(skin.bent_kPa, 3, number);
  snprintf(title, sizeof title,
           isfinite(skin.bent_kPa) ? "Deformed body at %s kPa" : "Deformed body", number);
  data_subtitle(&inputs[0], subtitle);
  data_notice(inputs[0].result, notice);
  double u = canvas->unit, left = 24 * u;
  double top = chart_heading_height(canvas, subtitle, notice);
  chart_heading(canvas, left, title, subtitle, notice);
  status = draw_body(
      canvas, &skin,
      (struct box){left, top, canvas->width - left - 8 * u, canvas->height - top - 12 * u}, &bar,
      error);
done:
  plot_skin_release(&skin);
  return status;
}
