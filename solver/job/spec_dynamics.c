/* The motion that a snap job asks for. */
#include <math.h>
#include <stdlib.h>

#include "solver/job/bistable.h"
#include "solver/job/reader.h"
#include "solver/job/snap.h"

/* Time for which the set-point is held after its ramp, s. */
#define HELD 1.0
#define SAMPLES_RATE 1000.0
#define TOLERANCE 1e-9

/* A ramp from 0. */
static enum status ramp(const struct reader *reader, double to, double rate,
                        struct bistable_spec *spec) {
  struct hlpv_input *input = &spec->actuator[0].input;
  input->profile = HLPV_LINEAR;
  input->count = 2;
  input->time = calloc(2, sizeof *input->time);
  input->value = calloc(2, sizeof *input->value);
  if (!input->time || !input->value) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the set-point");
  }
  input->time[1] = to / rate;
  input->value[1] = to;
  spec->end = input->time[1] + HELD;
  spec->sample_rate = fmin(SAMPLES_RATE, (BISTABLE_SAMPLES_MAX - 2) / spec->end);
  spec->tolerance = TOLERANCE;
  return STATUS_OK;
}

static void add_pairs(const struct reader *reader, const json_t *value,
                      struct bistable_spec *spec) {
  double spread = json_number_value(json_object_get(value, "trigger_spread"));
  spec->cell_count = reader_count(value, "pairs", 1);
  for (int i = 0; i < spec->cell_count; i++) {
    spec->cell[i] = (struct cell_spec){
        .stiffness = 1.0 + spread * (i - 0.5 * (spec->cell_count - 1)),
        .size = 1.0,
        .mass = reader_member(reader, value, "pair_mass", "kg", 0.0),
        .damping = reader_member(reader, value, "damping", "N s/m", 0.0),
        .elongation = NAN,
        .stop_from = -INFINITY,
        .stop_to = INFINITY,
    };
  }
  spec->actuator_count = 1;
  spec->actuator[0].cell_count = spec->cell_count;
}

enum status reader_snap_dynamics(const struct reader *reader, const json_t *value,
                                 struct job_spec *job) {
  const struct snap_spec *snap = job->snap;
  double spread = json_number_value(json_object_get(value, "trigger_spread"));
  int pairs = reader_count(value, "pairs", 1);
  if (snap->law_count < 2 || snap->pair_count != 1) {
    return error_set(reader->error, STATUS_INVALID, "/dynamics",
                     "the motion needs the law of one pair at several pressures\ngive "
                     "\"actuator\": { \"pairs\": 1 } and for example \"load\": { \"law\": [\"-20 "
                     "kPa\", \"0 kPa\", \"20 kPa\", \"40 kPa\", \"60 kPa\"] }");
  }
  if (spread * 0.5 * (pairs - 1) >= 0.9) {
    return error_set(reader->error, STATUS_INVALID, "/dynamics/trigger_spread",
                     "%d pairs whose triggers differ by %.3g would have one without a trigger\nthe "
                     "spread must be smaller",
                     pairs, spread);
  }
  struct bistable_spec *spec = calloc(1, sizeof *spec);
  if (!spec) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the model");
  }
  job->bistable = spec;
  spec->law_count = 1;
  spec->law[0].is_table = true;
  reader_copy(spec->law[0].pointer, sizeof spec->law[0].pointer, "/load/law");
  reader_copy(spec->law[0].name, sizeof spec->law[0].name, "snap");
  add_pairs(reader, value, spec);
  spec->plate_mass = reader_member(reader, value, "plate_mass", "kg", 0.0);
  spec->initial_pressure = NAN;
  enum status status = reader_pneumatics(reader, json_object_get(value, "pneumatics"),
                                         "/dynamics/pneumatics", &spec->actuator[0].supply);
  double rate = reader_member(reader, value, "rate", "kPa/s", 0.0);
  return status == STATUS_OK ? ramp(reader, snap->pressure_to, rate, spec) : status;
}
