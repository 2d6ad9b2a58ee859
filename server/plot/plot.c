#include "server/plot/plot.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "server/plot/draw.h"
#include "server/plot/offer.h"

typedef enum status draw_function(struct canvas *, const struct plot_input *, size_t,
                                  struct error *);

struct entry {
  const char *name, *kind; /* kind NULL: of several jobs */
  draw_function *draw;
  offer_function *offer; /* NULL: any result of the kind has this plot */
};

static const struct entry entries[] = {
    {"angle", "response", draw_angle, NULL},
    {"midline", "response", draw_midline, NULL},
    {"tip", "response", draw_tip, NULL},
    {"midline3d", "response", draw_midline3d, offer_spatial},
    {"tip3d", "response", draw_tip3d, offer_spatial},
    {"measured", "response", draw_measured, offer_measured},
    {"surface", "response", draw_surface, NULL},
    {"convergence", "verify", draw_convergence, NULL},
    {"curve", "verify", draw_curve, NULL},
    {"curves", "study", draw_curves, offer_curves},
    {"metric", "study", draw_metric, offer_metric},
    {"ranking", "study", draw_ranking, offer_ranking},
    {"workspace", "study", draw_workspace, offer_workspace},
    {"twist", "study", draw_twist, offer_twist},
    {"contraction", "study", draw_contraction, offer_contraction},
    {"mesh", "study", draw_mesh, offer_mesh},
    {"suction", "study", draw_suction, offer_suction},
    {"fit", "fit-material", draw_fit, NULL},
    {"stress", "material-curve", draw_stress, NULL},
    {"time", "hlpv", draw_time, NULL},
    {"phase", "hlpv", draw_phase, NULL},
    {"steady", "hlpv", draw_steady, offer_steady},
    {"control", "hlpv", draw_control, offer_control},
    {"coefficients", "identify", draw_coefficients, NULL},
    {"fitted", "identify", draw_fitted, NULL},
    {"snap-path", "snap", draw_snap_path, NULL},
    {"shapes", "snap", draw_shapes, offer_shapes},
    {"held", "snap", draw_held, offer_held},
    {"stability", "snap", draw_stability, offer_stability},
    {"time", "bistable", draw_motion, NULL},
    {"phase", "bistable", draw_phase, NULL},
    {"snap", "bistable", draw_snap, offer_snap},
    {"motion", "snap", draw_motion, offer_motion},
    {"snap", "snap", draw_snap, offer_snap},
    {"force", "grasp", draw_force, offer_pull},
    {"pressure", "grasp", draw_press, offer_press},
    {"snapshots", "grasp", draw_snapshots, offer_moments},
    {"contact", "grasp", draw_contact_map, offer_moments},
    {"stages", "grasp", draw_stages, NULL},
    {"overlay", NULL, draw_overlay, NULL},
};

enum { ENTRIES = sizeof entries / sizeof *entries };

const char *const *plot_names(const char *kind) {
  static const char *const response[] = {"angle", "midline", "tip", "surface", NULL};
  static const char *const verify[] = {"convergence", "curve", NULL};
  static const char *const study[] = {"curves", NULL};
  static const char *const fit[] = {"fit", NULL};
  static const char *const curve[] = {"stress", NULL};
  static const char *const hlpv[] = {"time", "phase", NULL};
  static const char *const identify[] = {"coefficients", "fitted", NULL};
  static const char *const bistable[] = {"time", "phase", NULL};
  static const char *const snap[] = {"snap-path", NULL};
  static const char *const grasp[] = {"stages", NULL};
  static const char *const none[] = {NULL};
  return !kind                                 ? none
         : strcmp(kind, "response") == 0       ? response
         : strcmp(kind, "verify") == 0         ? verify
         : strcmp(kind, "study") == 0          ? study
         : strcmp(kind, "fit-material") == 0   ? fit
         : strcmp(kind, "material-curve") == 0 ? curve
         : strcmp(kind, "hlpv") == 0           ? hlpv
         : strcmp(kind, "identify") == 0       ? identify
         : strcmp(kind, "bistable") == 0       ? bistable
         : strcmp(kind, "snap") == 0           ? snap
         : strcmp(kind, "grasp") == 0          ? grasp
                                               : none;
}

void plot_names_for(const char *kind, const json_t *result, const char *names[PLOT_NAMES]) {
  static const char *const planar[] = {"midline", "tip"};
  const struct plot_input input = {.result = result};
  bool spatial = offer_spatial(&input) == NULL;
  size_t count = 0;
  for (size_t i = 0; i < ENTRIES; i++) {
    const struct entry *entry = &entries[i];
    bool replaced =
        spatial && (strcmp(entry->name, planar[0]) == 0 || strcmp(entry->name, planar[1]) == 0);
    if (kind && entry->kind && strcmp(entry->kind, kind) == 0 && !replaced &&
        (!entry->offer || !entry->offer(&input)) && count + 1 < PLOT_NAMES) {
      names[count++] = entry->name;
    }
  }
  names[count] = NULL;
}

/* Finds a plot and whether this result has it. */
static enum status find(const char *plot, const struct plot_input *input,
                        const struct entry **found, struct error *error) {
  const char *kind = json_string_value(json_object_get(input->result, "kind"));
  char known[400] = "";
  for (size_t i = 0; i < ENTRIES; i++) {
    const struct entry *entry = &entries[i];
    size_t used = strlen(known);
    if (!kind || !entry->kind || strcmp(entry->kind, kind) == 0) {
      snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", entry->name);
      if (strcmp(entry->name, plot) == 0) {
        const char *reason = entry->offer ? entry->offer(input) : NULL;
        *found = entry;
        return reason ? error_set(error, STATUS_NOT_FOUND, NULL, "there is no plot \"%s\" here: %s",
                                  entry->name, reason)
                      : STATUS_OK;
      }
    }
  }
  return error_set(error, STATUS_NOT_FOUND, NULL,
                   "there is no plot \"%.40s\" of this kind of job; there may be: %s", plot, known);
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

enum status plot_render(const char *plot, const struct plot_input *inputs, size_t count,
                        const struct plot_sheet *sheet, unsigned char **png, size_t *size,
                        struct error *error) {
  const struct entry *entry = NULL;
  if (count == 0 || count > DRAW_OVERLAY_LIMIT) {
    return error_set(error, STATUS_INVALID, NULL,
                     "%zu jobs cannot be drawn together; 1 to %d can, as in ?jobs=1,2", count,
                     DRAW_OVERLAY_LIMIT);
  }
  enum status status = find(plot, inputs, &entry, error);
  if (status != STATUS_OK) {
    return status;
  }
  struct canvas *canvas = NULL;
  status = plot_sheet_open(sheet, &canvas, error);
  if (status != STATUS_OK) {
    return status;
  }
  status = entry->draw(canvas, inputs, count, error);
  if (status == STATUS_OK) {
    status = encode(canvas, inputs, count, png, size, error);
  }
  canvas_destroy(canvas);
  return status;
}
