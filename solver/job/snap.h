/* A bistable bellows of conical shells and what is computed of it, as a snap job gives it: plain
 * data in SI units.
 *
 * The meridian is followed upwards along the middle of the wall. Its direction makes an angle with
 * the r axis: pi - a on a snapping shell of base angle a, b on a supporting one. A hinge is an arc
 * between two shells, vertical at its crest. Of the pair k, with arcs of the radii q (below), i
 * (between its shells) and q' (above, that of the next pair),
 *   S cos b = s cos a + (q + i)(1 - sin a) - (i + q')(1 - sin b)
 * relates the slants s and S when the outer crests are equally wide. */
#ifndef PNEULAB_JOB_SNAP_H
#define PNEULAB_JOB_SNAP_H

#include <stdbool.h>
#include "solver/job/spec.h"

enum { SNAP_PAIRS_MAX = 8, SNAP_LAW_MAX = 40 };

enum snap_model { SNAP_SOLID, SNAP_SHELL };

enum snap_ends {
  SNAP_PERIODIC, /* an endless row of these pairs, cut in the middle of supporting shells */
  SNAP_PLATES    /* from the inner crest below one more supporting shell to an outer crest */
};

/* Dimensions as the job gives them, in m, rad and Pa; NAN where it is silent. */
struct snap_given {
  double outer_diameter, wall, hinge_length, hinge_wall;
  double snapping_angle, supporting_angle;
  double snapping_slant, supporting_slant, supporting_pet;
  double pet_thickness, pet_modulus, pet_poisson;
  double angle_factor[SNAP_PAIRS_MAX], slant_factor[SNAP_PAIRS_MAX], pet_factor[SNAP_PAIRS_MAX];
};

/* What a pair comes to. */
struct snap_pair {
  double snapping_angle;
  double snapping_slant, supporting_slant; /* straight parts */
  double pet_thickness;
};

/* The number that a calibration changes until a metric has its target; all in SI. */
struct snap_calibrate {
  bool asked;
  char pointer[40]; /* into the job */
  char metric[40];  /* key of the result's metrics */
  const char *unit; /* in which results give the number: "mm", "deg", "GPa" */
  double unit_si;
  size_t offset; /* of the number in struct snap_given */
  double target, from, to;
};

struct snap_spec {
  enum snap_model model;
  enum snap_ends ends;
  int pair_count;
  struct snap_given given;
  struct snap_pair pair[SNAP_PAIRS_MAX];
  double crest_radius; /* of the middle of the wall at the outer crests */
  double wall, hinge_length, hinge_wall;
  double supporting_angle;
  double mounting_slant;   /* of the additional shell of SNAP_PLATES */
  double supporting_pet;   /* its length from the outer crest; infinite: all of the shells */
  double rest_length;      /* 0: that of the compressed state */
  double pet_yield_strain; /* logarithmic principal strain */
  struct material_spec silicone, pet;
  double pressure_to, vacuum_to, extension_at;
  int law_count;
  double law[SNAP_LAW_MAX]; /* Pa, rising */
  bool contact;
  int harmonics_to; /* 0: no test */
  struct snap_calibrate calibrate;
  enum accuracy accuracy;
  double element_length; /* relative to that of the accuracy; 1 unless a study tries others */
};

/* Radius of the middle line of the hinge between a snapping shell of base angle `snapping` and a
 * supporting one. */
double snap_hinge_radius(const struct snap_spec *spec, double snapping);

/* Fills everything that follows from spec->given, and checks that such a body can exist; the counts
 * and options are set. STATUS_OK, or GEOMETRY with the pointer to the dimension that has to
 * change. */
enum status snap_derive(struct snap_spec *spec, struct error *error);

/* Sets the number that is calibrated and derives what follows. As snap_derive. */
enum status snap_set(struct snap_spec *spec, double value, struct error *error);

#endif
