/* Motion of bistable actuators against closed forms. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/bistable/simulate.h"
#include "solver/job/json.h"
#include "tests/physics/fold_law.h"
#include "tests/unit/suite.h"

#define PI 3.14159265358979323846

struct run {
  struct job_spec spec;
  struct bistable_system system;
  struct bistable_trajectory t;
};

/* Simulates the job with these members after its kind. */
static void run_job_text(const char *members, struct run *run) {
  static char text[6000];
  struct error error = {.status = STATUS_OK};
  struct bistable_options options = {0};
  snprintf(text, sizeof text, "{\"kind\": \"bistable\", %s}", members);
  ck_assert_msg(job_spec_read(text, strlen(text), &run->spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  ck_assert_msg(system_open(run->spec.bistable, &run->system, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(bistable_simulate(&run->system, &options, &run->t, &error) == STATUS_OK, "%s",
                error.message);
}

static void release(struct run *run) {
  bistable_trajectory_release(&run->t);
  system_close(&run->system);
  job_spec_release(&run->spec);
}

static const char linear_law[] =
    "\"laws\": {\"spring\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"2 N\"], \"area\": "
    "\"8 cm2\", \"volume\": \"10 ml\"}}";

/* k = 2000 N/m, m = 50 g + 20 g / 2, b = 3 N s/m, 8 N from the pressure. */
START_TEST(a_linear_cell_is_a_damped_oscillator) {
  struct run run;
  char text[2000];
  snprintf(text, sizeof text,
           "%s, \"actuators\": [{\"cells\": [{\"law\": \"spring\", \"mass\": \"20 g\", "
           "\"damping\": \"3 N s/m\", \"elongation\": \"1 mm\"}]}], \"plate\": {\"mass\": \"50 "
           "g\"}, \"input\": {\"hold\": [[\"0 s\", \"10 kPa\"]]}, \"end\": \"0.3 s\", "
           "\"tolerance\": 1e-11",
           linear_law);
  run_job_text(text, &run);
  double m = 0.06, k = 2000.0, b = 3.0, rest = 4e-3, decay = b / (2.0 * m);
  double w = sqrt(k / m - decay * decay), amplitude = 1e-3 - rest;
  ck_assert_uint_eq(run.t.sample_count, 301);
  for (size_t i = 0; i < run.t.sample_count; i++) {
    double s = run.t.sample[i].time;
    double h = rest + amplitude * exp(-decay * s) * (cos(w * s) + decay / w * sin(w * s));
    ck_assert_double_eq_tol(run.t.sample[i].x[0], h, 1e-8 * 4e-3 * 10.0);
  }
  ck_assert_double_lt(run.t.balance_error, 1e-8);
  release(&run);
}
END_TEST

/* U = a (h^4/4 - (h1 + h2) h^3/3 + h1 h2 h^2/2) with a = 1 N/mm3, h1 = 3, h2 = 7 mm. */
START_TEST(a_double_well_keeps_its_energy) {
  struct run run;
  run_job_text("\"laws\": {\"well\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"21 N\", \"-10 "
               "N\", \"1 N\"]}}, \"actuators\": [{\"cells\": [{\"law\": \"well\", \"mass\": \"40 "
               "g\", \"elongation\": \"3.001 mm\"}]}], \"plate\": {\"mass\": \"30 g\"}, \"input\": "
               "{\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"1 s\", \"tolerance\": 1e-12",
               &run);
  double h = 3.001, lost = (h * h * h * h - 7.0 * 7.0 * 7.0 * 7.0) / 4.0 -
                           10.0 * (h * h * h - 343.0) / 3.0 + 21.0 * (h * h - 49.0) / 2.0;
  double speed = sqrt(2.0 * 1e-3 * lost / 0.05);
  ck_assert_double_eq_tol(run.t.peak_speed, speed, 1e-5 * speed);
  ck_assert_double_lt(run.t.balance_error, 1e-7 * 1e-3 * lost);
  ck_assert_double_eq_tol(run.t.lowest_h, 3.001e-3, 1e-7);
  ck_assert_uint_eq(run.t.event_count, 1); /* it never goes back over the barrier */
  ck_assert_double_eq_tol(run.t.event[0].peak_speed, speed, 1e-5 * speed);
  release(&run);
}
END_TEST

/* Mean time between passages of the plate through its first place upwards. */
static double period(const struct bistable_trajectory *t, double middle, int angle) {
  double first = NAN, last = NAN;
  int count = -1;
  for (size_t i = 1; i < t->sample_count; i++) {
    double a = t->sample[i - 1].x[angle] - middle, b = t->sample[i].x[angle] - middle;
    if (a < 0.0 && b >= 0.0) {
      double at = t->sample[i - 1].time + (t->sample[i].time - t->sample[i - 1].time) * a / (a - b);
      first = isnan(first) ? at : first;
      last = at;
      count++;
    }
  }
  return (last - first) / count;
}

/* Closed air stiffens: w = sqrt((k + n P A^2 / V) / m). */
START_TEST(closed_air_is_a_spring) {
  static const double exponents[] = {1.0, 1.2, 1.4};
  struct run run;
  char text[2000];
  double n = exponents[_i];
  snprintf(text, sizeof text,
           "%s, \"actuators\": [{\"cells\": [{\"law\": \"spring\", \"mass\": \"20 g\"}]}], "
           "\"plate\": {\"mass\": \"50 g\"}, \"pneumatics\": {\"supply\": \"chamber\", "
           "\"dead_volume\": \"15 ml\", \"conductance\": \"0 ml/s/kPa\", \"exponent\": %.1f, "
           "\"atmosphere\": \"90 kPa\"}, \"input\": {\"hold\": [[\"0 s\", \"20 kPa\"]]}, "
           "\"initial\": {\"velocity\": \"0.2 mm/s\"}, \"end\": \"0.5 s\", \"sample_rate\": \"40 "
           "kHz\", \"tolerance\": 1e-13",
           linear_law, n);
  run_job_text(text, &run);
  double area = 8e-4, rest = area * 20e3 / 2000.0, volume = 25e-6 + area * rest;
  double w = sqrt((2000.0 + n * 110e3 * area * area / volume) / 0.06);
  ck_assert_double_eq_tol(run.t.start[0], rest, 1e-12);
  ck_assert_double_eq_tol(2.0 * PI / period(&run.t, rest, 0), w, 2e-6 * w);
  release(&run);
}
END_TEST

/* p = u (1 - exp(-t / tau)), tau = V / (n P0 C); of the lag it is given. */
START_TEST(a_rigid_chamber_fills_exponentially) {
  static const char *const supplies[] = {
      "{\"supply\": \"chamber\", \"dead_volume\": \"90 ml\", \"conductance\": \"5 ml/s/kPa\", "
      "\"exponent\": 1}",
      "{\"supply\": \"chamber\", \"dead_volume\": \"90 ml\", \"conductance\": \"5 ml/s/kPa\", "
      "\"exponent\": 1.4}",
      "{\"supply\": \"lag\", \"time_constant\": \"0.11 s\"}"};
  const double constants[] = {1e-4 / (101325.0 * 5e-9), 1e-4 / (1.4 * 101325.0 * 5e-9), 0.11};
  struct run run;
  char text[2000];
  snprintf(text, sizeof text,
           "\"laws\": {\"rigid\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"1000 N\"], "
           "\"volume\": \"10 ml\"}}, \"actuators\": [{\"cells\": [{\"law\": \"rigid\", \"mass\": "
           "\"20 g\"}]}], \"plate\": {\"mass\": \"50 g\"}, \"pneumatics\": %s, \"initial\": "
           "{\"pressure\": \"-5 kPa\"}, \"input\": {\"hold\": [[\"0 s\", \"40 kPa\"]]}, \"end\": "
           "\"1 s\", \"tolerance\": 1e-11",
           supplies[_i]);
  run_job_text(text, &run);
  for (size_t i = 0; i < run.t.sample_count; i++) {
    double p = 40e3 - 45e3 * exp(-run.t.sample[i].time / constants[_i]);
    ck_assert_double_eq_tol(run.t.sample[i].motion.pressure[0], p, 1e-3);
  }
  release(&run);
}
END_TEST

static const char pair_of_springs[] =
    "%s, \"actuators\": [{\"offset\": \"-25 mm\", \"cells\": [{\"law\": \"spring\", \"mass\": \"20 "
    "g\", \"damping\": \"%s\" %s}]}, {\"offset\": \"25 mm\", \"cells\": [{\"law\": \"spring\", "
    "\"mass\": \"20 g\", \"damping\": \"%s\" %s}]%s}], \"plate\": {\"mass\": \"50 g\", "
    "\"inertia\": \"2e-5 kg m2\"}, \"input\": {\"hold\": [[\"0 s\", \"10 kPa\"]]}, \"initial\": "
    "{\"pressure\": \"0 kPa\"}, \"sample_rate\": \"20 kHz\", \"end\": \"0.5 s\", \"tolerance\": "
    "1e-12";

START_TEST(equal_actuators_do_not_tilt_the_plate) {
  struct run run;
  char text[3000];
  snprintf(text, sizeof text, pair_of_springs, linear_law, "0 N s/m", "", "0 N s/m", "", "");
  run_job_text(text, &run);
  double w = sqrt(2.0 * 2000.0 / 0.07);
  ck_assert_double_eq_tol(run.t.highest_tilt, 0.0, 1e-12);
  ck_assert_double_eq_tol(run.t.lowest_tilt, 0.0, 1e-12);
  ck_assert_double_eq_tol(2.0 * PI / period(&run.t, 4e-3, 0), w, 1e-5 * w);
  release(&run);
}
END_TEST

START_TEST(opposite_elongations_only_tilt_it) {
  struct run run;
  char text[3000];
  snprintf(text, sizeof text, pair_of_springs, linear_law, "0 N s/m", ", \"elongation\": \"-1 mm\"",
           "0 N s/m", ", \"elongation\": \"1 mm\"", "");
  run_job_text(text, &run);
  /* both actuators push alike: h moves as above, and independently of it the plate turns */
  double w = sqrt(2.0 * 2000.0 * 0.025 * 0.025 / (2e-5 + 2.0 * 0.01 * 0.025 * 0.025));
  ck_assert_double_eq_tol(run.t.sample[0].x[1], 1e-3 / 0.025, 1e-15);
  ck_assert_double_eq_tol(2.0 * PI / period(&run.t, 0.0, 1), w, 1e-5 * w);
  ck_assert_double_eq_tol(run.t.highest_tilt, 0.04, 1e-7);
  release(&run);
}
END_TEST

/* One of two actuators inflated: at rest it is longer by A p / k, the other as it was. */
START_TEST(one_side_bends) {
  struct run run;
  char text[3000];
  snprintf(text, sizeof text, pair_of_springs, linear_law, "40 N s/m", "", "40 N s/m", "",
           ", \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}");
  run_job_text(text, &run);
  ck_assert_double_eq_tol(run.t.x[0], 2e-3, 1e-9);
  ck_assert_double_eq_tol(run.t.x[1], -4e-3 / 0.05, 1e-8);
  release(&run);
}
END_TEST

/* Without inertia worth it, b x' = A (p - p*) + f''/2 (x - x*)^2 near the limit point: under p - p*
 * = r t the state leaves it at t = 2.33811 (f'' A r / (2 b^2))^(-1/3), 2.33811 the first zero of
 * Airy's function (the delay of a saddle-node bifurcation). */
START_TEST(a_slow_ramp_passes_the_limit_point_late) {
  struct run run;
  run_job_text("\"laws\": {\"well\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"21 N\", \"-10 "
               "N\", \"1 N\"], \"area\": \"8 cm2\"}}, \"actuators\": [{\"cells\": [{\"law\": "
               "\"well\", \"mass\": \"0.02 g\", \"damping\": \"200 N s/m\"}]}], \"plate\": "
               "{\"mass\": \"0.01 g\"}, \"input\": {\"linear\": [[\"0 s\", \"0 kPa\"], [\"100 s\", "
               "\"50 kPa\"]]}, \"end\": \"50 s\", \"sample_rate\": \"10 Hz\"",
               &run);
  double x = (20.0 - sqrt(400.0 - 252.0)) / 6.0;               /* mm */
  double limit = x * (x - 3.0) * (x - 7.0);                    /* N */
  double bend = (20.0 - 6.0 * x) * 1e6;                        /* N/m2 */
  double rate = 8e-4 * 500.0, start = limit / rate, b = 200.0; /* N/s, s */
  double delay = 2.33811 / cbrt(0.5 * bend * rate / (b * b));
  ck_assert_uint_eq(run.t.event_count, 1);
  ck_assert_double_eq_tol(run.t.event[0].time - start, delay, 0.05 * delay);
  ck_assert_double_lt(run.t.event[0].trigger_time - start, 0.5 * delay);
  ck_assert_double_gt(run.t.event[0].trigger_time, start);
  release(&run);
}
END_TEST

/* A cell in a row of n equal ones takes an n-th of the way; n springs and masses have the known
 * lowest frequency of a rod in lumps: 2 sqrt(k/m) sin(pi / (4 n)) with half a mass on top. */
START_TEST(cells_in_a_row_are_a_chain) {
  struct run run;
  char text[2000];
  snprintf(text, sizeof text,
           "%s, \"actuators\": [{\"cells\": [{\"law\": \"spring\", \"count\": 4, \"mass\": \"20 "
           "g\"}]}], \"plate\": {\"mass\": \"1e-9 kg\"}, \"input\": {\"hold\": [[\"0 s\", \"10 "
           "kPa\"]]}, \"end\": \"0.1 s\", \"sample_rate\": \"200 kHz\", \"tolerance\": 1e-11",
           linear_law);
  run_job_text(text, &run);
  ck_assert_double_eq_tol(run.t.x[0], 16e-3, 1e-9);
  release(&run);
  /* along the lowest mode, sin((2 i + 1) ...): all samples stay in it */
  double e[4];
  for (int i = 0; i < 4; i++) {
    e[i] = sin((i + 1) * PI / 8.0) - sin(i * PI / 8.0);
  }
  snprintf(text, sizeof text,
           "%s, \"actuators\": [{\"cells\": [{\"law\": \"spring\", \"mass\": \"20 g\", "
           "\"elongation\": \"%.15g mm\"}, {\"law\": \"spring\", \"mass\": \"20 g\", "
           "\"elongation\": \"%.15g mm\"}, {\"law\": \"spring\", \"mass\": \"20 g\", "
           "\"elongation\": \"%.15g mm\"}, {\"law\": \"spring\", \"mass\": \"20 g\", "
           "\"elongation\": \"%.15g mm\"}]}], \"plate\": {\"mass\": \"1e-9 kg\"}, \"input\": "
           "{\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"0.1 s\", \"tolerance\": 1e-11",
           linear_law, e[0], e[1], e[2], e[3]);
  run_job_text(text, &run);
  double w = 2.0 * sqrt(2000.0 / 0.02) * sin(PI / 16.0);
  for (size_t i = 0; i < run.t.sample_count; i++) {
    ck_assert_double_eq_tol(run.t.sample[i].x[0], 1e-3 * cos(w * run.t.sample[i].time), 1e-8);
  }
  release(&run);
}
END_TEST

/* ---- laws that snap back ------------------------------------------------------------------ */

/* The text of a table of the folding pair. */
static char *table_text(void) {
  static const double levels[] = {-40e3, -20e3, 0.0, 20e3, 40e3, 60e3};
  struct law_table table;
  fold_table(&fold_pair, 6, levels, 120, -2.5e-3, 13e-3, &table);
  size_t room = 200000, used = 0;
  char *text = malloc(room);
  used += (size_t)snprintf(text + used, room - used, "[");
  for (int k = 0; k < table.count; k++) {
    const struct law_level *level = &table.level[k];
    used += (size_t)snprintf(text + used, room - used, "%s{\"pressure_kPa\": %.3f, \"points\": [",
                             k ? "," : "", 1e-3 * level->pressure);
    for (size_t i = 0; i < level->count; i++) {
      used += (size_t)snprintf(text + used, room - used,
                               "%s{\"h_mm\": %.12g, \"force_N\": %.12g, \"volume_mm3\": %.12g, "
                               "\"energy_mJ\": %.12g}",
                               i ? "," : "", 1e3 * level->h[i], level->force[i],
                               1e9 * level->volume[i], 1e3 * level->energy[i]);
    }
    used += (size_t)snprintf(text + used, room - used, "]}");
  }
  snprintf(text + used, room - used, "]");
  law_table_release(&table);
  return text;
}

static void run_table(const char *rest, struct run *run) {
  struct error error = {.status = STATUS_OK};
  struct bistable_options options = {0};
  char *table = table_text(), *text = malloc(220000);
  snprintf(text, 220000, "{\"kind\": \"bistable\", \"laws\": {\"pair\": {\"table\": %s}}, %s}",
           table, rest);
  ck_assert_msg(job_spec_read(text, strlen(text), &run->spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  ck_assert_msg(system_open(run->spec.bistable, &run->system, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(bistable_simulate(&run->system, &options, &run->t, &error) == STATUS_OK, "%s",
                error.message);
  free(table);
  free(text);
}

/* At a held pressure, without damping: what the jump loses is the difference of the potentials at
 * the turning point, and the peak speed follows from the energies. */
START_TEST(a_jump_loses_the_difference_of_the_potentials) {
  struct run run;
  run_table("\"actuators\": [{\"cells\": [{\"law\": \"pair\", \"mass\": \"20 g\"}]}], \"plate\": "
            "{\"mass\": \"40 g\"}, \"input\": {\"hold\": [[\"0 s\", \"40 kPa\"]]}, \"initial\": "
            "{\"pressure\": \"0 kPa\"}, \"end\": \"0.1 s\", \"tolerance\": 1e-11",
            &run);
  const struct fold *f = &fold_pair;
  double p = 40e3, end = fold_end(f, 0, p), start[4], before[4], after[4], least = INFINITY;
  fold_state(f, 0.0, 0.0, start);
  fold_state(f, fold_inner(f, 0, end, p), p, before);
  fold_state(f, fold_inner(f, 1, end, p), p, after);
  double lost = before[3] - after[3] - p * (before[2] - after[2]);
  ck_assert_uint_ge(run.t.event_count, 1);
  ck_assert_int_eq(run.t.event[0].type, EVENT_SNAP);
  ck_assert_double_eq_tol(run.t.event[0].h, end, 3e-6);
  ck_assert_double_gt(lost, 1e-4);
  ck_assert_double_eq_tol(run.t.event[0].lost, lost, 0.01 * lost);
  ck_assert_double_lt(run.t.balance_error, 1e-7);
  /* where it starts the pull at 40 kPa is not 0: its energy there is of the same h */
  double state[4], from[4];
  fold_state(f, fold_inner(f, 0, start[0], p), p, from);
  for (double x = 6e-3; x < 13e-3; x += 1e-6) {
    fold_state(f, x, p, state);
    least = fmin(least, state[3] - p * state[2]);
  }
  double gain = from[3] - p * from[2] - least - lost;
  ck_assert_double_eq_tol(run.t.event[0].peak_speed, sqrt(2.0 * gain / 0.05),
                          3e-3 * sqrt(2.0 * gain / 0.05));
  release(&run);
}
END_TEST

/* Closed air and damping: what is lost, taken and supplied balances. Pressure falls as it snaps. */
START_TEST(energies_balance_with_air) {
  struct run run;
  run_table("\"actuators\": [{\"cells\": [{\"law\": \"pair\", \"count\": 3, \"mass\": \"12 g\", "
            "\"damping\": \"2 N s/m\"}]}], \"plate\": {\"mass\": \"30 g\"}, \"gravity\": \"9.81 "
            "m/s2\", \"pneumatics\": {\"supply\": \"chamber\", \"dead_volume\": \"20 ml\", "
            "\"conductance\": \"2 ml/s/kPa\", \"exponent\": 1.3}, \"input\": {\"linear\": [[\"0 "
            "s\", \"0 kPa\"], [\"2 s\", \"60 kPa\"], [\"3 s\", \"-30 kPa\"]]}, \"end\": \"6 s\", "
            "\"tolerance\": 1e-10",
            &run);
  int snaps = 0, returns = 0;
  for (size_t i = 0; i < run.t.event_count; i++) {
    snaps += run.t.event[i].type == EVENT_SNAP;
    returns += run.t.event[i].type == EVENT_RETURN;
    if (run.t.event[i].type == EVENT_SNAP) {
      ck_assert_double_lt(run.t.event[i].least_pressure, run.t.event[i].trigger_pressure - 3e3);
      ck_assert_double_le(run.t.event[i].after, run.t.event[i].before);
    }
  }
  ck_assert_int_ge(snaps, 3);
  ck_assert_int_ge(returns, 3);
  ck_assert_double_gt(run.t.peak_kinetic, 0.02);
  ck_assert_double_lt(run.t.balance_error, 2e-6);
  release(&run);
}
END_TEST

/* Stiffer pairs snap later, each at its factor times the pressure of the first; larger ones go
 * further. */
START_TEST(pairs_snap_in_the_order_of_their_factors) {
  struct run run;
  run_table("\"actuators\": [{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\", \"damping\": "
            "\"60 N s/m\", \"stiffness_factor\": 1.3}, {\"law\": \"pair\", \"mass\": \"12 g\", "
            "\"damping\": \"60 N s/m\"}, {\"law\": \"pair\", \"mass\": \"12 g\", \"damping\": \"60 "
            "N s/m\", \"stiffness_factor\": 1.15, \"size_factor\": 1.5}]}], \"plate\": {\"mass\": "
            "\"30 g\"}, \"input\": {\"linear\": [[\"0 s\", \"0 kPa\"], [\"30 s\", \"60 kPa\"]]}, "
            "\"end\": \"30 s\", \"sample_rate\": \"10 Hz\", \"tolerance\": 1e-8",
            &run);
  const struct fold *f = &fold_pair;
  double x = (f->x1 + f->x2 - sqrt(f->x1 * f->x1 + f->x2 * f->x2 - f->x1 * f->x2)) / 3.0;
  double trigger = f->a * x * (x - f->x1) * (x - f->x2) / (f->A + f->B);
  static const int order[] = {1, 2, 0};
  static const double factors[] = {1.0, 1.15, 1.3};
  ck_assert_uint_eq(run.t.event_count, 3);
  for (int i = 0; i < 3; i++) {
    const struct bistable_event *event = &run.t.event[i];
    ck_assert_int_eq(event->cell, order[i]);
    ck_assert_double_eq_tol(event->trigger_pressure, factors[i] * trigger, 0.01 * trigger);
  }
  ck_assert_double_eq_tol(run.t.event[1].travel / run.t.event[0].travel, 1.5, 0.15);
  release(&run);
}
END_TEST

/* ---- pushes ------------------------------------------------------------------------------- */

static const char push[] =
    "\"laws\": {\"well\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"21 N\", \"-10 N\", \"1 "
    "N\"], \"area\": \"8 cm2\"}}, \"actuators\": [{\"cells\": [{\"law\": \"well\", \"mass\": \"20 "
    "g\", \"damping\": \"1 N s/m\"}]}], \"plate\": {\"mass\": \"40 g\"}, \"load\": {\"mass\": "
    "\"100 g\" %s}, %s \"input\": {\"hold\": [[\"0 s\", \"30 kPa\"]]}, \"initial\": "
    "{\"pressure\": \"0 kPa\"}, \"end\": \"0.05 s\", \"tolerance\": 1e-11";

/* Impulse = change of momentum, and the weight while it lasts. */
START_TEST(a_push_gives_its_impulse) {
  struct run run;
  char text[2000];
  double g = _i == 0 ? 0.0 : 9.81;
  snprintf(text, sizeof text, push, "", _i == 0 ? "" : "\"gravity\": \"9.81 m/s2\",");
  run_job_text(text, &run);
  double left = NAN;
  for (size_t i = 0; i < run.t.event_count && isnan(left); i++) {
    left = run.t.event[i].type == EVENT_SEPARATION ? run.t.event[i].time : NAN;
  }
  ck_assert(left > 0.0 && left < 0.05);
  ck_assert_int_eq(run.t.in_contact, false);
  double speed = run.t.x[run.system.load + 1] + g * (run.t.time - left);
  ck_assert_double_gt(speed, 0.5);
  ck_assert_double_eq_tol(run.t.x[run.system.impulse], 0.1 * speed + 0.1 * g * left, 1e-7);
  ck_assert_double_lt(run.t.balance_error, 1e-6);
  release(&run);
}
END_TEST

/* A load at a distance is hit: momentum is kept, and the speeds differ by the restitution. */
START_TEST(an_impact_keeps_the_momentum) {
  struct run run;
  char text[2000];
  snprintf(text, sizeof text, push, ", \"gap\": \"4 mm\", \"restitution\": 0.4", "");
  run_job_text(text, &run);
  const struct bistable_event *impact = NULL;
  for (size_t i = 0; i < run.t.event_count && !impact; i++) {
    impact = run.t.event[i].type == EVENT_CONTACT ? &run.t.event[i] : NULL;
  }
  ck_assert_ptr_nonnull(impact);
  double plate = 0.05, load = 0.1, reduced = plate * load / (plate + load);
  double closing = impact->impulse / (reduced * 1.4);
  /* a plastic part of the energy of the closing motion is lost: (1 - e^2) */
  ck_assert_double_eq_tol(impact->lost, 0.5 * reduced * closing * closing * (1.0 - 0.16), 1e-9);
  ck_assert_double_eq_tol(impact->h, 4e-3 + run.t.start[0], 1e-9);
  ck_assert_double_eq_tol(impact->velocity, closing - impact->impulse / plate, 1e-9);
  ck_assert_double_eq_tol(run.t.x[run.system.impulse], 0.1 * run.t.x[run.system.load + 1], 1e-7);
  ck_assert_double_lt(run.t.balance_error, 1e-6);
  release(&run);
}
END_TEST

/* Without a way to hold on, the simulation says so. */
START_TEST(what_is_let_go_is_named) {
  static const char text[] =
      "{\"kind\": \"bistable\", \"laws\": {\"loose\": {\"per\": \"mm\", \"coefficients\": [\"0 "
      "N\", \"1 N\", \"-1 N\"]}}, \"actuators\": [{\"cells\": [{\"law\": \"loose\", \"mass\": \"20 "
      "g\", \"elongation\": \"2 mm\"}]}], \"plate\": {\"mass\": \"40 g\"}, \"input\": {\"hold\": "
      "[[\"0 s\", \"0 kPa\"]]}, \"end\": \"100 s\", \"sample_rate\": \"1 Hz\"}";
  struct run run;
  struct error error = {.status = STATUS_OK};
  struct bistable_options options = {0};
  ck_assert_int_eq(job_spec_read(text, strlen(text), &run.spec, &error), STATUS_OK);
  ck_assert_int_eq(system_open(run.spec.bistable, &run.system, &error), STATUS_OK);
  ck_assert_int_eq(bistable_simulate(&run.system, &options, &run.t, &error), STATUS_DIVERGED);
  ck_assert_double_lt(run.t.time, 1.0);
  release(&run);
}
END_TEST

/* A name that is cut within a character leaves a warning that is text. */
START_TEST(warnings_are_text) {
  struct bistable_trajectory t = {0};
  bistable_warn(&t, "the law \"%.2s\"", "p\u00fcr");
  json_t *texts = json_texts(t.warning[0], sizeof t.warning[0], t.warning_count);
  ck_assert_uint_eq(json_array_size(texts), 1);
  ck_assert_str_eq(json_string_value(json_array_get(texts, 0)), "the law \"p?\"");
  json_decref(texts);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("bistable: motion");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60);
  tcase_add_test(tcase, a_linear_cell_is_a_damped_oscillator);
  tcase_add_test(tcase, a_double_well_keeps_its_energy);
  tcase_add_loop_test(tcase, closed_air_is_a_spring, 0, 3);
  tcase_add_loop_test(tcase, a_rigid_chamber_fills_exponentially, 0, 3);
  tcase_add_test(tcase, equal_actuators_do_not_tilt_the_plate);
  tcase_add_test(tcase, opposite_elongations_only_tilt_it);
  tcase_add_test(tcase, one_side_bends);
  tcase_add_test(tcase, a_slow_ramp_passes_the_limit_point_late);
  tcase_add_test(tcase, cells_in_a_row_are_a_chain);
  tcase_add_test(tcase, a_jump_loses_the_difference_of_the_potentials);
  tcase_add_test(tcase, energies_balance_with_air);
  tcase_add_test(tcase, pairs_snap_in_the_order_of_their_factors);
  tcase_add_loop_test(tcase, a_push_gives_its_impulse, 0, 2);
  tcase_add_test(tcase, an_impact_keeps_the_momentum);
  tcase_add_test(tcase, what_is_let_go_is_named);
  tcase_add_test(tcase, warnings_are_text);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
