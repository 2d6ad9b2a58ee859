/* The equations of motion of bistable actuators with a plate, a load and air.
 *
 * Positions: elongation h and, of several actuators, angle theta of the plate, then the junctions
 * between cells. With the elongation e of a cell between its ends, which it pulls together by
 *   T = F(e, p) + damping e' + stops,
 * the generalised forces on the masses follow; see solver/job/bistable.h for the model. The load is
 * either in contact (it moves with the plate, which presses on it by m (h'' + g) >= 0) or free.
 *
 * Air in a chamber: with the absolute pressure P and the volume V, N = P^(1/n) V is the state, and
 *   N' = P^(1/n - 1) P0 conductance (u - p),  P0 = 101.325 kPa:
 * what stays when the valve is closed is then kept exactly, whatever the cells do. The pressure
 * follows from N, as the volume of the cells depends on it. */
#ifndef PNEULAB_BISTABLE_SYSTEM_H
#define PNEULAB_BISTABLE_SYSTEM_H

#include "solver/bistable/law.h"
#include "solver/hlpv/integrator.h"

#define NORMAL_PRESSURE 101325.0

enum {
  SYSTEM_POSITIONS_MAX = BISTABLE_CELLS_MAX + 2,
  SYSTEM_STATES_MAX = 2 * SYSTEM_POSITIONS_MAX + 2 + BISTABLE_ACTUATORS_MAX + 2,
  SYSTEM_ROOTS_MAX = 4 * BISTABLE_CELLS_MAX + 1
};

struct cell {
  const struct cell_spec *spec;
  const struct law *law;
  int actuator;
  int bottom, top; /* positions; -1: ground, -2: plate */
  enum law_side side;
};

enum { END_GROUND = -1, END_PLATE = -2 };

struct bistable_system {
  const struct bistable_spec *spec;
  struct law *law[BISTABLE_LAWS_MAX];
  struct cell cell[BISTABLE_CELLS_MAX];
  bool in_contact;                 /* the load with the plate */
  int positions;                   /* then as many velocities */
  int load;                        /* its position, then its velocity; -1 without */
  int gas[BISTABLE_ACTUATORS_MAX]; /* p or N; -1 for a direct supply */
  int work;                        /* what supplies have put in less what dashpots have taken, J */
  int impulse;                     /* of the plate on the load, N s */
  int states;
  double plate[3]; /* mass, static moment, moment of inertia of what moves with the plate */
  double mass[SYSTEM_POSITIONS_MAX]; /* of the junctions */
  struct set_point set_point[BISTABLE_ACTUATORS_MAX];
  bool is_held; /* the pressures are `held`, whatever supplies and air say */
  double held[BISTABLE_ACTUATORS_MAX];
  double guess[BISTABLE_ACTUATORS_MAX]; /* of the pressures, for the next look */
};

/* What the system does in a state. */
struct bistable_motion {
  double pressure[BISTABLE_ACTUATORS_MAX];
  double acceleration[SYSTEM_POSITIONS_MAX];
  double contact_force;      /* of the plate on the load; 0 when apart */
  double kinetic, potential; /* J; the latter with that of the air in chambers */
};

/* The spec must outlive the system, whose laws system_close releases. STATUS_INVALID for tables
 * that are no law, with the pointer to the law; STATUS_NO_MEMORY. */
enum status system_open(const struct bistable_spec *spec, struct bistable_system *system,
                        struct error *error);
void system_close(struct bistable_system *system);

/* Elongation of a cell and its rate. */
double system_elongation(const struct bistable_system *system, int cell, const double x[]);

/* The law of a cell with its factors, on its side. */
void system_cell(const struct bistable_system *system, int cell, double e, double p,
                 struct law_value *value);
/* law_end, law_limit and law_rest of a cell with its factors. */
double system_end(const struct bistable_system *system, int cell, enum law_side side, double p);
double system_limit(const struct bistable_system *system, int cell, enum law_side side, double p);
double system_rest(const struct bistable_system *system, int cell, enum law_side side, double p,
                   double force);

/* Enclosed volume of an actuator: chamber and cells. */
double system_volume(const struct bistable_system *system, int actuator, const double x[],
                     double p);

/* The state of the air that has the pressure p. */
double system_gas(const struct bistable_system *system, int actuator, const double x[], double p);

/* The pressure of an actuator; NAN where none fits to the air. */
double system_pressure(struct bistable_system *system, int actuator, double time, const double x[]);

/* The derivative of the state. false where a pressure fails. */
bool system_derivative(struct bistable_system *system, double time, const double x[],
                       double rate[]);

/* Accelerations, forces, pressures, energies. false where a pressure fails. */
bool system_motion(struct bistable_system *system, double time, const double x[],
                   struct bistable_motion *motion);

/* Impulse per change of speed of the plate under a force at its middle: its mass, unless the masses
 * lie to one side. */
double system_plate_mass(const struct bistable_system *system);

#endif
