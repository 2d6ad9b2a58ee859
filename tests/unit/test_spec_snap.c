/* Jobs of bellows that snap: bodies, loads, calibrations and motions that are taken, and those that
 * are refused. */
#include <math.h>

#include "solver/job/snap.h"
#include "tests/unit/suite.h"

static const char snap[] =
    "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", \"outer_diameter\": \"40 "
    "mm\", \"wall\": \"2 mm\", \"snapping_angle\": \"40 deg\", \"supporting_angle\": \"55 deg\", "
    "\"pet_thickness\": \"0.25 mm\", \"snapping_slant\": \"5 mm\"}, \"silicone\": {\"model\": "
    "\"neo-hooke\", \"mu\": \"0.19 MPa\"}, \"load\": {}}";

#define PAIRS(count)                                                                               \
  { "/actuator/pairs", count }
#define CALIBRATE(pointer, from, to)                                                               \
  {                                                                                                \
    "/calibrate", "{\"pointer\": \"" pointer "\", \"target\": \"35 kPa\", \"from\": \"" from       \
                  "\", \"to\": \"" to "\"}"                                                        \
  }
#define LAW                                                                                        \
  { "/load/law", "[\"-20 kPa\", \"0 kPa\", \"20 kPa\", \"60 kPa\"]" }
#define MOTION(more)                                                                               \
  {                                                                                                \
    "/dynamics",                                                                                   \
        "{\"pairs\": 3, \"pair_mass\": \"12 g\", \"plate_mass\": \"30 g\", \"damping\": \"2 N "    \
        "s/m\", \"rate\": \"10 kPa/s\", \"pneumatics\": {\"supply\": \"direct\"}" more "}"         \
  }

static const struct variant variants[] = {
    {snap, {{NULL}}, NULL, NULL},
    {snap, {{"/accuracy", "\"fine\""}, {"/model", "\"shell\""}}, NULL, NULL},
    {snap, {{"/accuracy", "\"fast\""}, {"/contact", "false"}}, NULL, NULL},
    /* bodies */
    {snap, {PAIRS("3"), {"/actuator/ends", "\"plates\""}}, NULL, NULL},
    {snap, {{"/actuator/hinge_wall", "\"1.5 mm\""}}, NULL, NULL},
    {snap, {{"/actuator/supporting_pet", "\"4 mm\""}}, NULL, NULL},
    {snap,
     {PAIRS("2"),
      {"/actuator/imperfection",
       "{\"snapping_angle\": [1, 1.02], \"snapping_slant\": [0.98, 1], \"pet_thickness\": [1, "
       "1.1]}"}},
     NULL,
     NULL},
    {snap,
     {{"/actuator/imperfection", "{\"snapping_angle\": [1, 1.02]}"}},
     "/actuator/imperfection/snapping_angle",
     "2 factors for 1 pair: give one"},
    {snap,
     {PAIRS("2"), {"/actuator/imperfection", "{\"snapping_slant\": [1]}"}},
     "/actuator/imperfection/snapping_slant",
     "1 factors for 2 pairs"},
    {snap,
     {PAIRS("2"), {"/actuator/imperfection", "{\"pet_thickness\": [1]}"}},
     "/actuator/imperfection/pet_thickness",
     "for 2 pairs"},
    {snap,
     {PAIRS("2"), {"/actuator/imperfection", "{\"snapping_angle\": [1, 1.5]}"}},
     "/actuator/imperfection/snapping_angle/1",
     "below 1.375"},
    {snap, {{"/actuator/snapping_angle", "\"55 deg\""}}, "/actuator/snapping_angle", "55 deg"},
    {snap,
     {{"/actuator/snapping_angle", "\"70 deg\""},
      {"/actuator/imperfection", "{\"snapping_angle\": [0.7]}"}},
     "/actuator/snapping_angle",
     "a smaller angle"},
    {snap, {{"/actuator/pet_thickness", "\"1.91 mm\""}}, "/actuator/wall", "at least 2.01 mm"},
    {snap, {{"/actuator/hinge_wall", "\"0.3 mm\""}}, "/actuator/hinge_wall", "at least 0.35 mm"},
    {snap, {{"/actuator/hinge_length", "\"1 mm\""}}, "/actuator/hinge_length", "at least \"1.5"},
    {snap, {{"/actuator/outer_diameter", "\"5 mm\""}}, "/actuator/outer_diameter", "a wider one"},
    {snap,
     {{"/actuator/snapping_slant", "\"30 mm\""}},
     "/actuator/snapping_slant",
     "must be below 2"},
    {snap,
     {{"/actuator/snapping_slant", "\"0.01 mm\""}, {"/actuator/supporting_slant", "\"1 mm\""}},
     "/actuator/supporting_slant",
     "equally wide crests"},
    {snap,
     {{"/actuator/supporting_slant", "\"9 mm\""}, {"/actuator/ends", "\"plates\""}},
     NULL,
     NULL},
    {snap, {{"/actuator/snapping_slant", "\"0.1 mm\""}}, "/actuator/snapping_slant", "too short"},
    {snap,
     {{"/actuator/snapping_slant", "\"0.1 mm\""},
      {"/actuator/snapping_angle", "\"54 deg\""},
      {"/actuator/supporting_angle", "\"80 deg\""}},
     "/actuator/snapping_slant",
     "short"},
    {snap, {{"/actuator/supporting_pet", "\"0.1 mm\""}}, "/actuator/supporting_pet", "too short"},
    {snap, {{"/actuator/supporting_pet", "\"20 mm\""}}, "/actuator/supporting_pet", "at most"},
    /* the silicone; its place is not that of the material of other kinds */
    {snap, {{"/silicone", "\"dragon-skin-20\""}}, NULL, NULL},
    {snap,
     {{"/silicone", "{\"model\": \"mooney-rivlin\", \"C10\": \"1 kPa\", \"C01\": \"-1 kPa\"}"}},
     "/silicone",
     "at least 1 Pa"},
    {snap,
     {{"/silicone", "{\"model\": \"ogden\", \"mu\": [\"1 kPa\", \"2 kPa\"], \"alpha\": [2]}"}},
     "/silicone/alpha",
     "one for each"},
    /* loads */
    {snap, {{"/load/extension_at", "\"60 kPa\""}}, NULL, NULL},
    {snap, {{"/load/extension_at", "\"61 kPa\""}}, "/load/extension_at", "0 to 60 kPa"},
    {snap, {{"/load/extension_at", "\"-1 kPa\""}}, "/load/extension_at", "not on the way"},
    {snap, {LAW}, NULL, NULL},
    {snap, {{"/load/law", "[\"0 kPa\", \"0 kPa\"]"}}, "/load/law/1", "they must rise"},
    {snap, {LAW, PAIRS("2")}, "/load/law", "there are 2"},
    /* calibrations */
    {snap, {CALIBRATE("/actuator/snapping_slant", "4.8 mm", "5.6 mm")}, NULL, NULL},
    {snap, {CALIBRATE("/pet/modulus", "2 GPa", "4000 MPa")}, NULL, NULL},
    {snap,
     {{"/calibrate", "{\"pointer\": \"/actuator/snapping_angle\", \"metric\": "
                     "\"travel_per_pair_mm\", \"target\": \"8 mm\", \"from\": \"30 deg\", "
                     "\"to\": \"45 deg\"}"}},
     NULL,
     NULL},
    {snap,
     {{"/calibrate", "{\"pointer\": \"/pet/modulus\", \"metric\": \"travel_per_pair_mm\", "
                     "\"target\": \"8 kPa\", \"from\": \"1 GPa\", \"to\": \"2 GPa\"}"}},
     "/calibrate/target",
     "a length is wanted"},
    {snap,
     {CALIBRATE("/actuator/hinge_wall", "1 deg", "2 mm")},
     "/calibrate/from",
     "a length is wanted"},
    {snap, {CALIBRATE("/pet/modulus", "1 GPa", "2")}, "/calibrate/to", "has no unit"},
    {snap,
     {CALIBRATE("/actuator/snapping_slant", "5.6 mm", "4.8 mm")},
     "/calibrate/to",
     "4.8 mm is not above 5.6 mm"},
    {snap,
     {CALIBRATE("/actuator/hinge_length", "0 mm", "3 mm")},
     "/calibrate/from",
     "hinge_length = 0 mm: a positive number"},
    {snap,
     {CALIBRATE("/actuator/snapping_angle", "30 deg", "60 deg")},
     "/calibrate/to",
     "snapping_angle = 60 deg"},
    /* motions */
    {snap, {LAW, MOTION("")}, NULL, NULL},
    {snap, {MOTION("")}, "/dynamics", "the law of one pair"},
    {snap, {PAIRS("2"), MOTION("")}, "/dynamics", "the law of one pair"},
    {snap,
     {LAW, MOTION(", \"trigger_spread\": 0.2"), {"/dynamics/pairs", "12"}},
     "/dynamics/trigger_spread",
     "must be smaller"},
};

START_TEST(variants_are_taken_or_refused) {
  suite_check_variant(&variants[_i]);
}
END_TEST

/* The body of a calibration is the given one, whatever its ends have been tried for. */
START_TEST(a_calibration_leaves_the_body_alone) {
  const char *const edits[][2] = {CALIBRATE("/actuator/snapping_slant", "4.8 mm", "5.6 mm"),
                                  {NULL, NULL}};
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(suite_read_document(snap, edits, &spec, &error), STATUS_OK);
  suite_check_near(spec.snap->given.snapping_slant, 5e-3);
  suite_check_near(spec.snap->pair[0].snapping_slant, 5e-3);
  suite_check_near(spec.snap->calibrate.target, 35e3);
  suite_check_near(spec.snap->calibrate.to, 5.6e-3);
  job_spec_release(&spec);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: bellows that snap");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_loop_test(tcase, variants_are_taken_or_refused, 0, sizeof variants / sizeof *variants);
  tcase_add_test(tcase, a_calibration_leaves_the_body_alone);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
