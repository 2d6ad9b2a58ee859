/* Hybrid dynamics against the matrix exponential, scalar roots and closed forms. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/hlpv/simulate.h"
#include "tests/physics/hybrid_exact.h"
#include "tests/unit/suite.h"

/* The bistable actuator; %s: stiffness of the compressed mode, input, end and more. */
static const char beast[] =
    "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"60 g\", \"gamma\": \"5.577 N/psi\", "
    "\"rest_length\": \"82 mm\", \"modes\": {"
    "\"compressed\": {\"stiffness\": %s, \"damping\": {\"per\": \"psi\", \"coefficients\": "
    "[\"14 N s/m\", \"0.2 N s/m\"]}, \"alpha\": \"-9 1/s\", \"beta\": {\"per\": \"psi\", "
    "\"coefficients\": [\"8.5 1/s\", \"0.1 1/s\", \"-0.005 1/s\"]}},"
    "\"stretched\": {\"rest\": \"28 mm\", \"stiffness\": \"1840 N/m\", \"damping\": \"4 N s/m\", "
    "\"alpha\": \"-12 1/s\", \"beta\": \"12 1/s\"}},"
    "\"transitions\": [{\"from\": \"compressed\", \"to\": \"stretched\", \"when\": {\"h\": "
    "\"14.06 mm\", \"direction\": \"rising\"}, \"reset\": {\"h\": \"44.7 mm\", \"velocity\": "
    "\"0.1067 m/s\", \"pressure\": \"5.6 psi\"}},"
    "{\"from\": \"stretched\", \"to\": \"compressed\", \"when\": {\"h\": \"27 mm\", "
    "\"direction\": \"falling\"}, \"reset\": {\"h\": \"0 mm\", \"velocity\": \"0 m/s\", "
    "\"pressure\": \"0 psi\"}}]}, \"initial\": {\"mode\": \"compressed\"}, %s}";

static const char constant_stiffness[] = "\"2000 N/m\"";
static const char varying_stiffness[] =
    "{\"per\": \"psi\", \"coefficients\": [\"5557 N/m\", \"-701.5 N/m\"]}";

static void read_beast(const char *stiffness, const char *rest, struct job_spec *spec) {
  char text[4000];
  struct error error;
  snprintf(text, sizeof text, beast, stiffness, rest);
  ck_assert_msg(job_spec_read(text, strlen(text), spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
}

static void simulate(const struct job_spec *spec, struct hlpv_trajectory *trajectory) {
  struct error error = {.status = STATUS_OK};
  struct hlpv_options options = {0};
  ck_assert_msg(hlpv_simulate(spec->hlpv, &options, trajectory, &error) == STATUS_OK, "%s",
                error.message);
}

/* Largest difference of a state over the samples, of its largest value. */
struct deviation {
  double most[HLPV_STATES], largest[HLPV_STATES];
};

static void deviate(struct deviation *deviation, const double x[], const double wanted[]) {
  for (int i = 0; i < HLPV_STATES; i++) {
    deviation->most[i] = fmax(deviation->most[i], fabs(x[i] - wanted[i]));
    deviation->largest[i] = fmax(deviation->largest[i], fabs(wanted[i]));
  }
}

static double worst(const struct deviation *deviation) {
  double most = 0.0;
  for (int i = 0; i < HLPV_STATES; i++) {
    most = fmax(most, deviation->most[i] / deviation->largest[i]);
  }
  return most;
}

/* ---- held set-points ---------------------------------------------------------------------- */

/* Follows the exact solution along the switches of held set-points. */
struct follower {
  const struct hlpv_spec *spec;
  const struct hlpv_trajectory *t;
  int mode;
  double time, x[HLPV_STATES];
  size_t sample, event;
  double event_error;
  struct deviation deviation;
};

static void compare_samples(struct follower *f, const struct exact_input *input, double until) {
  for (; f->sample < f->t->sample_count && f->t->sample[f->sample].time < until; f->sample++) {
    const struct hlpv_sample *sample = &f->t->sample[f->sample];
    double x[HLPV_STATES];
    exact_state(f->spec, f->mode, input, f->x, sample->time - f->time, x);
    ck_assert_int_eq(sample->mode, f->mode);
    deviate(&f->deviation, sample->x, x);
  }
}

static void follow_hold(struct follower *f, double set_point, double end) {
  struct exact_input input = {.u = set_point};
  while (f->time < end) {
    double first = INFINITY, after[HLPV_STATES];
    int index = -1;
    for (int i = 0; i < f->spec->transition_count; i++) {
      const struct hlpv_transition *transition = &f->spec->transition[i];
      double at = transition->from == f->mode
                      ? exact_passage(f->spec, transition, &input, f->x, end - f->time, 2e-3)
                      : INFINITY;
      index = at < first ? i : index;
      first = fmin(first, at);
    }
    double until = fmin(end, f->time + first);
    compare_samples(f, &input, until);
    exact_state(f->spec, f->mode, &input, f->x, until - f->time, after);
    f->time = until;
    if (index >= 0) {
      ck_assert_uint_lt(f->event, f->t->event_count);
      ck_assert_int_eq(f->t->event[f->event].transition, index);
      f->event_error = fmax(f->event_error, fabs(f->t->event[f->event].time - until));
      f->event++;
      for (int i = 0; i < HLPV_STATES; i++) {
        const struct hlpv_reset *reset = &f->spec->transition[index].reset[i];
        after[i] = reset->factor * after[i] + reset->value;
      }
      f->mode = f->spec->transition[index].to;
    }
    memcpy(f->x, after, sizeof f->x);
  }
}

static void follow(const struct hlpv_spec *spec, const struct hlpv_trajectory *t,
                   struct follower *f) {
  *f = (struct follower){.spec = spec, .t = t, .mode = spec->initial_mode};
  memcpy(f->x, spec->initial, sizeof f->x);
  for (size_t i = 0; i < spec->input.count; i++) {
    double end = i + 1 < spec->input.count ? spec->input.time[i + 1] : spec->end;
    follow_hold(f, spec->input.value[i], end);
  }
  ck_assert_uint_eq(f->event, t->event_count);
}

/* 12 times up and back through vacuum, by steps of different height. */
static void vacuum_profile(char *text, size_t size, const char *options) {
  size_t length = (size_t)snprintf(text, size, "\"input\": {\"hold\": [");
  for (int i = 0; i < 12; i++) {
    length += (size_t)snprintf(
        text + length, size - length, "%s[\"%.1f s\", \"%.2f psi\"], [\"%.1f s\", \"%.2f psi\"]",
        i ? ", " : "", 1.6 * i, 5.5 + 0.1 * i, 1.6 * i + 0.9, -1.0 - 0.1 * i);
  }
  snprintf(text + length, size - length, "]}, \"end\": \"19.2 s\", \"sample_rate\": \"47 Hz\"%s",
           options);
}

static const struct {
  const char *options;
  double state, event; /* bounds */
} accuracies[] = {
    {"", 1e-8, 1e-9},
    {", \"tolerance\": 1e-12", 1e-9, 1e-11},
};

START_TEST(held_set_points_follow_the_matrix_exponential) {
  char rest[2000], what[80];
  vacuum_profile(rest, sizeof rest, accuracies[_i].options);
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct follower f;
  read_beast(varying_stiffness, rest, &spec);
  simulate(&spec, &t);
  follow(spec.hlpv, &t, &f);
  ck_assert_uint_eq(t.event_count, 24);
  ck_assert_uint_eq(t.sample_count,
                    f.sample + (t.sample[t.sample_count - 1].time == spec.hlpv->end));
  snprintf(what, sizeof what, "24 switches, tolerance %g", spec.hlpv->tolerance);
  printf("%s: states %.2g of their size, switches %.2g s\n", what, worst(&f.deviation),
         f.event_error);
  ck_assert_double_lt(worst(&f.deviation), accuracies[_i].state);
  ck_assert_double_lt(f.event_error, accuracies[_i].event);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* A lightly damped oscillator: 20 periods and more in each hold. */
START_TEST(a_ringing_mode_follows_the_matrix_exponential) {
  static const char text[] =
      "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"60 g\", \"gamma\": \"0.8 N/kPa\", \"modes\": "
      "{\"a\": {\"stiffness\": \"2400 N/m\", \"damping\": \"0.24 N s/m\", \"alpha\": \"-9 1/s\", "
      "\"beta\": \"9 1/s\"}}}, \"initial\": {\"mode\": \"a\", \"velocity\": \"1 m/s\"}, "
      "\"input\": {\"hold\": [[\"0 s\", \"20 kPa\"], [\"1 s\", \"-30 kPa\"]]}, \"end\": \"2 s\"}";
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct follower f;
  struct error error;
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_OK);
  simulate(&spec, &t);
  follow(spec.hlpv, &t, &f);
  printf("ringing: states %.2g of their size\n", worst(&f.deviation));
  ck_assert_double_lt(worst(&f.deviation), 1e-8);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* Largest speed and settling time of one hold, by looking at the exact motion closely. */
START_TEST(speed_and_settling_are_those_of_the_exact_motion) {
  const double look = 1e-4;
  struct job_spec spec;
  struct hlpv_trajectory t;
  read_beast(constant_stiffness, "\"input\": {\"hold\": [[\"0 s\", \"3 psi\"]]}, \"end\": \"3 s\"",
             &spec);
  simulate(&spec, &t);
  const struct hlpv_hold *hold = &t.hold[0];
  struct exact_input input = {.u = spec.hlpv->input.value[0]};
  double speed = 0.0, settled = 0.0, x[HLPV_STATES];
  exact_state(spec.hlpv, 0, &input, spec.hlpv->initial, 20.0, x);
  double rest = x[HLPV_H];
  for (int i = 1; i < 30000; i++) {
    exact_state(spec.hlpv, 0, &input, spec.hlpv->initial, look * i, x);
    speed = fmax(speed, fabs(x[HLPV_VELOCITY]));
    settled = fabs(x[HLPV_H] - rest) > 0.02 * rest ? look * i : settled;
  }
  printf("peak speed %.9g m/s, settling %.9g s\n", t.peak_speed, hold->settling);
  ck_assert_double_eq_tol(t.peak_speed, speed, 1e-5 * speed);
  ck_assert_double_eq_tol(hold->peak_speed, speed, 1e-5 * speed);
  ck_assert_double_eq_tol(hold->settling, settled, 1.01 * look);
  ck_assert_double_eq_tol(hold->steady_h, rest, 1e-9 * rest);
  ck_assert_double_eq_tol(hold->last[HLPV_H], rest, 1e-6 * rest);
  ck_assert_uint_eq(t.hold_count, 1);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* ---- ramps and sinusoids ------------------------------------------------------------------ */

START_TEST(a_ramp_follows_the_matrix_exponential) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct deviation deviation = {0};
  read_beast(constant_stiffness,
             "\"input\": {\"linear\": [[\"0 s\", \"1 psi\"], [\"2 s\", \"1 psi\"], [\"4 s\", \"4 "
             "psi\"]]}, \"end\": \"5 s\"",
             &spec);
  /* Constant coefficients, which only the matrix exponential asks for. */
  struct hlpv_spec *model = spec.hlpv;
  model->mode[0].damping.count = model->mode[0].beta.count = 1;
  simulate(&spec, &t);
  double x[HLPV_STATES] = {0}, corner[HLPV_STATES];
  for (size_t i = 0, piece = 0; i < t.sample_count; i++) {
    const struct hlpv_input *u = &model->input;
    struct exact_input input = {.u = u->value[piece]};
    if (piece + 1 < u->count) {
      input.slope = (u->value[piece + 1] - u->value[piece]) / (u->time[piece + 1] - u->time[piece]);
    }
    if (piece + 1 < u->count && t.sample[i].time > u->time[piece + 1]) {
      exact_state(model, 0, &input, x, u->time[piece + 1] - u->time[piece], corner);
      memcpy(x, corner, sizeof x);
      piece++;
      i--;
      continue;
    }
    exact_state(model, 0, &input, x, t.sample[i].time - u->time[piece], corner);
    deviate(&deviation, t.sample[i].x, corner);
  }
  printf("ramp: states %.2g of their size\n", worst(&deviation));
  ck_assert_double_lt(worst(&deviation), 1e-8);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

START_TEST(a_sinusoid_follows_the_matrix_exponential) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct deviation deviation = {0};
  read_beast(constant_stiffness,
             "\"input\": {\"sine\": {\"mean\": \"1 psi\", \"amplitude\": \"2 psi\", "
             "\"frequency\": \"3 Hz\", \"phase\": \"40 deg\"}}, \"end\": \"4 s\"",
             &spec);
  spec.hlpv->mode[0].damping.count = spec.hlpv->mode[0].beta.count = 1;
  const struct hlpv_input *u = &spec.hlpv->input;
  struct exact_input input = {.u = u->mean,
                              .amplitude = u->amplitude,
                              .omega = 2.0 * acos(-1.0) * u->frequency,
                              .phase = u->phase};
  simulate(&spec, &t);
  for (size_t i = 0; i < t.sample_count; i++) {
    double x[HLPV_STATES];
    exact_state(spec.hlpv, 0, &input, spec.hlpv->initial, t.sample[i].time, x);
    deviate(&deviation, t.sample[i].x, x);
  }
  printf("sinusoid: states %.2g of their size\n", worst(&deviation));
  ck_assert_double_lt(worst(&deviation), 1e-8);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* With coefficients that vary along a ramp there is no closed form: the solution at a tolerance is
 * compared with that at a thousandth of it. */
static double ramp_difference(double tolerance) {
  char rest[300];
  struct job_spec spec;
  struct hlpv_trajectory coarse, fine;
  struct deviation deviation = {0};
  snprintf(rest, sizeof rest,
           "\"input\": {\"linear\": [[\"0 s\", \"0 psi\"], [\"3 s\", \"6 psi\"], [\"6 s\", \"-2 "
           "psi\"]]}, \"end\": \"6 s\", \"tolerance\": %g",
           tolerance);
  read_beast(varying_stiffness, rest, &spec);
  simulate(&spec, &coarse);
  spec.hlpv->tolerance *= 1e-3;
  simulate(&spec, &fine);
  ck_assert_uint_eq(coarse.event_count, 2);
  ck_assert_uint_eq(fine.event_count, 2);
  for (size_t i = 0; i < fine.sample_count; i++) {
    if (fine.sample[i].mode == coarse.sample[i].mode) {
      deviate(&deviation, coarse.sample[i].x, fine.sample[i].x);
    }
  }
  hlpv_trajectory_release(&coarse);
  hlpv_trajectory_release(&fine);
  job_spec_release(&spec);
  return worst(&deviation);
}

START_TEST(a_smaller_tolerance_is_a_smaller_error) {
  double loose = ramp_difference(1e-6), tight = ramp_difference(1e-9);
  printf("varying coefficients: %.2g at tolerance 1e-6, %.2g at 1e-9\n", loose, tight);
  ck_assert_double_lt(loose, 1e-3);
  ck_assert_double_lt(tight, 1e-5);
  ck_assert_double_lt(tight, 0.05 * loose);
}
END_TEST

/* What the pressure does is stored or lost: d/dt (m v^2/2 + k h^2/2) = gamma p v - b v^2, the right
 * side by Simpson's rule over the samples. */
START_TEST(energy_is_balanced) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  read_beast(constant_stiffness,
             "\"input\": {\"sine\": {\"mean\": \"1 psi\", \"amplitude\": \"2 psi\", "
             "\"frequency\": \"3 Hz\"}}, \"end\": \"2 s\", \"sample_rate\": \"4000 Hz\", "
             "\"tolerance\": 1e-12",
             &spec);
  const struct hlpv_spec *m = spec.hlpv;
  spec.hlpv->mode[0].damping.count = 1;
  double work = 0.0, turned = 0.0;
  simulate(&spec, &t);
  ck_assert_uint_eq(t.sample_count, 8001);
  for (size_t i = 0; i < t.sample_count; i++) {
    double v = t.sample[i].x[HLPV_VELOCITY];
    double power = m->gamma * t.sample[i].x[HLPV_PRESSURE] * v - m->mode[0].damping.c[0] * v * v;
    double weight = i == 0 || i + 1 == t.sample_count ? 1.0 : i % 2 ? 4.0 : 2.0;
    work += weight * power / (3.0 * m->sample_rate);
    turned += weight * fabs(power) / (3.0 * m->sample_rate);
  }
  double stored = 0.5 * m->mass * pow(t.x[HLPV_VELOCITY], 2) +
                  0.5 * m->mode[0].stiffness.c[0] * pow(t.x[HLPV_H], 2);
  printf("energy: stored %.9g J, given %.9g J, turned over %.3g J\n", stored, work, turned);
  ck_assert_double_lt(fabs(stored - work), 1e-9 * turned);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("physics: hybrid dynamics");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 120);
  tcase_add_loop_test(tcase, held_set_points_follow_the_matrix_exponential, 0,
                      sizeof accuracies / sizeof *accuracies);
  tcase_add_test(tcase, a_ringing_mode_follows_the_matrix_exponential);
  tcase_add_test(tcase, speed_and_settling_are_those_of_the_exact_motion);
  tcase_add_test(tcase, a_ramp_follows_the_matrix_exponential);
  tcase_add_test(tcase, a_sinusoid_follows_the_matrix_exponential);
  tcase_add_test(tcase, a_smaller_tolerance_is_a_smaller_error);
  tcase_add_test(tcase, energy_is_balanced);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
