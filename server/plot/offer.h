/* Which plots a result has something for. Each function returns NULL when the plot can be drawn and
 * otherwise a sentence that says what is missing, in static storage. */
#ifndef PNEULAB_PLOT_OFFER_H
#define PNEULAB_PLOT_OFFER_H

#include "server/plot/plot.h"

typedef const char *offer_function(const struct plot_input *input);

/* A body whose centreline or tip leaves the plane y = 0 by more than a thousandth of a mm. */
const char *offer_spatial(const struct plot_input *input);
/* A response with measured points. */
const char *offer_measured(const struct plot_input *input);

/* A study in which some member has more than metrics, or that has no members yet. */
const char *offer_curves(const struct plot_input *input);
/* A study in which some member has the metric. */
const char *offer_metric(const struct plot_input *input);
/* A hybrid model with two held set-points at least. */
const char *offer_steady(const struct plot_input *input);

/* A snap whose motion was computed. */
const char *offer_motion(const struct plot_input *input);
/* A motion in which a cell snapped. */
const char *offer_snap(const struct plot_input *input);
/* A hybrid model under position control. */
const char *offer_control(const struct plot_input *input);
/* A snap with meridians of some states. */
const char *offer_shapes(const struct plot_input *input);
/* A snap with forces that hold its natural length. */
const char *offer_held(const struct plot_input *input);
/* A snap whose circumferential harmonics were tested. */
const char *offer_stability(const struct plot_input *input);

/* A grasp that was pulled. */
const char *offer_pull(const struct plot_input *input);
/* A grasp whose body pressed on the object while the pressure rose. */
const char *offer_press(const struct plot_input *input);
/* A grasp that left pictures of its moments. */
const char *offer_moments(const struct plot_input *input);

/* A study with a ranking. */
const char *offer_ranking(const struct plot_input *input);
/* A study in which some tip leaves the plane y = 0. */
const char *offer_workspace(const struct plot_input *input);
/* A study in which some member twists by more than a twentieth of a degree. */
const char *offer_twist(const struct plot_input *input);
/* A study whose samples have the contraction. */
const char *offer_contraction(const struct plot_input *input);
/* A study whose parameters all are of the mesh: "/accuracy", or with "mesh" in their pointers, and
 * whose members have two different numbers of unknowns at least. */
const char *offer_mesh(const struct plot_input *input);
/* A study in which some member has a suction force and a number of suckers. */
const char *offer_suction(const struct plot_input *input);

#endif
