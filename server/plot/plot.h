/* Pictures of results, as PNG. Every function is safe to call from several threads at once. */
#ifndef PNEULAB_PLOT_PLOT_H
#define PNEULAB_PLOT_PLOT_H

#include <jansson.h>
#include <stddef.h>
#include "server/plot/sheet.h"
#include "solver/base/error.h"

/* One job to draw. The caller keeps everything alive during plot_render. */
struct plot_input {
  const json_t *result;      /* the result document */
  const char *artifacts_dir; /* folder of the job's files, or NULL */
  const char *title;         /* the job's name in UTF-8 of any length, or NULL */
  long long job_id;          /* 0: unknown, left out */
  const char *spec_hash;     /* written into the file as text, or NULL */
  const char *metric;        /* key of what "metric" and "mesh" show, or NULL: chosen by them */
};

/* Most names of plot_names_for, with the end. */
enum { PLOT_NAMES = 16 };

/* Names of the plots that any result of a kind has, NULL-terminated; for an unknown kind the list
 * is empty. Static storage. "overlay", the plot of several jobs, is not among them. */
const char *const *plot_names(const char *kind);

/* Names of the plots that this result of `kind` has, NULL-terminated: those of plot_names and
 * those that its content allows (a workspace for a study whose tips leave their plane). A body that
 * leaves its plane has "midline3d" and "tip3d" instead of "midline" and "tip". The texts are in
 * static storage. */
void plot_names_for(const char *kind, const json_t *result, const char *names[PLOT_NAMES]);

/* Draws `plot`: one of plot_names_for() from inputs[0], or "overlay" from all inputs.
 * On success *png (allocated with malloc, the caller frees it) holds *size bytes.
 * A result without samples gives a picture that says so.
 * Errors: STATUS_NOT_FOUND (no such plot of this kind, or nothing in this result to draw: the
 * message says which),
 * STATUS_INVALID (size, number of inputs), STATUS_SYNTAX (a damaged artifact),
 * STATUS_TOO_LARGE, STATUS_NO_MEMORY, STATUS_IO. */
enum status plot_render(const char *plot, const struct plot_input *inputs, size_t count,
                        const struct plot_sheet *sheet, unsigned char **png, size_t *size,
                        struct error *error);

#endif
