/* Jobs with tables, tensile tests and trials of hybrid dynamics: columns, values and options that
 * are taken, and those that are refused. */
#include "tests/unit/suite.h"

/* A step up and one down. */
#define ROWS                                                                                       \
  "t,u,h,p\\n0.0,20,0.000,0.000\\n0.1,20,3.935,7.869\\n0.2,20,6.321,12.642\\n"                     \
  "0.3,20,7.769,15.537\\n0.4,20,8.647,17.293\\n0.5,20,9.179,18.358\\n"                             \
  "0.6,20,9.502,19.004\\n0.7,20,9.698,19.396\\n0.8,20,9.817,19.634\\n"                             \
  "0.9,20,9.889,19.778\\n1.0,20,9.933,19.865\\n1.1,20,9.959,19.918\\n"                             \
  "1.2,0,10.000,20.000\\n1.3,0,6.065,12.131\\n1.4,0,3.679,7.358\\n"                                \
  "1.5,0,2.231,4.463\\n1.6,0,1.353,2.707\\n1.7,0,0.821,1.642\\n1.8,0,0.498,0.996\\n"               \
  "1.9,0,0.302,0.604\\n2.0,0,0.183,0.366\\n2.1,0,0.111,0.222\\n2.2,0,0.067,0.135\\n"               \
  "2.3,0,0.041,0.082\\n"
#define COLUMN(name, unit) "{\"name\": \"" name "\", \"unit\": \"" unit "\"}"

static const char identify[] =
    "{\"kind\": \"identify\", \"data\": {\"csv\": \"" ROWS
    "\"}, \"columns\": {\"time\": " COLUMN("t", "s") ", \"set_point\": " COLUMN(
        "u", "kPa") ", \"h\": " COLUMN("h", "mm") ", "
                                                  "\"pressure\": " COLUMN(
                                                      "p", "kPa") "}, \"modes\": [{\"name\": "
                                                                  "\"free\", \"rest\": \"0 mm\"}]}";
static const char fit[] =
    "{\"kind\": \"fit-material\", \"model\": \"yeoh\", \"terms\": 2, \"data\": {\"csv\": "
    "\"e,s\\n0,0\\n0.2,0.05\\n0.4,0.09\\n0.6,0.12\\n0.8,0.15\\n1,0.17\\n1.2,0.2\\n\"}, "
    "\"columns\": {\"strain\": " COLUMN("e", "1") ", \"stress\": " COLUMN("s", "MPa") "}}";

#define CSV(text)                                                                                  \
  { "/data/csv", "\"" text "\"" }
#define TABLES(first, second)                                                                      \
  {"/data", NULL}, {                                                                               \
    "/tables", "[{\"name\": \"" first "\", \"data\": {\"csv\": \"" ROWS "\"}}, {\"name\": "        \
               "\"" second "\", \"data\": {\"csv\": \"" ROWS "\"}}]"                               \
  }
#define MODES(last) "[{\"name\": \"a\"}, {\"name\": \"b\"}, {\"name\": \"" last "\"}]"
#define ABSCISSA(key, unit)                                                                        \
  { "/columns", "{\"" key "\": " COLUMN("e", unit) ", \"stress\": " COLUMN("s", "MPa") "}" }

static const struct variant variants[] = {
    /* trials */
    {identify, {{NULL}}, NULL, NULL},
    {identify, {{"/held_out", "0.5"}}, NULL, NULL},
    {identify, {TABLES("a", "b")}, NULL, NULL},
    {identify, {TABLES("a", "b"), {"/held_out", "0.9"}}, NULL, NULL},
    {identify, {TABLES("a", "b"), {"/held_out", "[\"b\"]"}}, NULL, NULL},
    {identify, {TABLES("a", "a")}, "/tables/1/name", "must differ"},
    {identify, {TABLES("a", "b"), {"/held_out", "[\"c\"]"}}, "/held_out/0", "first of which is"},
    {identify, {{"/held_out", "[\"1\"]"}}, "/held_out", "at least one that is left"},
    {identify,
     {CSV("t,u,h,p\\n0,0,1,1\\n1,0,2,2\\n2,0,3,3\\n3,0,3,3\\n4,0,3,3\\n5,0,3,3\\n6,0,3,3\\n7,0,3,"
          "3\\n")},
     "/columns/set_point/name",
     "with steps"},
    {identify, {{"/columns/h/unit", "\"km\""}}, "/columns/h/unit", "less than 10 m"},
    {identify, {{"/columns/h/unit", "\"pm\""}}, "/columns/h/unit", "more than 1 um"},
    {identify, {{"/columns/pressure/unit", "\"MPa\""}}, "/columns/pressure/unit", "5 times the"},
    {identify, {{"/columns/pressure/unit", "\"Pa\""}}, "/columns/pressure/unit", "5 times the"},
    {identify, {{"/columns/time/unit", "\"h\""}}, "/data/csv", "at most 60 s; is the unit"},
    {identify,
     {{"/columns/h/name", "\"Pressure (kPa)\""}},
     "/columns/h/name",
     "the column that holds the elongation"},
    {identify,
     {{"/columns/pressure/name", "\"Elongation\""}},
     "/columns/pressure/name",
     "the column that holds the pressure"},
    {identify,
     {{"/columns/set_point/name", "\"displacement\""}},
     "/columns/set_point/name",
     "the column that holds the set-point"},
    /* modes, levels, degrees */
    {identify, {{"/levels", "[\"5 mm\"]"}}, "/levels", "parted by 0 levels"},
    {identify,
     {{"/modes", MODES("c")}, {"/levels", "[\"5 mm\", \"4 mm\"]"}},
     "/levels/1",
     "they must rise"},
    {identify, {{"/modes", MODES("a")}}, "/modes/2/name", "must differ"},
    {identify,
     {{"/modes", "[{\"name\": \"a\"}, {\"name\": \"b\"}]"}, {"/levels", "[\"500 mm\"]"}},
     "/modes/1",
     "one with"},
    {identify, {{"/degree", "{\"damping\": 0, \"alpha\": 1}"}}, NULL, NULL},
    {identify, {{"/per", "\"1/kPa\""}}, "/per", "no unit of pressure"},
    {identify, {{"/per", "\"-1 kPa\""}}, "/per", "no unit of pressure"},
    /* tensile tests */
    {fit, {{NULL}}, NULL, NULL},
    {fit, {{"/strain", "\"true\""}, {"/stress", "\"true\""}}, NULL, NULL},
    {fit,
     {ABSCISSA("stretch", "1"), CSV("e,s\\n1,0\\n1.2,0.05\\n1.4,0.1\\n1.6,0.2\\n")},
     NULL,
     NULL},
    {fit,
     {ABSCISSA("extension", "mm"),
      {"/columns/gauge", "\"33 mm\""},
      CSV("e,s\\n0,0\\n3,0.05\\n5,0.1\\n9,0.2\\n")},
     NULL,
     NULL},
    {fit,
     {{"/model", "\"ogden\""}, {"/terms", "1"}, {"/bounds", "{\"alpha1\": [1, 10]}"}},
     NULL,
     NULL},
    {fit,
     {{"/model", "\"ogden\""}, {"/terms", "1"}, {"/bounds", "{\"alpha1\": [10, 1]}"}},
     "/bounds/alpha1",
     "[1, 10]"},
    {fit, {{"/columns/strain/unit", "\"mm\""}}, "/columns/strain/unit", "its units"},
    {fit, {{"/columns/stress/unit", "\"-1 MPa\""}}, "/columns/stress/unit", "its units"},
    {fit,
     {{"/columns/strain/name", "\"Stress (MPa)\""},
      CSV("Stress (MPa),s\\n0,0\\n0.2,0.05\\n0.4,0.1\\n0.6,0.2\\n")},
     "/columns/strain/name",
     "a column of strains"},
    {fit,
     {{"/columns/stress/name", "\"strain\""},
      CSV("e,strain\\n0,0\\n0.2,0.05\\n0.4,0.1\\n0.6,0.2\\n")},
     "/columns/stress/name",
     "a column of stresses"},
    {fit,
     {{"/columns/stress/name", "\"stress at strain\""},
      CSV("e,stress at strain\\n0,0\\n0.2,0.05\\n0.4,0.1\\n0.6,0.2\\n")},
     NULL,
     NULL},
    {fit, {CSV("e,s\\n0,0\\n")}, "/data/csv", "does not rise"},
    {fit, {CSV("e,s\\n0,0\\n0,1\\n0,2\\n0,3\\n")}, "/data/csv", "pulling is positive"},
    {fit, {CSV("e,s\\n0,0\\n0.2,0.05\\n0.4,0.1\\n")}, "/data/csv", "at least 4"},
    {fit, {{"/range", "[0.7, 0.5]"}}, "/range", "must be below"},
    {fit, {{"/range", "[0.5, 0.7]"}}, "/range", "1 of 7 points are used"},
    {fit, {CSV("e,s\\n0.5,9\\n1,10\\n1.2,11\\n1.5,11\\n2,12\\n")}, NULL, NULL},
    {fit, {CSV("e,s\\n0.4,0.09\\n1,0.1\\n1.2,0.11\\n1.5,0.11\\n")}, NULL, NULL},
    {fit, {CSV("e,s\\n0.1,0.09\\n1,0.1\\n1.2,0.11\\n1.5,0.11\\n")}, "/data/csv", "at most half"},
    {fit, {CSV("e,s\\n0,0\\n0.2,2e3\\n0.4,4e3\\n")}, "/data/csv", "0.0001 to 1000 MPa"},
    {fit, {CSV("e,s\\n0,0\\n0.2,1e-6\\n0.4,2e-6\\n")}, "/data/csv", "0.0001 to 1000 MPa"},
    {fit, {CSV("e,s\\n0,0\\n0.2,-1e-6\\n0.1,2\\n0.1,2\\n")}, "/data/csv", "does not rise"},
    {fit, {CSV("e,s\\n0,0\\n-0.5,-0.1\\n0.4,0.1\\n0.5,0.11\\n")}, NULL, NULL},
    {fit,
     {CSV("e,s\\n0,0\\n.2,.1\\n.19,.2\\n.3,.3\\n.29,.29\\n.4,.5\\n.39,.6\\n.6,.7\\n")},
     NULL,
     NULL},
};

START_TEST(variants_are_taken_or_refused) {
  suite_check_variant(&variants[_i]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: variants of tables");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_loop_test(tcase, variants_are_taken_or_refused, 0, sizeof variants / sizeof *variants);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
