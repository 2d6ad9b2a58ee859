/* What is computed of a bistable bellows: equilibrium paths from state to state, and what they
 * say.
 *
 * The lengths h of this module are elongations from the body as moulded. */
#ifndef PNEULAB_SNAP_STUDY_H
#define PNEULAB_SNAP_STUDY_H

#include <stdio.h>
#include "solver/snap/body.h"

enum { SNAP_PATHS_MAX = 8, SNAP_SENTENCE = 300, SNAP_WARNINGS_MAX = 12, SNAP_EVENTS_MAX = 200 };

struct snap_point {
  double pressure, force, elongation, volume, energy, stiffness; /* as struct axi_state */
  double pet_strain;
  int negative_free, negative_held, inverted;
  bool touching;
};

/* Which load changes along a path. */
enum snap_control { SNAP_BY_PRESSURE, SNAP_BY_FORCE, SNAP_BY_PRESSURE_HELD };

struct snap_path {
  const char *name; /* static */
  enum snap_control control;
  int count, capacity;
  struct snap_point *point;
};

enum snap_event_type {
  SNAP_LIMIT_POINT,
  SNAP_STABLE_STATE,
  SNAP_LOSS_OF_AXISYMMETRY,
  SNAP_TOUCH,
  SNAP_YIELD
};

struct snap_event {
  enum snap_event_type type;
  const char *path;
  double pressure, force, elongation;
  int harmonic; /* of a loss of axisymmetry */
};

/* Negative pivots of the second variation in a state of a path. */
struct snap_waves {
  const char *path;
  double pressure, elongation;
  int inverted;  /* snapping shells that are inside out */
  int *negative; /* from 0 to spec->harmonics_to waves */
};

/* States that are kept. */
enum snap_mark {
  SNAP_NATURAL,    /* as moulded */
  SNAP_COMPRESSED, /* stable without load, all shells inside out */
  SNAP_TRIGGER,    /* highest limit point of the pressure from there with all of them so */
  SNAP_SNAPPED,    /* on the stretched branch at the same pressure */
  SNAP_STRETCHED,  /* at the largest pressure */
  SNAP_RELEASE,    /* deepest limit point under vacuum with none of them so */
  SNAP_MARKS
};

/* A state that is stable without load, with some pairs folded. */
struct snap_stair {
  bool known;
  struct axi_state state;
  double trigger; /* first limit point of the pressure from there; NAN: none */
};

/* NAN where it was not found. SI. */
struct snap_metrics {
  double trigger_pressure, release_pressure;
  double compressed, stretched; /* h at no load, and at extension_at */
  double barrier, return_barrier, released;
  double snap_force, return_force;
  double held_force, force_per_pressure;
  double pet_strain;
  double contact_onset;
  double axisymmetric_to;
  int critical_harmonic; /* -1: none */
  int stable_states;
};

struct snap_study {
  const struct snap_spec *spec;
  struct snap_body body;
  FILE *progress; /* JSON lines, or NULL */
  double deadline_s;
  bool (*cancelled)(void *context);
  struct snap_metrics metrics;
  int path_count, law_count, event_count, warning_count, waves_count, waves_capacity;
  struct snap_path path[SNAP_PATHS_MAX];
  struct snap_path law[SNAP_LAW_MAX];
  struct snap_path held;
  struct snap_event event[SNAP_EVENTS_MAX];
  struct snap_waves *waves;
  char warning[SNAP_WARNINGS_MAX][SNAP_SENTENCE];
  struct axi_state state[SNAP_MARKS];
  bool has[SNAP_MARKS];
  struct snap_stair stair[SNAP_PAIRS_MAX]; /* of a row of pairs: [k] with k + 1 folded */
  long states;                             /* converged ones */
};

/* Opens a study of the job; snap_study_close it, also after a failure. */
enum status snap_study_open(const struct snap_spec *spec, struct snap_study *study,
                            struct error *error);
void snap_study_close(struct snap_study *study);

/* Everything that the job asks for, calibration apart. A path that fails does not keep the others
 * from being computed: returns the first failure, with a sentence that names its path; NO_MEMORY,
 * TIMEOUT and CANCELLED end the study. */
enum status snap_study_run(struct snap_study *study, struct error *error);

/* The compressed state, then only what the metric needs. */
enum status snap_study_metric(struct snap_study *study, const char *metric, double *value,
                              struct error *error);

/* ---- within the study --------------------------------------------------------------------- */

/* A path that is being followed. */
struct snap_walk {
  struct snap_study *study;
  struct snap_path *path;
  /* Whether to go on from this state. */
  bool (*go_on)(struct snap_walk *walk, const struct axi_state *state,
                const struct continuation_point *point);
  void *context;
  double share[2]; /* of the job's progress at its start and end */
  bool quiet;      /* no events, no harmonics */
  bool open;       /* go_on wants more */
  double waves_at; /* arc of the last test of harmonics */
  enum status status;
  struct error *error;
};

/* Follows the ramp, records every state and calls go_on. state: where to start, then the last one.
 * A path that fails is followed anew in other manners: what the study has learnt on it is then
 * forgotten, and go_on sees CONTINUATION_START again. Returns as axi_follow; DIVERGED for a path
 * without an end. */
enum status snap_walk_along(struct snap_walk *walk, const struct axi_ramp *ramp, int direction,
                            int target_count, const double *target, struct axi_state *state);

void snap_path_release(struct snap_path *path);

/* Axial force that is comparable with the pressures of the job, N. */
double snap_force_scale(const struct snap_spec *spec);

/* Whether nothing more can be computed after such an end. */
bool snap_is_final(enum status status);

/* Keeps a copy of a state. STATUS_NO_MEMORY. */
enum status snap_study_keep(struct snap_study *study, enum snap_mark mark,
                            const struct axi_state *state, struct error *error);
void snap_study_event(struct snap_study *study, enum snap_event_type type, const char *path,
                      const struct axi_state *state, int harmonic);
void snap_study_warn(struct snap_study *study, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* A state of the body to work with, a copy of a kept one. */
enum status snap_study_copy(struct snap_study *study, enum snap_mark mark, struct axi_state *state,
                            struct error *error);

enum status snap_find_compressed(struct snap_study *study, struct error *error);
enum status snap_follow_axial(struct snap_study *study, struct error *error);
enum status snap_follow_pressure(struct snap_study *study, struct error *error);
enum status snap_follow_vacuum(struct snap_study *study, struct error *error);
enum status snap_follow_stretched(struct snap_study *study, struct error *error);
enum status snap_follow_held(struct snap_study *study, struct error *error);
/* Keeps a state without load as a stair unless one with as many folded pairs is there; then finds
 * the pressure at which each stair gives way. */
enum status snap_stairs_note(struct snap_study *study, const struct axi_state *state,
                             struct error *error);
enum status snap_follow_stairs(struct snap_study *study, struct error *error);
enum status snap_follow_laws(struct snap_study *study, struct error *error);

/* Tests a state of a path for waves around the circumference. */
enum status snap_test_waves(struct snap_study *study, const char *path,
                            const struct axi_state *state, struct error *error);

#endif
