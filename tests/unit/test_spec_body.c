/* Pneu-nets of one and of two rows: suckers, gaps, layers and parameters of sensitivities that are
 * taken, and those that are refused. */
#include "tests/unit/suite.h"

#define SUCKERS(list)                                                                              \
  { "/actuator/suckers", "[" list "]" }
#define SUCKER(position, diameter, more)                                                           \
  "{\"position\": \"" position "\", \"diameter\": \"" diameter "\"" more "}"
#define SENSITIVITY(pointer)                                                                       \
  { "/sensitivity", "{\"parameters\": [\"" pointer "\"]}" }
#define ROOT                                                                                       \
  { "/actuator/gap_root", "\"1 mm\"" }
#define ROUND                                                                                      \
  { "/actuator/gap_round", "\"1 mm\"" }
#define MATERIAL(text)                                                                             \
  { "/material", "{" text "}" }
#define OBLIQUE(more)                                                                              \
  {                                                                                                \
    "/actuator", "{\"family\": \"oblique-pneunet\", \"length\": \"260 mm\", \"width\": \"25 "      \
                 "mm\", \"height\": "                                                              \
                 "\"20 mm\", \"chamber_angle\": \"45 deg\", \"chamber_thickness\": \"4 mm\", "     \
                 "\"chamber_gap\": "                                                               \
                 "\"1.5 mm\", \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": " \
                 "\"10 mm\"" more "}"                                                              \
  }

static const struct variant variants[] = {
    /* suckers */
    {NULL, {SUCKERS(SUCKER("40 mm", "10 mm", ""))}, NULL, NULL},
    {NULL, {SUCKERS(SUCKER("30 mm", "8 mm", "") "," SUCKER("60 mm", "8 mm", ""))}, NULL, NULL},
    {NULL,
     {SUCKERS(SUCKER("40 mm", "4 mm", ", \"wall\": \"2.1 mm\""))},
     "/actuator/suckers/0/wall",
     "at most 2 mm"},
    {NULL,
     {SUCKERS(SUCKER("3 mm", "10 mm", ", \"wall\": \"1 mm\""))},
     "/actuator/suckers/0/position",
     "leaves the body at its base: the middle must be between 6.1 mm and 111.9 mm"},
    {NULL,
     {SUCKERS(SUCKER("114 mm", "10 mm", ", \"wall\": \"1 mm\""))},
     "/actuator/suckers/0/position",
     "at its tip"},
    {NULL,
     {SUCKERS(SUCKER("60 mm", "28 mm", ", \"wall\": \"1 mm\""))},
     "/actuator/suckers/0/diameter",
     "wider than the body"},
    {NULL,
     {SUCKERS(SUCKER("30 mm", "8 mm", "") "," SUCKER("35 mm", "8 mm", ""))},
     "/actuator/suckers/1/position",
     "overlaps that of /actuator/suckers/0: their middles are 5 mm apart"},
    /* gaps and layers */
    {NULL, {{"/actuator/gap_shape", "\"trapezoidal\""}}, NULL, NULL},
    {NULL,
     {{"/actuator/gap_shape", "\"V\""}, {"/actuator/gap_root", "\"9 mm\""}},
     "/actuator/gap_root",
     "at most chamber_gap, 2 mm"},
    {NULL,
     {{"/actuator/gap_shape", "\"U\""}, {"/actuator/gap_round", "\"9.7 mm\""}},
     "/actuator/gap_round",
     "at most their height, 9.6 mm"},
    {NULL,
     {{"/actuator/gap_shape", "\"U\""},
      {"/actuator/chambers", "[{\"config\": \"A\", \"count\": 9}]"}},
     NULL,
     NULL},
    {NULL,
     {{"/actuator/height", "{\"base\": \"16 mm\", \"tip\": \"14 mm\"}"},
      {"/actuator/taper", "{\"bottom\": \"1 deg\"}"}},
     "/actuator/taper/bottom",
     "leave out the taper"},
    {NULL,
     {{"/actuator/height", "{\"base\": \"16 mm\", \"tip\": \"14 mm\"}"},
      {"/actuator/taper", "{\"top\": \"1 deg\"}"}},
     "/actuator/taper/top",
     "or give one height"},
    {NULL,
     {{"/actuator/taper", "{\"top\": \"10 deg\", \"bottom\": \"9 deg\"}"}},
     "/actuator/taper/top",
     "the limit is 2.6686 deg"},
    {NULL,
     {{"/actuator/chambers", "[{\"config\": \"B\", \"count\": 12}]"},
      {"/actuator/channel", NULL},
      {"/actuator/taper", "{\"left\": \"6.5 deg\"}"}},
     "/actuator/taper/left",
     "a cavity"},
    /* parameters of sensitivities */
    {NULL, {SENSITIVITY("/actuator/chamber_gap")}, NULL, NULL},
    {NULL, {SENSITIVITY("/actuator/gap_root"), ROOT}, "/sensitivity/parameters/0", "/actuator/"},
    {NULL, {SENSITIVITY("/actuator/gap_root"), ROOT, {"/actuator/gap_shape", "\"V\""}}, NULL, NULL},
    {NULL,
     {SENSITIVITY("/actuator/gap_round"), ROUND, {"/actuator/gap_shape", "\"V\""}},
     "/sensitivity/parameters/0",
     "/actuator/"},
    {NULL,
     {SENSITIVITY("/actuator/gap_round"), ROUND, {"/actuator/gap_shape", "\"U\""}},
     NULL,
     NULL},
    {NULL,
     {SENSITIVITY("/actuator/gap_round"),
      ROUND,
      {"/actuator/chambers", "[{\"config\": \"A\", \"count\": 9}]"},
      {"/actuator/gap_shape", "\"U\""}},
     "/sensitivity/parameters/0",
     "/actuator/"},
    {NULL,
     {SENSITIVITY("/actuator/gap_root"),
      ROOT,
      {"/actuator/chambers", "[{\"config\": \"A\", \"count\": 9}]"},
      {"/actuator/gap_shape", "\"V\""}},
     "/sensitivity/parameters/0",
     "/actuator/"},
    {NULL,
     {SENSITIVITY("/material/alpha/1"),
      MATERIAL("\"model\": \"ogden\", \"mu\": [\"1 MPa\", \"1 kPa\"], \"alpha\": [2, 3]")},
     NULL,
     NULL},
    {NULL,
     {SENSITIVITY("/material/C01"),
      MATERIAL("\"model\": \"mooney-rivlin\", \"C10\": \"1 MPa\", \"C01\": \"0 MPa\"")},
     NULL,
     NULL},
    {NULL,
     {SENSITIVITY("/material/mu"), MATERIAL("\"model\": \"neo-hooke\", \"mu\": \"1 MPa\"")},
     NULL,
     NULL},
    {NULL,
     {SENSITIVITY("/material/C/0"), MATERIAL("\"model\": \"neo-hooke\", \"mu\": \"1 MPa\"")},
     "/sensitivity/parameters/0",
     "/material/mu"},
    {NULL, {{"/sensitivity", "{\"parameters\": []}"}}, "/sensitivity/parameters", "too short"},
    /* materials */
    {NULL,
     {MATERIAL("\"model\": \"ogden\", \"mu\": [\"1 MPa\", \"1 kPa\"], \"alpha\": [2]")},
     "/material/alpha",
     "one for each"},
    {NULL, {MATERIAL("\"model\": \"yeoh\", \"C\": [\"0 MPa\"]")}, "/material", "at least 1 Pa"},
    /* planes: whether half the body will do */
    {NULL,
     {{"/planes", "[{\"point\": [0, \"-3 cm\", 0], \"normal\": [0, 0.5, 1]}]"},
      {"/contact", "true"},
      {"/error_estimate", "true"}},
     NULL,
     NULL},
    {NULL, {{"/load/gravity", "[0, \"9.8 m/s2\", 0]"}, {"/contact", "false"}}, NULL, NULL},
    /* two rows */
    {NULL, {OBLIQUE(", \"spine\": true")}, NULL, NULL},
    {NULL,
     {OBLIQUE(", \"channel\": {\"width\": \"4 mm\", \"height\": \"2 mm\"}, \"chambers\": 3")},
     NULL,
     NULL},
    {NULL,
     {OBLIQUE(""), {"/actuator/side_wall", "\"12 mm\""}, {"/actuator/gap_wall", "\"1 mm\""}},
     "/actuator/side_wall",
     "a side wall can be at most"},
    {NULL,
     {OBLIQUE(""), {"/actuator/height", "\"12 mm\""}},
     "/actuator/height",
     "at least 12.1 mm"},
    {NULL,
     {OBLIQUE(", \"channel\": {\"width\": \"4 mm\", \"height\": \"2 mm\", \"cover\": \"11 mm\"}")},
     "/actuator/channel/height",
     "lower than 0 mm"},
};

START_TEST(variants_are_taken_or_refused) {
  suite_check_variant(&variants[_i]);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: variants of pneu-nets");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_loop_test(tcase, variants_are_taken_or_refused, 0, sizeof variants / sizeof *variants);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
