/* The pneu-net of the physics tests: chambers of configuration B, 8 mm long, 2 mm apart. */
#ifndef PNEULAB_TESTS_PHYSICS_PNEUNET_CASE_H
#define PNEULAB_TESTS_PHYSICS_PNEUNET_CASE_H

#include "solver/fe/path.h"
#include "solver/job/spec.h"

enum { CASE_RECORDS = 40 };

/* The sanitizers slow the assembly down several times: tests then do with less. */
#ifdef __SANITIZE_ADDRESS__
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

struct pneunet_case {
  struct job_spec spec;
  struct mesh mesh;
  struct fe_model *model;
  struct equilibrium *solver;
  struct fe_state state;
  /* Recorded states of case_follow: angle in degrees. */
  int records;
  double pressure[CASE_RECORDS], angle[CASE_RECORDS], gap[CASE_RECORDS];
  int factorizations; /* of case_follow */
};

/* Fills the spec of the reference body: 20 mm high, 30 mm wide, tapered sideways by 2 degrees,
 * bottom layer 6 mm, half model, no contact, 50 kPa in ten steps. The mesh is that of the method's
 * first prototype; an empty spec->mesh leaves it to the accuracy, standard. */
void case_prototype(struct job_spec *spec, int chambers);

/* Sets `n` elements through every feature of 2 mm and in proportion elsewhere. */
void case_refine(struct job_spec *spec, int n);

/* Builds mesh, model and solver; fails the test when that is impossible. */
void case_open(struct pneunet_case *c, const struct job_spec *spec);
void case_close(struct pneunet_case *c);

/* Follows the load of the spec from the undeformed state and fills the records; a path that
 * stops early fails the test. */
void case_follow(struct pneunet_case *c);

/* case_open, case_follow and case_close. Returns the last angle. */
double case_angle_of(const struct job_spec *spec);

/* Change of direction of the bottom centreline from the base to the chord under the last
 * chamber, degrees, accumulated from chamber to chamber; positive towards -z. */
double case_angle(const struct mesh *mesh, const double *u);

#endif
