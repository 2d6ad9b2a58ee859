/* Ranks the members of a study by what is measured at stations along the body.
 *
 * At a station of undeformed arc length s:
 *   bending     turn of the bottom centreline from the base to s, deg, towards -z; its direction is
 *               that of the chord over a twelfth of the body about s, less that of the body at rest
 *   slope       bending / s: the mean angular gradient from the base to s, deg/mm
 *   deflection  displacement towards -z, mm
 * Each measure v is normalised to (v - min) / (max - min), the extremes being those over all
 * members at the station or at all stations; 0 where they agree.
 *   mean       mean over the stations of  w_b bending + w_s slope + w_d deflection
 *   variance   of the slope over the stations, deg2/mm2, normalised over all members
 *   final      mean_weight * mean + (1 - mean_weight) * (1 - normalised variance)
 * The formula is the one printed in "Design Space Exploration and Performance Evaluation of a
 * Multi-Chamber, Multi-Curvature Soft Actuator for Robotic Applications". */
#ifndef PNEULAB_EXPLORE_RANKING_H
#define PNEULAB_EXPLORE_RANKING_H

#include <jansson.h>
#include "solver/job/study.h"

/* Measures of one member at the stations. */
struct ranking_measures {
  double bending[STATIONS_MAX];    /* deg */
  double slope[STATIONS_MAX];      /* deg/mm */
  double deflection[STATIONS_MAX]; /* mm */
};

struct ranking_score {
  double mean;                /* of the weighted score */
  double variance;            /* of the slope, deg2/mm2 */
  double normalised_variance; /* 0 to 1 over the members */
  double final;
  int rank; /* from 1; members that agree to 1e-9 share one */
};

/* Measures a member at `count` stations (m) from `points` of its centreline, rest[3 p] and
 * now[3 p] in mm. False when the body ends before a station or has fewer than two points. */
bool ranking_measure(const double *rest, const double *now, size_t points, const double *station,
                     int count, struct ranking_measures *measures);

/* Scores `count` members, normalised per station or over all stations. */
void ranking_score(const struct study_ranking *ranking, bool by_station,
                   const struct ranking_measures *measures, size_t count,
                   struct ranking_score *scores);

/* The block "ranking" of a study's result, a new reference, from its array "members": those that
 * reached their load, best first. Adds to `warnings` when some are left out. NULL when memory runs
 * out. */
json_t *ranking_document(const struct study_ranking *ranking, const json_t *members,
                         json_t *warnings);

#endif
