/* Identification of hybrid models: derivatives against the matrix exponential, presets from their
 * own motion, coverage of the intervals, what cannot be seen, guards and resets. */
#include <gsl/gsl_math.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/base/clock.h"
#include "solver/identify/response.h"
#include "tests/physics/hybrid_exact.h"
#include "tests/physics/identify_case.h"

/* ---- responses ---------------------------------------------------------------------------- */

/* Stiff and overdamped, as the presets; oscillating; slow. */
static const struct response_system systems[] = {
    {5554.0, 25.56, -9.0, 0.06, 8.0888e-4},
    {1841.0, 2.0, -9.0, 0.06, 8.0888e-4},
    {20.0, 3.0, -2.0, 0.5, 1e-3},
    {300.0, 40.0, -25.0, 0.2, 2e-3},
};

/* One response function by the matrix exponential. */
static double exact_response(const struct response_system *s, int function, double time) {
  static const int from[] = {HLPV_H, HLPV_VELOCITY, HLPV_PRESSURE, HLPV_PRESSURE};
  static const int to[] = {HLPV_H, HLPV_H, HLPV_H, HLPV_PRESSURE};
  struct hlpv_spec spec = {.mass = s->mass, .gamma = s->gamma, .mode_count = 1};
  struct hlpv_polynomial *const polynomial[] = {&spec.mode[0].stiffness, &spec.mode[0].damping,
                                                &spec.mode[0].alpha, &spec.mode[0].beta};
  const double value[] = {s->stiffness, s->damping, s->alpha, 0.0};
  for (int i = 0; i < 4; i++) {
    *polynomial[i] = (struct hlpv_polynomial){.count = 1, .per = 1.0, .c = {value[i]}};
  }
  struct exact_input input = {.u = 0.0};
  double x[HLPV_STATES] = {0.0, 0.0, 0.0}, after[HLPV_STATES];
  x[from[function]] = 1.0;
  exact_state(&spec, 0, &input, x, time, after);
  return after[to[function]];
}

/* Its derivative to a parameter by differences of the matrix exponential (Richardson). */
static double exact_slope(const struct response_system *s, int function, int parameter,
                          double time) {
  double difference[2];
  for (int k = 0; k < 2; k++) {
    double side[2], step = 0.0;
    for (int i = 0; i < 2; i++) {
      struct response_system moved = *s;
      double *const slot[RESPONSE_PARAMETERS] = {&moved.stiffness, &moved.damping, &moved.alpha,
                                                 &moved.mass, &moved.gamma};
      step = (k == 0 ? 2e-3 : 1e-3) * fabs(*slot[parameter]);
      *slot[parameter] += i == 0 ? -step : step;
      side[i] = exact_response(&moved, function, time);
    }
    difference[k] = (side[1] - side[0]) / (2.0 * step);
  }
  return (4.0 * difference[1] - difference[0]) / 3.0;
}

START_TEST(sensitivities_are_those_of_the_matrix_exponential) {
  enum { TIMES = 25 };
  const struct response_system *s = &systems[_i];
  double time[TIMES], value[TIMES * RESPONSE_FUNCTIONS], worst = 0.0, worst_value = 0.0;
  double slope[TIMES * RESPONSE_PARAMETERS * RESPONSE_FUNCTIONS];
  const double parameter[] = {s->stiffness, s->damping, s->alpha, s->mass, s->gamma};
  struct response *response;
  struct error error;
  ck_assert_int_eq(response_create(1e-10, RESPONSE_PARAMETERS, &response, &error), STATUS_OK);
  for (int i = 0; i < TIMES; i++) {
    time[i] = 0.6 / fabs(s->alpha) * 0.25 * i;
  }
  ck_assert_int_eq(response_evaluate(response, s, time, TIMES, value, slope, &error), STATUS_OK);
  for (int f = 0; f < RESPONSE_FUNCTIONS; f++) {
    double size = 0.0, slope_size[RESPONSE_PARAMETERS] = {0.0};
    for (int i = 0; i < TIMES; i++) {
      size = fmax(size, fabs(value[i * RESPONSE_FUNCTIONS + f]));
    }
    for (int i = 0; i < TIMES; i++) {
      double off = value[i * RESPONSE_FUNCTIONS + f] - exact_response(s, f, time[i]);
      worst_value = fmax(worst_value, fabs(off) / size);
      for (int j = 0; j < RESPONSE_PARAMETERS && time[i] > 0.0; j++) {
        double found = slope[(i * RESPONSE_PARAMETERS + j) * RESPONSE_FUNCTIONS + f];
        slope_size[j] = fmax(fabs(found * parameter[j]), 1e-3 * size);
        worst = fmax(worst, fabs(found - exact_slope(s, f, j, time[i])) * fabs(parameter[j]) /
                                fmax(size, slope_size[j]));
      }
    }
  }
  printf("system %d: functions within %.1e, derivatives within %.1e of their size\n", _i,
         worst_value, worst);
  ck_assert_double_lt(worst_value, 1e-7);
  ck_assert_double_lt(worst, 1e-6);
  response_destroy(response);
}
END_TEST

/* ---- presets ------------------------------------------------------------------------------ */

static const char both_modes[] =
    "\"modes\":[{\"name\":\"compressed\",\"rest\":\"0 mm\"},{\"name\":\"stretched\"}],"
    "\"degree\":{\"stiffness\":1,\"damping\":0,\"alpha\":0,\"beta\":0},\"per\":\"psi\"";
static const char preset_constants[] = "\"mass\":\"60 g\",\"gamma\":\"5.577 N/psi\"";

static const char *const presets[] = {"20A-0.18", "20A-0.25", "30A-0.18", "30A-0.25"};
static const char *const keys[] = {"stiffness_N_m", "damping_N_s_m", "alpha_1_s", "beta_1_s"};

START_TEST(presets_come_back_from_their_own_motion) {
  static const struct synthetic_plan plan = {
      .before = 0.25, .hold = 3.0, .fast = 120.0, .fast_time = 0.5, .slow = 10.0};
  struct synthetic_run run[SYNTHETIC_RUNS_MAX];
  struct synthetic_trial trial[SYNTHETIC_RUNS_MAX];
  struct job_spec preset;
  char rest[600];
  case_preset(presets[_i], &preset);
  const struct hlpv_spec *model = preset.hlpv;
  /* The compressed mode of the thin PET snaps at 3.5 psi: its trials end before. */
  size_t all = synthetic_protocol(1, run), count = 0;
  for (size_t i = 0; i < all; i++) {
    double h = hlpv_rest(model, run[i].mode, run[i].up);
    if (run[i].mode == 1 || h < 0.98 * model->transition[0].level) {
      run[count++] = run[i];
    }
  }
  case_trials(model, run, count, &plan, trial);
  char *table = case_table(trial, count, 0.0, NULL);
  snprintf(rest, sizeof rest, "%s,%s", preset_constants, both_modes);
  double start = clock_cpu_s(), worst = 0.0;
  json_t *document = case_run(table, rest);
  double took = clock_cpu_s() - start;
  for (int mode = 0; mode < 2; mode++) {
    const struct hlpv_mode *m = &model->mode[mode];
    const struct hlpv_polynomial *const truth[] = {&m->stiffness, &m->damping, &m->alpha, &m->beta};
    for (int c = 0; c < 4; c++) {
      size_t terms = c == 0 && mode == 0 ? 2 : 1;
      for (size_t i = 0; i < terms; i++) {
        double found = case_number(case_coefficient(document, m->name, keys[c], i), "value");
        double wanted = truth[c]->c[i] * (i == 1 ? PSI / truth[c]->per : 1.0);
        worst = fmax(worst, fabs(found / wanted - 1.0));
      }
    }
  }
  const json_t *rest_mm =
      json_object_get(case_named(json_object_get(document, "modes"), "stretched"), "rest_mm");
  worst = fmax(worst, fabs(1e-3 * case_number(rest_mm, "value") / model->mode[1].rest - 1.0));
  printf("%s: %zu trials in %.3f s, coefficients within %.1e\n", presets[_i], count, took, worst);
  ck_assert_double_lt(worst, 1e-5);
  ck_assert_double_gt(case_number(json_object_get(document, "metrics"), "r_squared_h"), 1.0 - 1e-9);
  json_decref(document);
  free(table);
  case_release(trial, count);
  job_spec_release(&preset);
}
END_TEST

/* ---- coverage ----------------------------------------------------------------------------- */

/* What the repeats add up to for one coefficient. */
struct score {
  double truth, sum, square,
      normal;        /* of the relative error; of the error over its standard error */
  int covered, near; /* truth inside the interval; within 3 % of it */
};

static void add_score(struct score *score, const json_t *c) {
  double off = case_number(c, "value") / score->truth - 1.0;
  score->sum += off;
  score->square += off * off;
  score->normal += gsl_pow_2(off * score->truth / case_number(c, "stderr"));
  score->covered += case_number(c, "low") <= score->truth && score->truth <= case_number(c, "high");
  score->near += fabs(off) <= 0.03;
}

/* 1 % noise on every trial, the compressed mode of a preset with its linear stiffness: in 200
 * repeats the intervals cover the truth, nothing is biased, and coefficients are within 3 %. */
START_TEST(intervals_cover_the_truth) {
  enum { REPEATS = 200, SCORES = 5 };
  static const struct synthetic_plan plan = {.before = 0.5, .hold = 1.5, .fast = 120.0};
  static const char *const score_keys[SCORES] = {"stiffness_N_m", "stiffness_N_m", "damping_N_s_m",
                                                 "alpha_1_s", "beta_1_s"};
  static const size_t score_index[SCORES] = {0, 1, 0, 0, 0};
  struct synthetic_run run[SYNTHETIC_RUNS_MAX];
  struct synthetic_trial trial[SYNTHETIC_RUNS_MAX];
  struct job_spec preset;
  char rest[600];
  case_preset("20A-0.25", &preset);
  const struct hlpv_mode *m = &preset.hlpv->mode[0];
  struct score score[SCORES] = {{.truth = m->stiffness.c[0]},
                                {.truth = m->stiffness.c[1] * PSI / m->stiffness.per},
                                {.truth = m->damping.c[0]},
                                {.truth = m->alpha.c[0]},
                                {.truth = m->beta.c[0]}};
  size_t count = 0;
  for (size_t all = synthetic_protocol(3, run); count < all && run[count].mode == 0; count++) {
  }
  case_trials(preset.hlpv, run, count, &plan, trial);
  snprintf(rest, sizeof rest,
           "%s,\"modes\":[{\"name\":\"compressed\",\"rest\":\"0 mm\"}],\"degree\":{\"stiffness\":1,"
           "\"damping\":0,\"alpha\":0,\"beta\":0},\"per\":\"psi\",\"tolerance\":1e-6",
           preset_constants);
  gsl_rng *generator = gsl_rng_alloc(gsl_rng_mt19937);
  gsl_rng_set(generator, 20260101);
  double took = 0.0;
  for (int repeat = 0; repeat < REPEATS; repeat++) {
    char *table = case_table(trial, count, 0.01, generator);
    json_t *document = case_run(table, rest);
    took += case_number(json_object_get(document, "statistics"), "cpu_s");
    for (int i = 0; i < SCORES; i++) {
      add_score(&score[i], case_coefficient(document, "compressed", score_keys[i], score_index[i]));
    }
    json_decref(document);
    free(table);
  }
  printf("%zu trials, %.1f ms each identification\n", count, 1e3 * took / REPEATS);
  for (int i = 0; i < SCORES; i++) {
    double bias = score[i].sum / REPEATS, rms = sqrt(score[i].square / REPEATS);
    printf("%s[%zu]: bias %+.3f %%, rms %.3f %%, within 3 %% in %d, covered in %d of %d, rms of "
           "error / standard error %.3f\n",
           score_keys[i], score_index[i], 100.0 * bias, 100.0 * rms, score[i].near,
           score[i].covered, REPEATS, sqrt(score[i].normal / REPEATS));
    ck_assert_int_ge(score[i].covered, REPEATS * 9 / 10);
    ck_assert_int_ge(score[i].near, REPEATS * 9 / 10);
    ck_assert_double_lt(fabs(bias), 4.0 * rms / sqrt(REPEATS));
  }
  gsl_rng_free(generator);
  case_release(trial, count);
  job_spec_release(&preset);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("identify");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 300);
  tcase_add_loop_test(tcase, sensitivities_are_those_of_the_matrix_exponential, 0,
                      sizeof systems / sizeof *systems);
  tcase_add_loop_test(tcase, presets_come_back_from_their_own_motion, 0,
                      sizeof presets / sizeof *presets);
  tcase_add_test(tcase, intervals_cover_the_truth);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
