/* Any bytes as a job: accepted or refused with a sentence and a place, never worse. */
#include <jansson.h>
#include <stdint.h>
#include <stdlib.h>

#include "solver/job/bistable.h"
#include "solver/job/grasp.h"
#include "solver/job/hlpv.h"
#include "solver/job/snap.h"
#include "solver/job/identify.h"
#include "solver/job/spec.h"
#include "tests/fuzz/fuzz.h"

static void check_error(const struct error *error, enum status status) {
  json_t *message = json_string(error->message);
  json_t *pointer = json_string(error->pointer);
  if (error->status != status || status == STATUS_INTERNAL || !message || !pointer ||
      error->message[0] == '\0' || (status != STATUS_TOO_LARGE && error->line < 1)) {
    abort();
  }
  json_decref(message);
  json_decref(pointer);
}

/* What every accepted job of its kind has. */
static bool is_complete(const struct job_spec *spec) {
  if (spec->kind == JOB_VERIFY) {
    return spec->verify.name[0] != '\0' && spec->verify.refinement >= 1;
  }
  if (spec->kind == JOB_IDENTIFY) {
    return json_is_object(spec->document) && spec->identify->mode_count >= 1 &&
           spec->identify->time.si > 0.0;
  }
  if (spec->kind == JOB_HLPV) {
    return spec->hlpv->mode_count >= 1 && spec->hlpv->mass > 0.0 && spec->hlpv->end > 0.0;
  }
  if (spec->kind == JOB_SNAP) {
    return spec->snap->pair_count >= 1 && spec->snap->pressure_to > 0.0;
  }
  if (spec->kind == JOB_BISTABLE) {
    return spec->bistable->cell_count >= 1 && spec->bistable->cell[0].mass > 0.0 &&
           spec->bistable->actuator_count >= 1 && spec->bistable->end > 0.0;
  }
  if (spec->kind == JOB_STUDY) {
    return json_is_object(spec->document) && spec->timeout_s > 0.0;
  }
  if (spec->kind == JOB_FIT_MATERIAL) {
    return json_is_object(spec->document) && spec->fit.count >= 1 && spec->fit.stress.si > 0.0;
  }
  if (spec->kind == JOB_MATERIAL_CURVE) {
    return spec->curve.points >= 2 && material_shear_modulus(&spec->material) > 0.0;
  }
  bool body = spec->family == FAMILY_PNEUNET
                  ? spec->pneunet.cavity_length > 0.0 && spec->pneunet.length > 0.0
                  : spec->oblique.cavity > 0.0 && spec->oblique.length > 0.0;
  bool weighs =
      spec->kind != JOB_GRASP || !spec->grasp->object.free || spec->grasp->object.mass > 0.0;
  return body && weighs && material_shear_modulus(&spec->material) > 0.0 && spec->load.steps >= 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static struct job_reader *reader; /* kept between inputs: creating it takes 10 ms */
  if (!reader && job_reader_create(&reader, NULL) != STATUS_OK) {
    abort();
  }
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status = job_reader_read(reader, (const char *)data, size, &spec, &error);
  if (status != STATUS_OK) {
    check_error(&error, status);
  } else if (!is_complete(&spec)) {
    abort();
  }
  job_spec_release(&spec);
  return 0;
}
