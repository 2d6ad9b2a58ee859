/* Switches of hybrid models in the corners of their theory: accumulation, grazing, order. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/hlpv/simulate.h"
#include "tests/unit/suite.h"

/* A mass under a constant force: the pressure stays as it starts. %s: transitions, initial state,
 * input and end. */
static const char free_mass[] =
    "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"1 kg\", \"gamma\": \"1 N/kPa\", \"modes\": "
    "{\"air\": {\"stiffness\": \"0 N/m\", \"damping\": \"0 N s/m\", \"alpha\": \"0 1/s\", "
    "\"beta\": \"0 1/s\"}, \"other\": {\"stiffness\": \"0 N/m\", \"damping\": \"0 N s/m\", "
    "\"alpha\": \"0 1/s\", \"beta\": \"0 1/s\"}}, \"transitions\": %s}, \"initial\": %s, "
    "\"input\": "
    "{\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"%s\"}";

/* The pressure alone moves, at -100 kPa/s in the mode "down" and 100 in "up". */
static const char relay[] =
    "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"1 kg\", \"gamma\": \"1 N/kPa\", \"modes\": "
    "{\"up\": {\"stiffness\": \"1e4 N/m\", \"damping\": \"200 N s/m\", \"alpha\": \"0 1/s\", "
    "\"beta\": \"1 1/s\"}, \"down\": {\"stiffness\": \"1e4 N/m\", \"damping\": \"200 N s/m\", "
    "\"alpha\": \"0 1/s\", \"beta\": \"-1 1/s\"}}, \"transitions\": %s}, \"initial\": %s, "
    "\"input\": {\"hold\": [[\"0 s\", \"100 kPa\"]]}, \"end\": \"%s\"}";

static void read_model(const char *form, const char *transitions, const char *initial,
                       const char *end, struct job_spec *spec) {
  char text[4000];
  struct error error;
  snprintf(text, sizeof text, form, transitions, initial, end);
  ck_assert_msg(job_spec_read(text, strlen(text), spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
}

static enum status run(const struct job_spec *spec, struct hlpv_trajectory *t,
                       struct error *error) {
  struct hlpv_options options = {.deadline_s = clock_wall_s() + 30.0};
  *error = (struct error){.status = STATUS_OK};
  return hlpv_simulate(spec->hlpv, &options, t, error);
}

static bool is_warned(const struct hlpv_trajectory *t, const char *phrase) {
  for (int i = 0; i < t->warning_count; i++) {
    if (strstr(t->warning[i], phrase)) {
      return true;
    }
  }
  return false;
}

/* ---- accumulation ------------------------------------------------------------------------- */

/* Dropped from 1 m at g, a ball that keeps the part e of its speed comes to rest at
 * sqrt(2/g) (1 + e) / (1 - e). */
static const double restitutions[] = {0.5, 0.8, 0.95};

START_TEST(a_bouncing_ball_is_named_zeno) {
  double e = restitutions[_i], g = 9.80665;
  char transitions[300];
  snprintf(transitions, sizeof transitions,
           "[{\"from\": \"air\", \"to\": \"air\", \"when\": {\"h\": \"0 mm\", \"direction\": "
           "\"falling\"}, \"reset\": {\"velocity\": {\"times\": %g}}}]",
           -e);
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(free_mass, transitions,
             "{\"mode\": \"air\", \"h\": \"1 m\", \"pressure\": \"-9.80665 kPa\"}", "100 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_ZENO);
  double rest = sqrt(2.0 / g) * (1.0 + e) / (1.0 - e), told = 0.0;
  const char *before = strstr(error.message, "before ");
  while (before && strstr(before + 1, "before ")) {
    before = strstr(before + 1, "before ");
  }
  ck_assert_ptr_nonnull(before);
  ck_assert_int_eq(sscanf(before, "before %lf s", &told), 1);
  printf("e = %g: %zu bounces, rest at %.9g s, told %.9g s\n", e, t.event_count, rest, told);
  ck_assert_double_eq_tol(told, rest, 1e-6 * rest);
  double when = sqrt(2.0 / g);
  for (size_t i = 0; i < 5; i++) {
    ck_assert_double_eq_tol(t.event[i].time, when, 1e-8);
    when += 2.0 * sqrt(2.0 / g) * pow(e, (double)i + 1.0);
  }
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

START_TEST(guards_that_send_the_state_back_are_named_chattering) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay,
             "[{\"from\": \"up\", \"to\": \"down\", \"when\": {\"pressure\": \"10 kPa\", "
             "\"direction\": \"rising\"}}, {\"from\": \"down\", \"to\": \"up\", \"when\": "
             "{\"pressure\": \"10 kPa\", \"direction\": \"falling\"}}]",
             "{\"mode\": \"up\"}", "1 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_CHATTERING);
  ck_assert_double_eq_tol(t.time, 0.1, 1e-9);
  ck_assert_msg(strstr(error.message, "at 0.1 s") != NULL, "%s", error.message);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* With hysteresis the relay switches regularly: at 100 kPa/s every 0.01 s between 9 and 10 kPa. */
START_TEST(hysteresis_is_no_chattering) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay,
             "[{\"from\": \"up\", \"to\": \"down\", \"when\": {\"pressure\": \"10 kPa\", "
             "\"direction\": \"rising\"}}, {\"from\": \"down\", \"to\": \"up\", \"when\": "
             "{\"pressure\": \"9 kPa\", \"direction\": \"falling\"}}]",
             "{\"mode\": \"up\"}", "1.005 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_eq(t.event_count, 91);
  for (size_t i = 0; i < t.event_count; i++) {
    ck_assert_double_eq_tol(t.event[i].time, 0.1 + 0.01 * (double)i, 1e-9);
  }
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

START_TEST(the_number_of_switches_is_bounded) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay,
             "[{\"from\": \"up\", \"to\": \"up\", \"when\": {\"pressure\": \"1 Pa\", "
             "\"direction\": \"rising\"}, \"reset\": {\"pressure\": \"0 Pa\"}}]",
             "{\"mode\": \"up\"}", "1 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_EVENTS);
  ck_assert_uint_eq(t.event_count, HLPV_EVENTS_MAX);
  ck_assert_double_eq_tol(t.time, 0.1, 1e-7);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* ---- grazing ------------------------------------------------------------------------------ */

/* Thrown up at v against g the mass turns at v^2 / 2g: 50 mm. */
static const struct {
  const char *level;
  size_t switches;
  bool grazing;
} throws[] = {
    {"40 mm", 1, false},
    {"49.999999 mm", 1, true},
    {"50.000001 mm", 0, true},
    {"51 mm", 0, false},
};

START_TEST(a_guard_that_is_only_touched_is_named_grazing) {
  char transitions[300];
  snprintf(transitions, sizeof transitions,
           "[{\"from\": \"air\", \"to\": \"other\", \"when\": {\"h\": \"%s\", \"direction\": "
           "\"rising\"}}]",
           throws[_i].level);
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(free_mass, transitions,
             "{\"mode\": \"air\", \"velocity\": \"1 m/s\", \"pressure\": \"-10 kPa\"}", "0.15 s",
             &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_eq(t.event_count, throws[_i].switches);
  ck_assert_int_eq(is_warned(&t, "grazing"), throws[_i].grazing);
  if (t.event_count > 0) {
    ck_assert_int_eq(t.event[0].grazing, throws[_i].grazing);
  }
  ck_assert_double_eq_tol(t.highest[HLPV_H], 0.05, 1e-9);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* ---- order -------------------------------------------------------------------------------- */

static const char *const rivals[] = {"air", "other"};

/* Two guards at one level: the first of the list wins, whichever it is. */
START_TEST(the_first_of_two_guards_is_taken) {
  char transitions[700];
  static const char form[] = "{\"from\": \"air\", \"to\": \"%s\", \"when\": {\"h\": \"20 mm\", "
                             "\"direction\": \"rising\"}, "
                             "\"reset\": {\"velocity\": \"-1 m/s\"}}";
  char first[300], second[300];
  snprintf(first, sizeof first, form, rivals[_i]);
  snprintf(second, sizeof second, form, rivals[1 - _i]);
  snprintf(transitions, sizeof transitions, "[%s, %s]", first, second);
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(free_mass, transitions, "{\"mode\": \"air\", \"velocity\": \"1 m/s\"}", "0.03 s",
             &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_eq(t.event_count, 1);
  ck_assert_int_eq(t.event[0].transition, 0);
  ck_assert_int_eq(t.mode, _i);
  ck_assert_double_eq_tol(t.event[0].time, 0.02, 1e-10);
  ck_assert_double_eq_tol(t.x[HLPV_H], 0.01, 1e-9);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* A reset that lands beyond a guard of the next mode passes it at the same time. */
START_TEST(a_reset_beyond_a_guard_passes_it_at_once) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(free_mass,
             "[{\"from\": \"air\", \"to\": \"other\", \"when\": {\"h\": \"20 mm\", \"direction\": "
             "\"rising\"}, \"reset\": {\"h\": \"60 mm\"}}, {\"from\": \"other\", \"to\": \"air\", "
             "\"when\": {\"h\": \"50 mm\", \"direction\": \"rising\"}, \"reset\": {\"h\": \"0 "
             "mm\", \"velocity\": \"0 m/s\"}}]",
             "{\"mode\": \"air\", \"velocity\": \"1 m/s\"}", "1 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_eq(t.event_count, 2);
  ck_assert_double_eq(t.event[0].time, t.event[1].time);
  ck_assert_double_eq(t.event[1].before[HLPV_H], 0.06);
  ck_assert_double_eq_tol(t.x[HLPV_H], 0.0, 1e-12);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* A guard that is reached at the very time of a step of the set-point: the switch is made first, in
 * the hold that ends there. The free mass is at h = t at 1 m/s; in the mode that follows the
 * set-point moves the pressure at once, which shows under which one it began. */
START_TEST(a_switch_at_a_corner_comes_before_it) {
  static const char form[] =
      "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"1 kg\", \"gamma\": \"1 N/kPa\", \"modes\": "
      "{\"air\": {\"stiffness\": \"0 N/m\", \"damping\": \"0 N s/m\", \"alpha\": \"0 1/s\", "
      "\"beta\": \"0 1/s\"}, \"other\": {\"stiffness\": \"1 N/m\", \"damping\": \"1 N s/m\", "
      "\"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\", \"range\": [\"0 kPa\", \"50 kPa\"]}}, "
      "\"transitions\": [{\"from\": \"air\", \"to\": \"other\", \"when\": {\"h\": \"%d mm\", "
      "\"direction\": \"rising\"}, \"reset\": {\"velocity\": \"0 m/s\"}}]}, \"initial\": "
      "{\"mode\": "
      "\"air\", \"velocity\": \"1 m/s\"}, \"input\": {\"hold\": [[\"0 s\", \"90 kPa\"], [\"%d "
      "ms\", "
      "\"40 kPa\"]]}, \"end\": \"1 s\"}";
  char text[2000];
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error = {.status = STATUS_OK};
  snprintf(text, sizeof text, form, _i, _i);
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_OK);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_eq(t.event_count, 1);
  ck_assert_double_eq_tol(t.event[0].time, 1e-3 * _i, 1e-12);
  ck_assert_double_le(t.event[0].time, spec.hlpv->input.time[1]);
  ck_assert_int_eq(t.hold[0].switches, 1);
  ck_assert_int_eq(t.hold[1].switches, 0);
  ck_assert_int_eq(t.hold[0].mode, 1);
  /* From then on p = 40 kPa (1 - exp(-t)), and nothing of the 90 kPa before. */
  double span = 1.0 - 1e-3 * _i;
  ck_assert_double_eq_tol(t.x[HLPV_PRESSURE], 40e3 * (1.0 - exp(-span)), 1e-4);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* ---- doubts ------------------------------------------------------------------------------- */

/* What is put in place of a number of the relay, and the warning that it leaves. */
START_TEST(doubtful_models_leave_warnings) {
  static const char *const phrases[] = {"8 psi", "outside the range", "no positive stiffness",
                                        "negative damping"};
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay, "[]", "{\"mode\": \"up\"}", "0.1 s", &spec);
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_int_eq(t.warning_count, 1); /* alpha is 0 */
  ck_assert(is_warned(&t, "does not settle"));
  hlpv_trajectory_release(&t);
  struct hlpv_mode *mode = &spec.hlpv->mode[0];
  if (_i == 0) {
    spec.hlpv->gamma = 5.577e-3; /* per kPa what is meant per psi */
  } else if (_i == 1) {
    mode->to = 99e3;
  } else if (_i == 2) {
    mode->stiffness.c[0] = -1.0;
  } else {
    mode->damping.c[0] = -1.0;
  }
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_int_eq(t.warning_count, 2);
  ck_assert_msg(is_warned(&t, phrases[_i]), "%s", t.warning[0]);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* The whole way from the job: 5.577 N/kPa where N/psi is meant makes 308 N. */
START_TEST(a_mixed_up_unit_of_gamma_is_questioned) {
  static const char form[] =
      "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"60 g\", \"gamma\": \"5.577 N/%s\", \"modes\": "
      "{\"free\": {\"stiffness\": \"2000 N/m\", \"damping\": \"15 N s/m\", \"alpha\": \"-9 1/s\", "
      "\"beta\": \"9 1/s\"}}}, \"initial\": {\"mode\": \"free\"}, \"input\": {\"hold\": [[\"0 s\", "
      "\"3 psi\"]]}, \"end\": \"1 s\"}";
  static const char *const units[] = {"psi", "kPa"};
  for (int i = 0; i < 2; i++) {
    char text[1000];
    struct job_spec spec;
    struct hlpv_trajectory t;
    struct error error;
    snprintf(text, sizeof text, form, units[i]);
    ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_OK);
    ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
    ck_assert_int_eq(t.warning_count, i);
    ck_assert_int_eq(is_warned(&t, "307.6 N at 8 psi"), i);
    hlpv_trajectory_release(&t);
    job_spec_release(&spec);
  }
}
END_TEST

/* Mode, set-point and time, as often as modes are concerned and not more. */
START_TEST(a_set_point_out_of_range_is_named) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay,
             "[{\"from\": \"up\", \"to\": \"down\", \"when\": {\"pressure\": \"10 kPa\", "
             "\"direction\": \"rising\"}}, {\"from\": \"down\", \"to\": \"up\", \"when\": "
             "{\"pressure\": \"0 kPa\", \"direction\": \"falling\"}}]",
             "{\"mode\": \"up\"}", "1 s", &spec);
  spec.hlpv->mode[0].to = 60e3;
  spec.hlpv->mode[0].alpha.c[0] = spec.hlpv->mode[1].alpha.c[0] = -1e-3;
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_uint_ge(t.event_count, 4);
  ck_assert_int_eq(t.warning_count, 1);
  ck_assert_msg(is_warned(&t, "mode \"up\": the set-point 100 kPa, at 0 s, is outside the range"),
                "%s", t.warning[0]);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* ---- endings ------------------------------------------------------------------------------ */

static bool at_once(void *context) {
  (void)context;
  return true;
}

START_TEST(limits_are_respected) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error = {.status = STATUS_OK};
  struct hlpv_options cancelled = {.cancelled = at_once};
  struct hlpv_options late = {.deadline_s = clock_wall_s() - 1.0};
  read_model(free_mass, "[]", "{\"mode\": \"air\", \"velocity\": \"1 m/s\"}", "100 s", &spec);
  ck_assert_int_eq(hlpv_simulate(spec.hlpv, &cancelled, &t, &error), STATUS_CANCELLED);
  ck_assert_uint_ge(t.sample_count, 1);
  hlpv_trajectory_release(&t);
  ck_assert_int_eq(hlpv_simulate(spec.hlpv, &late, &t, &error), STATUS_TIMEOUT);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* Without damping and with k < 0 the mass runs away: the result says which mode did. */
START_TEST(a_state_without_bound_is_named) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay, "[]", "{\"mode\": \"up\", \"h\": \"1 mm\"}", "100 s", &spec);
  spec.hlpv->mode[0].stiffness.c[0] = -1e4;
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_DIVERGED);
  ck_assert_msg(strstr(error.message, "\"up\" is not stable") != NULL, "%s", error.message);
  ck_assert(is_warned(&t, "no positive stiffness"));
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

/* 0.5 us of a period, while the pressure takes 100 s: the speed is 10^9 times that of the latter.
 */
START_TEST(fast_ringing_is_no_instability) {
  struct job_spec spec;
  struct hlpv_trajectory t;
  struct error error;
  read_model(relay, "[]", "{\"mode\": \"up\", \"h\": \"1 mm\"}", "10 us", &spec);
  struct hlpv_mode *mode = &spec.hlpv->mode[0];
  mode->stiffness.c[0] = 1.6e14;
  mode->damping.c[0] = 0.0;
  mode->alpha.c[0] = -0.01;
  ck_assert_int_eq(run(&spec, &t, &error), STATUS_OK);
  ck_assert_double_eq_tol(t.peak_speed, 1e-3 * sqrt(1.6e14), 1.0);
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("physics: switches of hybrid models");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60);
  tcase_add_loop_test(tcase, a_bouncing_ball_is_named_zeno, 0,
                      sizeof restitutions / sizeof *restitutions);
  tcase_add_test(tcase, guards_that_send_the_state_back_are_named_chattering);
  tcase_add_test(tcase, hysteresis_is_no_chattering);
  tcase_add_test(tcase, the_number_of_switches_is_bounded);
  tcase_add_loop_test(tcase, a_guard_that_is_only_touched_is_named_grazing, 0,
                      sizeof throws / sizeof *throws);
  tcase_add_loop_test(tcase, the_first_of_two_guards_is_taken, 0, 2);
  tcase_add_test(tcase, a_reset_beyond_a_guard_passes_it_at_once);
  tcase_add_loop_test(tcase, a_switch_at_a_corner_comes_before_it, 1, 60);
  tcase_add_test(tcase, a_mixed_up_unit_of_gamma_is_questioned);
  tcase_add_test(tcase, a_set_point_out_of_range_is_named);
  tcase_add_loop_test(tcase, doubtful_models_leave_warnings, 0, 4);
  tcase_add_test(tcase, limits_are_respected);
  tcase_add_test(tcase, a_state_without_bound_is_named);
  tcase_add_test(tcase, fast_ringing_is_no_instability);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
