/* A hybrid linear parameter-varying model with its input, as an hlpv job gives it: plain data in SI
 * units.
 *
 * The state is x = [h, v, p]: elongation in m, its rate in m/s, pressure in the chamber in Pa. In
 * the mode i, with the set-point u in Pa,
 *   h' = v
 *   v' = (gamma p - k_i(u) (h - rest_i) - b_i(u) v) / m
 *   p' = alpha_i(u) p + beta_i(u) u. */
#ifndef PNEULAB_JOB_HLPV_H
#define PNEULAB_JOB_HLPV_H

#include <stdbool.h>
#include <stddef.h>

enum {
  HLPV_STATES = 3,
  HLPV_TERMS_MAX = 9, /* coefficients of a polynomial: degree 8 */
  HLPV_MODES_MAX = 8,
  HLPV_TRANSITIONS_MAX = 16,
  HLPV_POINTS_MAX = 10000, /* of a set-point profile */
  HLPV_SAMPLES_MAX = 25000
};

/* Places of the state. */
enum hlpv_quantity { HLPV_H, HLPV_VELOCITY, HLPV_PRESSURE };

/* sum over i of c[i] (u / per)^i, in SI. */
struct hlpv_polynomial {
  int count;
  double per; /* Pa */
  double c[HLPV_TERMS_MAX];
};

struct hlpv_mode {
  char name[164]; /* 40 characters in UTF-8 */
  double rest;    /* m: elongation without force */
  struct hlpv_polynomial stiffness, damping, alpha, beta;
  double from, to; /* set-points for which the coefficients hold, Pa; infinite where not given */
};

/* after = factor before + value. */
struct hlpv_reset {
  double factor, value;
};

/* The switch that is made when x[quantity] passes `level` upwards (direction 1) or downwards (-1)
 * in the mode `from`. */
struct hlpv_transition {
  int from, to;
  enum hlpv_quantity quantity;
  double level;
  int direction;
  struct hlpv_reset reset[HLPV_STATES];
};

enum hlpv_profile { HLPV_HELD, HLPV_LINEAR, HLPV_SINE };

/* The set-point over time. Held: value[i] from time[i] on. Linear: straight between the points,
 * held after the last. Both begin at 0 and times rise. Sine: mean + amplitude sin(2 pi frequency t
 * + phase). */
struct hlpv_input {
  enum hlpv_profile profile;
  size_t count;
  double *time, *value; /* s, Pa; owned */
  double mean, amplitude, frequency, phase;
};

/* Position control: solver/job/hlpv_control.h. */
struct hlpv_control;

struct hlpv_spec {
  double mass;        /* kg */
  double gamma;       /* N/Pa, an area */
  double rest_length; /* m, to which extension ratios refer; 0 when not known */
  int mode_count, transition_count;
  struct hlpv_mode mode[HLPV_MODES_MAX];
  struct hlpv_transition transition[HLPV_TRANSITIONS_MAX];
  int initial_mode;
  double initial[HLPV_STATES];
  struct hlpv_input input;      /* with a control: what its set-point would be at rest */
  struct hlpv_control *control; /* that makes the set-point, or NULL; owned */
  double end;                   /* s */
  double sample_rate;           /* Hz */
  double tolerance;             /* of the integration, relative to the size of each state */
};

void hlpv_input_release(struct hlpv_input *input);
void hlpv_spec_destroy(struct hlpv_spec *spec);

double hlpv_polynomial_value(const struct hlpv_polynomial *polynomial, double set_point);

/* The derivative of the state; the formulas stand at the top of this file. */
void hlpv_derivative(const struct hlpv_spec *spec, int mode, double set_point,
                     const double x[HLPV_STATES], double derivative[HLPV_STATES]);

/* The set-point at a time >= 0; at a step its new value. */
double hlpv_set_point(const struct hlpv_input *input, double time);

/* Elongation at rest in the mode with the pressure at the set-point; not finite where its stiffness
 * vanishes. */
double hlpv_rest(const struct hlpv_spec *spec, int mode, double set_point);

/* Whether the transition is due at once in a state that lies beyond its level, or on it and moving
 * that way. */
bool hlpv_is_crossed(const struct hlpv_spec *spec, const struct hlpv_transition *transition,
                     double set_point, const double x[HLPV_STATES]);

#endif
