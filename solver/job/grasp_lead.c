#include "solver/job/grasp_lead.h"

#include <math.h>
#include <string.h>

#include "solver/base/vec3.h"
#include "solver/job/grasp_shape.h"

/* Parts of a leg that are rounding. */
static const double rounding = 1e-9;

int grasp_lead_leg(const struct grasp_pull *pull, double along) {
  int leg = (int)ceil(along * pull->leg_count - rounding) - 1;
  return leg < 0 ? 0 : leg;
}

/* Leads on along a part of a leg. */
static void follow(const struct grasp_leg *leg, double part, struct grasp_lead *lead) {
  double move[3], turn[3];
  for (int i = 0; i < 3; i++) {
    move[i] = part * leg->move[i];
    turn[i] = part * leg->turn[i];
  }
  rigid_pose_move(&lead->pose, move, turn);
  lead->way += vec3_norm(move);
  lead->turned += vec3_norm(turn);
}

/* v by its length; 0 for 0. */
static void direct(const double v[3], double out[3]) {
  double length = vec3_norm(v);
  for (int i = 0; i < 3; i++) {
    out[i] = length > 0 ? v[i] / length : 0;
  }
}

void grasp_lead_at(const struct grasp_spec *spec, const double away[3], double along,
                   struct grasp_lead *lead) {
  const struct grasp_pull *pull = &spec->pull;
  *lead = (struct grasp_lead){.pose = grasp_pose(&spec->object, away)};
  if (pull->leg_count == 0) {
    memcpy(lead->direction, pull->direction, sizeof lead->direction);
    return;
  }
  int last = grasp_lead_leg(pull, along);
  for (int k = 0; k < last; k++) {
    follow(&pull->leg[k], 1, lead);
  }
  follow(&pull->leg[last], along * pull->leg_count - last, lead);
  direct(pull->leg[last].move, lead->direction);
  direct(pull->leg[last].turn, lead->axis);
}
