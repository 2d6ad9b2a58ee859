/* Position control of a hybrid model, as the job gives it: plain data in SI units. */
#ifndef PNEULAB_JOB_HLPV_CONTROL_H
#define PNEULAB_JOB_HLPV_CONTROL_H

#include "solver/job/hlpv.h"

enum { CONTROL_REGIONS_MAX = 64, CONTROL_SAMPLES_MAX = 1000000 };

struct hlpv_control {
  struct hlpv_input reference; /* of the elongation, m */
  double interval;             /* between two samples of the controller, s */
  double lowest, highest;      /* set-points that it may give, Pa */
  int regions;                 /* set-points, evenly between these, for which gains are computed */
  /* Deviations that cost alike: of the elongation in m, and of the set-point in Pa. */
  double weight_h, weight_set_point;
  double integral_time; /* the integral of weight_h over this time costs as much, s */
  double guard_margin;  /* of elongations that are aimed at, to guards, m */
  bool anti_windup;
  double noise_h, noise_pressure; /* standard deviations of what is measured, m, Pa */
  unsigned long seed;             /* of the noise */
  double mass, gamma;             /* that the controller takes for the model's, kg, N/Pa */
};

void hlpv_control_destroy(struct hlpv_control *control);

#endif
