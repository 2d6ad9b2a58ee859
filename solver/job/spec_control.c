/* The position control of a hybrid model. */
#include <math.h>
#include <stdlib.h>

#include "solver/job/hlpv_control.h"
#include "solver/job/reader.h"

/* What the job gives, but for the reference. */
static void read_figures(const struct reader *reader, const json_t *value,
                         const struct hlpv_spec *spec, struct hlpv_control *control) {
  const json_t *limits = json_object_get(value, "saturation");
  const json_t *weights = json_object_get(value, "weights");
  const json_t *noise = json_object_get(value, "noise");
  const json_t *assumed = json_object_get(value, "assumed");
  control->interval = 1.0 / reader_member(reader, value, "rate", "Hz", 50.0);
  control->lowest = reader_quantity(reader, json_array_get(limits, 0), "kPa");
  control->highest = reader_quantity(reader, json_array_get(limits, 1), "kPa");
  control->regions = reader_count(value, "regions", 9);
  control->weight_h = reader_member(reader, weights, "h", "mm", 1e-3);
  control->weight_set_point = reader_member(reader, weights, "set_point", "kPa", 1e4);
  control->integral_time = reader_member(reader, weights, "integral_time", "s", 0.5);
  control->guard_margin = reader_member(reader, value, "guard_margin", "mm", 0.0);
  control->anti_windup = json_is_true(json_object_get(value, "anti_windup"));
  control->noise_h = reader_member(reader, noise, "h", "mm", 0.0);
  control->noise_pressure = reader_member(reader, noise, "pressure", "kPa", 0.0);
  control->seed = (unsigned long)json_number_value(json_object_get(noise, "seed"));
  control->mass = reader_member(reader, assumed, "mass", "kg", spec->mass);
  control->gamma = reader_member(reader, assumed, "gamma", "N/kPa", spec->gamma);
}

static enum status check(const struct reader *reader, const struct hlpv_spec *spec,
                         const struct hlpv_control *control) {
  if (!(control->lowest < control->highest)) {
    return error_set(reader->error, STATUS_INVALID, "/control/saturation",
                     "%.6g kPa is not below %.6g kPa\nthey must rise\n[\"-5 psi\", \"8 psi\"]",
                     1e-3 * control->lowest, 1e-3 * control->highest);
  }
  double samples = spec->end / control->interval;
  if (samples > CONTROL_SAMPLES_MAX) {
    return error_set(reader->error, STATUS_INVALID, "/control/rate",
                     "%.6g Hz over %.6g s are %.0f samples of the controller\nat most %d",
                     1.0 / control->interval, spec->end, samples, CONTROL_SAMPLES_MAX);
  }
  return STATUS_OK;
}

/* The set-point that is held while nothing is asked for: 0, or what is nearest to it. */
static enum status rest_input(const struct reader *reader, const struct hlpv_control *control,
                              struct hlpv_input *input) {
  input->time = calloc(1, sizeof *input->time);
  input->value = calloc(1, sizeof *input->value);
  if (!input->time || !input->value) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the set-point");
  }
  input->profile = HLPV_HELD;
  input->count = 1;
  input->value[0] = fmin(fmax(0.0, control->lowest), control->highest);
  return STATUS_OK;
}

enum status reader_hlpv_control(const struct reader *reader, const json_t *value,
                                struct hlpv_spec *spec) {
  struct hlpv_control *control = calloc(1, sizeof *control);
  if (!control) {
    return error_set(reader->error, STATUS_NO_MEMORY, NULL, "no memory for the control");
  }
  spec->control = control;
  read_figures(reader, value, spec, control);
  enum status status = check(reader, spec, control);
  if (status == STATUS_OK) {
    status = reader_reference(reader, json_object_get(value, "reference"), "/control/reference",
                              &control->reference);
  }
  return status == STATUS_OK ? rest_input(reader, control, &spec->input) : status;
}
