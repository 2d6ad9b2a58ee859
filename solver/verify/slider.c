#include "solver/verify/slider.h"

#include <math.h>

enum { HALVINGS = 8 };

enum status slider_open(struct slider *s, struct verify_body *body, const struct rigid_shape *shape,
                        const struct rigid_pose *pose, double friction,
                        const struct verify_run *run, struct error *error) {
  *s = (struct slider){.body = body, .pose = *pose};
  enum status status = model_add_obstacle(body->model, shape, friction, &s->object, error);
  /* The state has to hold the memory of the object too. */
  state_release(&body->state);
  if (status == STATUS_OK && (state_create(body->model, &body->state) != STATUS_OK ||
                              state_create(body->model, &s->trial) != STATUS_OK)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a state");
  }
  if (status == STATUS_OK) {
    status = equilibrium_create(body->model, &s->solver, error);
  }
  if (status == STATUS_OK) {
    model_place_obstacle(body->model, s->object, pose);
    s->solver->options.deadline_s = run->control.deadline_s;
    s->solver->options.cancelled = run->control.cancelled;
  }
  return status;
}

void slider_close(struct slider *s) {
  equilibrium_destroy(s->solver);
  state_release(&s->trial);
}

enum status slider_step(struct slider *s, const struct rigid_pose *pose) {
  struct fe_model *m = s->body->model;
  int iterations;
  model_place_obstacle(m, s->object, pose);
  state_copy(m, &s->trial, &s->body->state);
  s->solver->factor_fits = false; /* the load is the object's way, which the solver cannot see */
  enum status status =
      equilibrium_solve(s->solver, &s->load, s->load.pressure, &s->trial, &iterations);
  if (status != STATUS_OK) {
    model_reject_obstacles(m);
    return status;
  }
  model_commit_obstacles(m, &s->trial);
  state_copy(m, &s->body->state, &s->trial);
  s->pose = *pose;
  s->now = model_obstacle_state(m, s->object);
  s->steps++;
  return STATUS_OK;
}

enum status slider_move(struct slider *s, const double shift[3], const double turn[3], int steps,
                        struct error *error) {
  const struct rigid_pose start = s->pose;
  double done = 0, step = 1.0 / steps;
  while (done < 1 - 1e-12) {
    double share = fmin(1, done + step), part_shift[3], part_turn[3];
    struct rigid_pose next = start;
    for (int i = 0; i < 3; i++) {
      part_shift[i] = share * shift[i];
      part_turn[i] = share * turn[i];
    }
    rigid_pose_move(&next, part_shift, part_turn);
    enum status status = slider_step(s, &next);
    if (status == STATUS_OK) {
      done = share;
    } else if ((status == STATUS_DIVERGED || status == STATUS_INVERTED ||
                status == STATUS_CONTACT) &&
               step * steps * (1 << HALVINGS) > 1) {
      step *= 0.5;
    } else {
      return verify_failed(status, "the step of the object", error);
    }
  }
  return STATUS_OK;
}
