#include "server/plot/plot.h"

#include <string.h>

#include "server/plot/draw.h"

enum { SIDE_MIN = 200, SIDE_MAX = 4000 };

typedef enum status draw_function(struct canvas *, const struct plot_input *, size_t,
                                  struct error *);

struct entry {
  const char *name;
  draw_function *draw;
};

static const struct entry entries[] = {
    {"angle", draw_angle},     {"midline", draw_midline}, {"tip", draw_tip},
    {"surface", draw_surface}, {"overlay", draw_overlay}, {"convergence", draw_convergence},
    {"curve", draw_curve},
};

const char *const *plot_names(const char *kind) {
  static const char *const response[] = {"angle", "midline", "tip", "surface", NULL};
  static const char *const verify[] = {"convergence", "curve", NULL};
  static const char *const none[] = {NULL};
  return !kind                           ? none
         : strcmp(kind, "response") == 0 ? response
         : strcmp(kind, "verify") == 0   ? verify
                                         : none;
}

static draw_function *find(const char *plot) {
  for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
    if (strcmp(entries[i].name, plot) == 0) {
      return entries[i].draw;
    }
  }
  return NULL;
}

/* The file itself says where it comes from; an overlay has no single job to name. */
static enum status encode(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                          unsigned char **png, size_t *size, struct error *error) {
  char ids[128] = "";
  for (size_t i = 0; i < count; i++) {
    size_t used = strlen(ids);
    snprintf(ids + used, sizeof ids - used, "%s%lld", i ? "," : "", inputs[i].job_id);
  }
  const json_t *provenance = json_object_get(inputs[0].result, "provenance");
  const struct canvas_note notes[] = {
      {"Job", ids},
      {"Spec-Hash", count == 1 ? inputs[0].spec_hash : NULL},
      {"Solver-Version", json_string_value(json_object_get(provenance, "version"))},
      {"Software", "PneuLab " PNEULAB_VERSION},
  };
  return canvas_encode(canvas, notes, sizeof notes / sizeof *notes, png, size, error);
}

enum status plot_render(const char *plot, const struct plot_input *inputs, size_t count, int width,
                        int height, unsigned char **png, size_t *size, struct error *error) {
  draw_function *draw = find(plot);
  if (!draw) {
    return error_set(
        error, STATUS_NOT_FOUND, NULL,
        "there is no plot \"%.40s\"; a response has angle, midline, tip and surface, a "
        "verification convergence and curve",
        plot);
  }
  if (count == 0 || count > DRAW_OVERLAY_LIMIT) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%zu jobs cannot be drawn together; 1 to %d can, as in ?jobs=1,2", count,
                     DRAW_OVERLAY_LIMIT);
  }
  if (width < SIDE_MIN || width > SIDE_MAX || height < SIDE_MIN || height > SIDE_MAX) {
    return error_set(error, STATUS_INVALID, NULL,
                     "a picture of %d x %d pixels cannot be drawn; each side may have %d to %d, "
                     "as in 800 x 600",
                     width, height, SIDE_MIN, SIDE_MAX);
  }
  struct canvas *canvas = canvas_create(width, height);
  if (!canvas) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "memory ran out for a picture of %d x %d",
                     width, height);
  }
  enum status status = draw(canvas, inputs, count, error);
  if (status == STATUS_OK) {
    status = encode(canvas, inputs, count, png, size, error);
  }
  canvas_destroy(canvas);
  return status;
}
