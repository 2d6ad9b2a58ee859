#include <math.h>

#include "server/plot/data.h"
#include "server/plot/draw.h"
#include "server/plot/ladder.h"

/* A run of one step says nothing about what lies between its ends: it gets a marker and no line. */
static size_t add_runs(const struct ladder *ladder, struct chart_series *series) {
  static const char *const names[2] = {"inflating", "deflating"};
  bool named[2] = {false, false};
  size_t count = 0;
  for (size_t i = 0; i < ladder->run_count; i++) {
    const struct ladder_run *run = &ladder->run[i];
    bool single = run->last == run->first + 1;
    for (size_t k = single && i == 0 ? 0 : 1; k < 2; k++) {
      /* The first set-point of all is come to from none. */
      bool falling = k == 0 ? ladder->points[0].x < 0 : run->falling;
      size_t first = k == 0 ? 0 : single ? run->last : run->first;
      series[count++] = (struct chart_series){
          .points = ladder->points + first,
          .count = (k == 0 ? 0 : run->last) - first + 1,
          .colour = colour_series(falling),
          .width = single ? 0 : 2.0,
          .marker = falling ? MARKER_SQUARE : MARKER_CIRCLE,
          .hollow = falling,
          .name = named[falling] ? NULL : names[falling],
      };
      named[falling] = true;
    }
  }
  return count;
}

enum status draw_steady(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error) {
  (void)count;
  const json_t *result = inputs[0].result;
  bool ratio = isfinite(data_number(json_object_get(result, "metrics"), "extension_ratio"));
  struct chart_series series[LADDER_RUNS + 1];
  struct ladder ladder;
  enum status status =
      ladder_read(result, ratio ? "end_extension_ratio" : "end_h_mm", &ladder, error);
  if (status == STATUS_OK) {
    char subtitle[DATA_HEADING], notice[DATA_HEADING];
    data_subtitle(&inputs[0], subtitle);
    data_notice(result, notice);
    struct chart chart = {.title = "Elongation at the end of each held set-point",
                          .subtitle = subtitle,
                          .notice = notice,
                          .x_label = "Set-point (kPa)",
                          .y_label = ratio ? "Extension ratio" : "h (mm)",
                          .series = series,
                          .series_count = add_runs(&ladder, series),
                          .empty = "Fewer than two set-points were held"};
    chart_draw(&chart, canvas);
  }
  ladder_release(&ladder);
  return status;
}
