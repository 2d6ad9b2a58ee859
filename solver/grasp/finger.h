/* One finger and its view of the object: body, solver, motion and ledger. */
#ifndef PNEULAB_GRASP_FINGER_H
#define PNEULAB_GRASP_FINGER_H

#include "solver/fe/dynamics_carry.h"
#include "solver/fe/obstacle.h"
#include "solver/grasp/cups.h"
#include "solver/grasp/loose.h"
#include "solver/grasp/sample.h"
#include "solver/job/grasp.h"
#include "solver/job/grasp_lead.h"
#include "solver/solve.h"

struct finger {
  struct job_spec spec;    /* the job, its load and half_model those of the finger */
  struct grasp_spec grasp; /* in the frame of the finger */
  struct rigid_shape *shape;
  struct solve solve;
  double reach;           /* of the object from the origin of its frame, m */
  int obstacle;           /* number of the object in the model */
  struct grasp_lead lead; /* where the course has led the object, and in which direction */
  struct loose loose;     /* the object once it has been let go */
  struct cups cups;       /* its suckers */
  struct fe_state trial;  /* step that is being tried */
  struct dynamics *dynamics;
  struct motion motion;
  struct energy energy;
  double whole; /* 2 for a half model, else 1: from its resultants to those of the finger */
};

/* Prepares the finger `number` of the job's gripper, with its object where the course begins.
 * half: half of it is computed, which the finger has to allow (finger_symmetric).
 * STATUS_GEOMETRY with place and depth when they overlap there; else the failures of meshing,
 * shapes and models. finger_release is due in either case. job must outlive the finger. */
enum status finger_prepare(const struct job_spec *job, int number, bool half, struct finger *finger,
                           struct error *error);

/* Whether the finger `number` and what it sees are symmetric about its y = 0, and the job does not
 * ask for whole ones. */
bool finger_symmetric(const struct job_spec *job, int number);
void finger_release(struct finger *finger);

/* Fills the numbers of *sample from the finger's state, which was evaluated last and committed; its
 * time, pressure and shift are the caller's. STATUS_OK or NO_MEMORY. */
enum status finger_measure(struct finger *finger, struct grasp_sample *sample);

#endif
