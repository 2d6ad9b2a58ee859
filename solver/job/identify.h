/* What an identify job asks for: plain data in SI units. */
#ifndef PNEULAB_JOB_IDENTIFY_H
#define PNEULAB_JOB_IDENTIFY_H

#include <stdbool.h>
#include "solver/job/hlpv.h"
#include "solver/job/spec.h"

/* Coefficients of a mode, in this order. */
enum identify_coefficient {
  IDENTIFY_STIFFNESS,
  IDENTIFY_DAMPING,
  IDENTIFY_ALPHA,
  IDENTIFY_BETA,
  IDENTIFY_COEFFICIENTS
};

enum { IDENTIFY_DEGREE_AUTO = -1, IDENTIFY_NAME = 164 /* 40 characters in UTF-8 */ };

struct identify_mode {
  char name[IDENTIFY_NAME];
  double rest; /* m; NAN: to be identified */
};

struct identify_spec {
  struct column_spec trial, time, set_point, h, pressure;
  bool has_trial;     /* whether a column numbers the trials */
  double mass, gamma; /* kg, N/Pa; NAN: not known */
  double rest_length; /* m; 0: not known */
  int mode_count;     /* from short to long */
  struct identify_mode mode[HLPV_MODES_MAX];
  int level_count; /* 0, or one less than modes */
  double level[HLPV_MODES_MAX];
  double transit;  /* s */
  bool free_start; /* the state at the start of a step is identified in any case */
  double noise[2]; /* standard deviations of h in m and p in Pa; 0: from the residuals */
  int degree[IDENTIFY_COEFFICIENTS]; /* IDENTIFY_DEGREE_AUTO: by information criterion */
  double per;                        /* unit of the polynomials' set-point, Pa */
  char per_name[44];
  double tolerance;      /* of the integration */
  double held_out_share; /* of the trials of each set-point; 0 with names in the document */
};

#endif
