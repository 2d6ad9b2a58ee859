/* Tables made by hand: columns by their names, codings of parameters, ranking, fronts, surrogates
 * and searches of functions that are known. */
#include <check.h>
#include <math.h>
#include <string.h>

#include "server/study/analysis.h"
#include "server/study/search.h"
#include "server/study/spread.h"
#include "solver/explore/pareto.h"
#include "solver/explore/random.h"
#include "tests/unit/suite.h"

enum { PARAMETERS = 3, METRICS = 2, MEMBERS_MAX = 1000 };

static char *const words[] = {"soft", "hard", "stiff"};

/* A study of `members` designs: side wall in mm, a whole number, a word. */
struct sample {
  struct study_column parameter[PARAMETERS], metric[METRICS];
  int member[MEMBERS_MAX], state[MEMBERS_MAX];
  int64_t job[MEMBERS_MAX];
  char *name[MEMBERS_MAX], *reason[MEMBERS_MAX];
  double value[MEMBERS_MAX * PARAMETERS], result[MEMBERS_MAX * METRICS];
  struct study_table table;
};

static struct sample sample; /* a process of its own for each test */

/* wall 1 to 3 mm, count 4 to 8, word: angle = 100 / wall + 5 count - 10 word, mass = wall count. */
static const struct study_table *make_table(size_t members) {
  uint64_t random = 11;
  sample.parameter[0] = (struct study_column){
      .key = "/wall", .title = "wall", .unit = "mm", .low = 1, .high = 3, .logarithmic = true};
  sample.parameter[1] =
      (struct study_column){.key = "/count", .title = "count", .unit = "", .low = 4, .high = 8};
  sample.parameter[2] = (struct study_column){.key = "/material",
                                              .title = "material",
                                              .unit = "",
                                              .low = NAN,
                                              .high = NAN,
                                              .categorical = true,
                                              .words = (char **)words,
                                              .word_count = 3};
  sample.metric[0] =
      (struct study_column){.key = "angle_deg", .title = "Angle", .unit = "°", .low = 0, .high = 1};
  sample.metric[1] =
      (struct study_column){.key = "mass_g", .title = "Mass", .unit = "g", .low = 0, .high = 1};
  for (size_t i = 0; i < members; i++) {
    double wall = pow(3, random_uniform(&random));
    double count = 4 + (double)random_below(&random, 5), word = (double)random_below(&random, 3);
    sample.member[i] = (int)i;
    sample.job[i] = 100 + (int64_t)i;
    sample.state[i] = JOB_STATE_SUCCEEDED;
    sample.name[i] = sample.reason[i] = "";
    memcpy(sample.value + i * PARAMETERS, (double[]){wall, count, word}, sizeof(double[3]));
    sample.result[i * METRICS] = 100 / wall + 5 * count - 10 * word;
    sample.result[i * METRICS + 1] = wall * count;
  }
  sample.table = (struct study_table){.study_id = 7,
                                      .name = "by hand",
                                      .sampling = "list",
                                      .members = members,
                                      .wanted = members,
                                      .parameters = PARAMETERS,
                                      .metrics = METRICS,
                                      .parameter = sample.parameter,
                                      .metric = sample.metric,
                                      .member = sample.member,
                                      .job_id = sample.job,
                                      .state = sample.state,
                                      .reason = sample.reason,
                                      .member_name = sample.name,
                                      .value = sample.value,
                                      .result = sample.result};
  return &sample.table;
}

static double number(const json_t *answer, const char *key) {
  return json_number_value(json_object_get(answer, key));
}

static const json_t *item(const json_t *answer, const char *key, size_t at) {
  return json_array_get(json_object_get(answer, key), at);
}

/* ---- criteria ----------------------------------------------------------------------------- */

START_TEST(criteria_are_read) {
  const struct study_table *table = make_table(4);
  struct criterion criteria[CRITERIA_MAX];
  struct condition conditions[CONDITIONS_MAX];
  struct error error;
  size_t count;
  ck_assert(criteria_read(table, "max:angle_deg:0.25,min:mass_g", criteria, &count, &error) ==
            STATUS_OK);
  ck_assert(count == 2 && criteria[0].maximise && criteria[0].number == 0.25);
  ck_assert(criteria[1].metric == 1 && !criteria[1].maximise && isnan(criteria[1].number));
  ck_assert(conditions_read(table, "angle_deg>=60,/wall<=-1e1", conditions, &count, &error) ==
            STATUS_OK);
  ck_assert(count == 2 && conditions[0].at_least && conditions[0].limit == 60);
  ck_assert(conditions[1].of.parameter && !conditions[1].at_least && conditions[1].limit == -10);
  ck_assert(conditions_read(table, NULL, conditions, &count, &error) == STATUS_OK && count == 0);
  ck_assert(criteria_read(table, "max:angel_deg", criteria, &count, &error) == STATUS_INVALID);
  ck_assert_str_eq(error.nearest, "angle_deg");
}
END_TEST

START_TEST(other_texts_are_refused) {
  static const char *const bad[] = {"",
                                    "angle_deg",
                                    "max:",
                                    "max:angle_deg,",
                                    "max:angle_deg:",
                                    "max:mass_g:x",
                                    "max:mass_g:1e999",
                                    "max:mass_g:nan",
                                    "max:mass_g,min:mass_g",
                                    "most:mass_g",
                                    "max:/wall",
                                    "max:mass_g:1:2"};
  static const char *const none[] = {"mass_g",       "mass_g>",     "mass_g>=", "mass_g>=x",
                                     ">=3",          "mass_g>=1,,", "mass_g=1", "other>=1",
                                     "/material>=1", "mass_g>= 1"};
  const struct study_table *table = make_table(4);
  struct criterion criteria[CRITERIA_MAX];
  struct condition conditions[CONDITIONS_MAX];
  struct error error;
  size_t count;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    ck_assert_msg(criteria_read(table, bad[i], criteria, &count, &error) == STATUS_INVALID, "%s",
                  bad[i]);
  }
  for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
    ck_assert_msg(conditions_read(table, none[i], conditions, &count, &error) == STATUS_INVALID,
                  "%s", none[i]);
  }
}
END_TEST

/* ---- space -------------------------------------------------------------------------------- */

START_TEST(designs_are_coded_and_back) {
  const struct study_table *table = make_table(50);
  struct space space;
  struct error error;
  double x[SURROGATE_PARAMETERS_MAX], u[3], design[3];
  ck_assert(space_make(table, &space, &error) == STATUS_OK);
  ck_assert(space.width == 5 && space.axis[0].coding == SPACE_LOGARITHM && space.axis[1].whole);
  ck_assert(space_encode(&space, (double[]){2, 5, 1}, x));
  ck_assert(x[0] == log10(2) && x[1] == 5 && x[2] == 0 && x[3] == 1 && x[4] == 0);
  ck_assert(!space_encode(&space, (double[]){2, NAN, 1}, x));
  uint64_t random = 5;
  for (int i = 0; i < 200; i++) {
    double again[3];
    for (int k = 0; k < 3; k++) {
      u[k] = random_uniform(&random);
    }
    space_design(&space, u, design);
    ck_assert(design[0] >= 1 && design[0] <= 3 && design[1] == round(design[1]) && design[2] < 3);
    space_place(&space, design, u);
    space_design(&space, u, again);
    ck_assert_double_eq_tol(again[0], design[0], 1e-12);
    ck_assert(again[1] == design[1] && again[2] == design[2]);
    space_round(&space, design);
    ck_assert_double_eq_tol(again[0], design[0], 0.006);
    ck_assert_double_eq_tol(design[0] * 1000, round(design[0] * 1000), 1e-9);
  }
}
END_TEST

/* 40 words in one parameter and 3 in another: the former gets one coordinate. */
START_TEST(many_words_get_one_coordinate) {
  const struct study_table *table = make_table(40);
  char *many[40];
  struct space space;
  struct error error;
  for (size_t i = 0; i < 40; i++) {
    many[i] = "w";
    sample.value[i * PARAMETERS + 1] = (double)i;
  }
  sample.parameter[1].categorical = true;
  sample.parameter[1].words = many;
  sample.parameter[1].word_count = 40;
  ck_assert(space_make(table, &space, &error) == STATUS_OK);
  ck_assert(space.width == 5 && space.axis[1].coding == SPACE_ORDER);
  sample.table.parameters = 0;
  ck_assert(space_make(table, &space, &error) == STATUS_INVALID);
}
END_TEST

/* ---- ranking and fronts ------------------------------------------------------------------- */

/* Three members: angles 10, 20, 40 and masses 4, 2, 3, weights 3 : 1. By hand: 0 + 0, 0.75 / 3 +
 * 0.25, 0.75 + 0.25 / 2. A fourth has failed, a fifth has no mass. */
static const struct study_table *three(void) {
  static const double results[] = {10, 4, 20, 2, 40, 3, 99, 0, 50, NAN};
  const struct study_table *table = make_table(5);
  memcpy(sample.result, results, sizeof results);
  sample.state[3] = JOB_STATE_FAILED;
  return table;
}

START_TEST(scores_by_hand) {
  const struct study_table *table = three();
  struct criterion criteria[2] = {{0, true, 3}, {1, false, NAN}};
  struct error error;
  json_t *answer;
  ck_assert(analysis_ranking(table, criteria, 2, 2, &answer, &error) == STATUS_OK);
  ck_assert(number(answer, "compared") == 3 && number(answer, "excluded") == 2);
  ck_assert(json_array_size(json_object_get(answer, "designs")) == 2);
  ck_assert_double_eq_tol(number(item(answer, "designs", 0), "score"), 0.875, 1e-12);
  ck_assert_double_eq_tol(number(item(answer, "designs", 1), "score"), 0.5, 1e-12);
  ck_assert(number(item(answer, "designs", 0), "job") == 102);
  ck_assert(number(item(answer, "criteria", 0), "weight") == 0.75);
  json_decref(answer);
  criteria[1].number = 0;
  ck_assert(analysis_ranking(table, criteria, 2, 2, &answer, &error) == STATUS_INVALID);
}
END_TEST

START_TEST(equal_members_share_a_rank) {
  const struct study_table *table = three();
  struct criterion criteria[1] = {{0, true, NAN}};
  struct error error;
  json_t *answer;
  sample.result[2] = 40; /* as the third */
  ck_assert(analysis_ranking(table, criteria, 1, 10, &answer, &error) == STATUS_OK);
  ck_assert(number(item(answer, "designs", 0), "rank") == 1);
  ck_assert(number(item(answer, "designs", 1), "job") == 101);
  ck_assert(number(item(answer, "designs", 1), "rank") == 2);
  ck_assert(number(item(answer, "designs", 2), "rank") == 2);
  ck_assert(number(item(answer, "designs", 3), "rank") == 4);
  json_decref(answer);
}
END_TEST

/* Up to (10, 4): of (20, 2) and (40, 3) the area is 10 x 2 + 20 x 1; with given references more. */
START_TEST(fronts_and_area_by_hand) {
  const struct study_table *table = three();
  struct criterion objectives[2] = {{0, true, NAN}, {1, false, NAN}};
  struct error error;
  json_t *answer;
  ck_assert(analysis_pareto(table, objectives, 2, 5, &answer, &error) == STATUS_OK);
  const json_t *volume = json_object_get(answer, "hypervolume");
  ck_assert_double_eq_tol(number(volume, "value"), 40, 1e-12);
  ck_assert_double_eq_tol(number(volume, "share"), 40.0 / 60, 1e-12);
  ck_assert(json_integer_value(item(answer, "layers", 0)) == 2);
  ck_assert(json_integer_value(item(answer, "layers", 1)) == 1);
  ck_assert(number(item(answer, "designs", 2), "job") == 100);
  json_decref(answer);
  objectives[0].number = 0;
  objectives[1].number = 5;
  ck_assert(analysis_pareto(table, objectives, 2, 1, &answer, &error) == STATUS_OK);
  ck_assert_double_eq_tol(number(json_object_get(answer, "hypervolume"), "value"), 20 * 3 + 20 * 2,
                          1e-12);
  json_decref(answer);
}
END_TEST

/* Three objectives of 1000 members on a sphere are too many for the exact volume: the estimate
 * agrees with it within its error. */
START_TEST(large_volumes_are_estimated) {
  enum { COUNT = 1000 };
  const struct study_table *table = make_table(COUNT);
  static double result[COUNT * 3], y[COUNT * 3];
  struct study_column metric[3] = {sample.metric[0], sample.metric[1], sample.metric[1]};
  struct criterion objectives[3] = {{0, false, 1}, {1, false, 1}, {2, true, -1}};
  uint64_t random = 9;
  double exact;
  struct error error;
  json_t *answer;
  metric[2].key = "third";
  for (size_t i = 0; i < COUNT; i++) {
    double a = M_PI_2 * random_uniform(&random), z = random_uniform(&random), r = sqrt(1 - z * z);
    memcpy(y + 3 * i, (double[]){1 - r * cos(a), 1 - r * sin(a), 1 - z}, 3 * sizeof *y);
    memcpy(result + 3 * i, (double[]){y[3 * i], y[3 * i + 1], -y[3 * i + 2]}, 3 * sizeof *y);
  }
  sample.table.metrics = 3;
  sample.table.metric = metric;
  sample.table.result = result;
  ck_assert(pareto_hypervolume(y, COUNT, 3, (double[]){1, 1, 1}, &exact, &error) == STATUS_OK);
  ck_assert(analysis_pareto(table, objectives, 3, 1, &answer, &error) == STATUS_OK);
  const json_t *volume = json_object_get(answer, "hypervolume");
  ck_assert(json_is_false(json_object_get(volume, "exact")));
  ck_assert_double_eq_tol(number(volume, "value"), exact, 4 * number(volume, "standard_error"));
  ck_assert_double_lt(number(volume, "standard_error"), 0.01 * exact);
  json_decref(answer);
}
END_TEST

/* ---- surrogates --------------------------------------------------------------------------- */

START_TEST(surrogates_are_kept_until_the_data_change) {
  const struct study_table *table = make_table(60);
  struct models *models;
  struct model *first, *second, *third;
  struct error error;
  double mean, deviation, worst = 0;
  ck_assert(models_create(&models, &error) == STATUS_OK);
  ck_assert(models_get(models, table, 0, &first, &error) == STATUS_OK);
  ck_assert(models_get(models, table, 0, &second, &error) == STATUS_OK);
  ck_assert(first == second && first->points == 60);
  for (int i = 0; i < 30; i++) {
    double design[3] = {1.05 + 0.06 * i, 4 + i % 5, i % 3};
    model_predict(first, design, &mean, &deviation);
    worst = fmax(worst, fabs(mean - (100 / design[0] + 5 * design[1] - 10 * design[2])));
  }
  ck_assert_double_lt(worst, 1);
  sample.state[3] = JOB_STATE_FAILED;
  sample.result[4 * METRICS] = NAN;
  ck_assert(models_get(models, table, 0, &third, &error) == STATUS_OK);
  ck_assert(third != first && third->points == 58 && third->succeeded == 59);
  model_release(first);
  model_release(second);
  model_release(third);
  sample.table.members = 3;
  ck_assert(models_get(models, table, 0, &third, &error) == STATUS_INVALID);
  models_destroy(models);
}
END_TEST

/* Of many members a choice is used, which is said; effects and shares are those of the function. */
START_TEST(many_members_are_bounded) {
  const struct study_table *table = make_table(MEMBERS_MAX);
  struct models *models;
  struct model *model;
  struct error error;
  json_t *answer;
  ck_assert(models_create(&models, &error) == STATUS_OK);
  ck_assert(models_get(models, table, 1, &model, &error) == STATUS_OK);
  ck_assert(model->points == MODEL_POINTS_MAX && model->complete == MEMBERS_MAX);
  ck_assert(analysis_importance(table, model, 1, &answer, &error) == STATUS_OK);
  ck_assert(number(json_object_get(answer, "surrogate"), "points") == MODEL_POINTS_MAX);
  /* mass = wall count: with the logarithm of the wall even, E(wall) = 2 / ln 3, E(wall^2) = 4 / ln
   * 3
   */
  double mean = 2 / log(3), square = 4 / log(3), wall = (square - mean * mean) * 36;
  double count = 2 * mean * mean, all = square * 38 - mean * mean * 36;
  const json_t *one = item(answer, "parameters", 0), *other = item(answer, "parameters", 1);
  ck_assert_str_eq(json_string_value(json_object_get(one, "key")), "/wall");
  ck_assert_double_eq_tol(number(json_object_get(one, "first"), "value"), wall / all, 0.03);
  ck_assert_double_eq_tol(number(json_object_get(other, "first"), "value"), count / all, 0.03);
  json_decref(answer);
  ck_assert(analysis_effects(table, model, 1, &answer, &error) == STATUS_OK);
  const json_t *pair = item(answer, "pairs", 0);
  ck_assert_double_eq_tol(number(json_object_get(pair, "share"), "value"),
                          (all - wall - count) / all, 0.03);
  json_decref(answer);
  model_release(model);
  models_destroy(models);
}
END_TEST

/* The least mass at 90 degrees or more is that of the thinnest walls and the fewest parts; the
 * most, with walls that a sum keeps between 1.2 and 1.3 mm, that of 8 parts and 1.3 mm. */
START_TEST(the_best_design_is_found) {
  const struct study_table *table = make_table(200);
  struct search_query query = {.conditions = 1, .chance = 0.5, .limit = 3};
  struct search_sum sum = {.factor = {1}, .low = _i ? 1.2 : 0, .high = _i ? 1.3 : INFINITY};
  struct candidate best[8];
  struct models *models;
  struct search search = {
      .table = table, .query = &query, .metrics = 2, .metric = {1, 0}, .sum = &sum, .sums = 1};
  struct error error;
  size_t count;
  query.condition[0] = (struct condition){.of = {false, 0}, .at_least = true, .limit = 90};
  query.goal = (struct quantity_of){false, 1};
  query.most = _i > 0;
  ck_assert(models_create(&models, &error) == STATUS_OK);
  for (size_t i = 0; i < 2; i++) {
    ck_assert(models_get(models, table, search.metric[i], &search.model[i], &error) == STATUS_OK);
    search.spread[i] = 1;
  }
  search.space = &search.model[0]->space;
  ck_assert(search_candidates(&search, best, 8, &count, &error) == STATUS_OK);
  ck_assert(count == 8 && best[0].chance >= 0.5);
  if (_i == 0) { /* the least: as thin as possible, with the fewest parts */
    ck_assert_double_eq_tol(best[0].design[0], 1, 0.01);
    ck_assert_double_eq_tol(best[0].mean[0], 4, 0.1);
  } else { /* the most, within the limits of the sum */
    ck_assert_double_eq_tol(best[0].design[0], 1.3, 0.005);
    ck_assert(best[0].design[1] == 8);
    ck_assert_double_eq_tol(best[0].mean[0], 10.4, 0.1);
  }
  for (size_t i = 1; i < count; i++) {
    ck_assert(!candidate_better(&search, &best[i], &best[i - 1]));
  }
  model_release(search.model[0]);
  model_release(search.model[1]);
  models_destroy(models);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("study: analysis");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, criteria_are_read);
  tcase_add_test(tcase, other_texts_are_refused);
  tcase_add_test(tcase, designs_are_coded_and_back);
  tcase_add_test(tcase, many_words_get_one_coordinate);
  tcase_add_test(tcase, scores_by_hand);
  tcase_add_test(tcase, equal_members_share_a_rank);
  tcase_add_test(tcase, fronts_and_area_by_hand);
  tcase_add_test(tcase, large_volumes_are_estimated);
  tcase_add_test(tcase, surrogates_are_kept_until_the_data_change);
  tcase_add_test(tcase, many_members_are_bounded);
  tcase_add_loop_test(tcase, the_best_design_is_found, 0, 2);
  tcase_set_timeout(tcase, 300);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
