#include "server/plot/study_plot.h"

#include <stdio.h>
#include <string.h>

#include "server/plot/study_draw.h"

/* An analysis that a plot is made of. */
enum need {
  NEED_NOTHING,
  NEED_PARETO,
  NEED_IMPORTANCE,
  NEED_EFFECTS,
  NEED_SLICE,
  NEED_LEFT_OUT,
  NEED_RANKING,
  NEED_COUNT
};

struct entry {
  const char *name;
  study_draw *draw;
  enum need need;
};

static const struct entry entries[] = {
    {"curve", study_draw_curve, NEED_NOTHING},
    {"heat-map", study_draw_heat_map, NEED_NOTHING},
    {"contour", study_draw_contour, NEED_SLICE},
    {"parallel", study_draw_parallel, NEED_NOTHING},
    {"scatter", study_draw_scatter, NEED_NOTHING},
    {"pareto", study_draw_pareto, NEED_PARETO},
    {"importance", study_draw_importance, NEED_IMPORTANCE},
    {"effects", study_draw_effects, NEED_EFFECTS},
    {"ranking", study_draw_ranking, NEED_RANKING},
    {"shapes", study_draw_shapes, NEED_NOTHING},
    {"history", study_draw_history, NEED_NOTHING},
    {"surrogate", study_draw_surrogate, NEED_LEFT_OUT},
};

enum { ENTRIES = sizeof entries / sizeof *entries };

const char *const *study_plot_names(void) {
  static const char *const names[ENTRIES + 1] = {"curve",   "heat-map", "contour",    "parallel",
                                                 "scatter", "pareto",   "importance", "effects",
                                                 "ranking", "shapes",   "history",    "surrogate"};
  return names;
}

static const char *missing(enum need need, const struct study_plot_input *input) {
  const struct {
    const void *there;
    const char *what;
  } needs[NEED_COUNT] = {
      [NEED_NOTHING] = {input->table, ""},
      [NEED_PARETO] = {input->pareto,
                       "objectives were not given, as in ?objectives=max:KEY,min:KEY"},
      [NEED_IMPORTANCE] = {input->importance, "the importance of its parameters is not known"},
      [NEED_EFFECTS] = {input->effects, "the effects of its parameters are not known"},
      [NEED_SLICE] = {input->slice, "it has no surrogate of this metric"},
      [NEED_LEFT_OUT] = {input->left_out, "it has no surrogate of this metric"},
      [NEED_RANKING] = {input->ranking, "it has no ranking"},
  };
  return needs[need].there ? NULL : needs[need].what;
}

static enum status find(const char *plot, const struct study_plot_input *input,
                        const struct entry **found, struct error *error) {
  char known[300] = "";
  for (size_t i = 0; i < ENTRIES; i++) {
    size_t used = strlen(known);
    snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", entries[i].name);
    if (strcmp(entries[i].name, plot) == 0) {
      const char *what = missing(entries[i].need, input);
      *found = &entries[i];
      return what ? error_set(error, STATUS_NOT_FOUND, NULL,
                              "there is no plot \"%s\" of this study: %s", plot, what)
                  : STATUS_OK;
    }
  }
  return error_set(error, STATUS_NOT_FOUND, NULL,
                   "there is no plot \"%.40s\" of studies; there may be: %s", plot, known);
}

enum status study_plot_render(const char *plot, const struct study_plot_input *input,
                              const struct study_plot_options *options,
                              const struct plot_sheet *sheet, unsigned char **png, size_t *size,
                              struct error *error) {
  const struct entry *entry = NULL;
  struct canvas *canvas = NULL;
  enum status status = find(plot, input, &entry, error);
  if (status == STATUS_OK) {
    status = plot_sheet_open(sheet, &canvas, error);
  }
  if (status == STATUS_OK) {
    status = entry->draw(canvas, input, options, error);
  }
  if (status == STATUS_OK) {
    char id[32];
    snprintf(id, sizeof id, "%lld", (long long)input->table->study_id);
    const struct canvas_note notes[] = {{"Study", id}, {"Software", "PneuLab " PNEULAB_VERSION}};
    status = canvas_encode(canvas, notes, sizeof notes / sizeof *notes, png, size, error);
  }
  canvas_destroy(canvas);
  return status;
}
