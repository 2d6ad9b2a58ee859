/* Vibrations of a cantilever of length 1 with shear and rotary inertia. */
#ifndef PNEULAB_VERIFY_TIMOSHENKO_H
#define PNEULAB_VERIFY_TIMOSHENKO_H

struct timoshenko {
  double young, shear; /* moduli, Pa */
  double poisson;
  double density; /* kg/m3 */
  double edge;    /* of the square section, m */
};

/* First angular frequency without shear and rotary inertia (Euler, Bernoulli), 1/s. */
double timoshenko_slender(const struct timoshenko *beam);

/* First angular frequency, 1/s (Timoshenko 1921), with the shear coefficient of a rectangle, 10 (1
 * + nu) / (12 + 11 nu) (Cowper 1966); the equations are integrated, the frequency is found by
 * bisection. */
double timoshenko_frequency(const struct timoshenko *beam);

#endif
