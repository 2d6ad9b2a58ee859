/* The law of one cell: the force that holds it, and the volume it encloses, at an elongation and a
 * pressure.
 *
 * Both derive from one potential, so that what the law gives back is what was put in:
 *   Phi(h, p) = W - p V, the least over the inner state of the cell of its elastic energy less p
 *   times its volume,   F = dPhi/dh,   V = -dPhi/dp,   hence dF/dp = -dV/dh (Maxwell).
 *
 * F(h) of a path may snap back: between two turning points h falls along it. The inner state of
 * the cell is then one of two branches, compressed or stretched, each with a force that is a
 * function of h up to its turning point. Beyond it the inside of the cell jumps to the other branch
 * at the same h: the air and the masses outside do not move in that moment, and the difference of
 * the potentials is lost to vibrations within the cell. Smaller folds than that between the
 * branches are stepped over.
 *
 * Of a table the forces along h, and the volumes at the far end of each branch, are taken, and all
 * other volumes follow from the potential: those of the table, and its energies, remain as a check.
 * On a branch with the turning point e(p) and the far end f, h = e + (f - e) q^2 and the force is a
 * cubic spline in q, smooth also where dF/dh is infinite; between pressures the forces at
 * equal q are combined by cubic splines. Beyond the far end forces go on straight, and
 * likewise beyond the pressures of the table. */
#ifndef PNEULAB_BISTABLE_LAW_H
#define PNEULAB_BISTABLE_LAW_H

#include "solver/job/bistable.h"

struct law;

enum law_side { LAW_COMPRESSED, LAW_STRETCHED };

struct law_value {
  double force, volume, potential; /* N, m3, J */
};

/* What the tables say against what derives from the potential: largest difference of the volumes,
 * of the volumes' range, and of the elastic energies, of theirs. NAN where there is no table, or
 * no energies. */
struct law_consistency {
  double volume, energy;
};

/* The spec must outlive the law, which the caller owns. STATUS_INVALID for paths without order (h
 * must rise in sum, by branches that the pressures share); STATUS_NO_MEMORY. */
enum status law_create(const struct law_spec *spec, struct law **law, struct error *error);
void law_destroy(struct law *law);

/* On a single branch the side makes no difference. Past the turning point the force there goes on.
 */
void law_evaluate(const struct law *law, enum law_side side, double h, double p,
                  struct law_value *value);

/* Whether the law has two branches. */
bool law_has_branches(const struct law *law);

/* Where the cell leaves the side: the turning point of the branch; of a single branch the end of
 * its falling stretch, seen from that side. NAN for a law whose force does not fall. */
double law_end(const struct law *law, enum law_side side, double p);

/* Where the side ceases to be stable under a constant force: the first greatest force of the
 * compressed side, the first least one of the stretched side, each from outside. NAN for a law
 * whose force does not fall. */
double law_limit(const struct law *law, enum law_side side, double p);

/* Elongation on the side at which the pull `force` holds the cell, NAN where there is none. The
 * outermost one with a rising force. */
double law_rest(const struct law *law, enum law_side side, double p, double force);

/* The range of the law: elongations and pressures beyond which it is continued. */
void law_range(const struct law *law, double h[2], double p[2]);

struct law_consistency law_check(const struct law *law);

#endif
