/* The plots themselves. Each draws a whole canvas from checked inputs (at least one). */
#ifndef PNEULAB_PLOT_DRAW_H
#define PNEULAB_PLOT_DRAW_H

#include "server/plot/canvas.h"
#include "server/plot/plot.h"

/* Most jobs in one overlay: more curves than that cannot be told apart. */
enum { DRAW_OVERLAY_LIMIT = 16 };

/* Bending angle against pressure, with the straight-line fit and the onset of contact. */
enum status draw_angle(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* The centreline in the bending plane at every recorded pressure. */
enum status draw_midline(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);
/* The way of the tip in the bending plane. */
enum status draw_tip(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                     struct error *error);
/* The deformed body from surface.json, coloured by the largest stretch. */
enum status draw_surface(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);
/* Error against element size of a verify job, both logarithmic, with the slope that is due. */
enum status draw_convergence(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error);
/* The computed points of a verify job on the curve of their references. */
enum status draw_curve(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* Bending angle against pressure of several jobs. */
enum status draw_overlay(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);

#endif
