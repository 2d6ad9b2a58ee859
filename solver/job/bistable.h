/* Bistable actuators in continuous motion, as a bistable job gives them: plain data in SI units.
 *
 * An actuator is a row of cells (frustum pairs) one above the other on a fixed base, filled by one
 * chamber of air. A rigid plate lies on the tops of all actuators. The elongation of the actuator
 * at the offset x is h + x theta, with the elongation h and the angle theta of the plate: exact
 * where the actuators bend into arcs of one angle. Half of the mass of every cell is lumped at
 * either end of it. */
#ifndef PNEULAB_JOB_BISTABLE_H
#define PNEULAB_JOB_BISTABLE_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"
#include "solver/job/hlpv.h"
#include "solver/job/snap.h"

enum {
  BISTABLE_LAWS_MAX = 8,
  BISTABLE_LEVELS_MAX = 40,
  BISTABLE_LEVEL_POINTS_MAX = 4000,
  BISTABLE_COEFFICIENTS_MAX = 10,
  BISTABLE_CELLS_MAX = 24, /* of all actuators */
  BISTABLE_ACTUATORS_MAX = 6,
  BISTABLE_SAMPLES_MAX = 25000
};

/* Equilibria of one cell at one pressure, in the order of the path, that is of its arc length: the
 * elongation need not rise. */
struct law_level {
  double pressure; /* Pa */
  size_t count;
  double *h, *force, *volume; /* m; N, the pull that holds it; m3: one block that h owns */
  double *energy;             /* J, elastic; of the same block, NULL where not known */
};

/* Paths at several pressures, which rise. */
struct law_table {
  int count;
  struct law_level level[BISTABLE_LEVELS_MAX];
};

/* What holds one cell: a table, or force = sum over i of c[i] (h / per)^i - area p with the volume
 * `volume` + area h. */
struct law_spec {
  char name[164];
  char pointer[200]; /* its place in the job, for errors */
  bool is_table;
  struct snap_spec *snap; /* the job that fills the table, which is empty until then; owned, NULL
                           * where there is none */
  struct law_table table;
  int count;
  double per, c[BISTABLE_COEFFICIENTS_MAX];
  double area, volume;
  double from, to; /* elongations between which equilibria are looked for */
};

/* The potential energy of a cell with these factors is stiffness size^3 times that of the law at
 * h / size and p / stiffness: the same body of a stiffer material, and a larger one. */
struct cell_spec {
  int law;
  double stiffness, size;
  double mass, damping;      /* kg, N s/m between its ends */
  bool stretched;            /* at the start */
  double elongation;         /* at the start, NAN: at rest */
  double stop_from, stop_to; /* infinite where there is none */
  double stop_stiffness;
};

enum supply_model { SUPPLY_DIRECT, SUPPLY_LAG, SUPPLY_CHAMBER };

/* How the pressure p follows the set-point u.
 *   direct:  p = u
 *   lag:     p' = (u - p) / time_constant
 *   chamber: air of the absolute pressure P = atmosphere + p in the volume V = dead_volume + that
 * of the cells, with the flow Q = conductance (u - p), as volume at 101.325 kPa: P' V / n + P V' =
 * 101.325 kPa Q, n = exponent. 1 is isothermal, 1.4 adiabatic. */
struct supply_spec {
  enum supply_model model;
  double time_constant;
  double dead_volume, conductance, exponent, atmosphere;
};

struct bistable_actuator {
  double offset;
  int first_cell, cell_count;
  struct supply_spec supply;
  struct hlpv_input input; /* owned */
};

struct bistable_spec {
  int law_count, cell_count, actuator_count;
  struct law_spec law[BISTABLE_LAWS_MAX];
  struct cell_spec cell[BISTABLE_CELLS_MAX];
  struct bistable_actuator actuator[BISTABLE_ACTUATORS_MAX];
  double plate_mass, plate_inertia; /* kg, kg m2 about the offset 0 */
  double bending_stiffness;         /* N m/rad: of all actuators, against the angle of the plate */
  double plate_damping;             /* N s/m: of the plate against the ground */
  double velocity, tilt_rate;       /* at the start */
  double initial_pressure;          /* NAN: the set-point */
  bool has_load;
  double load_mass, load_gap, restitution;
  double gravity;     /* m/s2 against the elongation */
  double rest_length; /* m, to which extension ratios refer; 0 when not known */
  double end, sample_rate, tolerance;
};

void bistable_spec_destroy(struct bistable_spec *spec);

/* Reads the paths in `law`, an array of { "pressure_kPa", "points": [{ "h_mm", "force_N",
 * "volume_mm3", "energy_mJ" (optional) }] } at `pointer`, into *table, which the caller releases in
 * any case. STATUS_INVALID for fewer than two pressures, pressures that do not rise, paths of fewer
 * than eight points, two equal points one after the other, or what is no number. */
enum status law_table_read(const json_t *law, const char *pointer, struct law_table *table,
                           struct error *error);
void law_table_release(struct law_table *table);

#endif
