#include "tests/physics/snap_case.h"

#include <stdio.h>
#include <string.h>

#include "tests/unit/suite.h"

static const char form[] =
    "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", "
    "\"outer_diameter\": \"40 mm\", \"wall\": \"2 mm\", \"snapping_angle\": \"40 deg\", "
    "\"supporting_angle\": \"55 deg\", \"snapping_slant\": \"5 mm\", "
    "\"pet_thickness\": \"0.25 mm\"%s}, "
    "\"silicone\": {\"model\": \"neo-hooke\", \"mu\": \"0.19 MPa\"}%s}";

enum status snap_case_read(const char *actuator, const char *job, struct job_spec *spec,
                           struct error *error) {
  char text[4000];
  *error = (struct error){.status = STATUS_OK};
  snprintf(text, sizeof text, form, actuator, job);
  return job_spec_read(text, strlen(text), spec, error);
}

void snap_case_must_read(const char *actuator, const char *job, struct job_spec *spec) {
  struct error error;
  ck_assert_msg(snap_case_read(actuator, job, spec, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
}
