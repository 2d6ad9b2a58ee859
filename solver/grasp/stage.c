#include "solver/grasp/stage.h"

#include <math.h>

#include "solver/base/vec3.h"

/* Time in which a free object is let go, s. */
static const double letting_go = 0.1;

int stages_plan(const struct finger *f, struct stage out[STAGE_COUNT]) {
  const struct grasp_spec *g = &f->grasp;
  double way = vec3_norm(g->approach.from), longest = g->longest_step;
  int count = 0, steps = f->spec.load.steps;
  if (solve_has_gravity(&f->spec)) {
    out[count++] = (struct stage){STAGE_GRAVITY, 1, 0.5, 1};
  }
  if (way > 0) {
    out[count++] = (struct stage){STAGE_APPROACH, g->approach.steps, fmin(0.25, longest / way),
                                  way / g->approach.rate};
  }
  out[count++] = (struct stage){STAGE_INFLATION, steps, fmin(0.1, 1.0 / steps), g->inflation_time};
  if (f->cups.weight && !g->blocked) {
    out[count++] = (struct stage){STAGE_SUCTION, 4, 0.1, g->inflation_time};
  }
  if (g->object.free) {
    out[count++] = (struct stage){STAGE_LETTING_GO, 4, 0.1, letting_go};
  }
  if (grasp_pulls(g)) { /* pace and longest step: see stage_enter_leg */
    out[count++] = (struct stage){STAGE_PULL, g->pull.steps, 0.1, g->inflation_time};
  }
  if (g->release) {
    out[count++] = (struct stage){STAGE_RELEASE, steps, fmin(0.1, 1.0 / steps), g->inflation_time};
  }
  return count;
}

void stage_enter_leg(struct stage *stage, const struct finger *f, double along) {
  const struct grasp_pull *pull = &f->grasp.pull;
  if (stage->kind != STAGE_PULL || pull->leg_count == 0) {
    return;
  }
  const struct grasp_leg *leg = &pull->leg[grasp_lead_leg(pull, along)];
  double way = vec3_norm(leg->move) + vec3_norm(leg->turn) * f->reach;
  stage->seconds = pull->leg_count * leg->seconds;
  stage->full = fmin(0.1, f->grasp.longest_step / way) / pull->leg_count;
}
