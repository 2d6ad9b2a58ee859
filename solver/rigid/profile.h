/* From points of a profile to the meridian of a body of revolution. */
#ifndef PNEULAB_RIGID_PROFILE_H
#define PNEULAB_RIGID_PROFILE_H

#include "solver/rigid/meridian.h"

/* The chain of lines and arcs of `count` points (z, r) with its ends closed: rules, checks and
 * messages as rigid_shape_create_revolution says. piece: room for MERIDIAN_PIECES. */
enum status profile_pieces(const double (*point)[2], int count, enum rigid_profile form,
                           double edge, struct meridian_piece *piece, int *pieces,
                           struct error *error);

/* The open smooth curve alone, through points that have been checked one by one and are in the
 * order in which the body is on the right. first: number of the first point in messages, from
 * which they count by `step` (1 or -1). STATUS_INVALID where it turns too far. */
enum status profile_curve(const double (*point)[2], int count, int first, int step,
                          struct meridian_piece *piece, int *pieces, struct error *error);

/* Rounds the corner between piece[at - 1] and piece[at] by an arc of `radius` (m), which is put
 * between them; *count grows by one. False, and nothing changed, when the arc has no room. Where
 * there is no corner, true and nothing changed. */
bool profile_round(struct meridian_piece *piece, int *count, int at, double radius);

#endif
