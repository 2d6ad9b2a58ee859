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
/* Simulated and measured bending angles, and below them what they differ by. */
enum status draw_measured(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                          struct error *error);
/* The centreline in three views at every recorded pressure. */
enum status draw_midline3d(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error);
/* The way of the tip in three views. */
enum status draw_tip3d(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);

/* Elongation, speed, pressure and set-point of a hybrid model over time, with its modes. */
enum status draw_time(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error);
/* Elongation of plate, cells and load, speed, pressure and bending over time, with the snaps. */
enum status draw_motion(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);
/* The same around the fastest snap. */
enum status draw_snap(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error);
/* Speed against elongation of a hybrid model, with its guards and resets; of cells in motion by how
 * many of them are stretched. */
enum status draw_phase(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* Elongation of a hybrid model under position control with its reference, and its pressures. */
enum status draw_control(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);
/* Elongation of a hybrid model at the end of each held set-point, up and down. */
enum status draw_steady(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);

/* Identified coefficients over the set-points with their intervals, and their polynomials. */
enum status draw_coefficients(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                              struct error *error);
/* Some trials as measured and as simulated, and what the two differ by. */
enum status draw_fitted(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);

/* Equilibrium paths of a bistable actuator: pressure and axial force against elongation. */
enum status draw_snap_path(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error);
/* Its meridian in some states, true to scale. */
enum status draw_shapes(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);
/* The force that holds it at its natural length, against pressure. */
enum status draw_held(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error);
/* The pressure at which each circumferential harmonic loses its stability. */
enum status draw_stability(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error);

/* Bending angle against pressure of the members of a study, with sensitivities and R²; of bistable
 * actuators extension and force, of grasps force against displacement. */
enum status draw_curves(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);
/* Contraction of the reach against pressure of the members of a study. */
enum status draw_contraction(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error);
/* Twist angle against pressure of the members of a study. */
enum status draw_twist(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* One metric of the members against the parameter that varies, with published values. */
enum status draw_metric(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);
/* The best designs of a ranked study and what their scores are made of. */
enum status draw_ranking(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);
/* Positions of the tips of all members in three views, coloured by the row pressures. */
enum status draw_workspace(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error);
/* A metric against the number of unknowns of members that differ in their mesh. */
enum status draw_mesh(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                      struct error *error);
/* Suction force and bending angle against the number of suckers. */
enum status draw_suction(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);

/* A tensile curve and the law through it, with its coefficients. */
enum status draw_fit(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                     struct error *error);
/* Engineering stresses of a material in three deformations against stretch. */
enum status draw_stress(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);

/* Force on a grasped object against its displacement, with peak, mean and what is dynamic. */
enum status draw_force(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* Force on an object, or of a blocked tip, while the pressure rises. */
enum status draw_press(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                       struct error *error);
/* Force, pressure and contact area of a grasp through its stages. */
enum status draw_stages(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                        struct error *error);
/* A grasp at its moments, from moments.bin, coloured by contact pressure. */
enum status draw_snapshots(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                           struct error *error);
/* Contact pressure on the unrolled surface of the body, from moments.bin. */
enum status draw_contact_map(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                             struct error *error);

/* Bending angle against pressure of several jobs; of bistable actuators extension and force, of
 * grasps force against displacement. */
enum status draw_overlay(struct canvas *canvas, const struct plot_input *inputs, size_t count,
                         struct error *error);

#endif
