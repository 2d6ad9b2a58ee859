#include "server/plot/study_dots.h"

#include <math.h>

#include "server/plot/cloud.h"
#include "server/plot/series.h"

/* So many dots are drawn one by one. */
enum { DOTS_FEW = 400 };

void study_dots_make(const struct study_table *table, const struct study_axis *by, bool failed,
                     struct study_dots *dots) {
  static const struct point dummy = {0, 0};
  *dots = (struct study_dots){0};
  if (by && by->table) {
    dots->by = *by;
    dots->bar = study_panel_bar(by, colour_map_line, dots->label);
    size_t words = by->column->categorical ? by->column->word_count : 0;
    for (size_t i = 0; i < words && i < STUDY_DOTS_WORDS; i++) {
      bool rest = i + 1 == STUDY_DOTS_WORDS && words > STUDY_DOTS_WORDS;
      dots->key[dots->key_count++] =
          (struct chart_series){.points = &dummy,
                                .count = 1,
                                .colour = rest ? colour_muted : colour_series(i),
                                .marker = MARKER_CIRCLE + (enum chart_marker)(i % 4),
                                .name = rest ? "others" : by->column->words[i]};
    }
  }
  if (failed) {
    struct chart_series cross = study_panel_failed_key(table);
    dots->key[dots->key_count] = cross;
    dots->key_count += cross.name != NULL;
  }
}

/* Which line of the key a row of words belongs to. */
static size_t word_of(const struct study_dots *dots, size_t row) {
  double at = study_axis_at(&dots->by, row);
  return at >= 0 && at < STUDY_DOTS_WORDS ? (size_t)at : STUDY_DOTS_WORDS - 1;
}

struct colour study_dots_colour(const struct study_dots *dots, size_t row) {
  if (!dots->by.table) {
    return colour_series(0);
  }
  if (dots->by.column->categorical) {
    return dots->key[word_of(dots, row)].colour;
  }
  return dots->bar.label ? chart_bar_colour(&dots->bar, study_axis_at(&dots->by, row))
                         : colour_series(0);
}

static void draw_few(const struct study_dots *dots, struct canvas *canvas,
                     const struct frame *frame, const struct study_axis *x,
                     const struct study_axis *y, size_t count) {
  for (size_t row = 0; row < x->table->members; row++) {
    struct point p = {study_axis_at(x, row), study_axis_at(y, row)};
    if (isnan(p.x) || isnan(p.y)) {
      continue;
    }
    bool words = dots->by.table && dots->by.column->categorical;
    struct chart_series series = {.points = &p,
                                  .count = 1,
                                  .colour = study_dots_colour(dots, row),
                                  .marker =
                                      words ? dots->key[word_of(dots, row)].marker : MARKER_CIRCLE,
                                  .small = count > DOTS_FEW / 2};
    series_draw(canvas, frame, &series);
  }
}

enum status study_dots_draw(const struct study_dots *dots, struct canvas *canvas,
                            const struct frame *frame, const struct study_axis *x,
                            const struct study_axis *y, struct error *error) {
  size_t members = x->table->members, count = 0;
  for (size_t row = 0; row < members; row++) {
    count += !isnan(study_axis_at(x, row)) && !isnan(study_axis_at(y, row));
  }
  if (count <= DOTS_FEW) {
    draw_few(dots, canvas, frame, x, y, count);
    return STATUS_OK;
  }
  double radius = fmax(count > 3000 ? 1.5 : 2.2, 1) * canvas->unit;
  struct box area = {frame->area.x - radius, frame->area.y - radius, frame->area.width + 2 * radius,
                     frame->area.height + 2 * radius};
  struct cloud *cloud = cloud_create(canvas, area, false);
  if (!cloud) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture");
  }
  for (size_t row = 0; row < members; row++) {
    struct point p =
        frame_pixel(frame, (struct point){study_axis_at(x, row), study_axis_at(y, row)});
    cloud_dot(cloud, p.x, p.y, radius, colour_rgb(study_dots_colour(dots, row), canvas->theme));
  }
  cloud_paint(cloud, canvas, fmax(cloud_opacity(count), 0.5));
  cloud_destroy(cloud);
  return STATUS_OK;
}
